// A rig that changes while it runs is diagnosed: the name, its size, and how soon.
#include "host_sim/live/live_diagnosis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "tests/live/changing_rig.hpp"

namespace {

using namespace host_sim::live;
using model::Channel;
using Rig = model::RigParameters<double>;
using Description = firmware::RigDescription (*)();

constexpr double changes_at = 40.0;

std::vector<Finding> after(Description rig, const std::function<void(Rig&)>& change, double lasts = 8.0,
                           const std::function<void(LiveSample&)>& reader = {}) {
  sample::Run run;
  run.seed = 20261201;
  run.changes_at = changes_at;
  run.duration = changes_at + lasts;
  run.change = change;
  run.reader = reader;
  return sample::diagnosed(rig(), run);
}

/// The first finding names this within 5 s, and nothing was named before.
void expect_named(const std::vector<Finding>& findings, const std::string& name, const std::string& channel,
                  double value, double within) {
  ASSERT_FALSE(findings.empty()) << name;
  const Finding& first = findings.front();
  EXPECT_EQ(first.kind, Finding::Kind::named) << sentence(first);
  EXPECT_EQ(first.cause.name, name) << sentence(first);
  EXPECT_EQ(first.cause.channel, channel) << sentence(first);
  EXPECT_NEAR(first.cause.value, value, within) << sentence(first);
  EXPECT_NEAR(first.since, changes_at, 0.5);
  EXPECT_LE(first.named_at - changes_at, 5.0 + 0.25);
}

struct LiveDiagnosisOf : testing::TestWithParam<Description> {};

// Journey. One Newton step from no friction: within a fifth, as a car that sticks now and then is not linear in it.
TEST_P(LiveDiagnosisOf, NamesFrictionThatAppears) {
  expect_named(after(GetParam(), [](Rig& rig) { rig.effects.add<model::CoulombFriction>({40.0}); }), "coulomb_friction",
               "", 40.0, 8.0);
}
INSTANTIATE_TEST_SUITE_P(Rigs, LiveDiagnosisOf,
                         testing::Values(sample::quarter_car, sample::hil, sample::component_bench,
                                         sample::quarter_car_fdva, sample::hil_fdva));

TEST(LiveDiagnosis, NamesADelayThatGrowsAndOneThatAppears) {
  expect_named(after(sample::hil, [](Rig& rig) { rig.effects.add<model::ActuatorDelay>({0.006}); }), "actuator_delay",
               "", 0.006, 2e-4);
  expect_named(after(sample::component_bench, [](Rig& rig) { rig.effects.add<model::ActuatorDelay>({0.004}); }),
               "actuator_delay", "", 0.004, 4e-4);
}

TEST(LiveDiagnosis, NamesSensorsThatChange) {
  expect_named(after(sample::quarter_car, [](Rig& r) { r.effects.add<model::SensorGain>(Channel::zdd_b, {1.1}); }),
               "sensor_gain", "zdd_b", 1.1, 0.01);
  expect_named(after(sample::quarter_car, [](Rig& r) { r.effects.add<model::SensorGain>(Channel::z_r, {1.05}); }),
               "sensor_gain", "z_r", 1.05, 0.01);
  expect_named(after(sample::hil, [](Rig& r) { r.effects.add<model::SensorOffset>(Channel::F, {-60.0}); }),
               "sensor_offset", "F", -60.0, 5.0);
  expect_named(
      after(sample::component_bench, [](Rig& r) { r.effects.add<model::SensorDelay>(Channel::x_act, {0.002}); }),
      "sensor_delay", "x_act", 0.002, 2e-4);
}

// On a rig without damping in its hardware a spring that is stiffer and a load cell with another gain do the same: both
// are said, the sensor first.
TEST(LiveDiagnosis, SaysBothWhereNothingTellsThemApart) {
  const auto findings = after(sample::hil, [](Rig& r) { r.effects.add<model::SensorGain>(Channel::F, {1.1}); });
  expect_named(findings, "sensor_gain", "F", 1.1, 0.01);
  ASSERT_EQ(findings.front().rivals.size(), 1U);
  EXPECT_EQ(findings.front().rivals.front().name, "suspension.stiffness");
}

// Fault. A damper that loses oil is a parameter, and what was named is part of the rig from then on: it is not named again.
TEST(LiveDiagnosis, NamesADamperThatFadesOnce) {
  const auto findings = after(
      sample::quarter_car, [](Rig& rig) { rig.suspension.damping *= 0.8; }, 60.0);
  ASSERT_EQ(findings.size(), 1U);
  expect_named(findings, "suspension.damping", "", 912.0, 25.0);
}

std::function<void(LiveSample&)> stuck(Channel channel) {
  return [channel, value = std::nan("")](LiveSample& sample) mutable {
    double& shown = sample.values[index(channel)];
    if (std::isnan(value)) value = shown;
    shown = value;
  };
}

// Fault. Such sensors are seen in their samples, and are no faults of the model.
TEST(LiveDiagnosis, SeesStuckAndLostSensors) {
  for (const auto& [rig, channel] : {std::pair{Description(sample::quarter_car), Channel::zdd_b},
                                     {sample::quarter_car, Channel::z_r},
                                     {sample::hil, Channel::F},
                                     {sample::component_bench, Channel::x_act}}) {
    const auto found = after(rig, {}, 8.0, stuck(channel));
    ASSERT_EQ(found.size(), 1U) << model::name(channel);
    EXPECT_EQ(found.front().kind, Finding::Kind::stuck);
    EXPECT_EQ(found.front().cause.channel, model::name(channel));
    EXPECT_NEAR(found.front().since, changes_at, 0.01);
    EXPECT_LE(found.front().named_at, changes_at + 1.0);
    const auto lost = after(rig, {}, 8.0, [c = index(channel)](LiveSample& s) { s.values[c] = std::nan(""); });
    ASSERT_EQ(lost.size(), 1U) << model::name(channel);
    EXPECT_EQ(lost.front().kind, Finding::Kind::lost);
  }
}

// A sensor that comes back is said to, and the diagnosis goes on.
TEST(LiveDiagnosis, GoesOnWhenASensorReturns) {
  const auto found = after(sample::quarter_car, {}, 20.0, [](LiveSample& s) {
    if (s.time < changes_at + 3.0) s.values[index(Channel::F_w)] = std::nan("");
  });
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].kind, Finding::Kind::returned);
}

// Fault. Samples beyond the range are known not to be true.
TEST(LiveDiagnosis, DoesNotBlameAClippedSensor) {
  sample::Run run;
  run.duration = 60.0;
  run.changes_at = 0.0;
  firmware::RigDescription rig = sample::quarter_car();
  rig.range[index(Channel::F_w)] = firmware::MeasuringRange{-700.0, 700.0};
  run.reader = [](LiveSample& s) {
    double& load = s.values[index(Channel::F_w)];
    load = std::clamp(load, -700.0, 700.0);
  };
  EXPECT_TRUE(sample::diagnosed(rig, run).empty());
}

// A healthy rig, a road that becomes twice as rough, and a model that is wrong from the beginning: nothing begins.
TEST(LiveDiagnosis, NamesNothingOnARigThatStaysAsItIs) {
  for (const Description rig : {sample::quarter_car, sample::hil, sample::component_bench, sample::quarter_car_fdva}) {
    sample::Run run;
    run.seed = 3;
    run.duration = 120.0;
    run.level = 2.0;
    EXPECT_TRUE(sample::diagnosed(rig(), run).empty());
    run.from_the_beginning = [](Rig& r) {
      r.suspension.stiffness *= 1.02;
      r.effects.add<model::CoulombFriction>({10.0});
    };
    EXPECT_TRUE(sample::diagnosed(rig(), run).empty());
  }
}

// A gap of a few samples is bridged; behind a longer one the simulations begin anew, and nothing of it is a fault.
TEST(LiveDiagnosis, BearsSamplesThatDoNotArrive) {
  const firmware::RigDescription rig = sample::quarter_car();
  LiveDiagnosis diagnosis(rig);
  sample::Run run;
  run.duration = 80.0;
  sample::drive(rig, run, [&](const LiveSample& s) {
    const double t = s.time;
    if ((t > 50.0 && t < 50.01) || (t > 55.0 && t < 55.3) || std::fmod(t, 1.0) < 0.002) return;
    static_cast<void>(diagnosis.push(s));
  });
  EXPECT_TRUE(diagnosis.findings().empty());
  EXPECT_EQ(diagnosis.progress().stage, Progress::Stage::watching);
  EXPECT_GT(diagnosis.progress().watched, 30.0);
}

// Nothing can be said of a rig that stands still, and that is said.
TEST(LiveDiagnosis, WaitsForARigThatMoves) {
  const firmware::RigDescription rig = sample::quarter_car();
  LiveDiagnosis diagnosis(rig);
  sample::Run run;
  run.duration = 30.0;
  run.speed = 1e-12;
  sample::drive(rig, run, [&](const LiveSample& s) { static_cast<void>(diagnosis.push(s)); });
  EXPECT_EQ(diagnosis.progress().stage, Progress::Stage::waiting);
  EXPECT_FALSE(diagnosis.progress().waits_for.empty());
}

}  // namespace
