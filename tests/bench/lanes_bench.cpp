// Time of a simulation in lanes against the same simulation alone, per rig.
//
//   lanes/…/alone      the time of one rig over ten seconds at 1 kHz, one after the other, with the channels that a rig
//                      records
//   lanes/…/beside     the same with as many rigs side by side as the processor takes; at most alone / 2.5
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host_sim/comparison/side_by_side.hpp"

namespace {

using host_sim::LaneUse;
using model::Channel;
using model::RigKind;
using Parameters = model::RigParameters<double>;

constexpr std::size_t rigs_at_once = 8;

Parameters rig_of(RigKind kind, bool with_fdva) {
  Parameters rig;
  rig.kind = kind;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, with_fdva ? 0.0 : 1140.0};
  if (kind == RigKind::hil) {
    rig.machine.virtual_damping = 1140.0;
    rig.effects.add(model::ActuatorDelay<double>{0.0103});
  }
  rig.has_fdva = with_fdva;
  if (with_fdva) rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

host_sim::SimulationInput shaken() {
  host_sim::SimulationInput input;
  input.period = 1e-3;
  for (std::size_t k = 0; k < 10'000; ++k) {
    const double t = static_cast<double>(k) * input.period;
    input.motion.push_back({0.01 * std::sin(9.0 * t) + 1e-3 * std::sin(70.0 * t),
                            0.09 * std::cos(9.0 * t) + 0.07 * std::cos(70.0 * t), -0.81 * std::sin(9.0 * t)});
  }
  return input;
}

void simulate(benchmark::State& state, const Parameters& first, LaneUse use) {
  const host_sim::SimulationInput input = shaken();
  std::vector<Parameters> rigs(rigs_at_once, first);
  for (std::size_t i = 0; i < rigs.size(); ++i) rigs[i].suspension.stiffness += 10.0 * static_cast<double>(i);
  const host_sim::InitialState start = host_sim::resting(first, input);
  std::vector<host_sim::SideBySideRig> all;
  for (const Parameters& rig : rigs) all.push_back({&rig, &start, &input});
  const std::vector<Channel> channels = first.kind == RigKind::quarter_car
                                            ? std::vector{Channel::zdd_w, Channel::zdd_b, Channel::dz_b, Channel::F_w}
                                            : std::vector{Channel::x_cmd, Channel::x_act, Channel::F};
  for (auto _ : state) {
    auto responses = host_sim::simulate_side_by_side(all, 0, 1, channels, use);
    benchmark::DoNotOptimize(responses);
  }
  state.counters["per_rig"] = benchmark::Counter(
      static_cast<double>(rigs_at_once), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void measure(const std::string& name, const Parameters& rig) {
  const auto least = [](const std::vector<double>& times) { return *std::min_element(times.begin(), times.end()); };
  const auto add = [&](const std::string& how, LaneUse use) {
    benchmark::RegisterBenchmark(("lanes/" + name + how).c_str(),
                                 [rig, use](benchmark::State& state) { simulate(state, rig, use); })
        ->Unit(benchmark::kMillisecond)
        ->ComputeStatistics("min", least);
  };
  add("/alone", LaneUse::one);
  add("/beside", LaneUse::automatic);
  if (host_sim::has_lanes(LaneUse::four)) add("/beside_four", LaneUse::four);
}

const bool registered = [] {
  measure("quarter_car", rig_of(RigKind::quarter_car, false));
  measure("quarter_car_fdva", rig_of(RigKind::quarter_car, true));
  measure("hil_fdva", rig_of(RigKind::hil, true));
  Parameters friction = rig_of(RigKind::quarter_car, false);
  friction.effects.add(model::CoulombFriction<double>{20.0});
  measure("friction", friction);
  Parameters stop = rig_of(RigKind::quarter_car, false);
  stop.effects.add(model::BumpStop<double>{5e-3, 1e5});
  measure("stop", stop);
  Parameters law = rig_of(RigKind::quarter_car, false);
  model::CurveTable<double>& damper = law.laws.curves[law.laws.curve_count++];
  damper.count = model::curve_points;
  for (std::size_t i = 0; i < damper.count; ++i) {
    damper.at[i] = 0.05 * (static_cast<double>(i) - 16.0);
    damper.value[i] = 600.0 * std::tanh(3.0 * damper.at[i]);
  }
  measure("law", law);
  return true;
}();

}  // namespace
