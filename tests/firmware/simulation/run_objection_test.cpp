#include "firmware/simulation/run_objection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "firmware/description/control_settings.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::FootPointMotion;
using firmware::RigDescription;
using testing::HasSubstr;

constexpr double h = 1e-3, two_pi = 6.283185307179586;

/// Faded in over a second, so that it begins at rest: a (1 − cos ωt)/2 · …
FootPointMotion hills(double amplitude, double frequency, double seconds, double begin = 0.0) {
  FootPointMotion motion;
  const double w = two_pi * frequency;
  for (int k = 0; k < static_cast<int>(seconds / h); ++k) {
    const double t = h * k, hill = 1.0 - std::cos(w * t);
    motion.push_back({begin + 0.25 * amplitude * hill * hill, 0.5 * amplitude * w * hill * std::sin(w * t), 0.0});
  }
  return motion;
}

RigDescription rig(const char* name) { return support::rig(name); }

std::string objection_to(const RigDescription& description, const FootPointMotion& motion) {
  return firmware::run_objection(description, motion).text;
}

// The roads that the shipped rigs are for pass: class A and B at motorway speed, at the rig's own bandwidth.
TEST(RunObjection, LetsTheUsualRoadsPass) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"}) {
    const RigDescription description = rig(name);
    for (const char* letter : {"A", "B"}) {
      firmware::IsoRoad road;
      road.roughness = firmware::class_roughness(letter);
      road.bandwidth = firmware::default_bandwidth(description.rig.kind, description.sample_rate);
      const auto motion = firmware::excitation(description.rig, firmware::drive_over(road, 1000.0, 60'000), 1000.0);
      EXPECT_EQ(objection_to(description, motion), "") << name << ' ' << letter;
    }
  }
}

// Class C asks the machine of the hil rig (1.5 m/s) for 2.2 m/s now and then, for 20 ms at most: it is caught up with
// within speed_time. Three of four seeds were refused.
TEST(RunObjection, LetsARoadPassThatIsCaughtUpWith) {
  const RigDescription description = rig("paper_hil_fdva");
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    firmware::IsoRoad road;
    road.roughness = firmware::class_roughness("C");
    road.bandwidth = firmware::default_bandwidth(description.rig.kind, description.sample_rate);
    road.seed = seed;
    const auto motion = firmware::excitation(description.rig, firmware::drive_over(road, 1000.0, 60'000), 1000.0);
    EXPECT_EQ(objection_to(description, motion), "") << seed;
  }
}

// A road in millimetres moved first and tripped then.
TEST(RunObjection, GuessesMillimetres) {
  EXPECT_THAT(objection_to(rig("paper_rig_fdva"), hills(35.0, 0.5, 5.0)),
              HasSubstr("positions reach 35 m: a road in millimetres?"));
  EXPECT_THAT(objection_to(rig("paper_hil_fdva"), hills(35.0, 0.5, 5.0)),
              HasSubstr("positions reach 35 m: a road in millimetres?"));
  EXPECT_EQ(objection_to(rig("paper_rig_fdva"), hills(0.035, 0.5, 5.0)), "");
}

// Beginning at 0.3 m moved to the end of the stroke before it tripped; beginning at 0.03 m is allowed: ready goes
// there.
TEST(RunObjection, RefusesABeginningBeyondTheStroke) {
  EXPECT_THAT(objection_to(rig("paper_rig_fdva"), hills(0.01, 1.0, 3.0, 0.3)),
              HasSubstr("the command reaches 0.3 m at 0 s, limits.stroke leaves ± 0.125 m"));
  EXPECT_EQ(objection_to(rig("paper_rig_fdva"), hills(0.01, 1.0, 3.0, 0.03)), "");
  EXPECT_EQ(objection_to(rig("paper_hil_fdva"), hills(0.01, 1.0, 3.0, 0.3)), "") << "the car starts above its road";
}

// One beyond the stroke was found out after 8.6 s of motion.
TEST(RunObjection, FindsTheStrokeAtTheEndOfARun) {
  FootPointMotion motion = hills(0.05, 0.5, 8.0);
  for (const auto& m : hills(0.13, 0.5, 2.0)) motion.push_back(m);
  EXPECT_THAT(objection_to(rig("paper_bench_fdva"), motion), HasSubstr("the command reaches 0.125"));
}

// A step of 30 mm went from rest to 0.7 m/s in 1 ms; a zigzag of 1200 m/s² was not noticed; a sine that begins in full
// motion is a step of the speed.
TEST(RunObjection, RefusesStepsAndZigzags) {
  FootPointMotion step(1000, {0.0, 0.0, 0.0});
  for (std::size_t k = 500; k < step.size(); ++k) step[k].position = 0.03;
  EXPECT_THAT(objection_to(rig("paper_rig_fdva"), step), HasSubstr("steps with 30 m/s at 0.5 s, limits.speed is 0.7"));

  FootPointMotion zigzag(1000, {0.0, 0.0, 0.0});
  for (std::size_t k = 500; k < zigzag.size(); ++k) zigzag[k].position = k % 2 == 0 ? 0.0 : 0.6e-3;
  EXPECT_THAT(objection_to(rig("paper_rig_fdva"), zigzag), HasSubstr("m/s² at 0.501 s, limits.acceleration is 131.9"));

  FootPointMotion sine;
  for (int k = 0; k < 1000; ++k) sine.push_back({0.01 * std::sin(40.0 * h * k), 0.4 * std::cos(40.0 * h * k), 0.0});
  EXPECT_THAT(objection_to(rig("paper_rig_fdva"), sine), HasSubstr("fade the run in from rest"));
}

// Faster than the limit for longer than speed_time, without a step.
TEST(RunObjection, RefusesWhatTheCommandGuardWouldEnd) {
  EXPECT_THAT(objection_to(rig("paper_rig_fdva"), hills(0.1, 2.0, 3.0)), HasSubstr("the run would end by speed at "));
}

// The loop of a hil rig is simulated: an unstable one, and a kerb that asks for more than the machine has.
TEST(RunObjection, SimulatesTheLoopOfAHilRig) {
  RigDescription unstable = rig("paper_hil_fdva");
  unstable.rig.machine.virtual_damping = 700.0;
  EXPECT_THAT(objection_to(unstable, hills(0.005, 1.0, 20.0)), HasSubstr("simulated over this road, the "));

  RigDescription weak = rig("paper_hil_fdva");
  weak.controller.force = 300.0;
  weak.controller.force_given = true;
  EXPECT_THAT(objection_to(weak, hills(0.02, 1.0, 3.0)), HasSubstr("the described component has"));
}

TEST(RunObjection, RefusesWhatIsNoNumber) {
  FootPointMotion motion = hills(0.01, 1.0, 1.0);
  motion[700].position = std::nan("");
  for (const char* name : {"paper_rig_fdva", "paper_hil_fdva"}) {
    EXPECT_EQ(objection_to(rig(name), motion), "the reference is no number at 0.7 s");
    EXPECT_EQ(objection_to(rig(name), {}), "the run has no sample");
  }
}

// [limits] force of 25 kN with a 10 kN cell could never trip.
TEST(LimitsObjection, FindsLimitsThatCanNeverTrip) {
  const auto objection = [](const std::string& more) {
    return firmware::limits_objection(firmware::parse_rig(std::string(support::hil_text) + more, "rig.toml")).text;
  };
  EXPECT_EQ(objection(""), "");
  EXPECT_EQ(objection("[range]\nF = [-10000.0, 10000.0]\n"), "");
  EXPECT_EQ(objection("[range]\nF = [-10000.0, 10000.0]\n[limits]\nforce = 9e3\n"), "");
  EXPECT_THAT(
      objection("[range]\nF = [-10000.0, 10000.0]\n[limits]\nforce = 25e3\n"),
      HasSubstr("limits.force = 2.5e+04 N can never trip: [range] of the force sensor ends at 1e+04 N; expected "
                "at most 9500 N"));
  EXPECT_THAT(objection("[range]\nx_act = [-0.125, 0.125]\n[limits]\nmeasured_stroke = 0.26\n"),
              HasSubstr("limits.measured_stroke = 0.26 m can never trip"));
  const std::string output = "[converters.command]\ndevice = 'd'\noutput = 'o'\nscale = 3e-6\noffset = -0.1\n";
  EXPECT_THAT(objection(output), HasSubstr("limits.stroke = 0.25 m is wider; expected at most 0.1932 m"));
  EXPECT_EQ(objection(output + "[limits]\nstroke = 0.19\n"), "");
  const std::string area = "[converters.area]\ndevice = 'd'\noutput = 'o'\nscale = -1e-4\noffset = 0.1\n";
  const auto air_spring = [](const std::string& more) {
    const std::string text = support::TemporaryFolder::read(support::rig_file("paper_hil_aas"));
    return firmware::limits_objection(firmware::parse_rig(text + more, "rig.toml")).text;
  };
  EXPECT_EQ(air_spring(""), "");
  EXPECT_THAT(air_spring("\n" + area + "highest_counts = 4000\n"),
              HasSubstr("[converters.area] puts out -0.3 … 0.1, air_spring.actuator_stroke = 0.15 is more; expected at "
                        "most 0.1"));
}

// An objection is about a key of the description: its line is where a user looks. A limit that the description leaves
// at its default has no line of its own, but that of its table.
TEST(LimitsObjection, NamesTheLineOfItsKey) {
  std::string text(support::hil_text);
  text += "[range]\nF = [-10000.0, 10000.0]\n[limits]\nspeed = 0.5\nforce = 25e3\n";
  const RigDescription description = firmware::parse_rig(text, "rig.toml");
  const firmware::MotionObjection objection = firmware::limits_objection(description);
  EXPECT_EQ(objection.key, "limits.force");
  EXPECT_EQ(firmware::place(description, objection),
            "rig.toml:" + std::to_string(support::line_of(text, "force = 25e3")));
  EXPECT_EQ(description.line_of("limits.stroke"), support::line_of(text, "[limits]"));
  EXPECT_EQ(description.line_of("converters.command"), 0U);
  const firmware::MotionObjection fast = firmware::run_objection(description, hills(0.5, 4.0, 3.0));
  EXPECT_EQ(firmware::place(description, fast), "rig.toml:" + std::to_string(support::line_of(text, "speed = 0.5")))
      << fast.text;
}

// Law. With [compensation] the rehearsal is of the compensated loop: the paper's rig without virtual damping may drive,
// which it may not without; a compensation that would add more than it may is found beforehand, with its key.
TEST(RunObjection, RehearsesTheCompensatedLoop) {
  RigDescription description = rig("paper_hil_fdva");
  description.rig.machine.virtual_damping = 0.0;
  const auto motion = firmware::drive_over({.roughness = 16e-6, .bandwidth = 40.0}, 1000.0, 10'000);
  EXPECT_NE(objection_to(description, motion), "");
  description.compensation.emplace().kind = firmware::compensation::Kind::inverse;
  EXPECT_EQ(objection_to(description, motion), "");
  description.compensation->numbers["limit"] = 1e-4;
  const auto objection = firmware::run_objection(description, motion);
  EXPECT_THAT(objection.text, HasSubstr("the compensation adds"));
  EXPECT_EQ(objection.key, "compensation.limit");
}

}  // namespace
