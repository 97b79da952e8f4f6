#include "firmware/description/wide_limits.hpp"

#include <gtest/gtest.h>

#include <string>

#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

// Numbers that switched guards off without a word: each is refused on devices, and names its key; a waiver says why.
TEST(WideLimits, NeedWords) {
  const auto objection = [](const std::string& more) {
    return firmware::wide_objection(firmware::parse_rig(std::string(support::hil_text) + more, "rig.toml"));
  };
  EXPECT_TRUE(objection("").empty()) << objection("").text;
  for (const auto& [table, entry, key] :
       {std::tuple("limits", "speed = 100.0", "limits.speed"),
        std::tuple("limits", "ramp = 0.6", "limits.ramp"),
        std::tuple("limits", "ramp = 0.21", "limits.ramp"),
        std::tuple("limits", "low_speed = 0.3", "limits.low_speed"),
        std::tuple("limits", "low_force = 20e3", "limits.low_force"),
        std::tuple("supervision", "force_share = 0.0", "supervision.force_share"),
        std::tuple("supervision", "innovation_share = 1.0", "supervision.innovation_share"),
        std::tuple("supervision", "innovation_noise = 100.0", "supervision.innovation_noise"),
        std::tuple("limits", "force = 500e3", "limits.force"),
        std::tuple("limits", "stroke = 1.5", "limits.stroke"),
        std::tuple("limits", "measured_stroke = 0.5", "limits.measured_stroke"),
        std::tuple("limits", "measured_speed = 5.0", "limits.measured_speed"),
        std::tuple("supervision", "bridged_leak = 1.0", "supervision.bridged_leak"),
        std::tuple("supervision", "late_leak = 1.0", "supervision.late_leak"),
        std::tuple("supervision", "late_after = 1.0", "supervision.late_after"),
        std::tuple("motion", "braking = 0.2", "motion.braking"),
        std::tuple("arming", "force_ramp = 0.0", "arming.force_ramp"),
        std::tuple("limits", "acceleration = 1e5", "limits.acceleration"),
        std::tuple("limits", "following = 0.1", "limits.following"),
        std::tuple("limits", "energy_gain = 50.0", "limits.energy_gain"),
        std::tuple("supervision", "frozen_time = 0.0", "supervision.frozen_time"),
        std::tuple("supervision", "frozen_time = 1.0", "supervision.frozen_time"),
        std::tuple("supervision", "frozen_samples = 0", "supervision.frozen_time"),
        std::tuple("supervision", "gap = 1.0", "supervision.gap"),
        std::tuple("supervision", "unpowered_way = 0.05", "supervision.unpowered_way"),
        std::tuple("controller", "late_in_a_row = 1000", "controller.late_in_a_row"),
        std::tuple("arming", "preload = 20e3", "arming.preload"),
        std::tuple("arming", "sway = 9e3", "arming.sway")}) {
    const std::string text = "[" + std::string(table) + "]\n" + entry + "\n";
    EXPECT_EQ(objection(text).key, key) << objection(text).text;
    EXPECT_TRUE(objection(text + "[waivers]\nwide_limits = 'a rig without people'\n").empty()) << entry;
  }
}

// Descriptions of before count samples, of their own rate.
TEST(WideLimits, TakesFrozenSamplesForATime) {
  const auto parsed = [](const std::string& more) {
    return firmware::parse_rig(std::string(support::hil_text) + "[supervision]\n" + more, "rig.toml");
  };
  const firmware::RigDescription rig = parsed("frozen_samples = 300\n");
  EXPECT_DOUBLE_EQ(rig.controller.loop.supervision.frozen_time, 300.0 / rig.sample_rate);
  EXPECT_THROW((void)parsed("frozen_samples = 300\nfrozen_time = 0.1\n"), firmware::InputError);
}

}  // namespace
