// [estimator] and the policy of [valves]: read, written, refused.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/semi_active_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace semi_active_test {
namespace {

using firmware::RigDescription;
using model::Channel;

std::string shipped() { return support::TemporaryFolder::read(support::rig_file("paper_rig_kalman")); }

std::string refusal(const std::string& text) {
  try {
    const RigDescription rig = firmware::parse_rig(text, "rig.toml");
    static_cast<void>(firmware::companion(rig));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string estimator(const std::string& keys) {
  return support::with(shipped(), "kind = \"kalman\"\n", "kind = \"kalman\"\n" + keys + "\n");
}
std::string valves(const std::string& keys) { return support::with(shipped(), "policy = \"rollout\"\n", keys + "\n"); }

// Law. What is read is what is written: the keys survive rigtwin diagnose's rig.toml.
TEST(SemiActiveDescription, IsWrittenAsItWasRead) {
  const std::string text = support::with(
      estimator(
          "sensors = [\"zdd_b\", \"dz_b\"]\nbias = [\"zdd_b\"]\nbias_drift = 0.2\nhistory = 6\nfalse_alarms = 0.5\n"
          "cut_off = 0.1\nage = { dz_b = 0.005 }"),
      "policy = \"rollout\"",
      "policy = \"force_velocity\"\nwheel_load = 2.0\nstroke = 0.5\ndwell = 0.03\ndelay = 0.02\npressure_peak = 2e6");
  const RigDescription read = firmware::parse_rig(text, "a.toml");
  const RigDescription again = firmware::parse_rig(firmware::format_rig(read), "b.toml");
  for (const RigDescription* rig : {&read, &again}) {
    const auto& kalman = rig->controller.kalman;
    EXPECT_TRUE(kalman.enabled);
    EXPECT_EQ(rig->controller.estimator_sensors, (std::vector<Channel>{Channel::zdd_b, Channel::dz_b}));
    EXPECT_TRUE(kalman.bias[model::index(Channel::zdd_b)]);
    EXPECT_EQ(kalman.bias_drift, 0.2);
    EXPECT_EQ(kalman.history, 6);
    EXPECT_EQ(kalman.false_alarms, 0.5);
    EXPECT_EQ(kalman.cut_off, 0.1);
    EXPECT_EQ(kalman.age[model::index(Channel::dz_b)], 0.005);
    const auto& ducts = rig->controller.ducts;
    EXPECT_EQ(ducts.policy, firmware::DuctPolicyKind::force_velocity);
    EXPECT_EQ(ducts.wheel_load, 2.0);
    EXPECT_EQ(ducts.stroke, 0.5);
    EXPECT_EQ(ducts.dwell, 0.03);
    EXPECT_EQ(ducts.delay, 0.02);
    EXPECT_EQ(ducts.pressure_peak, 2e6);
  }
  EXPECT_NE(firmware::companion(read), nullptr);
  EXPECT_EQ(firmware::companion(support::rig("paper_rig_fdva")), nullptr);
}

// Fault. Each mistake is named with its key.
TEST(SemiActiveDescription, RefusesWhatDoesNotFit) {
  EXPECT_EQ(refusal(shipped()), "accepted");
  for (const auto& [text, words] : std::map<std::string, std::string>{
           {support::with(shipped(), "\"kalman\"", "\"luenberger\""), "estimator.kind"},
           {support::with(shipped(), "kind = \"kalman\"", ""), "valves.policy"},
           {estimator("sensors = []"), "estimator.sensors"},
           {estimator("sensors = [\"F_q\"]"), "estimator.sensors"},
           {estimator("sensors = [\"z_b\"]"), "cannot weigh z_b"},
           {estimator("sensors = [\"zdd_b\", \"zdd_w\"]\ncut_off = 0.0"), "'z_w' is not observable"},
           {estimator("bias = [\"z_w\"]"), "estimator.bias"},
           {estimator("history = 0"), "history"},
           {estimator("noise = 1.0"), "noise"},
           {support::with(shipped(), "speed = 27.78", "speed = 1000.0"), "speed"},
           {valves("policy = \"skyhook\""), "valves.policy"},
           {valves("policy = \"rollout\"\ndwell = 0.0"), "dwell"},
           {valves("policy = \"rollout\"\ndelay = 20.0"), "delay"},
           {valves("policy = \"rollout\"\nwheel_load = 0.0"), "weights"},
           {valves("policy = \"rollout\"\npressure_peak = 10.0"), "pressure_peak"}}) {
    EXPECT_NE(refusal(text).find(words), std::string::npos) << words << ": " << refusal(text);
  }
}

}  // namespace
}  // namespace semi_active_test
