// A rig description arrives as it was written, or is refused in one line that says where and what.
#include "firmware/description/rig_description.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/control_settings.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/spelling.hpp"
#include "firmware/description/values/loop_settings.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::parse_rig;
using firmware::RigDescription;
using model::Channel;
using model::index;
using support::bench_text;
using support::hil_text;
using support::line_of;
using support::quarter_car_text;
using support::with;

std::string refusal_of(std::string_view text) {
  try {
    static_cast<void>(parse_rig(text, "RIG.toml"));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// The text is refused at the line in which `place` begins (empty: without a line), and the message holds `says`.
void expect_refused(std::string_view text, std::string_view place, std::string_view says) {
  const std::string refusal = refusal_of(text);
  const std::size_t line = place.empty() ? 0 : line_of(text, place);
  const std::string where = line == 0 ? "RIG.toml: " : "RIG.toml:" + std::to_string(line) + ": ";
  EXPECT_EQ(refusal.substr(0, where.size()), where) << refusal << "\nfor\n" << text;
  EXPECT_NE(refusal.find(says), std::string::npos) << refusal << "\nexpected to say " << says;
  EXPECT_NE(refusal.find(", expected "), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find('\n'), std::string::npos) << "one line: " << refusal;
}

// The contract's example, key by key: a key that lands in the wrong place is a rig that is silently another.
TEST(RigDescription, TakesEveryKeyToItsPlace) {
  const RigDescription d = parse_rig(std::string(hil_text) + R"([effects.coulomb_friction]
force = 40
[effects.tyre_lift_off]
[tolerance]
"body.mass" = 0.01
fdva.coupling_stiffness = 0.03
"effects.actuator_delay.delay" = 0.5
[noise]
F_w = 10.0
[range]
F_w = [-10000, 9000.0]
[channels]
z_r = { column = "Road mm", scale = 1e-3, offset = 0.25 }
t = { column = "ms", scale = 1e-3 }
duct_2 = { column = "V2" }
[limits]
stroke = 0.2
speed = 1.5
force = 20e3
ramp = 0.1
[estimator]
cross_over = 2.0
[valves]
safe = 1
plan = [{ t = 0.5, open = 3 }, { t = 2, open = [1, 6] }, { t = 3.5, open = 0 }]
)",
                                     "RIG.toml");
  EXPECT_EQ(d.source, "RIG.toml");
  EXPECT_EQ(d.rig.kind, model::RigKind::hil);
  EXPECT_EQ(d.sample_rate, 1000.0);
  EXPECT_EQ(d.period(), 1e-3);
  EXPECT_EQ(d.rig.body.mass, 290.0);
  EXPECT_EQ(d.rig.wheel.mass, 40.0);
  EXPECT_EQ(d.rig.tyre.stiffness, 200e3);
  EXPECT_EQ(d.rig.tyre.damping, 100.0);
  EXPECT_EQ(d.rig.suspension.stiffness, 31500.0);
  EXPECT_EQ(d.rig.suspension.damping, 0.0);
  EXPECT_EQ(d.rig.machine.virtual_damping, 1140.0);
  ASSERT_TRUE(d.rig.has_fdva);
  EXPECT_EQ(d.rig.fdva.piston_area, 30e-4);
  EXPECT_EQ(d.rig.fdva.duct_diameter, 12e-3);
  EXPECT_EQ(d.rig.fdva.duct_length, 0.6361571127);
  EXPECT_EQ(d.rig.fdva.oil_density, 860.0);
  EXPECT_EQ(d.rig.fdva.oil_viscosity, 32e-6);
  EXPECT_EQ(d.rig.fdva.minor_loss, 1.5);
  EXPECT_EQ(d.rig.fdva.coupling_stiffness, 55e3);
  EXPECT_EQ(d.rig.fdva.ducts, 6);
  EXPECT_EQ(d.rig.fdva.open_ducts, 2);

  EXPECT_TRUE(d.rig.effects.get<model::ActuatorDelay>().active);
  EXPECT_EQ(d.rig.effects.get<model::ActuatorDelay>().effect.delay, 0.010);
  EXPECT_TRUE(d.rig.effects.get<model::CoulombFriction>().active);
  EXPECT_EQ(d.rig.effects.get<model::CoulombFriction>().effect.force, 40.0) << "an integer is a number";
  EXPECT_TRUE(d.rig.effects.get<model::TyreLiftOff>().active) << "an effect without parameters is an empty table";
  EXPECT_FALSE(d.rig.effects.get<model::ForceSensorInertia>().active);

  EXPECT_EQ(d.tolerance,
            (std::map<std::string, double>{
                {"body.mass", 0.01}, {"effects.actuator_delay.delay", 0.5}, {"fdva.coupling_stiffness", 0.03}}))
      << "with quotes and without";
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const bool wheel_load = model::channel_at(i) == Channel::F_w;
    EXPECT_EQ(d.noise[i].has_value(), wheel_load) << "unlisted noise is unknown, not 0";
    EXPECT_EQ(d.range[i].has_value(), wheel_load);
  }
  EXPECT_EQ(d.noise[index(Channel::F_w)], 10.0);
  EXPECT_EQ(d.range[index(Channel::F_w)]->lower, -10000.0);
  EXPECT_EQ(d.range[index(Channel::F_w)]->upper, 9000.0);
  ASSERT_EQ(d.channels.size(), 3U);
  EXPECT_EQ(d.channels.at("z_r").column, "Road mm");
  EXPECT_EQ(d.channels.at("z_r").scale, 1e-3);
  EXPECT_EQ(d.channels.at("z_r").offset, 0.25);
  EXPECT_FALSE(d.channels.at("duct_2").scale) << "without one the heading's unit converts";

  EXPECT_EQ(d.controller.stroke, 0.2);
  EXPECT_EQ(d.controller.speed, 1.5);
  EXPECT_EQ(d.controller.force, 20e3);
  EXPECT_EQ(d.controller.ramp, 0.1);
  EXPECT_EQ(d.controller.cross_over, 2.0);
  EXPECT_EQ(d.controller.safe_ducts, 0b1);
  ASSERT_EQ(d.controller.valve_plan.size(), 3U);
  EXPECT_EQ(d.controller.valve_plan[0].time, 0.5);
  EXPECT_EQ(d.controller.valve_plan[0].open, 0b111) << "a number: the first so many";
  EXPECT_EQ(d.controller.valve_plan[1].open, 0b100001) << "a list: these";
  EXPECT_EQ(d.controller.valve_plan[2].open, 0);
}

// Unlisted is off or as on the paper's rig: what the contract's "leave the table out" promises.
TEST(RigDescription, DoesWithoutWhatAKindDoesNotNeed) {
  const RigDescription bench = parse_rig(bench_text, "RIG.toml");
  EXPECT_EQ(bench.rig.kind, model::RigKind::component_bench);
  EXPECT_FALSE(bench.rig.has_fdva);
  const RigDescription car = parse_rig(quarter_car_text, "RIG.toml");
  EXPECT_EQ(car.rig.kind, model::RigKind::quarter_car);
  EXPECT_TRUE(car.tolerance.empty());
  EXPECT_TRUE(car.channels.empty());
  EXPECT_EQ(car.controller.stroke, 0.250);
  EXPECT_EQ(car.controller.speed, 0.7);
  EXPECT_EQ(car.controller.force, 25e3);
  EXPECT_TRUE(car.controller.valve_plan.empty());
  const RigDescription hil = parse_rig(with(hil_text, "[machine]\nvirtual_damping = 1140.0\n", ""), "RIG.toml");
  EXPECT_EQ(hil.rig.machine.virtual_damping, 0.0);
}

// Every table that is needed, by the kinds that need it.
TEST(RigDescription, NamesAMissingTableOrKey) {
  for (const std::string_view text : {hil_text, quarter_car_text}) {
    expect_refused(with(text, "[body]\nmass = 290.0\n", ""), "kind", "no 'body'");
    expect_refused(with(text, "[wheel]\nmass = 40.0\n", ""), "kind", "no 'wheel'");
    expect_refused(with(text, "[tyre]\nstiffness = 200e3\ndamping = 100.0\n", ""), "kind", "no 'tyre'");
  }
  for (const std::string_view text : {quarter_car_text, bench_text}) {
    expect_refused(with(text, "[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n", ""), "kind", "no 'suspension'");
    expect_refused(with(text, "damping = 1140.0\n", ""), "[suspension]", "[suspension] has no 'damping'");
  }
  expect_refused(with(hil_text, "kind = \"hil\"", ""), "\nsample_rate", "no 'kind'");
  expect_refused(with(hil_text, "sample_rate = 1000.0", ""), "kind", "no 'sample_rate'");
  expect_refused(with(hil_text, "minor_loss = 1.5\n", ""), "[fdva]", "[fdva] has no 'minor_loss'");
  expect_refused(with(hil_text, "open_ducts = 2\n", ""), "[fdva]", "[fdva] has no 'open_ducts'");
  expect_refused(with(hil_text, "delay = 0.010\n", ""), "[effects.actuator_delay]", "has no 'delay'");
}

struct Mistake {
  std::string_view from;
  std::string_view to;
  std::string_view says;
};

/// The mistake stands in the line of what was put in.
void expect_each_refused(std::string_view text, const std::vector<Mistake>& mistakes) {
  for (const Mistake& m : mistakes) expect_refused(with(text, m.from, m.to), m.to, m.says);
}

// A typing mistake must not become a default: the contract's rule, with the word that was meant.
TEST(RigDescription, NamesTheNearestKnownKey) {
  expect_each_refused(
      hil_text, {
                    {"sample_rate", "samplerate", "unknown key 'samplerate' (did you mean 'sample_rate'?)"},
                    {"[machine]", "[machin]", "unknown key 'machin' (did you mean 'machine'?)"},
                    {"virtual_damping", "virtual_dampng", "(did you mean 'machine.virtual_damping'?)"},
                    {"oil_viscosity", "viscosity", "unknown key 'fdva.viscosity' (did you mean 'fdva.oil_viscosity'?)"},
                    {"mass = 290.0", "masss = 290.0", "unknown key 'body.masss' (did you mean 'body.mass'?)"},
                    {"delay =", "dely =", "(did you mean 'effects.actuator_delay.delay'?)"},
                    {"[wheel]", "[wheels]", "unknown key 'wheels' (did you mean 'wheel'?)"},
                    {"[effects.actuator_delay]", "[effects.actuator_dely]",
                     "unknown key 'effects.actuator_dely' (did you mean 'effects.actuator_delay'?)"},
                    {"kind = \"hil\"", "kind = \"hill\"", "unknown kind 'hill' (did you mean 'hil'?)"},
                });
  const std::string more = std::string(hil_text) + "mass = 3\n";
  expect_refused(more, "mass = 3", "unknown key 'effects.actuator_delay.mass' (did you mean");
  expect_refused(std::string(hil_text) + "[effects.tyre_lift_off]\nforce = 1\n", "force = 1", "an empty table");
  expect_refused(with(hil_text, "mass = 40.0\n", "mass = 40.0\nmas = 1\n"), "mas = 1", "(did you mean 'wheel.mass'?)");
  expect_refused(std::string(hil_text) + "[noise]\nF_v = 1\n", "F_v",
                 "unknown channel 'noise.F_v' (did you mean 'F_w'?)");
  expect_refused(std::string(hil_text) + "[channels]\nz_R = { column = 'x' }\n", "z_R", "(did you mean 'z_r'?)");
  expect_refused(std::string(hil_text) + "[limits]\nspede = 1\n", "spede", "(did you mean 'limits.speed'?)");
  expect_refused(std::string(hil_text) + "[valves]\nplans = []\n", "plans", "(did you mean 'valves.plan'?)");
  expect_refused(std::string(hil_text) + "[estimator]\ncrossover = 1\n", "crossover", "'estimator.cross_over'");
  expect_refused(std::string(hil_text) + "[tolerance]\n\"body.mas\" = 0.1\n", "\"body.mas",
                 "(did you mean 'body.mass'?)");
  expect_refused(std::string(hil_text) + "[bodies]\n", "[bodies]", "(did you mean 'body'?)");
}

// Point: distances by hand – one exchanged, one missing, one too many, all different.
TEST(RigDescription, MeasuresNearnessInSingleChanges) {
  constexpr std::string_view words[] = {"mass", "stiffness", "damping"};
  EXPECT_EQ(firmware::nearest("mess", words), "mass");
  EXPECT_EQ(firmware::nearest("stifness", words), "stiffness");
  EXPECT_EQ(firmware::nearest("dampingg", words), "damping");
  EXPECT_EQ(firmware::nearest("ssam", words), "mass") << "4 changes against 7";
  EXPECT_EQ(firmware::nearest("x", {}), "");
}

// What toml++ finds: the line, and its words in our form.
TEST(RigDescription, ReportsTomlSyntaxWithItsLine) {
  expect_each_refused(hil_text, {
                                    {"mass = 290.0", "mass = ", "TOML syntax"},
                                    {"mass = 290.0", "mass = 29O.0", "TOML syntax"},
                                    {"mass = 290.0", "mass 290.0", "TOML syntax"},
                                    {"[wheel]", "[wheel", "TOML syntax"},
                                    {"kind = \"hil\"", "kind = \"hil", "TOML syntax"},
                                });
  expect_refused(with(hil_text, "mass = 40.0\n", "mass = 40.0\nmass = 41.0\n"), "mass = 41.0", "TOML syntax");
  expect_refused(std::string(hil_text) + "[wheel]\nmass = 1\n", "[wheel]\nmass = 1\n", "TOML syntax");
  EXPECT_NE(refusal_of("kind = '\xff\xfe'").find("TOML syntax"), std::string::npos);
  EXPECT_NE(refusal_of("PK\x03\x04").find("TOML syntax"), std::string::npos);
  EXPECT_NE(refusal_of("").find("the file is empty"), std::string::npos);
  EXPECT_NE(refusal_of(" \n\t\r\n").find("the file is empty"), std::string::npos);
}

// A number is an integer or a real: toml++ itself would take true for 1 and lose 2⁵³ + 1.
TEST(RigDescription, TakesNothingButNumbersForNumbers) {
  expect_each_refused(hil_text,
                      {
                          {"mass = 290.0", "mass = true", "body.mass is not a number"},
                          {"mass = 290.0", "mass = '290'", "body.mass is not a number"},
                          {"mass = 290.0", "mass = [290.0]", "body.mass is not a number"},
                          {"mass = 290.0", "mass = 2001-01-01", "body.mass is not a number"},
                          {"mass = 290.0", "mass = nan", "body.mass is not finite"},
                          {"mass = 290.0", "mass = inf", "body.mass is not finite"},
                          {"mass = 290.0", "mass = -inf", "body.mass is not finite"},
                          {"sample_rate = 1000.0", "sample_rate = '1 kHz'", "sample_rate is not a number"},
                          {"kind = \"hil\"", "kind = 3", "kind is not a text"},
                          {"ducts = 6\n", "ducts = 6.5\n", "fdva.ducts is not a whole number in range"},
                          {"ducts = 6\n", "ducts = true\n", "fdva.ducts is not a whole number in range"},
                          {"ducts = 6\n", "ducts = 99999999999\n", "fdva.ducts is not a whole number in range"},
                          {"[body]\nmass = 290.0\n[wheel]", "body = 290.0\n[wheel]", "body is not a table"},
                      });
  const RigDescription d = parse_rig(with(hil_text, "stiffness = 200e3", "stiffness = 200000"), "RIG.toml");
  EXPECT_EQ(d.rig.tyre.stiffness, 200e3);
  expect_refused(with(hil_text, "mass = 290.0", "mass = -9007199254740993"), "mass = -9", "does not fit");
}

// What no rig can be: the number, its line, and what it should have been.
TEST(RigDescription, RefusesNumbersThatNoRigHas) {
  expect_each_refused(
      hil_text,
      {
          {"mass = 290.0", "mass = -290.0", "body.mass = -290 does not fit, expected a finite number > 0"},
          {"mass = 290.0", "mass = 0", "body.mass = 0 does not fit"},
          {"mass = 40.0", "mass = -0.1", "wheel.mass = -0.1 does not fit"},
          {"stiffness = 200e3", "stiffness = 0.0", "tyre.stiffness = 0 does not fit"},
          {"damping = 100.0", "damping = -100.0", "tyre.damping = -100 does not fit"},
          {"stiffness = 31500.0", "stiffness = -1", "suspension.stiffness = -1 does not fit"},
          {"virtual_damping = 1140.0", "virtual_damping = -1", "machine.virtual_damping = -1 does not fit"},
          {"piston_area = 30e-4", "piston_area = 0", "fdva.piston_area = 0 does not fit"},
          {"oil_viscosity = 32e-6", "oil_viscosity = -1e-6", "fdva.oil_viscosity = -1e-06 does not fit"},
          {"ducts = 6\n", "ducts = 0\n", "fdva.ducts = 0 does not fit"},
          {"ducts = 6\n", "ducts = 7\n", "fdva.ducts = 7 does not fit"},
          {"open_ducts = 2", "open_ducts = 7", "fdva.open_ducts = 7 does not fit"},
          {"open_ducts = 2", "open_ducts = -1", "fdva.open_ducts = -1 does not fit"},
          {"sample_rate = 1000.0", "sample_rate = 0", "sample_rate = 0 does not fit"},
          {"sample_rate = 1000.0", "sample_rate = -1000.0", "sample_rate = -1000 does not fit"},
          {"sample_rate = 1000.0", "sample_rate = 0.5", "sample_rate = 0.5 does not fit"},
          {"sample_rate = 1000.0", "sample_rate = 1e9", "sample_rate = 1e+09 does not fit"},
          {"delay = 0.010", "delay = -0.001", "effects.actuator_delay.delay = -0.001 does not fit"},
          {"delay = 0.010", "delay = 7.0",
           "effects.actuator_delay.delay = 7 does not fit, expected a number within the physical bounds of the "
           "effect, 0 to 0.5"},
      });
}

// The line of the delay has 508 samples: 0.4 s fit at 1 kHz, not at 2 kHz.
TEST(RigDescription, RefusesADelayBeyondTheLine) {
  const std::string slow = with(hil_text, "delay = 0.010", "delay = 0.4");
  EXPECT_EQ(refusal_of(slow), "accepted");
  expect_refused(with(slow, "sample_rate = 1000.0", "sample_rate = 2000.0"), "delay = 0.4",
                 "a delay within the capacity of the delay line");
}

// A step that cannot resolve its rig would stop the program (model::require): it is refused before.
TEST(RigDescription, RefusesARigThatNoStepResolves) {
  for (const auto& [from, to] : std::vector<std::pair<std::string_view, std::string_view>>{
           {"mass = 40.0", "mass = 1e-300"},
           {"stiffness = 200e3", "stiffness = 1e300"},
           {"damping = 100.0", "damping = 1e200"},
           {"duct_diameter = 12e-3", "duct_diameter = 1e-100"},
           {"oil_density = 860.0", "oil_density = 1e-310"},
           {"minor_loss = 1.5", "minor_loss = 1e300"},
       }) {
    expect_refused(with(hil_text, from, to), "", "the rig as a whole does not fit");
  }
  const std::string bench = std::string(bench_text) + std::string(hil_text.substr(hil_text.find("[fdva]")));
  EXPECT_EQ(refusal_of(bench), "accepted");
  expect_refused(with(bench, "piston_area = 30e-4", "piston_area = 1e-200"), "", "the rig as a whole does not fit");
  // A bench without a car of its own is commanded as the paper's car would: what throws that is refused as well.
  expect_refused(with(bench_text, "stiffness = 31500.0", "stiffness = 1e300"), "", "the rig as a whole does not fit");
  expect_refused(with(hil_text, "mass = 290.0", "mass = 2.9e302"), "mass = 2.9e302", "a mass that a road moves");
}

// A part that the kind does not have must not be taken along silently.
TEST(RigDescription, RefusesPartsThatTheKindDoesNotHave) {
  for (const std::string_view text : {quarter_car_text, bench_text}) {
    expect_refused(std::string(text) + "[machine]\nvirtual_damping = 700\n", "virtual_damping",
                   "only a hil rig has virtual damping");
  }
  expect_refused(std::string(quarter_car_text) + "[effects.moving_mass]\nmass = 5\n", "[effects.moving_mass]",
                 "this kind of rig has no such place");
  const auto car = firmware::parse_rig(std::string(quarter_car_text) + "[effects.actuator_delay]\ndelay = 0.01\n", "r");
  EXPECT_TRUE(car.rig.effects.get<model::ActuatorDelay>().active) << "its foot point is moved by a machine";
  expect_refused(std::string(hil_text) + "[effects.force_sensor_inertia]\nmass = 5\n", "[effects.force_sensor_inertia]",
                 "this kind of rig has no such place");
  expect_refused(std::string(bench_text) + "[effects.tyre_lift_off]\n", "[effects.tyre_lift_off]",
                 "this kind of rig has no such place");
}

// A bench may say on which car its component drives; that car must be one.
TEST(RigDescription, ChecksTheCarOfABench) {
  const std::string car = "[body]\nmass = 250\n[wheel]\nmass = 35\n[tyre]\nstiffness = 180e3\ndamping = 50\n";
  EXPECT_EQ(parse_rig(std::string(bench_text) + car, "RIG.toml").rig.body.mass, 250.0);
  expect_refused(std::string(bench_text) + with(car, "mass = 35", "mass = -35"), "mass = -35", "wheel.mass = -35");
}

TEST(RigDescription, RefusesTolerancesThatMeanNothing) {
  const auto text = [](std::string_view entry) {
    return std::string(quarter_car_text) + "[tolerance]\n" + std::string(entry) + "\n";
  };
  EXPECT_EQ(parse_rig(text("body.mass = 0"), "RIG.toml").tolerance.at("body.mass"), 0.0) << "0 is exact";
  expect_refused(text("body.mass = -0.01"), "body.mass", "tolerance of body.mass is not a number in 0 … 10");
  expect_refused(text("body.mass = 11"), "body.mass", "tolerance of body.mass is not a number in 0 … 10");
  expect_refused(text("body.mass = nan"), "body.mass", "tolerance of body.mass is not a number in 0 … 10");
  expect_refused(text("body.mass = true"), "body.mass", "tolerance of body.mass is not a number in 0 … 10");
  expect_refused(text("body.mass = \"1 %\""), "body.mass", "tolerance of body.mass is not a number in 0 … 10");
  expect_refused(text("body = 0.1"), "body =", "unknown parameter 'body'");
  // Parameters of parts and effects that this rig does not have:
  expect_refused(text("fdva.minor_loss = 0.1"), "fdva", "unknown parameter 'fdva.minor_loss'");
  expect_refused(text("machine.virtual_damping = 0.1"), "machine", "unknown parameter 'machine.virtual_damping'");
  expect_refused(text("effects.actuator_delay.delay = 0.1"), "effects", "unknown parameter");
  expect_refused(std::string(bench_text) + "[tolerance]\nbody.mass = 0.1\n", "body.mass", "unknown parameter");
}

TEST(RigDescription, RefusesSensorsThatMakeNoSense) {
  const auto text = [](std::string_view entry) { return std::string(hil_text) + std::string(entry) + "\n"; };
  expect_refused(text("[noise]\nF = -1"), "F = -1", "noise.F is negative");
  expect_refused(text("[noise]\nF = '10 N'"), "F = '", "noise.F is not a number");
  expect_refused(text("[noise]\nF = nan"), "F = nan", "noise.F is not finite");
  expect_refused(text("[range]\nF = 10"), "F = 10", "range.F is not a range");
  expect_refused(text("[range]\nF = [1]"), "F = [1]", "range.F is not a range");
  expect_refused(text("[range]\nF = [1, 2, 3]"), "F = [1,", "range.F is not a range");
  expect_refused(text("[range]\nF = [2, 1]"), "F = [2,", "range.F is not a range");
  expect_refused(text("[range]\nF = [1, 1]"), "F = [1,", "range.F is not a range");
  expect_refused(text("[range]\nF = [nan, 1]"), "F = [nan", "range.F is not a range");
  expect_refused(text("[range]\nF = [false, true]"), "F = [false", "range.F is not a range");
  EXPECT_EQ(refusal_of(text("[range]\nF = [-9007199254740993, 9007199254740993]")), "accepted");
  expect_refused(text("[channels]\nF = 'Force'"), "F = 'Force'", "channels.F is not a table");
  expect_refused(text("[channels]\nF = { scale = 2.0 }"), "F = {", "[channels.F] has no 'column'");
  expect_refused(text("[channels]\nF = { column = 'N', scale = 0 }"), "F = {", "channels.F.scale is 0");
  expect_refused(text("[channels]\nF = { column = 'N', unit = 'kN' }"), "F = {", "unknown key 'channels.F.unit'");
  expect_refused(text("[channels]\nduct_7 = { column = 'x' }"), "duct_7", "unknown channel");
}

// What rig_controller needs stands in the same file, is looked at by everybody and used by it alone.
TEST(RigDescription, RefusesDevicesThatCannotBe) {
  const auto text = [](std::string_view entry) { return std::string(hil_text) + std::string(entry) + "\n"; };
  EXPECT_EQ(refusal_of(text("[controller]\n[gpio]\nchip = 'a'\n[converters]\n[lasers]")), "accepted");
  expect_refused(text("[controller]\npriority = 100"), "priority", "controller.priority is out of range");
  expect_refused(text("[controller]\ncpu = -1"), "cpu", "expected 0 to 1023");
  expect_refused(text("[controller]\npriorty = 1"), "priorty", "(did you mean 'controller.priority'?)");
  expect_refused(text("[gpio]\nstop = 's'"), "[gpio]", "[gpio] has no 'chip'");
  expect_refused(text("[gpio]\nchip = 'a'\nvalves = ['x']"), "valves = [", "a list of 6 line names");
  expect_refused(text("[gpio]\nchip = 'a'\nvalves = [1, 2, 3, 4, 5, 6]"), "valves = [1", "is not a text");
  expect_refused(text("[gpio]\nchip = 'a'\nvalves = 'x'"), "valves = 'x'", "gpio.valves is not a list");
  expect_refused(text("[gpio]\nchip = 'a'\nenable_feedback = 'f'"), "enable_feedback", "shows no enable");
  expect_refused(text("[gpio]\nchip = 'a'\nstop_bias = 'up'"), "stop_bias", "one of pull-down, pull-up,");
  expect_refused(text("[gpio]\nchip = 'a'\nstop_active_low = 1"), "stop_active_low", "neither true nor false");
  expect_refused(text("[converters.G]\ndevice = 'a'"), "[converters.G]", "unknown key 'converters.G'");
  expect_refused(text("[converters.F]\ndevice = 'a'\ninput = 'b'\nscale = 0"), "scale = 0", "converters.F.scale is 0");
  expect_refused(text("[converters.F]\ndevice = 'a'\ninput = 'b'"), "[converters.F]", "has no 'scale'");
  expect_refused(text("[converters.command]\ndevice = 'a'\noutput = 'b'\nscale = 1\nhighest_counts = 0"),
                 "[converters.c", "lowest_counts < highest_counts");
  expect_refused(text("[converters.area]\ndevice = 'a'\noutput = 'b'\nscale = 1\nhighest_counts = 0"), "[converters.a",
                 "lowest_counts < highest_counts");
  expect_refused(text("[lasers.x_act]\nport = 'a'"), "[lasers.x_act]", "has no 'range'");
  expect_refused(text("[lasers.x_act]\nport = 'a'\nrange = 1\naddress = 0"), "address", "expected 1 to 127");
}

// The pull gives the level of a cut wire, so a description in which that reads "released" is refused, as is an enable
// that is on without a program. Only a sentence by somebody who answers for it changes that.
TEST(RigDescription, RefusesWiringThatFailsDangerous) {
  const auto text = [](std::string_view entry, std::string_view waiver = "") {
    return std::string(hil_text) + "[gpio]\nchip = 'a'\nstop = 's'\n" + std::string(entry) + "\n" +
           (waiver.empty() ? "" : "[waivers]\n" + std::string(waiver) + "\n");
  };
  const auto gpio = [&](std::string_view entry) { return *parse_rig(text(entry), "rig").hardware.gpio; };
  EXPECT_EQ(gpio("").stop_bias, "pull-down");
  EXPECT_TRUE(gpio("").stop_active_low) << "a contact to supply: cut or pressed is low";
  EXPECT_FALSE(gpio("stop_bias = 'pull-up'").stop_active_low) << "a contact to ground: cut or pressed is high";
  EXPECT_TRUE(gpio("stop_bias = 'external-pull-down'").stop_active_low);
  EXPECT_EQ(refusal_of(text("stop_active_low = true")), "accepted");
  for (const std::string_view dangerous : {"stop_active_low = false", "stop_bias = 'pull-up'\nstop_active_low = true",
                                           "stop_bias = 'external-pull-down'\nstop_active_low = false"}) {
    expect_refused(text(dangerous), "stop_active_low", "a cut wire at gpio.stop would read released");
    EXPECT_EQ(refusal_of(text(dangerous, "stop_fails_dangerous = 'a button without drive'")), "accepted");
  }
  expect_refused(text("stop_active_low = false", "stop_fails_dangerous = 'yes'"), "stop_fails_dangerous",
                 "is no sentence");
  expect_refused(text("enable_active_low = true"), "enable_active_low", "would give the drive power");
  EXPECT_EQ(refusal_of(text("enable_active_low = true", "enable_active_low = 'inverted by the relay'")), "accepted");
  expect_refused(text("stop_2 = 's'"), "stop_2", "no second contact");
  expect_refused(text("interlock_bias = 'up'"), "interlock_bias", "unknown gpio.interlock_bias");
  expect_refused(text("[gpio.interlocks]\ndoor = 1"), "door = 1", "");
  expect_refused(text("", "no_heart = 'there is no such waiver'"), "no_heart", "unknown key");
}

// A rig of devices has a stop button, a heartbeat and an enable, or a sentence that says why not.
TEST(RigDescription, AsksForWhatMakesDevicesSafe) {
  const auto wrong = [](std::string_view more) {
    const RigDescription rig = parse_rig(std::string(hil_text) + std::string(more), "rig.toml");
    try {
      firmware::check_wiring(rig);
    } catch (const firmware::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string gpio = "[gpio]\nchip = 'a'\n";
  EXPECT_NE(wrong("").find("no table [gpio]"), std::string::npos);
  EXPECT_NE(wrong(gpio).find("[gpio] has no stop, expected"), std::string::npos) << wrong(gpio);
  EXPECT_EQ(wrong(gpio).rfind("rig.toml:", 0), 0U) << wrong(gpio);
  EXPECT_NE(wrong(gpio + "stop = 's'\n").find("[gpio] has no heartbeat, expected"), std::string::npos);
  EXPECT_NE(wrong(gpio + "stop = 's'\nheartbeat = 'h'\n").find("[gpio] has no enable, expected"), std::string::npos);
  const std::string enabled = gpio + "stop = 's'\nheartbeat = 'h'\nenable = 'e'\n";
  EXPECT_NE(wrong(enabled).find("[gpio] has no enable_feedback, expected"), std::string::npos) << wrong(enabled);
  EXPECT_EQ(wrong(enabled + "enable_feedback = 'f'\n"), "accepted");
  EXPECT_EQ(wrong(enabled + "[waivers]\nno_enable_feedback = 'a hand pump only'\n"), "accepted");
  EXPECT_EQ(wrong(gpio + "[waivers]\nno_stop = 'a hand pump only'\nno_heartbeat = 'a hand pump only'\n"
                         "no_enable = 'a hand pump only'\n"),
            "accepted");
}

// [arming]: bounds, and defaults that follow from kind and limits.
TEST(RigDescription, ReadsWhatArmingLooksAt) {
  const auto text = [](std::string_view entry) { return std::string(hil_text) + std::string(entry) + "\n"; };
  const firmware::Arming usual = firmware::arming_settings(parse_rig(text("[limits]\nforce = 8e3"), "rig"));
  EXPECT_EQ(usual.tare_time, 0.5);
  EXPECT_EQ(usual.preload, 800.0);
  EXPECT_EQ(usual.position_tolerance, 5e-3);
  EXPECT_EQ(usual.probe_amplitude, 2e-3);
  EXPECT_EQ(usual.force_ramp, 0.5);
  expect_refused(text("[arming]\nprobe_amplitude = 0"), "probe_amplitude", "does not find a wrong sign");
  EXPECT_EQ(refusal_of(text("[arming]\nprobe_amplitude = 0\n[waivers]\nno_probe = 'signs were measured'")), "accepted");
  expect_refused(text("[arming]\nprobe_amplitude = 0.2"), "probe_amplitude", "does not fit");
  expect_refused(text("[arming]\nposition_tolerance = 5.0"), "position_tolerance", "does not fit");
  expect_refused(text("[arming]\npreload = 30e3"), "preload", "does not fit");
  expect_refused(text("[arming]\ntare_time = 0"), "tare_time", "does not fit");
  expect_refused(text("[arming]\nforce_ramp = -1"), "force_ramp", "does not fit");
  expect_refused(text("[arming]\ntare = 1"), "tare = 1", "unknown key 'arming.tare'");
}

TEST(RigDescription, RefusesAControllerThatCannotWork) {
  const auto text = [](std::string_view entry) { return std::string(hil_text) + std::string(entry) + "\n"; };
  for (const std::string_view key : {"stroke", "speed", "force", "ramp", "energy_gain"}) {
    const std::string entry = std::string(key) + " = 0";
    expect_refused(text("[limits]\n" + entry), entry, "limits." + entry + " does not fit");
  }
  const std::string gpio = "[gpio]\nchip = \"c\"\nvalves = [\"1\", \"2\", \"3\", \"4\", \"5\", \"6\"]\n";
  expect_refused(text(gpio + "high_pressure = \"h\""), "high_pressure", "a second stage without a first one");
  expect_refused(text(gpio + "hold_to_run = \"door\""), "hold_to_run", "is no interlock");
  expect_refused(text("[arming]\nstop_test = 1e5"), "stop_test", "does not fit");
  expect_refused(text("[arming]\nstop_test = 12"), "[arming]", "asks for a press of a button that is not there");
  expect_refused(text(gpio + "[arming]\nstop_test = 12"), "[arming]", "its line, [gpio] stop");
  expect_refused(text("[controller]\nallowed_gain = 0.9"), "allowed_gain", "allowed_gain");
  expect_refused(text("[limits]\nramp = 0.8"), "ramp", "limits.ramp is faster than limits.speed");
  expect_refused(text("[limits]\nspeed = 0.01"), "speed = 0.01", "limits.ramp is faster than limits.speed");
  expect_refused(text("[estimator]\ncross_over = -1"), "cross_over", "estimator.cross_over = -1 does not fit");
  expect_refused(text("[valves]\nsafe = 7"), "safe", "valves.safe is not a valid number of ducts");
  expect_refused(text("[valves]\nsafe = [0]"), "safe", "valves.safe names no such duct");
  expect_refused(text("[valves]\nsafe = [true]"), "safe", "valves.safe names no such duct");
  expect_refused(text("[valves]\nplan = 3"), "plan", "valves.plan is not a list");
  expect_refused(text("[valves]\nplan = [3]"), "plan", "an entry of valves.plan is not a table");
  expect_refused(text("[valves]\nplan = [{ t = 1, open = 7 }]"), "plan", "is not a valid number of ducts");
  expect_refused(text("[valves]\nplan = [{ t = 1 }]"), "plan", "has no 'open'");
  expect_refused(text("[valves]\nplan = [{ t = -1, open = 1 }]"), "plan", "do not grow");
  expect_refused(text("[valves]\nplan = [{ t = 1, open = 1 }, { t = 1, open = 2 }]"), "plan", "do not grow");
  expect_refused(text("[valves]\nplan = [{ t = 1, open = 1, x = 2 }]"), "plan", "unknown key 'valves.plan.x'");
  expect_refused(std::string(bench_text) + "[valves]\nsafe = 1\n", "safe", "from 0 to 0");
  std::string plan = "[valves]\nplan = [";
  for (int i = 0; i < 257; ++i) plan += "{ t = " + std::to_string(i) + ", open = 1 },\n";
  expect_refused(text(plan + "]"), "{ t = 256", "valves.plan is too long");
}

// parameter_paths, find_parameter and the reader must speak of the same place: each path is written in a text and read
// back by its name.
TEST(RigDescription, FindsEveryParameterByItsPath) {
  RigDescription d = parse_rig(hil_text, "RIG.toml");
  d.rig.air_spring.fitted = true;
  std::set<const double*> places;
  for (const auto& p : firmware::parameter_paths()) {
    const std::string path = std::string(p.table) + "." + std::string(p.key);
    double* value = firmware::find_parameter(d.rig, path);
    ASSERT_NE(value, nullptr) << path;
    EXPECT_TRUE(places.insert(value).second) << path << " is the place of another";
    EXPECT_FALSE(p.unit.empty());
    *value = 1234.5;
    EXPECT_EQ(p.value(d.rig), 1234.5) << path;
  }
  EXPECT_EQ(firmware::find_parameter(d.rig, "effects.actuator_delay.delay"),
            &d.rig.effects.get<model::ActuatorDelay>().effect.delay);
  for (const char* none : {"", ".", "body", "body.", "body.masses", "bodyXmass", "effects.coulomb_friction.force"}) {
    EXPECT_EQ(firmware::find_parameter(d.rig, none), nullptr) << none;
  }
}

TEST(RigDescription, SaysWhatIsWrongWithAFile) {
  const support::TemporaryFolder folder;
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      static_cast<void>(firmware::read_rig(file));
    } catch (const firmware::InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(folder.write("rig.toml", hil_text)), "accepted");
  EXPECT_EQ(refusal(folder.path()), folder.path().string() + ": is a directory, expected a rig description in TOML");
  EXPECT_NE(refusal(folder / "none.toml").find("none.toml: cannot be opened"), std::string::npos);
  EXPECT_NE(refusal(folder.write("empty.toml", "")).find("the file is empty"), std::string::npos);
  EXPECT_NE(refusal("/dev/zero").find("/dev/zero: is larger than 1 MiB"), std::string::npos);
  const auto broken = folder.write("broken.toml", with(hil_text, "mass = 290.0", "mass = x"));
  EXPECT_EQ(refusal(broken).rfind(broken.string() + ":4: TOML syntax", 0), 0U) << refusal(broken);
}

// The rigs that come with the project, and those measured and made by others.
TEST(RigDescription, ReadsAllRigsOfTheProject) {
  std::size_t rigs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(support::source / "host_sim" / "rigs")) {
    if (entry.path().extension() != ".toml") continue;  // tables of laws
    EXPECT_NO_THROW(static_cast<void>(firmware::read_rig(entry.path()))) << entry.path();
    ++rigs;
  }
  EXPECT_GE(rigs, 5U);
}

TEST(RigDescription, ReadsAllSharedRigs) {
  if (!std::filesystem::exists(support::shared)) GTEST_SKIP() << "measured rigs: " << support::shared << " is missing";
  std::size_t rigs = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(support::shared)) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(static_cast<void>(firmware::read_rig(entry.path()))) << entry.path();
    ++rigs;
  }
  EXPECT_GE(rigs, 8U);
}

// Both examples say ± 10 kN and 0.30518 N a count: the converter's end is 9999.97 N. Half a count makes it clipped.
TEST(RigDescription, TrustsARangeUpToHalfACountBeforeItsEnds) {
  const std::string text = std::string(support::hil_text) + R"(
[range]
F = [-10000.0, 10000.0]
x_act = [-0.125, 0.125]
[converters.F]
device = "ads8688"
input = "voltage0"
scale = -0.30518
offset = 10000.0
)";
  const firmware::RigDescription rig = firmware::parse_rig(text, "rig.toml");
  const auto force = firmware::trusted_range(rig, model::index(model::Channel::F));
  ASSERT_TRUE(force);
  EXPECT_FALSE(force->holds(-0.30518 * 65535.0 + 10000.0));
  EXPECT_TRUE(force->holds(-0.30518 * 65534.0 + 10000.0));
  EXPECT_FALSE(force->holds(10000.0));
  EXPECT_EQ(firmware::trusted_range(rig, model::index(model::Channel::x_act))->upper, 0.125) << "no converter";
  EXPECT_FALSE(firmware::trusted_range(rig, model::index(model::Channel::F_w)));
}

// A value in other units: the message says what the number stands for. stroke = 250.0 was accepted and switched the
// limit off.
TEST(RigDescription, RefusesLimitsThatAreAbsurd) {
  const auto text = [](std::string_view entry) { return std::string(hil_text) + std::string(entry) + "\n"; };
  expect_refused(text("[limits]\nstroke = 250.0"), "stroke",
                 "limits.stroke = 250 does not fit, expected the whole travel of the drive in m (not mm), 0.001 to 2");
  expect_refused(text("[limits]\nforce = 1e9"), "force", "a force in N (not kN), 1 to 1e+06");
  expect_refused(text("[limits]\nspeed = 700"), "speed", "a speed in m/s");
  expect_refused(text("[limits]\nfollowing = 0.2"), "following", "does not fit limits.stroke");
  expect_refused(text("[limits]\nmeasured_stroke = 0.2"), "measured_stroke",
                 "does not fit limits.stroke, expected 0.25");
  expect_refused(text("[limits]\nmeasured_speed = 20"), "measured_speed", "does not fit limits.speed");
  for (const auto& setting : firmware::loop_settings()) {
    const std::string table = "[" + std::string(setting.table) + "]\n" + std::string(setting.key) + " = ";
    const std::string beyond = std::to_string(static_cast<int>(setting.highest) + 1);
    expect_refused(text(table + beyond), setting.key, setting.key);
    expect_refused(text(table + "-1"), setting.key, setting.key);
  }
}

// Every setting reaches the control loop, and survives being written and read again.
TEST(RigDescription, SetsTheControlLoop) {
  std::string text(hil_text), table;
  for (const auto& setting : firmware::loop_settings()) {
    if (setting.table != table) text += "[" + (table = setting.table) + "]\n";
    double value = setting.whole ? 7.0 : setting.get(firmware::Settings{}) * 1.125;
    if (setting.key == "acceleration") value = 55.5;
    if (setting.key == "low_force") value = 9000.0;
    if (setting.key == "low_speed") value = 0.2;
    if (setting.key == "measured_stroke") value = 0.3125;
    if (setting.key == "measured_speed") value = 1.5;
    if (setting.key == "settling") value = 2.5;
    text += std::string(setting.key) + " = " + (setting.whole ? "7" : firmware::shortest(value)) + "\n";
  }
  const firmware::RigDescription first = firmware::parse_rig(text, "rig.toml");
  const firmware::RigDescription again = firmware::parse_rig(firmware::format_rig(first), "again.toml");
  for (const auto* description : {&first, &again}) {
    const firmware::Settings settings = firmware::control_settings(*description);
    for (const auto& setting : firmware::loop_settings()) {
      EXPECT_NE(setting.get(settings), setting.get(firmware::Settings{})) << setting.key;
      EXPECT_EQ(setting.get(settings), setting.get(first.controller.loop)) << setting.key;
    }
  }
}

// A limit that the sensor cannot show would never trip. Without a limit in the description it follows from the range.
TEST(RigDescription, KeepsTheForceLimitWithinTheSensor) {
  const std::string range = std::string(hil_text) + "[range]\nF = [-8000.0, 10000.0]\n";
  EXPECT_EQ(firmware::control_settings(firmware::parse_rig(range, "r")).limits.force, 0.95 * 8000.0);
  EXPECT_EQ(firmware::control_settings(firmware::parse_rig(range + "[limits]\nforce = 3e3\n", "r")).limits.force, 3e3);
  EXPECT_EQ(firmware::control_settings(firmware::parse_rig(std::string(hil_text), "r")).limits.force, 25e3);
}

TEST(RigDescription, TakesWaiversAsSentences) {
  const auto text = [](std::string_view entry) {
    return std::string(hil_text) + "[waivers]\n" + std::string(entry) + "\n";
  };
  const auto rig = firmware::parse_rig(text("no_heartbeat = 'no hydraulics, a spindle drive'"), "rig.toml");
  EXPECT_EQ(rig.waivers.at("no_heartbeat"), "no hydraulics, a spindle drive");
  EXPECT_EQ(firmware::parse_rig(firmware::format_rig(rig), "again").waivers, rig.waivers);
  expect_refused(text("no_heartbeat = true"), "no_heartbeat", "no_heartbeat");
  expect_refused(text("no_heartbeat = 'yes'"), "no_heartbeat", "waivers.no_heartbeat is no sentence");
  expect_refused(text("no_hartbeat = 'we do not need it'"), "no_hartbeat", "no_heartbeat");
}

// A component_bench driven by force is a kind of its own, written as it was read; what it cannot have is refused by name.
TEST(RigDescription, ReadsAMassThatAForceDrives) {
  const std::string text =
      "kind = \"component_bench\"\ndriven_by = \"force\"\nsample_rate = 1000.0\n[body]\nmass = 10.0\n"
      "[suspension]\nstiffness = 10e3\ndamping = 30.0\n[tolerance]\n\"body.mass\" = 0.02\n";
  const firmware::RigDescription read = firmware::parse_rig(text, "rig.toml");
  EXPECT_EQ(read.rig.kind, model::RigKind::driven_mass);
  const firmware::RigDescription again = firmware::parse_rig(firmware::format_rig(read), "again.toml");
  EXPECT_EQ(again.rig.kind, model::RigKind::driven_mass);
  EXPECT_EQ(again.rig.body.mass, 10.0);
  EXPECT_NE(refusal_of(text + "[wheel]\nmass = 40.0\n").find("no wheel and no tyre"), std::string::npos);
  EXPECT_NE(refusal_of(text + "[effects.actuator_delay]\ndelay = 0.01\n").find("actuator_delay"), std::string::npos);
  std::string other = text;
  other.replace(other.find("\"force\""), 7, "\"hand\"");
  EXPECT_NE(refusal_of(other).find("RIG.toml:2"), std::string::npos) << refusal_of(other);
}

}  // namespace
