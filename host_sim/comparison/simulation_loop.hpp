// The loop of a simulation over the samples of its input: one model, its state, one sample after the other.
#pragma once

#include <cstddef>
#include <optional>
#include <type_traits>

#include "host_sim/comparison/lane_simulation.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim {

/// The model of rigs without laws and extensions, which is the faster one.
using PlainModel =
    model::RigModel<double, model::usual_delay_capacity, model::ModelVariant::every_part, model::no_laws>;

/// Steps a model through an input. simulate() runs it over a whole recording, CarriedSimulation block by block.
template <class Model>
class SimulationLoop {
 public:
  using Rig = model::RigParameters<double>;

  explicit SimulationLoop(int substeps) : substeps_(substeps) {}

  /// From now on this rig, which is answering() to the input; the state stays. `period` of the samples [s].
  void become(const Rig& answers, double period) {
    if constexpr (std::is_same_v<typename Model::Rig, Rig>) {
      model_.emplace(answers, period / substeps_);
    } else {
      model_.emplace(model::without_laws(answers), period / substeps_);
    }
  }

  /// Begins at the first sample of the input.
  void start(const SimulationInput& input, const InitialState& start) {
    const auto& first = input.motion.front();
    model::MachinePath<double> machine{};
    model_->parameters().effects.act_on(machine);
    InitialState core = start;
    model::Stroke<double> reached{start(0) - start(2), start(1) - start(3)};
    if (model_->parameters().kind == model::RigKind::component_bench) {
      const double away = remembers(machine) ? core(bench_machine_state) : 0.0;
      reached = {first.position + away, first.velocity};
      core(bench_machine_state) = 0.0;
    } else {
      reached = model_->component_stroke(reached);
    }
    reached.position -= reached.velocity * machine.delay;
    foot_machine_ = moves_foot_point(model_->parameters().kind, machine);
    x_ = model_->start(core, first, reached);
    if (!input.actuator_force.empty()) x_.actuator_force = input.actuator_force.front();
  }

  /// The readings at the sample that was reached.
  [[nodiscard]] model::Signals<double> measured() const { return model_->measured(x_); }

  /// From sample k of the input to the next.
  void advance(const SimulationInput& input, std::size_t k) {
    if (!input.ducts.empty() && input.ducts[k] != x_.ducts.open()) model_->open_ducts(x_, input.ducts[k]);
    if (!input.area.empty()) model_->command_area(x_, input.area[k]);
    const auto& next = input.motion[k + 1];
    const double actuator_force = input.actuator_force.empty() ? 0.0 : input.actuator_force[k + 1];
    const SampledValues<double> sampled{x_.received_force, x_.reached, x_.acceleration};
    for (int substep = 1; substep < substeps_; ++substep) {
      const double share = static_cast<double>(substep) / substeps_;
      const model::Motion<double> inside = between_samples(input.motion[k], next, share, input.period);
      model_->step(
          x_, {.foot_point = inside,
               .command = {inside.position, inside.velocity},
               .actuator_force = x_.actuator_force + (actuator_force - x_.actuator_force) / (substeps_ - substep + 1)});
      x_.received_force = sampled.force;
    }
    model_->step(x_, {.foot_point = next, .command = {next.position, next.velocity}, .actuator_force = actuator_force});
    if (foot_machine_ && substeps_ > 1) sampled.move_foot_point(x_, input.period);
  }

 private:
  int substeps_;
  std::optional<Model> model_;
  typename Model::State x_{};
  bool foot_machine_ = false;
};

}  // namespace host_sim
