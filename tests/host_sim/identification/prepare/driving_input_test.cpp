// Roads that were not measured.
#include "host_sim/identification/prepare/driving_input.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// 20 s of a car with 30 N of friction in its suspension, of which only these channels were recorded.
sample::Given car_with(const std::vector<Channel>& channels, const std::string& group) {
  truth::Wanted wanted;
  wanted.duration = 20.0;
  truth::Truth truth = truth::draw(group, 2, wanted);
  truth.records.resize(1);
  sample::Given given{firmware::parse_rig(truth::rig_toml(truth), "rig.toml"), {}};
  const firmware::Recording whole =
      firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv");
  given.recording = whole;
  for (auto& values : given.recording.channels) values.clear();
  for (const Channel channel : channels) given.recording[channel] = whole[channel];
  return given;
}

// Law. The second integral of a sine's acceleration is the sine, up to a line; over whole periods
// its mean is none.
TEST(DrivingInput, IntegratesTwice) {
  constexpr double h = 1e-3, w = 2.0 * std::numbers::pi * 5.0;
  std::vector<double> acceleration, position;
  for (int k = 0; k < 4000; ++k) {
    position.push_back(std::cos(w * h * k));
    acceleration.push_back(-w * w * position.back());
  }
  const std::vector<double> found = twice_integrated(acceleration, h);
  for (std::size_t k = 0; k < position.size(); ++k) ASSERT_NEAR(found[k], position[k], 2e-2) << k;
}

// Point. The road drives where it was measured; else its acceleration, else the wheel; nothing else can.
TEST(DrivingInput, TakesWhatIsThere) {
  const auto driven_by = [](const std::vector<Channel>& channels) {
    const sample::Given car = car_with(channels, "none:quarter_car");
    return driving_input(car.description.rig, car.recording);
  };
  EXPECT_EQ(driven_by({Channel::z_r, Channel::zdd_r, Channel::zdd_b}).channel, Channel::z_r);
  EXPECT_EQ(driven_by({Channel::zdd_r, Channel::zdd_w, Channel::zdd_b}).channel, Channel::zdd_r);
  const host_sim::SimulationInput wheel = driven_by({Channel::zdd_w, Channel::zdd_b});
  EXPECT_EQ(wheel.channel, Channel::zdd_w);
  EXPECT_TRUE(wheel.wheel_prescribed);
  EXPECT_NE(road_remark(wheel).find("tyre and road cannot be judged"), std::string::npos);
  EXPECT_THROW((void)driven_by({Channel::zdd_b, Channel::dz_b}), firmware::InputError);
}

Diagnosis diagnosis_of(const std::vector<Channel>& channels, const std::string& group) {
  const sample::Given car = car_with(channels, group);
  return diagnose(car.description, {{car.recording, Use::shared}});
}

// Journey. The wheel's motion alone tells the suspension's friction from its damping; tyre and road are no suspects.
TEST(DiagnosisWithoutRoad, NamesFrictionFromTheWheelsMotion) {
  const Diagnosis d =
      diagnosis_of({Channel::zdd_w, Channel::zdd_b, Channel::dz_b}, "single:quarter_car:coulomb_friction");
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects.front().effect.entry->name, "coulomb_friction");
  EXPECT_NEAR(d.effects.front().parameters.front().value, 30.55, 1.0);
  EXPECT_GT(d.effects.front().confidence, 0.9);
  EXPECT_EQ(d.parameters.count("tyre.stiffness"), 0U);
  EXPECT_EQ(d.parameters.count("wheel.mass"), 0U);
  EXPECT_EQ(diagnosis_of({Channel::zdd_w, Channel::zdd_b, Channel::dz_b}, "none:quarter_car").verdict,
            Verdict::no_discrepancy);
}

// Without a road the wheel's acceleration drives, and its mean is unknown: a ramp of velocity, of which a damper of the
// guides makes a ramp of force. Before, a relaxation stood beside it.
TEST(DiagnosisWithoutRoad, NamesADamperOfTheGuides) {
  const truth::Truth truth = truth::draw_rough("no_road", 2026120402);
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_FALSE(found.unexplained) << said;
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "body_guide_damping") << said;
  const double damping = truth.effects.at(0).parameters.at("damping");
  EXPECT_NEAR(found.effects[0].effect.values[0], damping, 4.0) << "its interval, of 95 %";
}

void expect_named(std::uint64_t seed, const std::vector<const char*>& names, Channel channel, double within) {
  const truth::Truth truth = truth::draw_rough("no_road", seed);
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.recording_faults.empty()) << said;
  ASSERT_EQ(found.effects.size(), names.size()) << said;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto is_it = [&](const auto& effect) { return effect.effect.entry->name == names[i]; };
    const auto it = std::find_if(found.effects.begin(), found.effects.end(), is_it);
    ASSERT_NE(it, found.effects.end()) << names[i] << ": " << said;
    EXPECT_GT(it->confidence, 0.5) << said;
    if (i > 0) continue;
    EXPECT_EQ(it->effect.channel, channel) << said;
    const auto hidden = std::find_if(truth.effects.begin(), truth.effects.end(),
                                     [&](const truth::Effect& e) { return e.name == names[0]; });
    EXPECT_NEAR(it->effect.values[0], hidden->parameters.begin()->second, within) << said;
  }
}

// Limit. Below 3 Hz the integrated noise of the channel that drives moves all others together: counted as if each had
// its own, it was called a rest in three of ten recordings of rigs that are as described.
TEST(DiagnosisWithoutRoad, CountsSharedNoiseOnce) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough("no_road", 2026121403));
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << sentence(found);
}

// Fault. A sensor of the channel that drives shows in all others: before, as gains of two of them, as a clock beside a
// rest. Its lag and delay take the hold's clock along, which had been set without them.
TEST(DiagnosisWithoutRoad, NamesTheGainOfWhatDrives) {
  expect_named(2026120906, {"sensor_gain"}, Channel::zdd_w, 1e-3);
}
TEST(DiagnosisWithoutRoad, NamesTheLagOfWhatDrives) {
  expect_named(2026120910, {"sensor_lag", "sensor_gain"}, Channel::zdd_w, 3e-5);
}
// A hold of it was no effect, and the road had images of its steps.
TEST(DiagnosisWithoutRoad, NamesTheHoldOfWhatDrives) {
  expect_named(2026130009, {"sensor_hold", "sensor_gain"}, Channel::zdd_w, 1e-6);
}
TEST(DiagnosisWithoutRoad, NamesTheDelayOfWhatDrives) {
  expect_named(2026121000, {"sensor_delay", "sensor_hold"}, Channel::zdd_w, 1e-5);
}

// Journey. The road's acceleration alone is as good as its displacement for everything that is relative.
TEST(DiagnosisWithoutRoad, IsDrivenByTheRoadsAcceleration) {
  const std::vector<Channel> channels{Channel::zdd_r, Channel::zdd_w, Channel::zdd_b,
                                      Channel::F_w,   Channel::dz_w,  Channel::dz_b};
  const Diagnosis d = diagnosis_of(channels, "single:quarter_car:coulomb_friction");
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects.front().effect.entry->name, "coulomb_friction");
  EXPECT_EQ(diagnosis_of(channels, "none:quarter_car").verdict, Verdict::no_discrepancy);
}

}  // namespace
