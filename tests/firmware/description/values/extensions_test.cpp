// Air spring, lever and varying delay in rig descriptions: read, checked with their lines, and written again.
#include "firmware/description/values/extensions.hpp"

#include <gtest/gtest.h>

#include "firmware/description/loop_proof.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::parse_rig;
using support::with;

std::string shipped() { return support::TemporaryFolder::read(support::rig_file("paper_hil_aas")); }

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(parse_rig(text, "RIG.toml"));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// One line, at the line of `place`, that says `words`.
void expect_refused(const std::string& text, std::string_view place, std::string_view words) {
  const std::string message = refusal(text);
  EXPECT_EQ(message.find("RIG.toml:" + std::to_string(support::line_of(text, place)) + ": "), 0U) << message;
  EXPECT_NE(message.find(words), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

// A key that lands in the wrong place is a rig that is silently another: each key has a value of its own.
TEST(AirSpringDescription, TakesEveryKeyToItsPlace) {
  std::string text = with(shipped(), "stiffness = 0.0\ndamping = 0.0", "stiffness = 10.0\ndamping = 0.0");
  text = text.substr(0, text.find("[air_spring]")) + "[air_spring]\npressure = 6e5\narea = 5e-3\nvolume = 7e-4\n";
  double value = 0.011;
  for (const auto& key : firmware::air_spring_keys()) {
    const double allowed = key.key == "polytropic_exponent" ? 1.3 : key.key == "volume_per_area" ? 1e-5 : value;
    text += std::string(key.key) + " = " + std::to_string(allowed) + "\n";
    value += 0.001;
  }
  const auto rig = parse_rig(text, "RIG.toml").rig;
  EXPECT_TRUE(rig.air_spring.fitted);
  EXPECT_EQ(rig.air_spring.pressure, 6e5);
  EXPECT_EQ(rig.air_spring.area, 5e-3);
  EXPECT_EQ(rig.air_spring.volume, 7e-4);
  EXPECT_EQ(rig.air_spring.area_per_stroke, 0.011);
  EXPECT_EQ(rig.air_spring.volume_per_area, 1e-5);
  EXPECT_EQ(rig.air_spring.polytropic_exponent, 1.3);
  EXPECT_EQ(rig.air_spring.skyhook, 0.023);
  EXPECT_EQ(rig.air_spring.levelling_time, 0.026);
}

// What is read is written, and is the same rig to the bit: diagnose writes descriptions.
TEST(AirSpringDescription, IsWrittenAsItWasRead) {
  const std::string text =
      with(with(shipped(), "pressure = 7e5 ", "pressure = 7.78e5 "), "virtual_damping = 1140.0",
           "virtual_damping = 1140.0\ndelay_swing = 1e-3\ndelay_jitter = 2e-4") +
      "[lever]\nat = [-0.05, 0.0, 0.05]\nratio = [0.8, 0.9, 1.1]\n[effects.air_leak]\nrate = 1e-4\n";
  const auto read = parse_rig(text, "RIG.toml");
  const auto again = parse_rig(firmware::format_rig(read), "RIG.toml");
  EXPECT_EQ(firmware::loop_text(read), firmware::loop_text(again));
  EXPECT_EQ(firmware::format_rig(read), firmware::format_rig(again));
  EXPECT_EQ(again.rig.lever.ratio[2], 1.1);
  EXPECT_EQ(again.rig.delay_variation.jitter, 2e-4);
  EXPECT_EQ(again.rig.air_spring.skyhook, 2000.0);
}

// Law. Every number of an air spring changes the loop that was found stable.
TEST(AirSpringDescription, IsPartOfTheProvenLoop) {
  const auto rig = parse_rig(shipped(), "RIG.toml");
  const std::string before = firmware::loop_fingerprint(rig);
  for (const auto& key : firmware::air_spring_keys()) {
    auto other = rig;
    other.rig.air_spring.*key.value += 1e-3;
    EXPECT_NE(firmware::loop_fingerprint(other), before) << key.key;
  }
  auto lever = rig;
  lever.rig.lever.count = 2;
  EXPECT_NE(firmware::loop_fingerprint(lever), before);
}

// Fault. One line with the place, what is wrong and what is expected.
TEST(AirSpringDescription, IsChecked) {
  const std::string text = shipped();
  expect_refused(with(text, "pressure = 7e5 ", "pressure = 5e5 "), "[air_spring]", "the body weighs 2845 N");
  expect_refused(with(text, "pressure = 7e5 ", "pressure = nan "), "pressure =", "pressure");
  expect_refused(with(text, "polytropic_exponent = 1.4", "polytropic_exponent = 14"), "polytropic_exponent", "1.67");
  expect_refused(with(text, "heat_time = 2.0", "heat_tme = 2.0"), "heat_tme", "heat_time");
  expect_refused(with(text, "skyhook = 2000.0", "skyhook = -1.0"), "skyhook = -1.0", "0 to 1e6");
  expect_refused(with(text, "skyhook = 2000.0", "volume_per_area = 1e-2\nskyhook = 2000.0"), "volume_per_area",
                 "a force that grows with the area");
  expect_refused(text + "[lever]\nat = [0.0]\nratio = [1.0]\n", "at = [0.0]", "2 to 9");
  expect_refused(text + "[lever]\nat = [0.0, 0.1]\nratio = [1.0, 1.0, 1.0]\n", "ratio = [1", "one ratio for each");
  expect_refused(text + "[lever]\nat = [0.1, 0.0]\nratio = [1.0, 1.0]\n", "at = [0.1", "ascending");
  expect_refused(text + "[lever]\nat = [0.0, 0.1]\nratio = [1.0, \"a\"]\n", "ratio = [1", "is no number");
  expect_refused(text + "[lever]\nat = [0.0, 0.1]\nratio = [1.0, 1.1]\n[tolerance]\nbody.mass = 0.1\n", "[tolerance]",
                 "beside [lever]");
  expect_refused(with(text, "virtual_damping = 1140.0", "delay_swing = 1.0"), "delay_swing", "0.1");
  expect_refused(std::string(support::hil_text) + "[effects.air_leak]\nrate = 1e-3\n", "[effects.air_leak]",
                 "the rig has no air spring");
}

// Point. Behind a lever of 0.8 the air spring carries the body with m_b g/0.8 = 3556 N (virtual work): 8.75 bar are
// right and 7 bar, which are right without the lever, are refused. Compare: model::Lever (2), F₀.
TEST(AirSpringDescription, CarriesTheBodyBehindTheLever) {
  const std::string lever = "\n[lever]\nat = [-0.08, 0.0, 0.06]\nratio = [0.7, 0.8, 0.85]\n";
  const std::string right = with(shipped(), "pressure = 7e5 ", "pressure = 8.75e5 ") + lever;
  EXPECT_EQ(refusal(right), "accepted");
  expect_refused(shipped() + lever, "[air_spring]", "which is 3556 N behind the lever's ratio 0.8 at rest");
}

// A tolerance names a parameter of the air spring as of everything else.
TEST(AirSpringDescription, HasTolerances) {
  const auto rig = parse_rig(shipped() + "[tolerance]\n\"air_spring.volume\" = 0.1\n", "RIG.toml");
  EXPECT_EQ(rig.tolerance.at("air_spring.volume"), 0.1);
  expect_refused(std::string(support::hil_text) + "[tolerance]\n\"air_spring.volume\" = 0.1\n", "\"air_spring.volume\"",
                 "unknown parameter");
}

}  // namespace
