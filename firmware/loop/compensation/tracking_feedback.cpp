#include "firmware/loop/compensation/tracking_feedback.hpp"

#include "firmware/loop/compensation/arithmetic.hpp"

namespace firmware::compensation {
namespace {

constexpr double shortest = 0.25;  ///< [periods] of a₁: a machine that follows at once still has a second-order model
/// So long both Riccati equations run [1/f_b]: e^{−2π · 4} of the start is left.
constexpr int iterations = 4000;

}  // namespace

TrackingFeedback::TrackingFeedback(const Coefficients& inverse, double bandwidth, double period) {
  if (!(bandwidth > 0.0)) return;
  const double least = shortest * period;
  const double a0 = inverse[0], a1 = inverse[1] > least ? inverse[1] : least;
  const double a2 = inverse[2] > 0.25 * a1 * a1 ? inverse[2] : 0.25 * a1 * a1;
  Matrix a = Matrix::Zero();
  a(deviation, rate) = 1.0;
  a(rate, deviation) = -a0 / a2;
  a(rate, rate) = -a1 / a2;
  a(rate, disturbance) = 1.0 / a2;
  State b = State::Zero();
  b(rate) = 1.0 / a2;
  const model::ExactDiscretisation<double, states> exact(a, period);
  transition_ = exact.transition();
  input_ = exact.held(b);

  const double gain = turn * bandwidth * period * a0;
  Matrix noise = Matrix::Zero();
  noise(disturbance, disturbance) = gain * gain;
  noise(rate, rate) = gain * gain / (a1 * a1);
  Matrix p = Matrix::Identity();
  for (int k = 0; k < iterations; ++k) {  // (2)
    const State column = p.col(deviation);
    observer_ = column / (column(deviation) + 1.0);
    for (int j = 0; j < states; ++j) p.col(j) -= observer_ * column(j);
    p = model::product(transition_, model::product(p, Matrix(transition_.transpose()))) + noise;
    p = (0.5 * (p + p.transpose())).eval();
  }

  using Small = model::Block<double, 2, 2>;
  using Pair = model::Column<double, 2>;
  const Small f = transition_.topLeftCorner<2, 2>();
  const Pair g = input_.head<2>();
  Small s = Small::Identity();
  Pair k = Pair::Zero();
  for (int n = 0; n < iterations; ++n) {  // (3)
    const Pair sg = model::product(s, g);
    const double weight = 1.0 + (g(0) * sg(0) + g(1) * sg(1));
    for (int j = 0; j < 2; ++j) k(j) = (sg(0) * f(0, j) + sg(1) * f(1, j)) / weight;
    Small closed = f;
    for (int j = 0; j < 2; ++j) closed.col(j) -= g * k(j);
    s = model::product(Small(f.transpose()), model::product(s, closed));
    s(deviation, deviation) += 1.0;
    s = (0.5 * (s + s.transpose())).eval();
  }
  regulator_ << k(0), k(1), 1.0;
}

double TrackingFeedback::next(State& x, double measured) const {
  x += observer_ * (measured - x(deviation));
  double u = 0.0;
  for (int i = 0; i < states; ++i) u -= regulator_(i) * x(i);
  State after = input_ * u;
  for (int j = 0; j < states; ++j) after += transition_.col(j) * x(j);
  x = after;
  return u;
}

}  // namespace firmware::compensation
