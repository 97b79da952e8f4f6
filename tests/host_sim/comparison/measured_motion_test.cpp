// Velocity and acceleration of a measured stroke, and the force of a bench that is simulated from it.
#include "host_sim/comparison/measured_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/comparison/model_rate.hpp"
#include "host_sim/comparison/side_by_side.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace measured_motion_test {
namespace {

using host_sim::measured_motion;
using model::Channel;

constexpr double two_pi = 2.0 * std::numbers::pi;

// (1), (2): of a sine the errors are (ωh)⁸/630 of the velocity and (ωh)⁸/3150 of the acceleration, without a phase.
// Half as much again for the next terms of the series.
TEST(MeasuredMotion, IsExactToTheOrderItSays) {
  for (const double h : {1.05e-3, 1e-3, 0.5e-3}) {
    for (const double f : {20.0, 60.0, 90.0}) {
      std::vector<double> x;
      for (int k = 0; k < 200; ++k) x.push_back(std::sin(two_pi * f * h * k + 0.3));
      const auto motion = measured_motion(x, 1.0 / h);
      const double w = two_pi * f, eighth = std::pow(w * h, 8);
      for (std::size_t k = 4; k + 4 < x.size(); ++k) {
        const double phase = w * h * static_cast<double>(k) + 0.3;
        EXPECT_EQ(motion[k].position, x[k]);
        EXPECT_NEAR(motion[k].velocity, w * std::cos(phase), w * (1.5 * eighth / 630.0 + 1e-12));
        EXPECT_NEAR(motion[k].acceleration, -w * w * std::sin(phase), w * w * (1.5 * eighth / 3150.0 + 1e-10));
      }
    }
  }
}

// What stands still has no sign of a velocity; the ends, and what is too short, are those of through_samples().
TEST(MeasuredMotion, StandsStillExactlyAndHasTheEndsOfTheRoad) {
  for (const auto& m : measured_motion(std::vector<double>(20, 0.123), 1000.0)) EXPECT_EQ(m.velocity, 0.0);
  std::vector<double> x;
  for (int k = 0; k < 12; ++k) x.push_back(0.01 * k * k * k);
  const auto motion = measured_motion(x, 100.0), plain = firmware::through_samples(x, 100.0);
  for (const std::size_t k : {0U, 1U, 2U, 3U, 8U, 11U}) EXPECT_EQ(motion[k].velocity, plain[k].velocity) << k;
  EXPECT_EQ(measured_motion({1.0, 2.0}, 10.0)[1].velocity, 10.0);
  EXPECT_TRUE(measured_motion({}, 10.0).empty());
}

struct ExactBench {
  firmware::RigDescription description;
  firmware::Recording recording;
  double highest = 0.0;  ///< [Hz] of its motion
};

/// F = k x + c ẋ + m ẍ of 24 lines up to `highest`, at this rate, without noise.
ExactBench exact_bench(double rate, double resonance, double highest) {
  const double k = 99050.0, m = k / std::pow(two_pi * resonance, 2), c = 0.05 * std::sqrt(k * m);
  char text[400];
  std::snprintf(text, sizeof text,
                "kind = 'component_bench'\nsample_rate = %.17g\n[suspension]\nstiffness = %.17g\ndamping = %.17g\n"
                "[effects.moving_mass]\nmass = %.17g\n[noise]\nF = 0.05\nx_act = 1e-9\n",
                rate, k, c, m);
  ExactBench bench{firmware::parse_rig(text, "bench.toml"), {}, highest};
  firmware::Recording& r = bench.recording;
  r.source = "bench.csv";
  r.sample_period = 1.0 / rate;
  const auto n = static_cast<std::size_t>(4.0 * rate);
  r.time = firmware::sample_times(n, rate);
  r[Channel::x_act].assign(n, 0.0);
  r[Channel::F].assign(n, 0.0);
  for (int line = 1; line <= 24; ++line) {
    const double f = highest * line / 24.0, w = two_pi * f, amplitude = 1e-3 / (1.0 + line);
    for (std::size_t i = 0; i < n; ++i) {
      const double phase = w * static_cast<double>(i) / rate + 2.4 * line * line;
      r[Channel::x_act][i] += amplitude * std::sin(phase);
      r[Channel::F][i] += amplitude * ((k - m * w * w) * std::sin(phase) + c * w * std::cos(phase));
    }
  }
  return bench;
}

// Law. An exact bench, described exactly as it is, is simulated from its measured deflection to within the errors of
// interpolation and differences, whatever the rate, the band and the resonance. Bound: of the damper's force (ωh)⁸/630,
// of the mass's (ωh)⁸/3150 at the highest line, and of the mass's what an interpolated signal (step > 1) has at its
// images, 1e-5 (signal/interpolation.hpp) times the second difference's gain there, at most 6.6/(ωh)². With the
// differences of fourth order and an acceleration that knows the past alone the error was up to 7 % of F, a damper.
TEST(MeasuredMotion, BoundsTheErrorOfABenchOverRatesBandsAndResonances) {
  for (const double rate : {610.3515625, 1000.0, 1220.703125, 2441.40625, 8192.0}) {
    for (const double resonance : {25.0, 68.0}) {
      for (const double highest : {60.0, 80.0, 90.0}) {
        const ExactBench bench = exact_bench(rate, resonance, highest);
        const auto prepared = host_sim::identification::prepare_recording(bench.description, bench.recording,
                                                                          host_sim::identification::Use::fitted, false);
        const auto given = host_sim::identification::described_hypothesis(bench.description, {prepared});
        const auto read =
            host_sim::identification::read_channels(given, prepared, prepared.input, given.starts.front(), 0, {1});
        const auto& measured = prepared.recording[Channel::F];
        double squares = 0.0, whole = 0.0;
        const auto margin = static_cast<std::size_t>(0.25 / prepared.input.period);
        for (std::size_t k = prepared.compared_from(margin); k + margin < measured.size(); k += prepared.step) {
          squares += std::pow(measured[k] - read[index(Channel::F)][k], 2);
          whole += std::pow(measured[k], 2);
        }
        const double h = prepared.input.period, wh = two_pi * highest * h, eighth = std::pow(wh, 8);
        // At the highest line: forces of mass and damper, of the stiffness, and F beside them.
        const double mass = std::pow(highest / resonance, 2), damper = 0.05 * highest / resonance;
        const double images = prepared.step > 1 ? 1e-5 * 6.6 / (wh * wh) : 0.0;
        const double force = std::hypot(1.0 - mass, damper);
        const double bound = 2.0 * (damper * eighth / 630.0 + mass * (eighth / 3150.0 + images)) / std::min(force, 1.0);
        EXPECT_LT(std::sqrt(squares / whole), bound + 1e-6)
            << rate << " Hz, resonance " << resonance << ", up to " << highest;
      }
    }
  }
}

// A square wave of a slow command is held until its next step; a ramp, a sine and a triangle are no staircases.
TEST(SteppedCommand, IsHeldBetweenSamples) {
  firmware::Recording r;
  r.sample_period = 0.02;
  for (int k = 0; k < 60; ++k) {
    r[Channel::x_cmd].push_back((k / 12) % 2 == 0 ? 1.0 : -1.0);
    r[Channel::x_act].push_back(std::sin(0.3 * k));
  }
  r.time = firmware::sample_times(60, 50.0);
  const firmware::Recording finer = host_sim::interpolated(r, 10);
  for (std::size_t k = 0; k < finer.size(); ++k) {
    ASSERT_EQ(finer[Channel::x_cmd][k], r[Channel::x_cmd][k / 10]) << k;
  }
  EXPECT_NEAR(finer[Channel::x_act][305], std::sin(0.3 * 30.5), 1e-4);
  std::vector<double> ramp, sine, triangle;
  for (int k = 0; k < 100; ++k) {
    ramp.push_back(0.1 * k);
    sine.push_back(std::sin(0.2 * k));
    triangle.push_back(k % 40 < 20 ? k % 40 : 40 - k % 40);
  }
  for (const auto& moving : {ramp, sine, triangle, std::vector<double>(50, 1.0), std::vector<double>()}) {
    EXPECT_FALSE(host_sim::is_stepped(moving));
  }
}

// The load cell's force does not depend on how many rigs are simulated at once, and passes the sensor of F.
TEST(MeasuredMotion, GivesTheLoadCellOfEachRigItsForce) {
  ExactBench bench = exact_bench(1000.0, 68.0, 80.0);
  const auto input = host_sim::simulation_input(bench.description.rig, bench.recording);
  const auto start = host_sim::resting(bench.description.rig, input);
  std::vector<model::RigParameters<double>> rigs(4, bench.description.rig);
  for (std::size_t i = 0; i < rigs.size(); ++i) rigs[i].suspension.damping *= 1.0 + 0.1 * static_cast<double>(i);
  std::vector<host_sim::SideBySideRig> all;
  for (const auto& rig : rigs) all.push_back({&rig, &start, &input});
  const auto together = host_sim::simulate_side_by_side(all, 0, 1, {Channel::F});
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    EXPECT_EQ(together[i][index(Channel::F)], host_sim::simulate(rigs[i], input, start)[index(Channel::F)]) << i;
  }
  model::RigParameters<double> halved = bench.description.rig;
  firmware::put_effect(halved, {firmware::find_effect("sensor_gain"), Channel::F, {0.5}});
  const auto whole = host_sim::simulate(bench.description.rig, input, start);
  const auto half = host_sim::simulate(halved, input, start);
  for (std::size_t k = 0; k < input.size(); ++k) {
    ASSERT_DOUBLE_EQ(half[index(Channel::F)][k], 0.5 * whole[index(Channel::F)][k]) << k;
  }
}

}  // namespace
// Point. (1) of longest_step(): a recording at 10 Hz has nothing above 5 Hz, a sixth of 30 Hz. Not of a car, and not
// behind a command that steps.
TEST(ModelRate, FollowsWhatARecordingCanHold) {
  firmware::Recording recording;
  recording.sample_period = 0.1;
  EXPECT_DOUBLE_EQ(host_sim::longest_step(model::RigKind::component_bench, recording), 6e-3);
  EXPECT_EQ(host_sim::model_steps_per_sample(0.1, 6e-3), 17U);
  EXPECT_EQ(host_sim::longest_step(model::RigKind::quarter_car, recording), host_sim::longest_model_step);
  recording[model::Channel::x_cmd] = {0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0};
  EXPECT_EQ(host_sim::longest_step(model::RigKind::component_bench, recording), host_sim::longest_model_step);
  recording[model::Channel::x_cmd].clear();
  recording.sample_period = 1e-3;
  EXPECT_EQ(host_sim::longest_step(model::RigKind::component_bench, recording), host_sim::longest_model_step);
}

}  // namespace measured_motion_test
