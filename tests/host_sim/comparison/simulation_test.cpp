// Simulation of a recording's own input.
#include "host_sim/comparison/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/comparison/start_state.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::parse_rig;
using firmware::Recording;
using firmware::RigDescription;
using host_sim::InitialState;
using host_sim::Response;
using host_sim::simulate;
using host_sim::simulation_input;
using host_sim::SimulationInput;
using model::Channel;
using model::index;

constexpr double pi = 3.141592653589793;

/// A recording of nothing but the given channels.
Recording recording_of(std::initializer_list<std::pair<Channel, std::vector<double>>> channels) {
  Recording recording;
  recording.source = "REC.csv";
  recording.sample_period = 1e-3;
  for (const auto& [channel, values] : channels) recording[channel] = values;
  recording.time = firmware::sample_times(channels.begin()->second.size(), 1000.0);
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
  firmware::IsoRoad road;
  road.bandwidth = 30.0;
  const auto motion =
      firmware::excitation(rig.rig, firmware::drive_over(road, rig.sample_rate, samples), rig.sample_rate);
  host_sim::RunOptions options;
  options.noise = firmware::SimulatedRig::Noise::none;
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
TEST(Simulation, IsDrivenByTheInputOfTheContract) {
  const auto car = parse_rig(support::quarter_car_text, "RIG.toml");
  const auto bench = parse_rig(support::bench_text, "RIG.toml");
  const auto x = sine(50, 0.01, 5.0);
  EXPECT_EQ(simulation_input(car.rig, recording_of({{Channel::z_r, x}})).channel, Channel::z_r);
  EXPECT_EQ(simulation_input(bench.rig, recording_of({{Channel::x_cmd, x}, {Channel::x_act, x}})).channel,
            Channel::x_cmd);
  const SimulationInput reached = simulation_input(bench.rig, recording_of({{Channel::x_act, x}}));
  EXPECT_EQ(reached.channel, Channel::x_act);
  EXPECT_TRUE(reached.deflection_reached);
  EXPECT_EQ(host_sim::response_channels(model::RigKind::component_bench, reached), std::vector<Channel>{Channel::F})
      << "an input is no answer";
  const SimulationInput commanded = simulation_input(car.rig, recording_of({{Channel::z_cmd, x}, {Channel::z_r, x}}));
  EXPECT_EQ(commanded.channel, Channel::z_cmd);
  const auto answers = host_sim::response_channels(model::RigKind::quarter_car, commanded);
  EXPECT_EQ(answers.front(), Channel::z_r) << "what the machine reaches is an answer";
  EXPECT_THROW(static_cast<void>(simulation_input(car.rig, recording_of({{Channel::z_w, x}}))), firmware::InputError);
  EXPECT_THROW(static_cast<void>(simulation_input(bench.rig, recording_of({{Channel::F, x}}))), firmware::InputError);
}

// Point. A machine that is known to have reached x_act has no delay any more; one that was commanded has.
TEST(Simulation, LeavesTheMachineOutWhereItsDeflectionIsRecorded) {
  const auto bench = parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 1000.0\n"
      "damping = 0.0\n[effects.actuator_delay]\ndelay = 0.004\n",
      "RIG.toml");
  const auto x = sine(200, 0.01, 5.0);
  const auto answer = [&bench](const Recording& recording) {
    const SimulationInput input = simulation_input(bench.rig, recording);
    return simulate(bench.rig, input, host_sim::resting(bench.rig, input))[index(Channel::F)];
  };
  const auto reached = answer(recording_of({{Channel::x_act, x}}));
  const auto commanded = answer(recording_of({{Channel::x_cmd, x}}));
  for (std::size_t k = 10; k < 200; ++k) {
    EXPECT_DOUBLE_EQ(reached[k], 1000.0 * x[k]) << k;
    EXPECT_DOUBLE_EQ(commanded[k], 1000.0 * x[k - 4]) << k;
  }
}

// Law. The machine of a quarter car stands between z_cmd and z_r: what the car does on the recorded z_cmd is what it
// does without machine on the z_r that was reached. z_r alone has velocities by differences, h⁴/30 |z⁽⁵⁾|: 5e-5 of them
// at 5 Hz and 1 kHz is plenty.
TEST(Simulation, LeavesTheMachineOfAQuarterCarOutWhereZrIsRecorded) {
  const auto car =
      parse_rig(std::string(support::quarter_car_text) + "[effects.actuator_lag]\ntime_constant = 0.02\n", "RIG.toml");
  auto z = sine(2000, 0.01, 5.0);
  for (std::size_t k = 0; k < 500; ++k) z[k] *= static_cast<double>(k * k) / 250000.0;
  const auto answer = [&car](const Recording& recording) {
    const SimulationInput input = simulation_input(car.rig, recording);
    return simulate(car.rig, input, host_sim::resting(car.rig, input));
  };
  const Response commanded = answer(recording_of({{Channel::z_cmd, z}}));
  const Response reached = answer(recording_of({{Channel::z_r, commanded[index(Channel::z_r)]}}));
  for (const Channel channel : {Channel::z_w, Channel::z_b, Channel::F_w, Channel::zdd_b}) {
    double largest = 0.0;
    for (const double v : commanded[index(channel)]) largest = std::max(largest, std::abs(v));
    EXPECT_LT(largest_difference(commanded[index(channel)], reached[index(channel)]), 5e-4 * largest)
        << model::name(channel);
  }
  EXPECT_GT(largest_difference(commanded[index(Channel::z_r)], z), 1e-3) << "the machine lags";
}

// Law. The firmware's run, fed back as a recording, is answered by what was recorded: the difference is what
// velocities by differences lack, h⁴/30 |z⁽⁵⁾|, below (2π · 30 Hz · h)⁴/30 = 4e-5 of the velocity at the road's 30 Hz,
// and less in all that lies below; 2e-4 of each channel's largest value.
TEST(Simulation, ReproducesASimulatedRun) {
  for (const char* name : {"paper_rig_fdva", "paper_hil_fdva", "paper_bench_fdva"}) {
    RigDescription rig = support::rig(name);
    rig.controller.valve_plan = {{0.7, 0b100}, {1.5, 0b011011}};
    rig.rig.effects.get<model::CoulombFriction>().active =
        false;  // it jumps, and so by all of its force if a sample late
    const Recording recording = simulated(rig, 3000);
    const SimulationInput input = simulation_input(rig.rig, recording);
    const Response response = simulate(rig.rig, input, host_sim::resting(rig.rig, input));
    int compared = 0;
    for (const Channel channel : host_sim::response_channels(rig.rig.kind, input)) {
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

// The same of a quarter car with a machine: the run records z_cmd, which drives the simulation, and z_r is among its
// answers. The machine starts as if it had always moved with its first velocity, which differs from rest: forgotten,
// with the wheel, after a second. A lag of 22 ms doubles what the velocities by differences lack at 7 Hz and triples it
// at 20 Hz.
TEST(Simulation, ReproducesASimulatedRunOnItsCommandedFootPoint) {
  RigDescription rig = support::rig("paper_rig_fdva");
  rig.rig.effects.add(model::ActuatorDelay<double>{0.0044});
  rig.rig.effects.add(model::ActuatorLag<double>{0.022});
  const Recording recording = simulated(rig, 4000);
  ASSERT_TRUE(recording.has(Channel::z_cmd));
  const SimulationInput input = simulation_input(rig.rig, recording);
  const Response response = simulate(rig.rig, input, host_sim::resting(rig.rig, input));
  for (const Channel channel : {Channel::z_r, Channel::zdd_w, Channel::dz_b, Channel::F_w}) {
    double largest = 0.0, off = 0.0;
    for (std::size_t k = 1500; k < 4000; ++k) {
      largest = std::max(largest, std::abs(recording[channel][k]));
      off = std::max(off, std::abs(recording[channel][k] - response[index(channel)][k]));
    }
    EXPECT_LT(off, 1e-3 * largest) << model::name(channel);
  }
  EXPECT_FALSE(simulated(support::rig("paper_rig_fdva"), 100).has(Channel::z_cmd)) << "its columns are what they were";
}

// Recorded valves are in force; a duct that is not recorded stands as described; one that is not installed is a
// mistake.
TEST(Simulation, TakesTheDuctsOfTheRecording) {
  RigDescription rig = support::rig("paper_bench_fdva");
  Recording recording = recording_of({{Channel::x_cmd, sine(30, 0.01, 5.0)}});
  EXPECT_TRUE(simulation_input(rig.rig, recording).ducts.empty());
  recording.ducts[1].assign(30, 0.0);
  recording.ducts[4].assign(30, 0.0);
  recording.ducts[4][7] = 1.0;
  const SimulationInput input = simulation_input(rig.rig, recording);
  ASSERT_EQ(input.ducts.size(), 30U);
  EXPECT_EQ(input.ducts[6], 0b00001) << "duct 1 as described, duct 2 recorded closed";
  EXPECT_EQ(input.ducts[7], 0b10001);
  rig.rig.fdva.ducts = 4;
  EXPECT_THROW(static_cast<void>(simulation_input(rig.rig, recording)), firmware::InputError);
}

// z̈_r is what the accelerometer says: second differences of a displacement with 20 µm of noise would be 54 m/s² of
// noise.
TEST(Simulation, TakesTheRecordedAccelerationOfTheFootPoint) {
  RigDescription rig =
      parse_rig(std::string(support::quarter_car_text) + "[effects.force_sensor_inertia]\nmass = 5\n", "R");
  const std::vector<double> zero(50, 0.0);
  Recording recording = recording_of({{Channel::z_r, zero}, {Channel::zdd_r, sine(50, 3.0, 20.0)}});
  const SimulationInput input = simulation_input(rig.rig, recording);
  const Response response = simulate(rig.rig, input, host_sim::resting(rig.rig, input));
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_DOUBLE_EQ(response[index(Channel::F_w)][k], 5.0 * recording[Channel::zdd_r][k]);
  }
}

// F_act pushes body and wheel apart: upwards on the body, z̈_b = F_act/m_b at first.
TEST(Simulation, AppliesTheRecordedActuatorForce) {
  const auto rig = parse_rig(support::quarter_car_text, "RIG.toml");
  const std::vector<double> zero(50, 0.0);
  std::vector<double> force(50, 0.0);
  for (std::size_t k = 10; k < 50; ++k) force[k] = 29.0;
  const SimulationInput input =
      simulation_input(rig.rig, recording_of({{Channel::z_r, zero}, {Channel::F_act, force}}));
  const Response response = simulate(rig.rig, input, host_sim::resting(rig.rig, input));
  EXPECT_EQ(response[index(Channel::zdd_b)][9], 0.0);
  EXPECT_NEAR(response[index(Channel::zdd_b)][10], 29.0 / 290.0, 0.02);
  EXPECT_LT(response[index(Channel::zdd_w)][10], 0.0);
}

// A response of the first samples is the beginning of the whole one, to the bit.
TEST(Simulation, MayBeCutShort) {
  const auto rig = support::rig("paper_rig_fdva");
  const SimulationInput input = simulation_input(rig.rig, recording_of({{Channel::z_r, sine(400, 0.01, 3.0)}}));
  const InitialState start = host_sim::resting(rig.rig, input);
  const auto all = simulate(rig.rig, input, start)[index(Channel::F_w)];
  const auto some = simulate(rig.rig, input, start, 150)[index(Channel::F_w)];
  ASSERT_EQ(some.size(), 150U);
  for (std::size_t k = 0; k < 150; ++k) ASSERT_EQ(some[k], all[k]);
  EXPECT_EQ(simulate(rig.rig, input, start, 1000)[index(Channel::F_w)].size(), 400U);
}

// Rest is above the first sample, wherever the road begins.
TEST(Simulation, RestsAboveTheFirstSample) {
  const auto rig = parse_rig(support::quarter_car_text, "RIG.toml");
  const SimulationInput input =
      simulation_input(rig.rig, recording_of({{Channel::z_r, std::vector<double>(300, 0.05)}}));
  const Response response = simulate(rig.rig, input, host_sim::resting(rig.rig, input));
  for (std::size_t k = 0; k < 300; ++k) {
    ASSERT_NEAR(response[index(Channel::z_b)][k], 0.05, 1e-14);
    ASSERT_NEAR(response[index(Channel::F_w)][k], 0.0, 1e-8);
  }
  const auto bench = support::rig("paper_bench_fdva");
  const SimulationInput held =
      simulation_input(bench.rig, recording_of({{Channel::x_cmd, std::vector<double>(300, 0.01)}}));
  const Response answer = simulate(bench.rig, held, host_sim::resting(bench.rig, held));
  for (std::size_t k = 0; k < 300; ++k) {
    ASSERT_NEAR(answer[index(Channel::F)][k], 31500.0 * 0.01, 1e-9) << "the piston has followed: its spring is relaxed";
  }
}

TEST(Simulation, TellsWhetherARecordingBeginsAtRest) {
  const auto rig = support::rig("paper_rig_fdva");
  const Recording recording = simulated(rig, 8000);
  const auto at_rest = [&rig](const Recording& r) {
    return host_sim::begins_at_rest(rig.rig, simulation_input(rig.rig, r), r);
  };
  EXPECT_TRUE(at_rest(recording));
  EXPECT_FALSE(at_rest(from_sample(recording, 5000)));
}

// Law. A recording that begins in mid-motion is answered from the state that it shows: the true one. What is left is
// what the differences at the first samples (second order there) lack: 1 % of each rms, where a rest would leave 20 %
// and more in some channel.
TEST(Simulation, FindsTheStateAtTheStart) {
  for (const char* name : {"paper_rig_fdva", "paper_bench_fdva", "paper_hil_fdva"}) {
    const auto rig = support::rig(name);
    const Recording recording = from_sample(simulated(rig, 12000), 4321);
    const SimulationInput input = simulation_input(rig.rig, recording);
    const auto worst = [&](const InitialState& start) {
      const Response response = simulate(rig.rig, input, start);
      double largest = 0.0;
      for (const Channel channel : host_sim::response_channels(rig.rig.kind, input)) {
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
    EXPECT_LT(worst(host_sim::estimated_start(rig.rig, input, recording)), 0.01) << name;
    EXPECT_GT(worst(host_sim::resting(rig.rig, input)), 0.05) << name;
  }
}

// What lies outside the measuring range tells nothing about the start: with the same wrong samples inside the range the
// start is spoilt.
TEST(Simulation, IgnoresClippedSamplesAtTheStart) {
  const auto rig = support::rig("paper_rig_fdva");
  Recording recording = from_sample(simulated(rig, 12000), 4321);
  const SimulationInput input = simulation_input(rig.rig, recording);
  const InitialState right = host_sim::estimated_start(rig.rig, input, recording);
  for (std::size_t k = 0; k < 40; ++k) recording[Channel::dz_b][k] = 0.125;
  firmware::MeasuringRanges range;
  range[index(Channel::dz_b)] = {-0.125, 0.125};
  const InitialState clipped = host_sim::estimated_start(rig.rig, input, recording, range);
  const InitialState believed = host_sim::estimated_start(rig.rig, input, recording);
  const double scale = right.norm();
  EXPECT_LT((clipped - right).norm(), 0.02 * scale);
  EXPECT_GT((believed - right).norm(), 0.10 * scale);
}

// Nothing moves, so nothing tells a start: it is rest, and finite.
TEST(Simulation, StartsARecordingOfNothingAtRest) {
  const auto rig = support::rig("paper_rig_fdva");
  const std::vector<double> zero(100, 0.0);
  const Recording recording = recording_of({{Channel::z_r, zero}, {Channel::F_w, zero}});
  const SimulationInput input = simulation_input(rig.rig, recording);
  EXPECT_EQ(host_sim::estimated_start(rig.rig, input, recording), host_sim::resting(rig.rig, input));
  EXPECT_TRUE(host_sim::begins_at_rest(rig.rig, input, recording));
}

// Law. A machine that has not settled on its command when the recording begins comes to it as its lag lets it,
// x_act − x_cmd = a e^(−t/T); the state at the start is found from x_act, and at rest is none.
TEST(Simulation, FindsWhereAMachineBegins) {
  auto bench = parse_rig(support::bench_text, "RIG.toml");
  constexpr double lag = 0.2, away = -2e-3;
  bench.rig.effects.add(model::ActuatorLag<double>{lag});
  Recording recording =
      recording_of({{Channel::x_cmd, std::vector<double>(1000, 2e-3)}, {Channel::x_act, std::vector<double>(1000)}});
  for (std::size_t k = 0; k < 1000; ++k) {
    recording[Channel::x_act][k] = 2e-3 + away * std::exp(-1e-3 * static_cast<double>(k) / lag);
  }
  const SimulationInput input = simulation_input(bench.rig, recording);
  EXPECT_EQ(host_sim::free_states(bench.rig, input, recording), std::vector{0});
  EXPECT_FALSE(host_sim::begins_at_rest(bench.rig, input, recording));
  const InitialState start = host_sim::estimated_start(bench.rig, input, recording);
  const Response response = simulate(bench.rig, input, start);
  // The command comes to its value within the first step, h/2 too late: a h/(2 T) at most.
  for (std::size_t k = 0; k < 1000; ++k) {
    ASSERT_NEAR(response[index(Channel::x_act)][k], recording[Channel::x_act][k], 2e-3 * 1e-3 / (2.0 * lag)) << k;
  }
  recording[Channel::x_act].clear();
  EXPECT_TRUE(host_sim::free_states(bench.rig, input, recording).empty()) << "nothing tells it";
}

}  // namespace
