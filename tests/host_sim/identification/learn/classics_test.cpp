// Two classics of nonlinear identification, and what a black box of equal size makes of the recordings of one.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <string>
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

/// A random-phase multisine: a period of `samples` at `rate`, with the lines `first` … `last` of its spectrum.
struct Excitation {
  double rate;  ///< [Hz]
  std::size_t samples, first, last;
  double rms;  ///< [N]
};
constexpr Excitation duffing_force{610.35, 8192, 2, 268, 4.0};     // 0.1 … 20 Hz
constexpr Excitation bouc_wen_force{750.0, 8192, 55, 1638, 50.0};  // 5 … 150 Hz, as published

/// u over a period, `per_sample` values a sample.
std::vector<double> multisine(const Excitation& of, std::uint64_t seed, std::size_t per_sample) {
  support::NormalNoise random(seed);
  std::vector<double> u(of.samples * per_sample, 0.0);
  const double amplitude = of.rms * std::sqrt(2.0 / static_cast<double>(of.last - of.first + 1));
  for (std::size_t line = of.first; line <= of.last; ++line) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(line) / static_cast<double>(u.size());
    const std::complex<double> by = std::polar(1.0, turn);
    std::complex<double> z = std::polar(amplitude, std::fmod(std::abs(random()) * 1e3, 2.0 * std::numbers::pi));
    for (double& value : u) {
      value += z.real();
      z = {z.real() * by.real() - z.imag() * by.imag(), z.real() * by.imag() + z.imag() * by.real()};
    }
  }
  return u;
}

/// One Runge–Kutta step of ẋ = rates(x, u); u at its beginning, middle and end are values i, i + 1, i + 2 of a period.
template <std::size_t N, class Rates>
void step(std::array<double, N>& x, double h, const Rates& rates, const std::vector<double>& u, std::size_t i) {
  const auto moved = [&](const std::array<double, N>& rate, double by) {
    std::array<double, N> other = x;
    for (std::size_t n = 0; n < N; ++n) other[n] += by * rate[n];
    return other;
  };
  const double middle = u[(i + 1) % u.size()];
  const auto k1 = rates(x, u[i % u.size()]), k2 = rates(moved(k1, 0.5 * h), middle);
  const auto k3 = rates(moved(k2, 0.5 * h), middle), k4 = rates(moved(k3, h), u[(i + 2) % u.size()]);
  for (std::size_t n = 0; n < N; ++n) x[n] += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
}

firmware::Recording begun(const Excitation& force, std::uint64_t seed) {
  firmware::Recording r;
  r.sample_period = 1.0 / force.rate;
  r.source = "multisine " + std::to_string(seed);
  r.time = firmware::sample_times(force.samples, force.rate);
  return r;
}

/// Four Runge–Kutta steps a sample; noise of 0.2 % of each channel.
firmware::Recording recorded(const Duffing& rig, std::uint64_t seed) {
  const Excitation& force = duffing_force;
  support::NormalNoise noise(seed + 50);
  firmware::Recording r = begun(force, seed);
  constexpr std::size_t steps = 4;
  const std::vector<double> u = multisine(force, seed, 2 * steps);
  const auto rates = [&](const std::array<double, 2>& x, double now) {
    return std::array{x[1], rig.acceleration(x[0], x[1], now)};
  };
  std::array<double, 2> x{};
  for (std::size_t k = 0; k < force.samples; ++k) {
    const double now = u[2 * steps * k], a = rig.acceleration(x[0], x[1], now);
    r[Channel::zdd_w].push_back(now / rig.mass + 4e-4 * noise());
    r[Channel::dz_b].push_back(x[0] + 2e-5 * noise());
    r[Channel::zdd_b].push_back(now / rig.mass - a + 0.04 * noise());
    for (std::size_t i = 0; i < steps; ++i) step(x, 1.0 / force.rate / steps, rates, u, 2 * (steps * k + i));
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
                duffing_force.rate, rig.mass, 1.02 * rig.stiffness, 1.1 * rig.damping);
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

/// The benchmark of J. P. Noël and M. Schoukens (Hysteretic benchmark with a dynamic nonlinearity, Nonlinear system
/// identification benchmarks, 2016): m ẍ + c ẋ + k x + z = u, ż = α ẋ − β (γ |ẋ| z + δ ẋ |z|), its published numbers,
/// 750 Hz and noise of 8 µm. A body on its suspension as above.
struct BoucWenOscillator {
  static constexpr double mass = 2.0, damping = 10.0, stiffness = 5e4, alpha = 5e4, beta = 1e3, gamma = 0.8,
                          delta = -1.1;
  [[nodiscard]] static std::array<double, 3> rates(const std::array<double, 3>& s, double u) {
    const auto [x, v, z] = s;
    return {v, (u - damping * v - stiffness * x - z) / mass,
            alpha * v - beta * (gamma * std::abs(v) * z + delta * v * std::abs(z))};
  }
};

/// The second period of the multisine, which is steady; 16 steps a sample.
firmware::Recording recorded(const BoucWenOscillator& /*rig*/, std::uint64_t seed) {
  const Excitation& force = bouc_wen_force;
  support::NormalNoise noise(seed + 50);
  firmware::Recording r = begun(force, seed);
  constexpr std::size_t steps = 16;
  const std::vector<double> u = multisine(force, seed, 2 * steps);
  std::array<double, 3> x{};
  for (std::size_t k = 0; k < 2 * force.samples; ++k) {
    if (k >= force.samples) {
      r[Channel::zdd_w].push_back(u[2 * steps * (k - force.samples)] / BoucWenOscillator::mass);
      r[Channel::dz_b].push_back(x[0] + 8e-6 * noise());
    }
    for (std::size_t i = 0; i < steps; ++i) {
      step(x, 1.0 / force.rate / steps, BoucWenOscillator::rates, u, 2 * (steps * k + i));
    }
  }
  return r;
}

// Truth by construction: α and the loop's two rates are those of `hardening_hysteresis`, F_h = −α/(β (γ + δ)), s =
// −(γ − δ)/(γ + δ). A model is to leave 5 % of another multisine at most; the noise is 1.2 %.
TEST(Classics, FindsTheHysteresisOfTheBoucWenOscillator) {
  const BoucWenOscillator rig;
  const firmware::Recording fitted = recorded(rig, 1), other = recorded(rig, 2);
  const firmware::RigDescription described = firmware::parse_rig(
      "kind = 'quarter_car'\nsample_rate = 750\n[body]\nmass = 2.0\n[wheel]\nmass = 1.0\n[tyre]\nstiffness = 1e5\n"
      "damping = 1.0\n[suspension]\nstiffness = 1e5\ndamping = 30.0\n[tolerance]\n'suspension.stiffness' = 0.7\n"
      "'suspension.damping' = 0.9\n[noise]\nzdd_w = 1e-4\ndz_b = 8e-6\n",
      "bouc_wen.toml");
  const Diagnosis found = diagnose(described, {{fitted, Use::fitted}, {other, Use::held_out}});
  const PredictionError& gap = found.prediction_errors.at(Channel::dz_b);
  std::printf("  error of dz_b on the other multisine: as described %.3f, refitted %.3f, found %.4f, noise %.4f\n",
              gap.before, gap.refit, gap.after, gap.noise_floor);
  EXPECT_LT(gap.after, 0.05) << sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << sentence(found);
  EXPECT_EQ(found.effects[0].effect.entry->name, "hardening_hysteresis");
  EXPECT_NEAR(found.effects[0].parameters[0].value, rig.alpha, 0.05 * rig.alpha);
  EXPECT_NEAR(found.rig.rig.suspension.stiffness, rig.stiffness, 0.05 * rig.stiffness);
}

}  // namespace
