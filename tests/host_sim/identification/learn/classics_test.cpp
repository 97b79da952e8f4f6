// A classic of nonlinear identification, and what a black box of equal size makes of the same recordings.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/support/reference_road.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// An oscillator like that of the Silverbox (T. Wigren, J. Schoukens, Three free data sets, ECC 2013): its equation
/// m ẍ + c ẋ + k x + k₃ x³ = u and its sample rate, a tenth of its resonance frequency, since rigs end at 90 Hz;
/// damping (Q 21) and cubic force (15 % at the peak) are ours. As a rig it is a body on its suspension, moved by the
/// wheel: x = z_w − z_b, u = m z̈_w.
struct Duffing {
  double mass = 1.0, stiffness = std::pow(2.0 * std::numbers::pi * 6.86, 2), damping = 0.047 * std::sqrt(stiffness),
         cubic = 0.125 * stiffness / 4e-4;
  [[nodiscard]] double acceleration(double x, double v, double u) const {
    return (u - damping * v - stiffness * x - cubic * x * x * x) / mass;
  }
  [[nodiscard]] double force(double x) const { return stiffness * x + cubic * x * x * x; }
};

constexpr double rate = 610.35;
constexpr std::size_t samples = 16384;

/// u of a random-phase multisine 0.1 … 20 Hz of 4 N rms.
class Multisine {
 public:
  explicit Multisine(std::uint64_t seed) {
    support::NormalNoise random(seed);
    for (int k = 3; k <= 536; ++k) phase_.push_back(std::fmod(std::abs(random()) * 1e3, 2.0 * std::numbers::pi));
  }
  [[nodiscard]] double operator()(double t) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < phase_.size(); ++i) {
      const double f = (static_cast<double>(i) + 3.0) * rate / static_cast<double>(samples);
      sum += std::cos(2.0 * std::numbers::pi * f * t + phase_[i]);
    }
    return 4.0 * std::sqrt(2.0 / static_cast<double>(phase_.size())) * sum;
  }

 private:
  std::vector<double> phase_;
};

/// Four Runge–Kutta steps a sample; noise of 0.2 % of each channel.
firmware::Recording recorded(const Duffing& rig, std::uint64_t seed) {
  const Multisine u(seed);
  support::NormalNoise noise(seed + 50);
  firmware::Recording r;
  r.sample_period = 1.0 / rate;
  r.source = "multisine " + std::to_string(seed);
  r.time = firmware::sample_times(samples, rate);
  constexpr int steps = 4;
  const double h = 1.0 / rate / steps;
  double x = 0.0, v = 0.0, now = u(0.0);
  for (std::size_t k = 0; k < samples; ++k) {
    const double a = rig.acceleration(x, v, now);
    r[Channel::zdd_w].push_back(now / rig.mass + 4e-4 * noise());
    r[Channel::dz_b].push_back(x + 2e-5 * noise());
    r[Channel::zdd_b].push_back(now / rig.mass - a + 0.04 * noise());
    for (int i = 0; i < steps; ++i) {
      const double t = (static_cast<double>(k) + static_cast<double>(i) / steps) / rate;
      const double middle = u(t + 0.5 * h), end = u(t + h);
      const double a1 = rig.acceleration(x, v, now), v2 = v + 0.5 * h * a1;
      const double a2 = rig.acceleration(x + 0.5 * h * v, v2, middle), v3 = v + 0.5 * h * a2;
      const double a3 = rig.acceleration(x + 0.5 * h * v2, v3, middle), v4 = v + h * a3;
      const double a4 = rig.acceleration(x + h * v3, v4, end);
      x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
      now = end;
    }
  }
  return r;
}

firmware::RigDescription described(const Duffing& rig) {
  char text[700];
  std::snprintf(text, sizeof text,
                "kind = 'quarter_car'\nsample_rate = %.2f\n[body]\nmass = %g\n[wheel]\nmass = 1.0\n[tyre]\n"
                "stiffness = 1e5\ndamping = 1.0\n[suspension]\nstiffness = %g\ndamping = %g\n[tolerance]\n"
                "'suspension.stiffness' = 0.2\n'suspension.damping' = 0.5\n[noise]\nzdd_w = 4e-4\ndz_b = 2e-5\n"
                "zdd_b = 0.04\n",
                rate, rig.mass, 1.02 * rig.stiffness, 1.1 * rig.damping);
  return firmware::parse_rig(text, "duffing.toml");
}

/// A polynomial NARX of the deflection by least squares on one-step errors, at a tenth of the rate, where a step of the
/// oscillator is no small change: 4 values of x and 4 of u, linear, and the 10 cubes of x and its delays. Its error
/// over a whole recording that it simulates freely, relative to the rms.
class Narx {
 public:
  static constexpr std::size_t every = 10, delays = 4;
  using Row = Eigen::Matrix<double, 18, 1>;

  explicit Narx(const firmware::Recording& r) {
    const auto x = thinned(r[Channel::dz_b]), u = thinned(r[Channel::zdd_w]);
    const auto n = static_cast<Eigen::Index>(x.size() - delays);
    Eigen::MatrixXd a(n, 18);
    Eigen::VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t k = static_cast<std::size_t>(i) + delays;
      a.row(i) = row(x, u, k).transpose();
      b(i) = x[k];
    }
    values_ = a.colPivHouseholderQr().solve(b);
  }

  [[nodiscard]] double error(const firmware::Recording& r) const {
    const auto truth = thinned(r[Channel::dz_b]), u = thinned(r[Channel::zdd_w]);
    std::vector<double> x = truth;
    double squares = 0.0, size = 0.0;
    for (std::size_t k = delays; k < x.size(); ++k) {
      x[k] = values_.dot(row(x, u, k));
      squares += std::pow(x[k] - truth[k], 2);
      size += truth[k] * truth[k];
    }
    return std::sqrt(squares / size);
  }

 private:
  static std::vector<double> thinned(const std::vector<double>& values) {
    std::vector<double> kept;
    for (std::size_t k = 0; k < values.size(); k += every) kept.push_back(values[k]);
    return kept;
  }
  static Row row(const std::vector<double>& x, const std::vector<double>& u, std::size_t k) {
    Row out;
    Eigen::Index at = 0;
    for (std::size_t d = 1; d <= delays; ++d) out(at++) = x[k - d];
    for (std::size_t d = 0; d < delays; ++d) out(at++) = u[k - d];
    const double unit = 1e-2;  // [m], so that the columns are of one size
    for (std::size_t i = 1; i <= 3; ++i) {
      for (std::size_t j = i; j <= 3; ++j) {
        for (std::size_t l = j; l <= 3; ++l) out(at++) = x[k - i] * x[k - j] * x[k - l] / (unit * unit);
      }
    }
    return out;
  }
  Row values_;
};

// Truth by construction. The static curve within 1 %, the name of the catalogue's effect, and an error on a recording
// that was not fitted that no black box of equal size reaches.
TEST(Classics, FindsTheSpringOfTheDuffingOscillator) {
  const Duffing rig;
  const firmware::Recording fitted = recorded(rig, 1), other = recorded(rig, 2);
  const Diagnosis found = diagnose(described(rig), {{fitted, Use::fitted}, {other, Use::held_out}});
  ASSERT_EQ(found.effects.size(), 1U) << sentence(found);
  EXPECT_EQ(found.effects[0].effect.entry->name, "progressive_spring");
  EXPECT_TRUE(found.laws.empty());
  const double cubic = found.effects[0].parameters[0].value, stiffness = found.rig.rig.suspension.stiffness;
  for (double x = 1e-3; x < 22e-3; x += 1e-3) {
    EXPECT_NEAR((stiffness * x + cubic * x * x * x) / rig.force(x), 1.0, 0.01) << x;
  }
  const PredictionError& gap = found.prediction_errors.at(Channel::dz_b);
  const double black_box = Narx(fitted).error(other);
  std::printf(
      "  error of dz_b on the other recording: as described %.3f, tolerances refitted %.3f, with the effect %.4f, "
      "NARX %.4f, noise %.4f\n",
      gap.before, gap.refit, gap.after, black_box, gap.noise_floor);
  EXPECT_LT(gap.after, black_box);
  EXPECT_LT(gap.after, 1.2 * gap.noise_floor);
}

}  // namespace
