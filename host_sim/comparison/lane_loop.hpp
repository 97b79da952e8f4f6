// The loop of simulate() with several rigs side by side; compiled once for each kind of processor.
//
// No function of the standard library or of another room that other sources use, too, may be called out of line here:
// the linker keeps one copy of an inline function, and that would be the one for this processor. So nothing here holds
// a container, and every type depends on the number of lanes.
#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <type_traits>

#include "host_sim/comparison/lane_simulation.hpp"
#include "model/numerics/lane_delay_line.hpp"
#include "model/numerics/lanes.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim {

template <std::size_t N, model::LawCapacity capacity>
class LaneLoop {
 public:
  using S = model::Lanes<N>;
  using Rig = model::RigModel<S, model::usual_delay_capacity, model::ModelVariant::every_part, capacity>;

  explicit LaneLoop(const LaneSimulation& simulation) : job_(simulation), model_(parameters(0), step_period()) {}

  void run() {
    typename Rig::State x = start();
    typename Rig::Input in;
    model::MachinePath<S> machine{};
    model_.parameters().effects.act_on(machine);
    const bool foot_machine = moves_foot_point(job_.kind, machine);
    for (std::size_t k = 0;; ++k) {
      keep(k, model_.measured(x));
      if (k + 1 == job_.samples) return;
      if (k > 0 && job_.every > 0 && k % job_.every == 0) become(k / job_.every);
      if (job_.opened != nullptr && job_.opened[k] != x.ducts.open()) model_.open_ducts(x, job_.opened[k]);
      const S force = job_.actuator_force == nullptr ? S(0.0) : S(job_.actuator_force[k + 1]);
      const SampledValues<S> sampled{x.received_force, x.reached, x.acceleration};
      for (int substep = 1; substep < job_.substeps; ++substep) {
        const double share = static_cast<double>(substep) / job_.substeps;
        take(in, motion(k, share));
        in.actuator_force = x.actuator_force + (force - x.actuator_force) / S(job_.substeps - substep + 1);
        model_.step(x, in);
        x.received_force = sampled.force;
      }
      take(in, motion(k + 1));
      in.actuator_force = force;
      model_.step(x, in);
      if (foot_machine && job_.substeps > 1) sampled.move_foot_point(x, S(job_.period));
    }
  }

 private:
  using Motion = model::Motion<S>;

  [[nodiscard]] S step_period() const { return S(job_.period / job_.substeps); }

  /// The rigs with their numbers after `changes`; in place, as a second model is too much for a stack.
  void become(std::size_t changes) {
    static_assert(std::is_trivially_destructible_v<Rig>, "nothing is lost");
    new (&model_) Rig(parameters(changes), step_period());
  }

  [[nodiscard]] typename Rig::Rig parameters(std::size_t changes) const {
    typename Rig::Rig rig;
    rig.kind = job_.kind;
    rig.has_fdva = job_.has_fdva;
    rig.fdva.ducts = job_.ducts;
    rig.fdva.open_ducts = job_.open_ducts;
    unsigned bit = 0;
    rig.effects.for_each([&](auto& slot) { slot.active = ((job_.active >> bit++) & 1U) != 0U; });
    std::size_t i = changes * job_.number_count;
    const auto take = [&](S& number) {
      number = S::each([&](std::size_t lane) { return job_.numbers[lane][i]; });
      ++i;
    };
    model::for_each_number(rig, take);
    if constexpr (capacity.any()) {
      place_laws(rig.laws);
      model::for_each_law_number(rig.laws, take);
    }
    return rig;
  }

  /// All of them but their numbers.
  void place_laws(model::Laws<S, capacity>& laws) const {
    const LaneLaws& of = job_.laws;
    laws.curve_count = of.curve_count;
    laws.surface_count = of.surface_count;
    laws.branch_count = of.branch_count;
    for (std::size_t i = 0; i < of.curve_count; ++i) {
      laws.curves[i].place = of.curves[i].place;
      laws.curves[i].over = of.curves[i].over;
      laws.curves[i].channel = of.curves[i].channel;
      laws.curves[i].count = of.curves[i].count;
    }
    for (std::size_t i = 0; i < of.surface_count; ++i) {
      laws.surfaces[i].place = of.surfaces[i].place;
      laws.surfaces[i].rows = of.surfaces[i].rows;
      laws.surfaces[i].columns = of.surfaces[i].columns;
    }
    for (std::size_t i = 0; i < of.branch_count; ++i) laws.branches[i].place = of.branches[i].place;
  }

  [[nodiscard]] typename Rig::State start() const {
    model::Column<S, model::plain_core_states> core;
    for (int i = 0; i < model::plain_core_states; ++i) {
      core(i) = S::each([&](std::size_t lane) { return job_.start[lane][i]; });
    }
    const Motion first = motion(0);
    model::MachinePath<S> machine{};
    model_.parameters().effects.act_on(machine);
    model::Stroke<S> reached{core(0) - core(2), core(1) - core(3)};
    if (job_.kind == model::RigKind::component_bench) {
      const S away = remembers(machine) ? core(bench_machine_state) : S(0);
      reached = {first.position + away, first.velocity};
      core(bench_machine_state) = S(0);
    }
    reached.position -= reached.velocity * machine.delay;
    typename Rig::State x = model_.start(core, first, reached);
    if (job_.actuator_force != nullptr) x.actuator_force = S(job_.actuator_force[0]);
    return x;
  }

  [[nodiscard]] Motion motion(std::size_t k) const {
    if (job_.one_motion) {
      const auto& m = job_.motion[0][k];
      return {S(m.position), S(m.velocity), S(m.acceleration)};
    }
    return {S::each([&](std::size_t lane) { return job_.motion[lane][k].position; }),
            S::each([&](std::size_t lane) { return job_.motion[lane][k].velocity; }),
            S::each([&](std::size_t lane) { return job_.motion[lane][k].acceleration; })};
  }

  /// As between_samples().
  [[nodiscard]] Motion motion(std::size_t k, double share) const {
    const Motion from = motion(k), to = motion(k + 1);
    const auto inside =
        model::hermite<S>({from.position, from.velocity}, {to.position, to.velocity}, S(share), S(job_.period));
    return {inside.position, inside.velocity, from.acceleration + S(share) * (to.acceleration - from.acceleration)};
  }

  static void take(typename Rig::Input& in, const Motion& motion) {
    in.foot_point = motion;
    in.command = {motion.position, motion.velocity};
  }

  /// N samples are turned together into pieces of channels: number by number would cost as much as the step.
  void keep(std::size_t k, const model::Signals<S>& measured) {
    const std::size_t row = k % N;
    for (std::size_t c = 0; c < job_.channel_count; ++c) {
      kept_[c][row] = measured[static_cast<std::size_t>(job_.channels[c])];
    }
    if (row + 1 != N && k + 1 != job_.samples) return;
    const std::size_t first = k - row;
    for (std::size_t c = 0; c < job_.channel_count; ++c) {
      model::transpose(kept_[c]);
      for (std::size_t lane = 0; lane < N; ++lane) {
        double* const out = job_.out[lane * job_.channel_count + c];
        if (out == nullptr) continue;
        if (row + 1 == N) {
          __builtin_memcpy(out + first, &kept_[c][lane], sizeof(S));
        } else {
          for (std::size_t i = 0; i <= row; ++i) out[first + i] = kept_[c][lane][i];
        }
      }
    }
  }

  const LaneSimulation& job_;
  Rig model_;
  std::array<std::array<S, N>, model::channel_count> kept_{};
};

template <std::size_t N, model::LawCapacity capacity>
void run_lanes_with(const LaneSimulation& simulation) {
  auto* const loop = new LaneLoop<N, capacity>(simulation);  // half a megabyte: too much for a stack
  loop->run();
  delete loop;
}

template <std::size_t N>
void run_lanes(const LaneSimulation& simulation) {
  const LaneLaws& laws = simulation.laws;
  if (laws.curve_count + laws.surface_count + laws.branch_count > 0) {
    return run_lanes_with<N, model::law_capacity<model::Lanes<N>>>(simulation);
  }
  run_lanes_with<N, model::no_laws>(simulation);
}

}  // namespace host_sim
