// A low-pass whose states are the derivatives of its output.
#pragma once

#include "model/numerics/exact_discretisation.hpp"

namespace firmware::compensation {

/// Butterworth low-pass of fourth order; its states are the filtered signal y and its first three derivatives:
///
///   (1)  y⁗ = ω⁴ (u − y) − c ω³ ẏ − (2 + √2) ω² ÿ − c ω y⃛,   c = √(4 + 2√2)
///
/// Exact for an input that goes straight from sample to sample. Two signals that pass the same filter keep every linear
/// relation between them, so no derivative has to be taken of a noisy sample.
class SignalFilter {
 public:
  static constexpr int derivatives = 4;
  using Output = model::Column<double, derivatives>;  ///< y, ẏ, ÿ, y⃛
  struct State {
    Output output = Output::Zero();
    double input = 0.0;
  };

  SignalFilter(double omega, double period);

  void start(State& x, double at) const {
    x.output = Output::Zero();
    x.output(0) = x.input = at;
  }
  void step(State& x, double input) const;
  /// y⁗ by (1).
  [[nodiscard]] double fourth_derivative(const State& x) const {
    double sum = highest_(0) * (x.output(0) - x.input);
    for (int i = 1; i < derivatives; ++i) sum += highest_(i) * x.output(i);
    return sum;
  }

 private:
  Output highest_;  ///< row of y⁗ in (1)
  model::Block<double, derivatives, derivatives> transition_;
  model::Block<double, derivatives, 2> input_;
};

}  // namespace firmware::compensation
