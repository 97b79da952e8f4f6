#include "firmware/description/probe_response.hpp"

#include <gtest/gtest.h>

#include <string>

#include "firmware/description/control_settings.hpp"
#include "tests/support/rig_texts.hpp"

namespace probe_response_test {
namespace {

double stiffness_of(const std::string& text) {
  return firmware::probe_stiffness(firmware::parse_rig(text, "rig.toml"), 2e-3);
}

// Law. A spring answers with its stiffness, however late and through whatever machine: to rounding. A mass that moves
// with it takes m Σẋ²/Σx² off, of x = s²(1 − s)² in 1 s: 4 (B(3, 3) − 4 B(4, 4))/B(5, 5) = 12 1/s².
TEST(ProbeResponse, OfASpringIsItsStiffness) {
  const std::string hil(support::hil_text);
  const std::size_t fdva = hil.find("[fdva]"), effects = hil.find("[effects");
  const std::string spring = hil.substr(0, fdva) + hil.substr(effects);
  EXPECT_NEAR(stiffness_of(spring), 31'500.0, 1e-6 * 31'500.0);
  EXPECT_NEAR(stiffness_of(spring + "[effects.sensor_gain.F]\ngain = 1.5\n"), 47'250.0, 0.1);
  EXPECT_NEAR(stiffness_of(spring + "[effects.sensor_offset.F]\noffset = 100.0\n"), 31'500.0, 0.1)
      << "taken off at rest";
  EXPECT_NEAR(stiffness_of(spring + "[effects.moving_mass]\nmass = 10.0\n"), 31'500.0 - 10.0 * 12.0, 2.0);
}

// Law. With closed ducts the piston stands still and its coupling is a second spring; open ones let it move, by less
// than all: the oil has mass.
TEST(ProbeResponse, OfAnAbsorberFollowsItsDucts) {
  const std::string hil(support::hil_text);
  EXPECT_NEAR(stiffness_of(hil + "[valves]\nsafe = 0\n"), 86'500.0, 1e-3 * 86'500.0);
  const double open = stiffness_of(hil + "[valves]\nsafe = 6\n");
  EXPECT_GT(open, 20'000.0);
  EXPECT_LT(open, 60'000.0);
}

// Only a proven hil rig is judged by it.
TEST(ProbeResponse, EntersArmingWithTheProof) {
  const std::string hil = std::string(support::hil_text) + "[valves]\nsafe = 0\n";
  const auto arming = [](const std::string& text) {
    return firmware::arming_settings(firmware::parse_rig(text, "rig.toml"));
  };
  EXPECT_EQ(arming(hil).allowed_gain, 0.0);
  EXPECT_EQ(arming(hil).probe_stiffness, 0.0);
  const firmware::Arming proven = arming(hil + "[controller]\nallowed_gain = 1.16\n");
  EXPECT_EQ(proven.allowed_gain, 1.16);
  EXPECT_NEAR(proven.probe_stiffness, 86'500.0, 100.0);
  EXPECT_EQ(firmware::probe_stiffness(firmware::parse_rig(std::string(support::bench_text), "rig.toml"), 2e-3), 0.0);
}

}  // namespace
}  // namespace probe_response_test
