// The loop as the controller runs it: in steps, with a ring buffer and a held force.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/stability/polynomial.hpp"
#include "model/rig_parameters.hpp"

namespace host_sim::stability {

/// One period of model::RigModel::step as a matrix: its columns are the step at unit vectors of the whole state – car,
/// component, machine, received force and every sample in the delay line that is still to be read. States that the
/// force does not reach or that do not reach the force – of effects that are not there, of a locked piston – stand
/// still or die away for themselves and are left out.
struct StepMatrix {
  Eigen::MatrixXd matrix;
  std::size_t own = 0;   ///< states before those of the line
  std::size_t line = 0;  ///< samples of the line, two states (position, velocity) each, newest first
};

/// `rig` must be linear (linear_part); `delay` replaces that of its machine [s]. The matrix is held against the model:
/// both are run from the same mid-motion state, and a difference is a std::logic_error.
/// Throws UnfitLoop when the delay exceeds the capacity of the model's line.
[[nodiscard]] StepMatrix step_matrix(const model::RigParameters<double>& rig, double period, double delay);

/// Verdict on the sampled loop.
struct SampledLoop {
  double period{};                       ///< T [s]
  std::size_t states{};                  ///< of the whole step
  std::vector<Complex> eigenvalues;      ///< Im ≥ 0, largest modulus first
  double spectral_radius{};              ///< stable below 1
  std::optional<double> critical_delay;  ///< of machine and budget, beside what sampling adds [s]; none: see below
  std::optional<double> added_delay;     ///< continuous critical delay − that of the sampled loop [s], about T/2

  [[nodiscard]] bool stable() const { return spectral_radius < 1.0; }
};

/// \param rig              linear rig
/// \param delay            of the machine path [s]
/// \param critical         critical delay of the continuous loop [s] and its frequency [rad/s], if any, from which that
///                         of the sampled loop is sought; it has none where no delay ≥ 0 within the line's capacity
///                         puts the largest eigenvalue on the unit circle.
struct ContinuousBorder {
  double delay{}, omega{};
};
[[nodiscard]] SampledLoop sampled_loop(const model::RigParameters<double>& rig, double period, double delay,
                                       const std::optional<ContinuousBorder>& critical);

}  // namespace host_sim::stability
