// Known noise becomes white.
#include "host_sim/identification/noise/whitening.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/reference_road.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;

constexpr double period = 1e-3;

identification::PreparedRecording two_channels(std::uint64_t seed, double correlated) {
  constexpr std::size_t n = 20'000;
  support::NormalNoise noise(seed);
  identification::PreparedRecording e;
  e.recording.sample_period = e.input.period = period;
  e.recording.time = sample_times(n, 1.0 / period);
  e.channels = {Channel::x_act, Channel::F};
  e.channel_noise[index(Channel::x_act)].level = 2e-5;
  e.channel_noise[index(Channel::F)].level = 10.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double common = correlated * noise();
    e.recording[Channel::x_act].push_back(2e-5 * (noise() + common));
    e.recording[Channel::F].push_back(10.0 * (noise() - 2.0 * common));
  }
  e.fitted = {0, n};
  return e;
}

// Law. Known noise becomes χ² = n; noise with a known common source too, and its channels become independent.
TEST(Whitening, MakesKnownNoiseWhite) {
  for (const double correlated : {0.0, 3.0}) {
    const identification::PreparedRecording e = two_channels(5, correlated);
    Eigen::MatrixXcd common(2, 2);
    const Eigen::Vector2cd source(2e-5 * correlated, -20.0 * correlated);
    common = source * source.adjoint();
    const identification::Whitening whitening(e, e.fitted, e.channel_noise, std::vector<Eigen::MatrixXcd>(91, common));
    Response nothing;
    for (const Channel c : e.channels) nothing[index(c)].assign(e.size(), 0.0);
    std::vector<double> r(whitening.count());
    whitening.whiten(whitening.spectra(e, nothing), r.data());
    double squares = 0.0, across = 0.0;
    for (std::size_t i = 0; i + 3 < r.size(); i += 4) {
      squares += r[i] * r[i] + r[i + 1] * r[i + 1] + r[i + 2] * r[i + 2] + r[i + 3] * r[i + 3];
      across += r[i] * r[i + 2] + r[i + 1] * r[i + 3];
    }
    const double n = static_cast<double>(r.size());
    EXPECT_NEAR(squares / n, 1.0, 5.0 * std::sqrt(2.0 / n)) << "seed 5, " << correlated;
    EXPECT_NEAR(across / (0.5 * n), 0.0, 5.0 / std::sqrt(0.5 * n)) << "seed 5, " << correlated;
  }
}

// Law. A mean that an acceleration cannot have, of a motion of rms 0.1 m/s over T = 20 s, counts in units of its
// deviation, √(2 · 3.2) · 0.1 m/s / T = 12.6 mm/s²: a constant x adds x² / (s² + a²), at 0 Hz and, from its side of
// Parseval's sum, once more. A deflection's mean counts nothing. Tolerance: Σw² N / (Σw)² of the taper is 1.009.
TEST(Whitening, CountsAnAccelerationThatLeavesTheRoad) {
  constexpr std::size_t n = 20'000;
  identification::PreparedRecording e;
  e.recording.sample_period = e.input.period = period;
  e.recording.time = sample_times(n, 1.0 / period);
  e.channels = {Channel::zdd_b, Channel::dz_b};
  e.channel_noise[index(Channel::zdd_b)].level = 0.05;
  e.channel_noise[index(Channel::dz_b)].level = 1e-4;
  e.mean_unknown = true;
  e.input.motion.resize(n);
  Response constant;
  for (std::size_t k = 0; k < n; ++k) e.input.motion[k].velocity = k % 2 == 0 ? 0.1 : -0.1;
  for (const Channel c : e.channels) e.recording[c].assign(n, 0.0);
  e.fitted = {0, n};
  const identification::Whitening whitening(e, e.fitted, e.channel_noise);
  const auto chi_squared = [&](double acceleration, double deflection) {
    constant[index(Channel::zdd_b)].assign(n, acceleration);
    constant[index(Channel::dz_b)].assign(n, deflection);
    std::vector<double> r(whitening.count());
    whitening.whiten(whitening.spectra(e, constant), r.data());
    double squares = 0.0;
    for (const double v : r) squares += v * v;
    return squares;
  };
  EXPECT_NEAR(chi_squared(0.0, 0.01), 0.0, 1e-9);
  const double a = std::sqrt(6.4) * 0.1 / 20.0, s = 0.05 / std::sqrt(20'000.0);
  EXPECT_NEAR(chi_squared(0.1, 0.0) * (a * a + s * s) / 0.01, 2.0, 0.03);
}

// Law. The mean that is taken from an integrated acceleration comes back as a ramp of velocity, and of what a damper of
// the guides makes of it: a line counts nothing, also where samples are left out. A parabola counts, so the test can
// fail.
TEST(Whitening, LeavesOutTheLineOfAnIntegratedInput) {
  constexpr std::size_t n = 20'000;
  for (const bool clipped : {false, true}) {
    identification::PreparedRecording e;
    e.recording.sample_period = e.input.period = period;
    e.recording.time = sample_times(n, 1.0 / period);
    e.channels = {Channel::dz_b};
    e.channel_noise[index(Channel::dz_b)].level = 1e-4;
    e.mean_unknown = true;
    e.input.motion.resize(n);
    e.recording[Channel::dz_b].assign(n, 0.0);
    e.fitted = {0, n};
    std::vector<bool>& left_out = e.clipped[index(Channel::dz_b)];
    left_out.assign(clipped ? n : 0, false);
    for (std::size_t k = 3'000; clipped && k < 5'000; ++k) left_out[k] = true;
    const identification::Whitening whitening(e, e.fitted, e.channel_noise);
    const auto chi_squared = [&](double offset, double slope, double bend) {
      Response response;
      auto& values = response[index(Channel::dz_b)];
      for (std::size_t k = 0; k < n; ++k) {
        const double x = static_cast<double>(k) / n;
        values.push_back(offset + slope * x + bend * x * x);
      }
      std::vector<double> r(whitening.count());
      whitening.whiten(whitening.spectra(e, response), r.data());
      double squares = 0.0;
      for (const double v : r) squares += v * v;
      return squares;
    };
    // Against 1e-2/1e-4 of 20 000 samples, 2e8: rounding is far below, a line that stays far above.
    EXPECT_LT(chi_squared(0.01, 0.02, 0.0), 1e-6) << clipped;
    EXPECT_GT(chi_squared(0.01, 0.02, 0.01), 1e5) << clipped;
  }
}

}  // namespace
