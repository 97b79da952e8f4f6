// Feedback of the tracking error: a Kalman filter and a linear quadratic regulator.
#pragma once

#include "firmware/loop/compensation/settings.hpp"
#include "model/numerics/exact_discretisation.hpp"

namespace firmware::compensation {

/// The machine as the truncated inverse describes it, around the wanted motion: deviation ξ = x_m − x, feedback u, and
/// an unknown constant d at the command that stands for everything the model lacks:
///
///   (1)  a₂ ξ̈ + a₁ ξ̇ + a₀ ξ = u + d,   ḋ = w,   y = ξ + v
///   (2)  Kalman filter of (ξ, ξ̇, d), steady: w has (2π f_b a₀)² times the density of v, ξ̇ a little of its own
///   (3)  u = −K (ξ̂, ξ̂˙) − d̂,  K minimises Σ ξ² + u²
///
/// f_b is the bandwidth of d̂: far below 1/(2π a₁), since the model has no delay. Both Riccati equations are iterated a
/// fixed number of times at construction. State: ξ̂, ξ̂˙, d̂ before the sample of this instant.
/// Source: Phillips and Spencer, Model-based feedforward-feedback actuator control for real-time hybrid simulation,
/// J. Struct. Eng. 2013.
class TrackingFeedback {
 public:
  enum Index : int { deviation, rate, disturbance };
  static constexpr int states = 3;
  using State = model::Column<double, states>;

  TrackingFeedback(const Coefficients& inverse, double bandwidth, double period);

  void start(State& x) const { x.setZero(); }
  /// ξ measured at t_k [m]; the feedback u of t_{k+1} [m].
  [[nodiscard]] double next(State& x, double measured) const;

 private:
  using Matrix = model::Block<double, states, states>;

  State observer_ = State::Zero();   ///< Kalman gain
  State regulator_ = State::Zero();  ///< K, and 1 for d
  Matrix transition_ = Matrix::Zero();
  State input_ = State::Zero();
};

}  // namespace firmware::compensation
