#include "firmware/loop/common/settings.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using firmware::Settings;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Settings, AreSoundAsTheyCome) { EXPECT_EQ(Settings{}.check(), ""); }

// The numbers of the rig and of its agreement: a limit that drifts unseen protects nobody.
TEST(Settings, HaveTheLimitsOfTheRig) {
  const Settings s;
  EXPECT_EQ(s.limits.stroke, 0.250);
  EXPECT_EQ(s.limits.speed, 0.7);
  EXPECT_EQ(s.limits.force, 25e3);
  EXPECT_EQ(s.limits.bridged_in_a_row, 3);
}

// The ends of what is allowed are allowed.
TEST(Settings, TakeTheEndsOfTheirBounds) {
  const std::vector<std::function<void(Settings&)>> ends{[](Settings& s) { s.period = hal::microseconds(10); },
                                                         [](Settings& s) { s.period = hal::milliseconds(1000); },
                                                         [](Settings& s) { s.limits.speed_time = 0.0; },
                                                         [](Settings& s) { s.limits.bridged_in_a_row = 1; },
                                                         [](Settings& s) { s.limits.stale_after = 1.0; },
                                                         [](Settings& s) { s.limits.stale_after = 1000.0; },
                                                         [](Settings& s) { s.limits.late_after = 1.0; },
                                                         [](Settings& s) { s.limits.late_in_a_row = 1; },
                                                         [](Settings& s) { s.ramps.rest = 0.125; },
                                                         [](Settings& s) { s.ramps.rest = -0.125; },
                                                         [](Settings& s) { s.ramps.rate = s.limits.speed; },
                                                         [](Settings& s) { s.ramps.settling = 0.0; }};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    Settings settings;
    ends[i](settings);
    EXPECT_EQ(settings.check(), "") << i;
  }
}

TEST(Settings, SayWhichKeyIsWrong) {
  struct Case {
    std::string key;
    std::function<void(Settings&)> spoil;
  };
  const std::vector<Case> cases{
      {"period", [](Settings& s) { s.period = {}; }},
      {"period", [](Settings& s) { s.period = hal::milliseconds(1001); }},
      {"limits.stroke", [](Settings& s) { s.limits.stroke = 0.0; }},
      {"limits.stroke", [](Settings& s) { s.limits.stroke = nan; }},
      {"limits.stroke", [](Settings& s) { s.limits.stroke = infinity; }},
      {"limits.speed:", [](Settings& s) { s.limits.speed = -1.0; }},
      {"limits.speed_time", [](Settings& s) { s.limits.speed_time = -1e-3; }},
      {"limits.force", [](Settings& s) { s.limits.force = nan; }},
      {"limits.bridged_in_a_row", [](Settings& s) { s.limits.bridged_in_a_row = 0; }},
      {"limits.bridged_leak", [](Settings& s) { s.limits.bridged_leak = 0.0; }},
      {"limits.bridged_leak", [](Settings& s) { s.limits.bridged_leak = 1.1; }},
      {"limits.stale_after", [](Settings& s) { s.limits.stale_after = 0.5; }},
      {"limits.stale_after", [](Settings& s) { s.limits.stale_after = 1e4; }},
      {"limits.late_after", [](Settings& s) { s.limits.late_after = 0.0; }},
      {"limits.late_after", [](Settings& s) { s.limits.late_after = 1.5; }},
      {"limits.late_in_a_row", [](Settings& s) { s.limits.late_in_a_row = 0; }},
      {"limits.energy_gain", [](Settings& s) { s.limits.energy_gain = 0.0; }},
      {"limits.energy_memory", [](Settings& s) { s.limits.energy_memory = nan; }},
      {"limits.energy_quiet", [](Settings& s) { s.limits.energy_quiet = -1e-3; }},
      {"limits.energy_cycles", [](Settings& s) { s.limits.energy_cycles = 0; }},
      {"limits.acceleration", [](Settings& s) { s.limits.acceleration = nan; }},
      {"limits.following", [](Settings& s) { s.limits.following = 0.0; }},
      {"limits.measured_stroke", [](Settings& s) { s.limits.measured_stroke = 0.249; }},
      {"limits.measured_speed", [](Settings& s) { s.limits.measured_speed = 0.69; }},
      {"supervision.following_time", [](Settings& s) { s.supervision.following_time = -1.0; }},
      {"supervision.speed_window", [](Settings& s) { s.supervision.speed_window = 0.0; }},
      {"supervision.frozen_time", [](Settings& s) { s.supervision.frozen_time = -1.0; }},
      {"supervision.frozen_way", [](Settings& s) { s.supervision.frozen_way = nan; }},
      {"supervision.frozen_speed", [](Settings& s) { s.supervision.frozen_speed = 0.0; }},
      {"supervision.frozen_acceleration", [](Settings& s) { s.supervision.frozen_acceleration = -1.0; }},
      {"supervision.late_leak", [](Settings& s) { s.supervision.late_leak = 0.0; }},
      {"supervision.gap", [](Settings& s) { s.supervision.gap = 0.0; }},
      {"supervision.growth_time", [](Settings& s) { s.supervision.growth_time = nan; }},
      {"ramps.rest", [](Settings& s) { s.ramps.rest = 0.126; }},
      {"ramps.rest", [](Settings& s) { s.ramps.rest = -0.126; }},
      {"ramps.rate", [](Settings& s) { s.ramps.rate = 0.0; }},
      {"ramps.rate", [](Settings& s) { s.ramps.rate = 0.8; }},
      {"ramps.braking", [](Settings& s) { s.ramps.braking = 0.0; }},
      {"ramps.settling", [](Settings& s) { s.ramps.settling = -1.0; }},
      {"observers.cross_over", [](Settings& s) { s.observers.cross_over = 0.0; }},
      {"observers.differentiation", [](Settings& s) { s.observers.differentiation = nan; }},
  };
  for (const Case& c : cases) {
    Settings settings;
    c.spoil(settings);
    EXPECT_EQ(settings.check().substr(0, c.key.size()), c.key) << settings.check();
  }
}

}  // namespace
