// The sampled loop as the controller runs it: discrete steps, delay line, held force.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "host_sim/stability/roots/polynomial.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::stability {

/// One period of model::RigModel::step as a matrix. Its columns are the step at unit vectors of the whole state (with a
/// lever or an air spring: its slopes at rest, by central differences): car, component, machine, received force and
/// every sample of the delay line that will still be read. States without a path from or to the force (inactive
/// effects, a locked piston) are left out.
struct StepMatrix {
  Eigen::MatrixXd matrix;
  std::size_t own = 0;    ///< states before those of the line
  std::size_t line = 0;   ///< samples of the line, two states (position, velocity) each, newest first
  std::size_t force = 0;  ///< the state that is the received force
};

/// `rig` must be linear (sampled_part); `delay` replaces that of its machine [s]. The matrix is checked against the
/// model: both run from the same state in motion, and a difference is a std::logic_error.
/// Throws UnfitLoop when the delay exceeds the capacity of the model's line.
[[nodiscard]] StepMatrix step_matrix(const model::RigParameters<double>& rig, double period, double delay);

/// Largest modulus of its eigenvalues.
[[nodiscard]] double spectral_radius(const StepMatrix& step);

/// L(e^{jωT}) of the loop cut at the received force: 1 + L = det(z − A)/det(z − A₀), A₀ without the column of the
/// force.
class LoopResponse {
 public:
  LoopResponse(StepMatrix step, double period);
  [[nodiscard]] Complex operator()(double omega) const;

 private:
  StepMatrix closed_, open_;
  double period_;
};

/// The value of a parameter at which the eigenvalue next to `lambda` reaches the unit circle, by the secant method from
/// `start` and `start` + `beside`, within `lowest` … `highest`; `lambda` becomes that eigenvalue. `step_at`: the matrix
/// at a value.
[[nodiscard]] std::optional<double> value_on_circle(const std::function<StepMatrix(double)>& step_at, double start,
                                                    double beside, double period, Complex& lambda, double lowest = 0.0,
                                                    double highest = 1e5);

/// Verdict on the sampled loop.
struct SampledLoop {
  double period{};                       ///< T [s]
  std::size_t states{};                  ///< of the whole step
  std::vector<Complex> eigenvalues;      ///< Im ≥ 0, largest modulus first
  double spectral_radius{};              ///< stable below 1
  std::optional<double> critical_delay;  ///< of machine and budget, without the delay of sampling [s]; none: see below
  std::optional<double> added_delay;     ///< continuous critical delay − that of the sampled loop [s], about T/2

  [[nodiscard]] bool stable() const { return spectral_radius < 1.0; }
};

/// `rig` must be linear, `delay` [s] is that of its machine. `critical` holds critical delay [s] and frequency [rad/s]
/// of the continuous loop: the start values of the search for the critical delay of the sampled loop. The sampled loop
/// has none if no delay ≥ 0 within the capacity of the delay line puts the largest eigenvalue on the unit circle.
struct ContinuousBorder {
  double delay{}, omega{};
};
[[nodiscard]] SampledLoop sampled_loop(const model::RigParameters<double>& rig, double period, double delay,
                                       const std::optional<ContinuousBorder>& critical);

/// The delay near that border at which an eigenvalue of the sampled loop reaches the unit circle [s].
[[nodiscard]] std::optional<double> sampled_border(const model::RigParameters<double>& rig, double period,
                                                   const ContinuousBorder& border);

}  // namespace host_sim::stability
