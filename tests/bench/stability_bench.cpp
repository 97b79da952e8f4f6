// What a point of a stability map costs, and a whole one.
//
//   stability/point   a 200 × 200 map over delay and virtual damping on one processor, time per point (item): rightmost
//                     root exact to 1e-9 and proven; at most 0.1 ms
//   stability/map     the same map with its border on all processors
//   stability/point_effects  the point of a rig with every linear effect, over delay and virtual damping
//   stability/point_parameters  over two parameters that change the polynomials at each point
#include <benchmark/benchmark.h>

#include "host_sim/stability/map/stability_map.hpp"

namespace {

using host_sim::stability::Axis;
using host_sim::stability::LoopFamily;
using host_sim::stability::stability_map;

model::RigParameters<double> fdva_rig() {
  model::RigParameters<double> rig;
  rig.kind = model::RigKind::hil;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, 0.0};
  rig.machine.virtual_damping = 1140.0;
  rig.effects.add(model::ActuatorDelay<double>{0.010});
  rig.has_fdva = true;
  rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

model::RigParameters<double> rig_with_effects() {
  auto rig = fdva_rig();
  rig.effects.add(model::ActuatorLag<double>{0.001});
  rig.effects.add(model::ActuatorResonance<double>{60.0, 0.7});
  rig.effects.add(model::Relaxation<double>{5e3, 0.02});
  rig.effects.add(model::Channel::F, model::SensorLag<double>{0.0005});
  return rig;
}

const Axis delay{"tau", 0.0, 0.03, 200}, damping{"virtual_damping", 0.0, 2000.0, 200};

void run(benchmark::State& state, const model::RigParameters<double>& rig, const Axis& x, const Axis& y,
         unsigned threads) {
  const LoopFamily family(rig, 0.0);
  std::size_t searches = 0;
  for (auto _ : state) {
    const auto map = stability_map(family, x, y, threads);
    benchmark::DoNotOptimize(map.rightmost.data());
    searches = map.searches;
  }
  const double points = static_cast<double>(x.count * y.count);
  state.counters["per_point"] =
      benchmark::Counter(points, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["searches"] = static_cast<double>(searches);
}

void point(benchmark::State& state) { run(state, fdva_rig(), delay, damping, 1); }
void map(benchmark::State& state) { run(state, fdva_rig(), delay, damping, 0); }
void point_effects(benchmark::State& state) { run(state, rig_with_effects(), delay, damping, 1); }
void point_parameters(benchmark::State& state) {
  run(state, fdva_rig(), {"suspension.stiffness", 1e4, 1e5, 100}, {"fdva.coupling_stiffness", 2e4, 9e4, 100}, 1);
}

BENCHMARK(point)->Name("stability/point")->Unit(benchmark::kMillisecond);
BENCHMARK(map)->Name("stability/map")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(point_effects)->Name("stability/point_effects")->Unit(benchmark::kMillisecond);
BENCHMARK(point_parameters)->Name("stability/point_parameters")->Unit(benchmark::kMillisecond);

}  // namespace
