// The interface of the sources that are compiled for one kind of processor: plain memory only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "model/components/channel.hpp"
#include "model/components/fdva.hpp"
#include "model/components/stroke_acceleration.hpp"
#include "model/components/subsystems.hpp"
#include "model/laws/law_tables.hpp"
#include "model/numerics/motion.hpp"
#include "model/numerics/select.hpp"

namespace host_sim {

/// Place in InitialState of how far the machine of a component_bench is from where it would have settled.
inline constexpr int bench_machine_state = 0;

/// true: a lag, a resonance or a rate limit, so that where the machine begins acts on what follows.
template <class S>
[[nodiscard]] bool remembers(const model::MachinePath<S>& machine) {
  using model::same;
  return same(machine.lag + machine.resonance_frequency + machine.rate_limit > S(0));
}

/// true: a machine moves the foot point of a quarter car.
template <class S>
[[nodiscard]] bool moves_foot_point(model::RigKind kind, const model::MachinePath<S>& machine) {
  using model::same;
  return kind == model::RigKind::quarter_car && (remembers(machine) || same(machine.delay > S(0)));
}

/// What belongs to the samples and not to the steps between them.
template <class S>
struct SampledValues {
  S force;                                    ///< F that enters the car of a hil rig, held for a sample
  model::Stroke<S> reached;                   ///< of a machine
  model::StrokeAcceleration<S> acceleration;  ///< of it

  /// Behind the last step of a sample: z̈_r is that of the strokes at the samples. Where a machine at its limit turns,
  /// the velocity jumps, and the acceleration of a shorter step would be larger as it is shorter.
  template <class State>
  void move_foot_point(State& x, S period) const {
    x.acceleration = acceleration;
    x.acceleration.step(reached, x.reached, period);
    x.foot_point.acceleration = x.acceleration.value();
  }
};

/// The laws of a rig. Of a table counts here what it is, not its numbers.
struct LaneLaws {
  const model::CurveTable<double>* curves;
  const model::SurfaceTable<double>* surfaces;
  const model::BranchNumbers<double>* branches;
  std::uint8_t curve_count, surface_count, branch_count;
};

/// Some rigs that are alike(), one a lane; fewer rigs than lanes: the last ones repeat.
struct LaneSimulation {
  model::RigKind kind;
  bool has_fdva;
  int ducts, open_ducts;
  std::uint64_t active;      ///< bit i: effect i of model::RigEffects
  double period;             ///< of the samples [s]
  int substeps;              ///< model steps per sample
  std::size_t samples;       ///< ≥ 1
  std::size_t every;         ///< samples after which the numbers change; 0: never
  std::size_t number_count;  ///< of a rig
  LaneLaws laws;             ///< of each rig
  /// Of each lane: those of model::for_each_number and for_each_law_number; of every change of them, one behind the
  /// other.
  const double* const* numbers;
  const double* const* start;                  ///< of each lane: InitialState
  const model::Motion<double>* const* motion;  ///< of each lane
  bool one_motion;                             ///< the same for all lanes
  const double* actuator_force;                ///< [N]; nullptr: none
  const model::OpenDucts* opened;              ///< in force from each sample on; nullptr: as in the rig
  std::size_t channel_count;
  const model::Channel* channels;
  double* const* out;  ///< of lane l and channel c: out[l · channel_count + c], nullptr where the lane repeats another
};

/// AVX2, four rigs; AVX-512, eight. Only where has_lanes() says so.
void simulate_four(const LaneSimulation& simulation);
void simulate_eight(const LaneSimulation& simulation);

}  // namespace host_sim
