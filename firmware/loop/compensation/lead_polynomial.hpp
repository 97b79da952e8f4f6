// The wanted deflection a delay ahead, by the polynomial through its past.
#pragma once

#include <array>
#include <cstddef>

#include "model/numerics/delay_line.hpp"

namespace firmware::compensation {

/// Horiuchi's extrapolation over the delay τ by the polynomial of degree n through the points at 0, −τ, … −nτ:
///
///   (1)  u(t) = Σ_i a_i x(t − iτ),  a = (2, −1), (3, −3, 1), (4, −6, 4, −1)
///
/// Its error for a sine of ω is |2 sin ωτ/2|^(n+1). Between samples x moves on the cubic through positions and
/// velocities. τ up to `longest` samples over n.
/// Source: Horiuchi, Inoue, Konno, Namita, Real-time hybrid experimental system with actuator delay compensation, 1999.
class LeadPolynomial {
 public:
  using Stroke = model::Stroke<double>;
  using Line = model::DelayLine<Stroke, 256>;
  static constexpr std::size_t longest = Line::longest;  ///< n τ/h [samples]
  using State = Line;

  LeadPolynomial(int degree, double delay, double period);

  void start(State& x, const Stroke& at) const { x.start(at, 0.0); }
  /// `now`: x, ẋ at the instant of the command.
  [[nodiscard]] Stroke next(State& x, const Stroke& now) const;

  /// Samples of the past that next() reads.
  [[nodiscard]] std::size_t reach() const;

 private:
  std::size_t degree_;
  double period_;
  std::array<model::SampleDelay<double>, 4> ago_{};  ///< i τ
};

}  // namespace firmware::compensation
