#include "model/components/road_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <vector>

#include "model/rig/rig_model.hpp"
#include "tests/support/reference_parameters.hpp"
#include "tests/support/reference_road.hpp"

namespace road_filter_test {
namespace {

using Filter = model::RoadFilter<double>;

constexpr double pi = 3.14159265358979323846;
constexpr double speed = 100.0 / 3.6, roughness = 64e-6, period = 1e-3;

/// One-sided spectrum of displacement that ISO 8608 and the filter's corners ask for.
double formula(double f, double cut_off, double bandwidth) {
  return roughness * 0.01 * speed / (f * f + cut_off * cut_off) / (1.0 + std::pow(f / bandwidth, 8));
}

// Point (1)–(3). Cut-off 0.5 Hz, bandwidth 10 Hz (ω = 62.832), state (1, 2, 3, 4, 5), w = 2:
// ż₀ = 2π·0.1·√(64e-6·27.78)·2 − 2π·0.5·1, p̈ = ω²(1 − 2) − 1.8478 ω·3, z̈ = ω²(2 − 4) − 0.76537 ω·5.
TEST(RoadFilter, HasTheRatesOfItsEquations) {
  const Filter filter({roughness, speed, 0.5, 10.0}, period);
  Filter::State x;
  x << 1.0, 2.0, 3.0, 4.0, 5.0;
  const auto rate = filter.rates(x, 2.0);
  EXPECT_NEAR(rate(0), 0.0529845 - 3.1415927, 1e-6);
  EXPECT_EQ(rate(1), 3.0);
  EXPECT_NEAR(rate(2), -3947.8418 - 348.2941, 1e-3);
  EXPECT_EQ(rate(3), 5.0);
  EXPECT_NEAR(rate(4), -7895.6835 - 240.4471, 1e-3);
  EXPECT_EQ(filter.motion(x).position, 4.0);
  EXPECT_EQ(filter.motion(x).velocity, 5.0);
  EXPECT_EQ(filter.motion(x).acceleration, rate(4));
}

// Law. The spectrum of the discrete filter itself, from its matrices: G(f) = 2 h σ² |C (e^{jωh} − Φ)⁻¹ Γ|² with
// σ² = 1/(2h). The hold takes (πfh)²/3 away (0.1 % at 20 Hz), the sampled low-pass folds nothing that is visible.
TEST(RoadFilter, HasTheSpectrumOfIso8608UpToItsBandwidth) {
  const double cut_off = 0.01, bandwidth = 40.0;
  const Filter filter({roughness, speed, cut_off, bandwidth}, period);
  Eigen::Matrix<double, 5, 5> transition;
  for (int j = 0; j < 5; ++j) transition.col(j) = filter.step(Filter::State::Unit(j), 0.0);
  const Filter::State noise = filter.step(Filter::State::Zero(), 1.0);
  for (const double f : {0.001, 0.01, 0.1, 0.5, 1.0, 3.0, 10.0, 20.0, 40.0, 60.0}) {
    const std::complex<double> turn = std::polar(1.0, 2.0 * pi * f * period);
    const Eigen::Matrix<std::complex<double>, 5, 5> a =
        turn * Eigen::Matrix<std::complex<double>, 5, 5>::Identity() - transition.cast<std::complex<double>>();
    const Eigen::Matrix<std::complex<double>, 5, 1> response = a.fullPivLu().solve(noise.cast<std::complex<double>>());
    const double hold = std::pow(std::sin(pi * f * period) / (pi * f * period), 2);
    EXPECT_NEAR(std::norm(response(3)) / formula(f, cut_off, bandwidth), hold, 2e-4) << f << " Hz";
    if (f <= bandwidth / 2.0) {
      EXPECT_NEAR(std::norm(response(3)) / formula(f, cut_off, 1e9), 1.0, 6e-3) << f << " Hz: the road alone";
    }
  }
}

/// One-sided spectrum at `frequencies` by Hann-windowed segments of 4 s, each averaged over five bins (±2).
std::vector<double> spectrum(const std::vector<double>& x, const std::vector<double>& frequencies) {
  const std::size_t n = 4000;
  const std::size_t segments = x.size() / n;
  std::vector<double> result;
  for (const double f : frequencies) {
    double power = 0.0;
    for (std::size_t s = 0; s < segments; ++s) {
      const double trend = (x[s * n + n - 1] - x[s * n]) / (n - 1.0);
      for (int bin = -2; bin <= 2; ++bin) {
        const std::complex<double> turn = std::polar(1.0, 2.0 * pi * (f * 4.0 + bin) / static_cast<double>(n));
        std::complex<double> sum, angle = 1.0;
        for (std::size_t i = 0; i < n; ++i, angle *= turn) {
          const double window = 1.0 - std::cos(2.0 * pi * static_cast<double>(i) / static_cast<double>(n));
          sum += angle * window * (x[s * n + i] - x[s * n] - trend * static_cast<double>(i));
        }
        power += std::norm(sum);
      }
    }
    result.push_back(2.0 * power * period / (1.5 * static_cast<double>(n) * static_cast<double>(segments) * 5.0));
  }
  return result;
}

// Golden. A long run has the spectrum of the formula within its statistical error: 150 segments of five Hann bins are
// some 400 independent values, 5 %; four of those. Noise of 3 dB too much (randn/√h) would be 100 % off.
TEST(RoadFilter, MakesARoadOfTheRightLoudness) {
  const std::uint64_t seed = 41;
  std::vector<double> z;
  for (const auto& m : support::random_road(roughness, period, 600.0, seed)) z.push_back(m.position);
  const std::vector<double> frequencies{2.0, 5.0, 10.0, 20.0, 35.0};
  const auto found = spectrum(z, frequencies);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    double expected = 0.0;  // mean over the bins: the spectrum is steep
    for (int bin = -2; bin <= 2; ++bin) expected += formula(frequencies[i] + 0.25 * bin, 0.01, 40.0) / 5.0;
    EXPECT_NEAR(found[i] / expected, 1.0, 0.2) << frequencies[i] << " Hz, seed " << seed;
  }
}

// Law. Position, velocity and acceleration belong together: the difference of positions is the integral of the velocity
// (Hermite's rule, off by h⁵/720 of the velocity's fourth derivative, ω⁴ ż₀ ≈ 4e9 · 2 m/s⁵: 2e-8 m).
TEST(RoadFilter, MovesWithItsOwnVelocity) {
  const auto road = support::random_road(roughness, period, 2.0, 42);
  for (std::size_t k = 1; k < road.size(); ++k) {
    const double hermite = 0.5 * period * (road[k].velocity + road[k - 1].velocity) +
                           period * period / 12.0 * (road[k - 1].acceleration - road[k].acceleration);
    EXPECT_NEAR(road[k].position - road[k - 1].position, hermite, 2e-8) << "seed 42, sample " << k;
  }
}

// Golden. Linear component on class B at 100 km/h, 0.1 … 50 Hz: rms F_w 493 N, z̈_b 1.02 m/s², travel 7.1 mm. Half an
// hour of road; the body mode (3 1/s wide) leaves 1/√(1800 · 1.5) ≈ 2 % of statistical error, F_w less.
TEST(RoadFilter, ShakesTheLinearCarAsMuchAsTheTextExpects) {
  const std::uint64_t seed = 43;
  const model::RigModel<> car(support::linear_rig(model::RigKind::quarter_car), period);
  auto x = car.start();
  double load = 0.0, body = 0.0, travel = 0.0;
  const auto road = support::random_road(roughness, period, 1800.0, seed, 50.0);
  for (const auto& m : road) {
    car.step(x, {.foot_point = m});
    const auto s = car.signals(x);
    load += s[index(model::Channel::F_w)] * s[index(model::Channel::F_w)];
    body += s[index(model::Channel::zdd_b)] * s[index(model::Channel::zdd_b)];
    travel += s[index(model::Channel::dz_b)] * s[index(model::Channel::dz_b)];
  }
  const auto n = static_cast<double>(road.size());
  EXPECT_NEAR(std::sqrt(load / n), 493.0, 15.0) << "seed " << seed;
  EXPECT_NEAR(std::sqrt(body / n), 1.02, 0.05) << "seed " << seed;
  EXPECT_NEAR(std::sqrt(travel / n), 7.1e-3, 0.4e-3) << "seed " << seed;
}

// Fault. What is no road stops where it is configured.
TEST(RoadFilterDeathTest, StopsAtWhatIsNoRoad) {
  const auto build = [](double g, double v, double low, double high) {
    const Filter filter({g, v, low, high}, period);
  };
  EXPECT_DEATH(build(-1e-6, speed, 0.01, 40.0), "");
  EXPECT_DEATH(build(roughness, 0.0, 0.01, 40.0), "");
  EXPECT_DEATH(build(roughness, speed, -0.01, 40.0), "");
  EXPECT_DEATH(build(roughness, speed, 0.01, 0.0), "");
}

}  // namespace
}  // namespace road_filter_test
