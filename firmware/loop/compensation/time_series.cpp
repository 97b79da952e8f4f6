#include "firmware/loop/compensation/time_series.hpp"

#include "firmware/loop/compensation/arithmetic.hpp"

namespace firmware::compensation {
namespace {

constexpr double root_two = 1.4142135623730951;
constexpr double first_damping = 2.6131259297527532;  // √(4 + 2√2)
/// `quiet` is a motion at this share of the filters' bandwidth, about that of a car's body.
constexpr double quiet_share = 0.1;

}  // namespace

SignalFilter::SignalFilter(double omega, double period) {
  using Matrix = model::Block<double, derivatives, derivatives>;
  // In units of 1/ω: the derivatives have one size, which the discretisation needs.
  Matrix a = Matrix::Zero();
  for (int i = 0; i + 1 < derivatives; ++i) a(i, i + 1) = omega;
  a(3, 0) = -omega;
  a(3, 1) = a(3, 3) = -first_damping * omega;
  a(3, 2) = -(2.0 + root_two) * omega;
  Output b = Output::Zero();
  b(3) = omega;
  const model::ExactDiscretisation<double, derivatives> exact(a, period);
  transition_ = exact.transition();
  input_ = exact.straight(b);
  double row = 1.0;
  for (int i = 0; i < derivatives; ++i, row *= omega) {
    highest_(i) = a(3, i) * (omega * omega * omega) / row;
    input_.row(i) *= row;
    double column = 1.0;
    for (int j = 0; j < derivatives; ++j, column *= omega) transition_(i, j) *= row / column;
  }
}

void SignalFilter::step(State& x, double input) const {
  Output next = input_.col(0) * x.input;
  next += input_.col(1) * input;
  for (int j = 0; j < derivatives; ++j) next += transition_.col(j) * x.output(j);
  x.output = next;
  x.input = input;
}

TimeSeries::TimeSeries(const Settings& settings, const Coefficients& assumed, double period)
    : count_(static_cast<std::size_t>(settings.order) + 1),
      period_(period),
      memory_(1.0 - period / settings.memory),
      weight_(quiet_share * quiet_share * settings.quiet * settings.quiet * settings.memory),
      filter_(turn * settings.bandwidth, period) {
  double scale = 1.0;
  for (std::size_t i = 0; i < count_; ++i, scale *= turn * settings.bandwidth) {
    scale_[i] = scale * turn * settings.bandwidth;
    unit_[i] = scale;
    lowest_[i] = settings.lowest[i];
    highest_[i] = settings.highest[i];
    assumed_[i] = limited(assumed[i], lowest_[i], highest_[i]);
    step_[i] = (highest_[i] - lowest_[i]) * period / settings.settling;
  }
}

void TimeSeries::start(State& x, double at) const {
  x = {};
  x.values = assumed_;
  filter_.start(x.wanted, at);
  filter_.start(x.commanded, at);
  filter_.start(x.reached, at);
}

void TimeSeries::step(State& x, double wanted, double commanded, double measured) const {
  filter_.step(x.wanted, wanted);
  filter_.step(x.commanded, commanded);
  filter_.step(x.reached, measured);
  const auto derivative = [this](const SignalFilter::State& y, std::size_t i) {  // of order i + 1
    return (i + 1 < coefficients ? y.output(static_cast<int>(i) + 1) : filter_.fourth_derivative(y)) / scale_[i];
  };
  std::array<double, coefficients> p{}, z{};
  for (std::size_t i = 0; i < count_; ++i) {
    p[i] = derivative(x.reached, i);
    z[i] = derivative(x.wanted, i);
  }
  const double u = derivative(x.commanded, 0);
  for (std::size_t i = 0; i < count_; ++i) {  // (1)
    for (std::size_t j = 0; j < count_; ++j) x.products[i][j] = memory_ * x.products[i][j] + period_ * z[i] * p[j];
    x.right[i] = memory_ * x.right[i] + period_ * z[i] * u;
  }
  const Coefficients solved = solve(x);
  for (std::size_t i = 0; i < count_; ++i) {  // (3)
    const double target = limited(solved[i], lowest_[i], highest_[i]);
    x.values[i] += limited(target - x.values[i], -step_[i], step_[i]);
  }
}

Coefficients TimeSeries::solve(const State& x) const {
  std::array<std::array<double, coefficients + 1>, coefficients> m{};
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t j = 0; j < count_; ++j) m[i][j] = x.products[i][j];
    m[i][i] += weight_;
    m[i][count_] = x.right[i] + weight_ * (assumed_[i] * unit_[i]);
  }
  for (std::size_t k = 0; k < count_; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < count_; ++i) {
      const double here = m[i][k] < 0.0 ? -m[i][k] : m[i][k], best = m[pivot][k] < 0.0 ? -m[pivot][k] : m[pivot][k];
      if (here > best) pivot = i;
    }
    if (m[pivot][k] == 0.0) return assumed_;
    const auto row = m[pivot];
    m[pivot] = m[k];
    m[k] = row;
    for (std::size_t i = k + 1; i < count_; ++i) {
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j <= count_; ++j) m[i][j] -= factor * m[k][j];
    }
  }
  Coefficients a{};
  for (std::size_t k = count_; k-- > 0;) {
    double sum = m[k][count_];
    for (std::size_t j = k + 1; j < count_; ++j) sum -= m[k][j] * a[j];
    a[k] = sum / m[k][k];
  }
  for (std::size_t i = 0; i < count_; ++i) a[i] /= unit_[i];
  return a;
}

}  // namespace firmware::compensation
