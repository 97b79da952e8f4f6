// Diagnosis of a mass that a force drives. The recordings come from a Runge–Kutta method here, not from the model.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/support/reference_road.hpp"

namespace driven_mass_test {
namespace {

using firmware::Recording;
using host_sim::identification::Diagnosis;
using host_sim::identification::Use;
using host_sim::identification::Verdict;
using model::Channel;

/// The linear part of the Silverbox benchmark in newtons and metres.
constexpr double mass = 0.5375, damping = 22.55, stiffness = 99.05e3;
constexpr double rate = 610.35, noise_of_position = 1e-5, noise_of_acceleration = 0.5;

firmware::RigDescription silverbox() {
  return firmware::parse_rig(
      "kind = \"component_bench\"\ndriven_by = \"force\"\nsample_rate = 610.35\n[body]\nmass = 0.5375\n"
      "[suspension]\nstiffness = 99050.0\ndamping = 22.55\n"
      "[tolerance]\n\"suspension.stiffness\" = 0.05\n\"suspension.damping\" = 0.3\n"
      "[noise]\nF = 0.02\nx_act = 1e-5\nzdd_b = 0.5\n",
      "silverbox.toml");
}

/// Forty sines from 2 Hz to `highest` with Schroeder's phases, whose sum has no peaks [N].
double force_at(double t, double amplitude, double highest) {
  constexpr int lines = 40;
  double force = 0.0;
  for (int i = 0; i < lines; ++i) {
    const double f = 2.0 + (highest - 2.0) * i / (lines - 1) + 0.037 * i, phase = -std::numbers::pi * i * i / lines;
    force += std::sin(2.0 * std::numbers::pi * f * t + phase);
  }
  return amplitude * std::sqrt(2.0 / lines) * force;
}

struct Truth {
  double amplitude, seconds;
  std::uint64_t seed;
  double friction = 0.0;
  double highest = 120.0;  // [Hz] of the force
};

/// m ẍ + c ẋ + k x + friction · v/√(v² + 1e-6) = F, from rest, with the noise of its sensors.
Recording recorded(const Truth& truth) {
  const auto acceleration = [&](double t, double x, double v) {
    return (force_at(t, truth.amplitude, truth.highest) - damping * v - stiffness * x -
            truth.friction * v / std::sqrt(v * v + 1e-6)) /
           mass;
  };
  constexpr int substeps = 20;
  const double h = 1.0 / rate / substeps;
  support::NormalNoise noise(truth.seed);
  Recording r;
  r.sample_period = 1.0 / rate;
  r.time = firmware::sample_times(static_cast<std::size_t>(truth.seconds * rate), rate);
  r.source = "silverbox, seed " + std::to_string(truth.seed);
  double x = 0.0, v = 0.0;
  for (const double start : r.time) {
    r[Channel::F].push_back(force_at(start, truth.amplitude, truth.highest) + 0.02 * noise());
    r[Channel::x_act].push_back(x + noise_of_position * noise());
    r[Channel::zdd_b].push_back(acceleration(start, x, v) + noise_of_acceleration * noise());
    for (int i = 0; i < substeps; ++i) {
      const double t = start + i * h;
      const double a1 = acceleration(t, x, v), v2 = v + 0.5 * h * a1;
      const double a2 = acceleration(t + 0.5 * h, x + 0.5 * h * v, v2), v3 = v + 0.5 * h * a2;
      const double a3 = acceleration(t + 0.5 * h, x + 0.5 * h * v2, v3), v4 = v + h * a3;
      const double a4 = acceleration(t + h, x + h * v3, v4);
      x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }
  return r;
}

// Law. A linear mass whose stiffness is 3 % off, inside its tolerance: nothing is named, and the stiffness is found. The
// force reaches far beyond what a road drives, and the mass answers there: that is no noise.
TEST(DrivenMass, FindsNothingWhereNothingIs) {
  Recording r = recorded({.amplitude = 10.0, .seconds = 8.0, .seed = 2, .highest = 250.0});
  auto described = silverbox();
  described.rig.suspension.stiffness = 1.03 * stiffness;
  const Diagnosis found = host_sim::identification::diagnose(described, {{std::move(r), Use::shared}});
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << host_sim::identification::sentence(found);
  for (const auto& fault : found.recording_faults) {
    EXPECT_EQ(std::count(fault.channels.begin(), fault.channels.end(), Channel::F), 0) << fault.name;
  }
  EXPECT_NEAR(found.parameters.at("suspension.stiffness").value / stiffness, 1.0, 2e-3);
}

// Journey. As it comes: position alone, no noise declared, no value known but roughly. The force that drives it is
// measured, so mass, stiffness and damping are known apart.
TEST(DrivenMass, KnowsTheMassByTheForce) {
  Recording r = recorded({.amplitude = 20.0, .seconds = 8.0, .seed = 4, .highest = 200.0});
  r[Channel::zdd_b].clear();
  auto described = silverbox();
  described.noise = {};
  described.tolerance = {{"body.mass", 0.2}, {"suspension.stiffness", 0.3}, {"suspension.damping", 0.5}};
  described.rig.body.mass = 0.5;
  described.rig.suspension.stiffness = 90e3;
  const Diagnosis found = host_sim::identification::diagnose(described, {{std::move(r), Use::shared}});
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << host_sim::identification::sentence(found);
  EXPECT_TRUE(found.undetermined.empty()) << found.undetermined.front().combination;
  const auto known = found.parameters.at("body.mass");
  EXPECT_NEAR(known.value / mass, 1.0, 2e-3);
  EXPECT_LT(known.lower, mass);
  EXPECT_GT(known.upper, mass);
  EXPECT_LT(known.upper - known.lower, 0.2 * mass);  // half of the tolerance
}

// Journey. Dry friction of a guide, seen by an accelerometer alone: the effect of the component.
TEST(DrivenMass, NamesFriction) {
  Recording r = recorded({.amplitude = 20.0, .seconds = 8.0, .seed = 3, .friction = 3.0});
  r[Channel::x_act].clear();
  const Diagnosis found = host_sim::identification::diagnose(silverbox(), {{std::move(r), Use::shared}});
  const std::string first = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << first;
  EXPECT_NE(first.find("friction"), std::string::npos) << first;
}

}  // namespace
}  // namespace driven_mass_test
