// The virtual car of a hil rig, from the numbers of its program.
#include "host_sim/identification/estimate/virtual_car_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/rig_texts.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;

constexpr double period = 1e-3;

// Point. Numbers that obey (1)–(3) give the parameters they were made with, inside their tolerances.
TEST(VirtualCarEstimate, IsReadFromWhatTheProgramRecorded) {
  RigDescription description = parse_rig(support::hil_text, "rig");
  description.tolerance = {{"body.mass", 0.05}, {"wheel.mass", 0.05}, {"tyre.stiffness", 0.05}};
  const double m_b = 1.02 * description.rig.body.mass, m_w = 0.97 * description.rig.wheel.mass;
  const double k_t = 1.01 * description.rig.tyre.stiffness, b_v = description.rig.machine.virtual_damping;
  constexpr std::size_t n = 8000;
  identification::PreparedRecording e;
  Recording& r = e.recording;
  r.sample_period = period;
  r.time = sample_times(n, 1.0 / period);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = period * static_cast<double>(k), w1 = 9.0, w2 = 70.0;
    const double x = 5e-3 * std::sin(w1 * t) + 2e-3 * std::sin(w2 * t);
    const double v = 5e-3 * w1 * std::cos(w1 * t) + 2e-3 * w2 * std::cos(w2 * t);
    const double force = 300.0 * std::sin(w1 * t + 0.5) + 200.0 * std::sin(w2 * t + 1.0);
    const double tyre = 1e-3 * std::sin(w1 * t + 0.2) + 3e-3 * std::sin(w2 * t + 2.0);
    const double rate = 1e-3 * w1 * std::cos(w1 * t + 0.2) + 3e-3 * w2 * std::cos(w2 * t + 2.0);
    const double load = k_t * tyre + description.rig.tyre.damping * rate;
    r[Channel::x_cmd].push_back(x);
    r[Channel::F].push_back(force);
    r[Channel::zdd_b].push_back((force + b_v * v) / m_b);
    r[Channel::F_w].push_back(load);
    r[Channel::zdd_w].push_back((load - force - b_v * v) / m_w);
    r[Channel::z_w].push_back(-tyre);
    r[Channel::z_r].push_back(0.0);
  }
  e.fitted = {0, n};
  const auto found = identification::estimate_virtual_car(description, {e}).parameters;
  ASSERT_EQ(found.size(), 3U);
  // Velocities by differences of fourth order are off by (ωh)⁴/30 = 8e-7.
  EXPECT_NEAR(found.at("body.mass").value / m_b, 1.0, 1e-5);
  EXPECT_NEAR(found.at("wheel.mass").value / m_w, 1.0, 1e-5);
  EXPECT_NEAR(found.at("tyre.stiffness").value / k_t, 1.0, 1e-5);
  EXPECT_TRUE(identification::estimate_virtual_car(description, {e}).off.empty());

  // What is beyond its tolerance, or has none and is not as described, is off; as described are damping and tyre
  // damping.
  description.tolerance = {{"body.mass", 0.01}, {"wheel.mass", 0.05}};
  const auto beyond = identification::estimate_virtual_car(description, {e});
  ASSERT_EQ(beyond.off.size(), 2U);
  EXPECT_EQ(beyond.off[0].path, "body.mass");
  EXPECT_EQ(beyond.off[0].described, description.rig.body.mass);
  EXPECT_GT(beyond.off[0].gain, 1e3);
  EXPECT_EQ(beyond.off[1].path, "tyre.stiffness");
  ASSERT_EQ(beyond.parameters.size(), 3U);
  EXPECT_NEAR(beyond.parameters.at("body.mass").value / m_b, 1.0, 1e-5);
  EXPECT_NEAR(beyond.parameters.at("wheel.mass").value / m_w, 1.0, 1e-5);
  EXPECT_NEAR(beyond.parameters.at("tyre.stiffness").value / k_t, 1.0, 1e-5);

  // A force that is not the program's explains no number: with noise of its size no mass is found to be off.
  identification::PreparedRecording other = e;
  for (std::size_t k = 0; k < n; ++k) other.recording[Channel::F][k] = k % 2 == 0 ? 400.0 : -400.0;
  EXPECT_TRUE(identification::estimate_virtual_car(description, {other}).off.empty());
  EXPECT_TRUE(identification::estimate_virtual_car(parse_rig(support::bench_text, "rig"), {e}).parameters.empty());
}

/// A hil recording of a virtual tyre F_w = k_t dz_w + b_t ḋz_w + k₃ dz_w³, never below `lowest`.
identification::PreparedRecording tyre_recording(const RigDescription& description, double cubic, double lowest) {
  identification::PreparedRecording e;
  Recording& r = e.recording;
  r.sample_period = period;
  r.time = sample_times(8000, 1.0 / period);
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double t = period * static_cast<double>(k), w1 = 9.0, w2 = 70.0;
    const double tyre = 6e-3 * std::sin(w1 * t + 0.2) + 12e-3 * std::sin(w2 * t + 2.0);
    const double rate = 6e-3 * w1 * std::cos(w1 * t + 0.2) + 12e-3 * w2 * std::cos(w2 * t + 2.0);
    const double load =
        description.rig.tyre.stiffness * tyre + description.rig.tyre.damping * rate + cubic * tyre * tyre * tyre;
    r[Channel::F_w].push_back(std::max(load, lowest));
    r[Channel::z_w].push_back(-tyre);
    r[Channel::z_r].push_back(0.0);
  }
  e.fitted = {0, r.size()};
  return e;
}

// Point. Effects of a tyre that is a number are read off its numbers; a linear one has none. Velocities by differences
// are off by 8e-7 of b_t ḋz_w, some 1e-8 of the cubic's part.
TEST(VirtualCarEstimate, ReadsTheEffectsOfItsTyre) {
  RigDescription description = parse_rig(support::hil_text, "rig");
  description.tolerance = {{"tyre.stiffness", 0.03}};
  constexpr double never = -1e9;
  EXPECT_TRUE(
      identification::estimate_virtual_car(description, {tyre_recording(description, 0.0, never)}).effects.empty());

  const auto car = identification::estimate_virtual_car(description, {tyre_recording(description, -4e8, never)});
  ASSERT_EQ(car.effects.size(), 1U);
  EXPECT_EQ(car.effects[0].effect.entry->name, "progressive_tyre");
  EXPECT_NEAR(car.effects[0].effect.values[0] / -4e8, 1.0, 1e-4);
  EXPECT_LT(car.tyre_error.with_effects, 0.01 * car.tyre_error.refitted);
  EXPECT_LE(car.tyre_error.refitted, car.tyre_error.described);
  EXPECT_GT(car.effects[0].gain, 1e4);

  // A tyre 10 % stiffer than described is no law.
  RigDescription softer = description;
  softer.rig.tyre.stiffness /= 1.1;
  EXPECT_TRUE(identification::estimate_virtual_car(softer, {tyre_recording(description, 0.0, never)}).effects.empty());

  // Beyond the bounds of its card, −1e12, it is no tyre's.
  EXPECT_TRUE(
      identification::estimate_virtual_car(description, {tyre_recording(description, -4e13, never)}).effects.empty());

  const double weight = 9.81 * (description.rig.body.mass + description.rig.wheel.mass);
  const auto lifted =
      identification::estimate_virtual_car(description, {tyre_recording(description, 0.0, -weight)}).effects;
  ASSERT_EQ(lifted.size(), 1U);
  EXPECT_EQ(lifted[0].effect.entry->name, "tyre_lift_off");

  const auto both =
      identification::estimate_virtual_car(description, {tyre_recording(description, 4e8, -weight)}).effects;
  ASSERT_EQ(both.size(), 2U);
  EXPECT_NEAR(both[1].effect.values.at(0) / 4e8, 1.0, 1e-4);
}

// Edge. One deflection of 100 m beside tenths of a micrometre cannot tell a cubic law from a line.
TEST(VirtualCarEstimate, NamesNoLawThatOneSampleShows) {
  RigDescription description = parse_rig(support::hil_text, "rig");
  constexpr double never = -1e9;
  auto recording = tyre_recording(description, -4e8, never);
  for (double& z : recording.recording[Channel::z_r]) z *= 1e-7;
  for (double& z : recording.recording[Channel::z_w]) z *= 1e-7;
  recording.recording[Channel::z_r][100] = 100.0;
  recording.recording[Channel::F_w][100] = 200.0 * description.rig.tyre.stiffness;
  EXPECT_TRUE(identification::estimate_virtual_car(description, {recording}).effects.empty());
}

// Law. What is held out is not fitted: its quarter of F_w is doubled, which moves neither the cubic term nor its gain,
// and all of it is error there: |2 F_w − F_w| ÷ |2 F_w| is one half.
TEST(VirtualCarEstimate, JudgesItsTyreOnWhatIsHeldOut) {
  RigDescription description = parse_rig(support::hil_text, "rig");
  constexpr double never = -1e9;
  auto recording = tyre_recording(description, -4e8, never);
  const auto whole = identification::estimate_virtual_car(description, {recording});
  recording.fitted = {0, 6000};
  recording.held_out = {6000, 8000};
  for (std::size_t k = 6000; k < 8000; ++k) recording.recording[Channel::F_w][k] *= 2.0;
  const auto found = identification::estimate_virtual_car(description, {recording});
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_NEAR(found.effects[0].effect.values[0] / whole.effects[0].effect.values[0], 1.0, 1e-4);
  EXPECT_NEAR(found.tyre_error.with_effects, 0.5, 1e-3);
  EXPECT_LT(whole.tyre_error.with_effects, 1e-3);
}

}  // namespace
