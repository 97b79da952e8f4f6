// The model's answer to a recording's own input.
#include "host_sim/response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "host_sim/closed_loop.hpp"
#include "host_sim/input_error.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using host_sim::Drive;
using host_sim::drive_of;
using host_sim::InitialState;
using host_sim::parse_rig;
using host_sim::Recording;
using host_sim::respond;
using host_sim::Response;
using host_sim::RigDescription;
using model::Channel;
using model::index;

constexpr double pi = 3.141592653589793;

/// A recording of nothing but the given channels.
Recording recording_of(std::initializer_list<std::pair<Channel, std::vector<double>>> channels) {
  Recording recording;
  recording.source = "REC.csv";
  recording.sample_period = 1e-3;
  for (const auto& [channel, values] : channels) recording[channel] = values;
  recording.time = host_sim::sample_times(channels.begin()->second.size(), 1000.0);
  return recording;
}

std::vector<double> sine(std::size_t samples, double amplitude, double frequency, double phase = 0.0) {
  std::vector<double> values;
  for (std::size_t k = 0; k < samples; ++k) {
    values.push_back(amplitude * std::sin(2.0 * pi * frequency * static_cast<double>(k) * 1e-3 + phase));
  }
  return values;
}

/// What the paper's rig records on its road, without noise.
Recording simulated(const RigDescription& rig, std::size_t samples) {
  host_sim::IsoRoad road;
  road.bandwidth = 30.0;
  const auto motion =
      host_sim::excitation(rig.rig, host_sim::drive_over(road, rig.sample_rate, samples), rig.sample_rate);
  host_sim::RunOptions options;
  options.noise = host_sim::SimulatedRig::Noise::none;
  return host_sim::run_closed_loop(rig, motion, options).recording;
}

Recording from_sample(Recording recording, std::size_t first) {
  const auto cut = [first](auto& column) {
    if (!column.empty()) column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  };
  cut(recording.time);
  for (auto& column : recording.channels) cut(column);
  for (auto& column : recording.ducts) cut(column);
  return recording;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

// contract.md: z_r drives quarter_car and hil; x_cmd a bench, x_act where it has no x_cmd.
TEST(Response, IsDrivenByTheInputOfTheContract) {
  const auto car = parse_rig(support::quarter_car_text, "RIG.toml");
  const auto bench = parse_rig(support::bench_text, "RIG.toml");
  const auto x = sine(50, 0.01, 5.0);
  EXPECT_EQ(drive_of(car.rig, recording_of({{Channel::z_r, x}})).channel, Channel::z_r);
  EXPECT_EQ(drive_of(bench.rig, recording_of({{Channel::x_cmd, x}, {Channel::x_act, x}})).channel, Channel::x_cmd);
  const Drive reached = drive_of(bench.rig, recording_of({{Channel::x_act, x}}));
  EXPECT_EQ(reached.channel, Channel::x_act);
  EXPECT_TRUE(reached.deflection_reached);
  EXPECT_EQ(host_sim::response_channels(model::RigKind::component_bench, reached), std::vector<Channel>{Channel::F})
      << "an input is no answer";
  EXPECT_THROW(static_cast<void>(drive_of(car.rig, recording_of({{Channel::z_w, x}}))), host_sim::InputError);
  EXPECT_THROW(static_cast<void>(drive_of(bench.rig, recording_of({{Channel::F, x}}))), host_sim::InputError);
}

// Point. A machine that is known to have reached x_act has no delay any more; one that was commanded has.
TEST(Response, LeavesTheMachineOutWhereItsDeflectionIsRecorded) {
  const auto bench = parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 1000.0\n"
      "damping = 0.0\n[effects.actuator_delay]\ndelay = 0.004\n",
      "RIG.toml");
  const auto x = sine(200, 0.01, 5.0);
  const auto answer = [&bench](const Recording& recording) {
    const Drive drive = drive_of(bench.rig, recording);
    return respond(bench.rig, drive, host_sim::resting(bench.rig, drive))[index(Channel::F)];
  };
  const auto reached = answer(recording_of({{Channel::x_act, x}}));
  const auto commanded = answer(recording_of({{Channel::x_cmd, x}}));
  for (std::size_t k = 10; k < 200; ++k) {
    EXPECT_DOUBLE_EQ(reached[k], 1000.0 * x[k]) << k;
    EXPECT_DOUBLE_EQ(commanded[k], 1000.0 * x[k - 4]) << k;
  }
}

// Law. The firmware's run, fed back as a recording, is answered by what was recorded: the difference is what
// velocities by differences lack, h⁴/30 |z⁽⁵⁾|, below (2π · 30 Hz · h)⁴/30 = 4e-5 of the velocity at the road's 30 Hz,
// and less in all that lies below; 2e-4 of each channel's largest value.
TEST(Response, ReproducesASimulatedRun) {
  for (const char* name : {"paper_rig_fdva", "paper_hil_fdva", "paper_bench_fdva"}) {
    RigDescription rig = support::rig(name);
    rig.controller.valve_plan = {{0.7, 0b100}, {1.5, 0b011011}};
    rig.rig.effects.get<model::CoulombFriction>().active =
        false;  // it jumps, and so by all of its force if a sample late
    const Recording recording = simulated(rig, 3000);
    const Drive drive = drive_of(rig.rig, recording);
    const Response response = respond(rig.rig, drive, host_sim::resting(rig.rig, drive));
    int compared = 0;
    for (const Channel channel : host_sim::response_channels(rig.rig.kind, drive)) {
      if (!recording.has(channel)) continue;
      double largest = 0.0;
      for (const double v : recording[channel]) largest = std::max(largest, std::abs(v));
      EXPECT_LT(largest_difference(response[index(channel)], recording[channel]), 2e-4 * largest)
          << name << " " << model::name(channel);
      ++compared;
    }
    EXPECT_GE(compared, 2) << name;
  }
}

// Recorded valves are in force; a duct that is not recorded stands as described; one that is not installed is a
// mistake.
TEST(Response, TakesTheDuctsOfTheRecording) {
  RigDescription rig = support::rig("paper_bench_fdva");
  Recording recording = recording_of({{Channel::x_cmd, sine(30, 0.01, 5.0)}});
  EXPECT_TRUE(drive_of(rig.rig, recording).ducts.empty());
  recording.ducts[1].assign(30, 0.0);
  recording.ducts[4].assign(30, 0.0);
  recording.ducts[4][7] = 1.0;
  const Drive drive = drive_of(rig.rig, recording);
  ASSERT_EQ(drive.ducts.size(), 30U);
  EXPECT_EQ(drive.ducts[6], 0b00001) << "duct 1 as described, duct 2 recorded closed";
  EXPECT_EQ(drive.ducts[7], 0b10001);
  rig.rig.fdva.ducts = 4;
  EXPECT_THROW(static_cast<void>(drive_of(rig.rig, recording)), host_sim::InputError);
}

// z̈_r is what the accelerometer says: second differences of a displacement with 20 µm of noise would be 54 m/s² of
// noise.
TEST(Response, TakesTheRecordedAccelerationOfTheFootPoint) {
  RigDescription rig =
      parse_rig(std::string(support::quarter_car_text) + "[effects.force_sensor_inertia]\nmass = 5\n", "R");
  const std::vector<double> zero(50, 0.0);
  Recording recording = recording_of({{Channel::z_r, zero}, {Channel::zdd_r, sine(50, 3.0, 20.0)}});
  const Drive drive = drive_of(rig.rig, recording);
  const Response response = respond(rig.rig, drive, host_sim::resting(rig.rig, drive));
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_DOUBLE_EQ(response[index(Channel::F_w)][k], 5.0 * recording[Channel::zdd_r][k]);
  }
}

// F_act pushes body and wheel apart: upwards on the body, z̈_b = F_act/m_b at first.
TEST(Response, AppliesTheRecordedActuatorForce) {
  const auto rig = parse_rig(support::quarter_car_text, "RIG.toml");
  const std::vector<double> zero(50, 0.0);
  std::vector<double> force(50, 0.0);
  for (std::size_t k = 10; k < 50; ++k) force[k] = 29.0;
  const Drive drive = drive_of(rig.rig, recording_of({{Channel::z_r, zero}, {Channel::F_act, force}}));
  const Response response = respond(rig.rig, drive, host_sim::resting(rig.rig, drive));
  EXPECT_EQ(response[index(Channel::zdd_b)][9], 0.0);
  EXPECT_NEAR(response[index(Channel::zdd_b)][10], 29.0 / 290.0, 0.02);
  EXPECT_LT(response[index(Channel::zdd_w)][10], 0.0);
}

// A response of the first samples is the beginning of the whole one, to the bit.
TEST(Response, MayBeCutShort) {
  const auto rig = support::rig("paper_rig_fdva");
  const Drive drive = drive_of(rig.rig, recording_of({{Channel::z_r, sine(400, 0.01, 3.0)}}));
  const InitialState start = host_sim::resting(rig.rig, drive);
  const auto all = respond(rig.rig, drive, start)[index(Channel::F_w)];
  const auto some = respond(rig.rig, drive, start, 150)[index(Channel::F_w)];
  ASSERT_EQ(some.size(), 150U);
  for (std::size_t k = 0; k < 150; ++k) ASSERT_EQ(some[k], all[k]);
  EXPECT_EQ(respond(rig.rig, drive, start, 1000)[index(Channel::F_w)].size(), 400U);
}

// Rest is above the first sample, wherever the road begins.
TEST(Response, RestsAboveTheFirstSample) {
  const auto rig = parse_rig(support::quarter_car_text, "RIG.toml");
  const Drive drive = drive_of(rig.rig, recording_of({{Channel::z_r, std::vector<double>(300, 0.05)}}));
  const Response response = respond(rig.rig, drive, host_sim::resting(rig.rig, drive));
  for (std::size_t k = 0; k < 300; ++k) {
    ASSERT_NEAR(response[index(Channel::z_b)][k], 0.05, 1e-14);
    ASSERT_NEAR(response[index(Channel::F_w)][k], 0.0, 1e-8);
  }
  const auto bench = support::rig("paper_bench_fdva");
  const Drive held = drive_of(bench.rig, recording_of({{Channel::x_cmd, std::vector<double>(300, 0.01)}}));
  const Response answer = respond(bench.rig, held, host_sim::resting(bench.rig, held));
  for (std::size_t k = 0; k < 300; ++k) {
    ASSERT_NEAR(answer[index(Channel::F)][k], 31500.0 * 0.01, 1e-9) << "the piston has followed: its spring is relaxed";
  }
}

TEST(Response, TellsWhetherARecordingBeginsAtRest) {
  const auto rig = support::rig("paper_rig_fdva");
  const Recording recording = simulated(rig, 8000);
  const auto at_rest = [&rig](const Recording& r) {
    return host_sim::begins_at_rest(rig.rig, drive_of(rig.rig, r), r);
  };
  EXPECT_TRUE(at_rest(recording));
  EXPECT_FALSE(at_rest(from_sample(recording, 5000)));
}

// Law. A recording that begins in mid-motion is answered from the state that it shows: the true one. What is left is
// what the differences at the first samples (second order there) lack: 1 % of each rms, where a rest would leave 20 %
// and more in some channel.
TEST(Response, FindsTheStateAtTheStart) {
  for (const char* name : {"paper_rig_fdva", "paper_bench_fdva", "paper_hil_fdva"}) {
    const auto rig = support::rig(name);
    const Recording recording = from_sample(simulated(rig, 12000), 4321);
    const Drive drive = drive_of(rig.rig, recording);
    const auto worst = [&](const InitialState& start) {
      const Response response = respond(rig.rig, drive, start);
      double largest = 0.0;
      for (const Channel channel : host_sim::response_channels(rig.rig.kind, drive)) {
        if (!recording.has(channel)) continue;
        double error = 0.0, power = 0.0;
        for (std::size_t k = 0; k < recording.size(); ++k) {
          error += std::pow(response[index(channel)][k] - recording[channel][k], 2);
          power += std::pow(recording[channel][k], 2);
        }
        largest = std::max(largest, std::sqrt(error / power));
      }
      return largest;
    };
    EXPECT_LT(worst(host_sim::estimated_start(rig.rig, drive, recording)), 0.01) << name;
    EXPECT_GT(worst(host_sim::resting(rig.rig, drive)), 0.05) << name;
  }
}

// What lies outside the measuring range tells nothing about the start: with the same wrong samples inside the range the
// start is spoilt.
TEST(Response, IgnoresClippedSamplesAtTheStart) {
  const auto rig = support::rig("paper_rig_fdva");
  Recording recording = from_sample(simulated(rig, 12000), 4321);
  const Drive drive = drive_of(rig.rig, recording);
  const InitialState right = host_sim::estimated_start(rig.rig, drive, recording);
  for (std::size_t k = 0; k < 40; ++k) recording[Channel::dz_b][k] = 0.125;
  host_sim::MeasuringRanges range;
  range[index(Channel::dz_b)] = {-0.125, 0.125};
  const InitialState clipped = host_sim::estimated_start(rig.rig, drive, recording, range);
  const InitialState believed = host_sim::estimated_start(rig.rig, drive, recording);
  const double scale = right.norm();
  EXPECT_LT((clipped - right).norm(), 0.02 * scale);
  EXPECT_GT((believed - right).norm(), 0.10 * scale);
}

// Nothing moves, so nothing tells a start: it is rest, and finite.
TEST(Response, StartsARecordingOfNothingAtRest) {
  const auto rig = support::rig("paper_rig_fdva");
  const std::vector<double> zero(100, 0.0);
  const Recording recording = recording_of({{Channel::z_r, zero}, {Channel::F_w, zero}});
  const Drive drive = drive_of(rig.rig, recording);
  EXPECT_EQ(host_sim::estimated_start(rig.rig, drive, recording), host_sim::resting(rig.rig, drive));
  EXPECT_TRUE(host_sim::begins_at_rest(rig.rig, drive, recording));
}

}  // namespace
