// The linear part of a hil rig, from the model's own equations.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/stability/roots/delay_equation.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::stability {

/// ẋ = A x + B u, y = C x + D u
struct StateSpace {
  Eigen::MatrixXd a, b, c, d;
};

/// The system without states that are structurally not controllable or not observable (by zero entries): a locked
/// piston, the state of an inactive effect.
[[nodiscard]] StateSpace without_idle_states(const StateSpace& system);

/// Which states are reached from those of `start` along the entries of `links` (j reaches i where links(i, j) ≠ 0).
[[nodiscard]] std::vector<bool> reached(const Eigen::MatrixXd& links, std::vector<bool> start);

/// Transfer functions numerator(i, k)/denominator from input k to output i.
class TransferMatrix {
 public:
  TransferMatrix() = default;
  explicit TransferMatrix(const StateSpace& system);  ///< for few states: expands determinants

  [[nodiscard]] const Polynomial& denominator() const { return denominator_; }
  [[nodiscard]] const Polynomial& numerator(std::size_t output, std::size_t input) const {
    return numerators_[output * inputs_ + input];
  }

 private:
  Polynomial denominator_{1.0};
  std::vector<Polynomial> numerators_;
  std::size_t inputs_ = 0;
};

/// A hil rig as one loop:  F_s → car → x_cmd → machine → x_act → component → F → force sensor → F_s
///
///   (1)  car        ẋ = A x + B F_s + B_r [z_r, ż_r],   x_cmd = i (z_w − z_b)
///   (2)  machine    x_act = M(s) e^{−s τ_m} x_cmd
///   (3)  component  F     = K(s) x_act
///   (4)  sensor     F_s   = S(s) e^{−s τ_s} F            delays of sensor and delay budget
///
/// A, B, K … are the right-hand side of model::RigEquations, evaluated at unit vectors. The delays of the loop commute
/// with its linear parts, so stability depends on their sum τ only:
///
///   (5)  1 − G(s) e^{−sτ} = 0,  G = S K M · x_cmd/F_s    ⇔    P + Q e^{−sτ} = 0
struct LinearRig {
  StateSpace car;                          ///< inputs F_s, z_r, ż_r; outputs z_w, z_b, F_w
  double lever_ratio = 1.0;                ///< i(0): x_cmd = i(0) (z_w − z_b); its square is in the car's B
  std::optional<Eigen::Index> area_force;  ///< state of the car: the skyhook's part of F
  TransferMatrix machine, component, force_sensor;
  double machine_delay{};                 ///< τ_m [s]
  double sensor_delay{};                  ///< τ_s [s], effects only
  Polynomial p, q;                        ///< of (5)
  std::vector<std::string> left_out;      ///< effects and parameters without a linear part
  std::vector<std::string> outside_loop;  ///< active effects that do not act on the loop

  [[nodiscard]] double delay() const { return machine_delay + sensor_delay; }
  [[nodiscard]] DelayEquation equation(double delay) const { return {p, q, delay}; }
  /// Numerator and denominator of M: x_act/x_cmd without its delay.
  [[nodiscard]] std::array<Polynomial, 2> machine_response() const;
  /// Numerator and denominator of K: F/x_act.
  [[nodiscard]] std::array<Polynomial, 2> component_response() const;
};

/// Throws UnfitLoop for another kind of rig than hil.
[[nodiscard]] LinearRig linearise(const model::RigParameters<double>& rig);

/// The rig without minor losses and without the effects whose card says that they have no linear part. Its step is
/// linear. Laws from tables are the parameters that they are at rest: the slope of a curve at 0, an elastic slider that
/// sticks, a Maxwell branch as the effect relaxation, a sensor's curve as a gain.
[[nodiscard]] model::RigParameters<double> linear_part(const model::RigParameters<double>& rig);

/// The same for a sampled loop, whose matrix comes from steps: a lever, and an air spring whose area follows a skyhook,
/// stay what they are (without levelling), so that their slopes at rest are those of the model's own step.
[[nodiscard]] model::RigParameters<double> sampled_part(const model::RigParameters<double>& rig);

}  // namespace host_sim::stability
