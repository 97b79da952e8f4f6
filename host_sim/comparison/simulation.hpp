// Simulation of a recording's own input.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim {

/// The input of a simulation, taken from a recording once and used for every simulation of it.
///
///   quarter_car          commanded foot point z_cmd; foot point z_r where there is no z_cmd, the machine is then left
///   out
///                        of the model; F_act where recorded
///   hil                  foot point z_r
///   component_bench      command x_cmd; x_act where there is no x_cmd, the machine is then left out of the model
///   driven_mass          force F
///
/// Between samples z_r and x move on cubic Hermite polynomials whose velocities are differences of fourth order, of a
/// measured x_act of eighth (measured_motion.hpp). z̈_r,
/// which only sensors with inertia see, is the recorded zdd_r; without it second differences of z_r, which multiply the
/// noise of z_r by 2.7/h².
///
/// A component_bench with a skyhook is the hardware of a hil rig: the area of its air spring was commanded by the body
/// velocity of the virtual car, the fourth-order difference of the recorded z_b. Without z_b the area stays at rest.
struct SimulationInput {
  double period = 0.0;                           ///< [s]
  firmware::FootPointMotion motion;              ///< foot point or command; of a driven_mass F [N] and its rate
  std::vector<double> actuator_force;            ///< F_act [N]; empty: none
  std::vector<double> area;                      ///< u_c of an air spring, held from each sample on; empty: see below
  std::vector<model::OpenDucts> ducts;           ///< in force from each sample on; empty: as in the rig description
  bool deflection_reached = false;               ///< motion is x_act, or z_r of a quarter car: the machine is left out
  bool wheel_prescribed = false;                 ///< motion is the wheel's; what is below it is not simulated
  model::Channel channel = model::Channel::z_r;  ///< that the motion comes from

  [[nodiscard]] std::size_t size() const { return motion.size(); }
  [[nodiscard]] bool is_force() const { return channel == model::Channel::F; }
};

/// [m] How far a rig moves in a recording, for differences and bounds of its state: the largest displacement of the
/// input; of a driven_mass that of x_act or, where only z̈_b is measured, the static deflection under the largest force.
[[nodiscard]] double size_of_motion(const model::RigParameters<double>& rig, const SimulationInput& input,
                                    const firmware::Recording& recording);

/// InputError when the recording does not hold the input of this kind of rig.
[[nodiscard]] SimulationInput simulation_input(const model::RigParameters<double>& rig,
                                               const firmware::Recording& recording);

/// The channels that the model computes: all of this kind of rig except its input. On a prescribed wheel z_b, z̈_b, dz_b
/// and F_w.
[[nodiscard]] std::vector<model::Channel> response_channels(model::RigKind kind, const SimulationInput& input);

/// z_w, ż_w, z_b, ż_b, y, ẏ. A component_bench has no car: there z_w's place holds how far a machine with a lag, a
/// resonance or a rate limit is from where it would have settled on its command [m].
using InitialState = model::Column<double, 6>;

/// At rest above the first sample of the input; on a prescribed wheel moving with it.
[[nodiscard]] InitialState resting(const model::RigParameters<double>& rig, const SimulationInput& input);

/// Simulated channels, by model::Channel; those that the rig does not have stay empty. `samples`: how many, 0 for all.
/// `substeps`: model steps per sample. Between samples the input is interpolated as the model does it. With several
/// substeps a law with a corner (friction, a stop) acts near its own instant and not at the next sample. The loop of a
/// hil rig stays the sampled one: the force that enters the car is that of the sample, for all of its substeps.
using Response = std::array<std::vector<double>, model::channel_count>;

/// A rig whose parameters change while it moves: from every `every`-th sample on it is `at` that sample.
struct RigVariation {
  std::size_t every = 0;  ///< 0: it does not change
  std::function<model::RigParameters<double>(std::size_t sample)> at{};
};

[[nodiscard]] Response simulate(const model::RigParameters<double>& rig, const SimulationInput& input,
                                const InitialState& start, std::size_t samples = 0, int substeps = 1,
                                const RigVariation& variation = {});
/// The same of a choice of response_channels().
[[nodiscard]] Response simulate(const model::RigParameters<double>& rig, const SimulationInput& input,
                                const InitialState& start, std::size_t samples, int substeps,
                                const std::vector<model::Channel>& channels, const RigVariation& variation = {});

/// The motion through samples that drive a rig: of a measured deflection that of measured_motion.hpp, which may be near
/// a resonance of the bench.
[[nodiscard]] firmware::FootPointMotion motion_between(bool deflection_reached, const std::vector<double>& samples,
                                                       double rate);

/// The force of what moves between load cell and component, on a measured deflection:
///
///   (1)  F += m ẍ_act       ẍ_act: of the samples before and behind (measured_motion.hpp)
///
/// simulate() has it; answering() leaves it out. F without its sensor.
void add_load_cell(const model::RigParameters<double>& rig, const SimulationInput& input, const RigVariation& variation,
                   Response& response);

/// The rig that answers to an input: without its machine and its load cell where the deflection is known, with a wheel
/// that follows where its motion is prescribed.
[[nodiscard]] model::RigParameters<double> answering(const model::RigParameters<double>& rig,
                                                     const SimulationInput& input);

/// Between two samples, where the model has it (model::hermite); its z̈ is the measured one, straight between.
[[nodiscard]] inline model::Motion<double> between_samples(const model::Motion<double>& from,
                                                           const model::Motion<double>& to, double share,
                                                           double period) {
  const auto [position, velocity] =
      model::hermite<double>({from.position, from.velocity}, {to.position, to.velocity}, share, period);
  return {position, velocity, from.acceleration + share * (to.acceleration - from.acceleration)};
}

}  // namespace host_sim
