#include "host_sim/identification/predict/low_pass.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "host_sim/identification/common/butterworth.hpp"
#include "host_sim/identification/predict/sample_polynomial.hpp"
#include "host_sim/signal/weighted_sums.hpp"

namespace host_sim::identification {
namespace {

using std::numbers::pi;

/// A factor of butterworth(): 1/(1 + damping s + s²), or 1/(1 + s).
struct Section {
  bool second_order;
  double damping;
};

std::vector<Section> sections_of(int order) {
  std::vector<Section> sections;
  for (int m = 0; m < order / 2; ++m) sections.push_back({true, butterworth_damping(order, m)});
  if (order % 2 == 1) sections.push_back({false, 0.0});
  return sections;
}

/// tan(π turns), bounded where the Nyquist frequency is near.
double warped(double turns) { return std::tan(pi * std::min(turns, 0.499)); }

/// One section over one sample period, exact for an input on the polynomial through six samples:
///
///   y[n] = A y[n−1] + B (u[first] … u[first + 5])
///
/// B depends on where n − 1 stands among the six. A and B by the classical Runge-Kutta method, from unit states and
/// unit samples. A step turns the pole by 0.05 rad at most, which is wrong by 1e-8 of the signal.
class AnalogueSection {
 public:
  AnalogueSection(const Section& section, double corner, double period)
      : section_(section),
        omega_(2.0 * pi * corner),
        steps_(2 + static_cast<int>(omega_ * period / 0.05)),
        step_(period / steps_) {
    for (std::size_t s = 0; s < 2; ++s) {
      State y{};
      y[s] = 1.0;
      for (int i = 0; i < steps_; ++i) y = advanced(y, 0.0, 0.0, 0.0);
      for (std::size_t r = 0; r < 2; ++r) turn_[r][s] = y[r];
    }
    for (std::size_t place = 0; place < drive_.size(); ++place) {
      std::array<State, polynomial_points> of_sample{};
      const auto unit_samples = [&](double share) { return weights_at(static_cast<double>(place) + share); };
      SampleWeights from = unit_samples(0.0);
      for (int i = 0; i < steps_; ++i) {
        const SampleWeights middle = unit_samples((i + 0.5) / steps_), to = unit_samples((i + 1.0) / steps_);
        for (std::size_t s = 0; s < of_sample.size(); ++s) {
          of_sample[s] = advanced(of_sample[s], from[s], middle[s], to[s]);
        }
        from = to;
      }
      for (std::size_t r = 0; r < 2; ++r) {
        for (std::size_t s = 0; s < of_sample.size(); ++s) drive_[place][r][s] = of_sample[s][r];
      }
    }
  }

  [[nodiscard]] std::vector<double> filtered(const std::vector<double>& values) const {
    const std::vector<double> of_value = driven(0, values);
    const std::vector<double> of_slope = section_.second_order ? driven(1, values) : std::vector<double>{};
    std::vector<double> result(values.size());
    State y{values.front(), 0.0};
    result.front() = y[0];
    for (std::size_t n = 1; n < result.size(); ++n) {
      if (section_.second_order) {
        y = {turn_[0][0] * y[0] + turn_[0][1] * y[1] + of_value[n],
             turn_[1][0] * y[0] + turn_[1][1] * y[1] + of_slope[n]};
      } else {
        y[0] = turn_[0][0] * y[0] + of_value[n];
      }
      result[n] = y[0];
    }
    return result;
  }

 private:
  using State = std::array<double, 2>;

  /// B (u[first] … u[first + 5]) of one state at each n > 0.
  [[nodiscard]] std::vector<double> driven(std::size_t state, const std::vector<double>& values) const {
    const auto count = static_cast<std::ptrdiff_t>(values.size());
    constexpr std::ptrdiff_t middle = 2;  // of six samples, but for the ends
    std::vector<double> sums(values.size());
    for (std::ptrdiff_t n = 1; n < count; ++n) {
      if (n == 1 + middle) n = count - middle;
      const std::ptrdiff_t first = first_around(n - 1, count);
      const auto place = static_cast<std::size_t>(n - 1 - first);
      sums[static_cast<std::size_t>(n)] = weighted(drive_[place][state], values.data() + first);
    }
    add_weighted_sums(drive_[middle][state].data(), polynomial_points, values.data(), sums.data() + 1 + middle,
                      static_cast<std::size_t>(count - polynomial_points + 1));
    return sums;
  }
  [[nodiscard]] State rate(const State& y, double u) const {
    if (!section_.second_order) return {omega_ * (u - y[0]), 0.0};
    return {y[1], omega_ * omega_ * (u - y[0]) - section_.damping * omega_ * y[1]};
  }
  /// One step of the method, with the input at its beginning, middle and end.
  [[nodiscard]] State advanced(const State& y, double from, double middle, double to) const {
    const auto moved = [&y](const State& k, double h) -> State { return {y[0] + h * k[0], y[1] + h * k[1]}; };
    const State k1 = rate(y, from), k2 = rate(moved(k1, 0.5 * step_), middle);
    const State k3 = rate(moved(k2, 0.5 * step_), middle), k4 = rate(moved(k3, step_), to);
    State next = y;
    for (std::size_t c = 0; c < 2; ++c) next[c] += step_ / 6.0 * (k1[c] + 2.0 * k2[c] + 2.0 * k3[c] + k4[c]);
    return next;
  }

  Section section_;
  double omega_;
  int steps_;
  double step_;
  std::array<State, 2> turn_{};
  std::array<std::array<SampleWeights, 2>, polynomial_points - 1> drive_{};  ///< of each place of n − 1 among the six
};

/// (2) with s = (1 − z⁻¹)/((1 + z⁻¹) k), k = tan(π corner T).
std::vector<double> digitally(const Section& section, double k, std::vector<double> values) {
  using Taps = std::array<double, 3>;  // newest first
  const double square = k * k, damped = section.damping * k;
  Taps in = section.second_order ? Taps{square, 2.0 * square, square} : Taps{k, k, 0.0};
  Taps out = section.second_order ? Taps{1.0 + damped + square, 2.0 * (square - 1.0), 1.0 - damped + square}
                                  : Taps{1.0 + k, k - 1.0, 0.0};
  const double divisor = out[0];  // a division in the loop would be what it waits for
  for (std::size_t i = 0; i < in.size(); ++i) {
    in[i] /= divisor;
    out[i] /= divisor;
  }
  double u1 = values.front(), u2 = u1, y1 = u1, y2 = u1;
  for (double& value : values) {
    const double next = (in[0] * value + in[1] * u1 + in[2] * u2 - out[2] * y2) - out[1] * y1;
    u2 = std::exchange(u1, value);
    y2 = std::exchange(y1, next);
    value = next;
  }
  return values;
}

constexpr double compared_up_to = 100.0;  ///< [Hz] a little more than what is
constexpr int samples_each_side = 10;

/// Weights w of Σ_j w_j e^{2πi fT j}, j = −samples_each_side … samples_each_side, nearest to 1/H.
Eigen::VectorXd inverse_weights(const LowPass& filter, double period) {
  constexpr int lines = 128;
  const double edge = std::clamp(compared_up_to * period, 0.16, 0.45);  // [1/T]
  constexpr double beyond = 1e-3;  // weight of the lines above, which hold the gain of the edge
  constexpr Eigen::Index count = 2 * samples_each_side + 1;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (int line = 0; line < lines; ++line) {
    const double turns = 0.5 * line / lines;
    const std::complex<double> gain = 1.0 / filter.response(std::min(turns, edge) / period, period);
    const double weight = (turns <= edge ? 1.0 : beyond) / std::abs(gain);
    Eigen::VectorXcd row(count);
    for (Eigen::Index j = 0; j < count; ++j)
      row(j) = std::polar(weight, 2.0 * pi * turns * static_cast<double>(j - samples_each_side));
    const std::complex<double> wanted = weight * gain;
    matrix += row.real() * row.real().transpose() + row.imag() * row.imag().transpose();
    right += row.real() * wanted.real() + row.imag() * wanted.imag();
  }
  matrix.diagonal().array() += 1e-12 * matrix.trace();
  return matrix.ldlt().solve(right);
}

}  // namespace

std::complex<double> LowPass::response(double f, double period) const {
  return butterworth(order, digital ? warped(f * period) / warped(corner * period) : f / corner);
}

std::vector<double> low_passed(const LowPass& filter, const std::vector<double>& values, double period) {
  constexpr double highest = 3.0;
  if (values.size() < polynomial_points || (!filter.digital && filter.corner * period > highest)) return values;
  std::vector<double> result = values;
  for (const Section& section : sections_of(filter.order)) {
    result = filter.digital ? digitally(section, warped(filter.corner * period), std::move(result))
                            : AnalogueSection(section, filter.corner, period).filtered(result);
  }
  return result;
}

std::vector<double> un_low_passed(const LowPass& filter, const std::vector<double>& values, double period) {
  const Eigen::VectorXd weights = inverse_weights(filter, period);
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  std::vector<double> raised(values.size());
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    double sum = 0.0;
    for (std::ptrdiff_t j = -samples_each_side; j <= samples_each_side; ++j) {
      const auto at = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k + j, 0, count - 1));
      sum += weights(j + samples_each_side) * values[at];
    }
    raised[static_cast<std::size_t>(k)] = sum;
  }
  return raised;
}

}  // namespace host_sim::identification
