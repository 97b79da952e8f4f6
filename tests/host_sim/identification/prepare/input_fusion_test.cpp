// One motion from two sensors of the foot point.
#include "host_sim/identification/prepare/input_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/support/reference_road.hpp"

namespace input_fusion_test {
namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;
using sample::sine;

constexpr double period = 1e-3;

// Point. Without noise both sensors say the same sine; the fusion keeps it up to (ωh)⁴/240 = 5e-6 at 30 Hz and the
// ends.
TEST(FusedDisplacement, KeepsWhatBothSensorsSay) {
  constexpr std::size_t n = 4000;
  const double hz = 30.0, omega = 2.0 * std::numbers::pi * hz;
  const auto z = sine(1e-3, hz, n);
  auto a = z;
  for (double& v : a) v *= -omega * omega;
  const auto fused = identification::fused_displacement(z, a, 2e-5, 0.05, period);
  for (std::size_t k = 200; k + 200 < n; ++k) EXPECT_NEAR(fused[k], z[k], 2e-5 * 1e-3);
  EXPECT_FALSE(identification::disagree(z, a, 2e-5, 0.05, period));
}

// Law. The error of the fusion has the spectrum 1/(1/σ_z² + ω⁴/σ_a²) a sample: its variance over all frequencies, a
// tenth of σ_z² here, is reached within the scatter of 60 000 samples correlated over some 20.
TEST(FusedDisplacement, IsAsGoodAsBothSensorsTogether) {
  constexpr std::size_t n = 60'000;
  support::NormalNoise noise(11);
  const double sz = 2e-5, sa = 0.05;
  std::vector<double> z(n), a(n);
  for (double& v : z) v = sz * noise();
  for (double& v : a) v = sa * noise();
  const auto fused = identification::fused_displacement(z, a, sz, sa, period);
  double variance = 0.0;
  for (const double v : fused) variance += v * v / static_cast<double>(n);
  double expected = 0.0;
  constexpr int steps = 100'000;
  for (int i = 0; i < steps; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / steps;
    const double d2 = std::pow(2.0 * std::sin(0.5 * angle), 2), m = 1.0 - d2 / 12.0;
    const double w = std::pow(sz / (period * period * sa), 2);
    // z = (Z + κ h² G M A)/(1 + κ G²): from both noises
    const double below = 1.0 + w * d2 * d2;
    expected += (sz * sz + std::pow(w * period * period * d2 * m * sa, 2)) / (below * below) / steps;
  }
  EXPECT_LT(expected, 0.1 * sz * sz);
  EXPECT_NEAR(variance / expected, 1.0, 5.0 * std::sqrt(2.0 * 40.0 / n)) << "seed 11";
  EXPECT_FALSE(identification::disagree(z, a, sz, sa, period)) << "seed 11";
}

// A sensor that is 2 % wrong is no second opinion.
TEST(FusedDisplacement, NoticesSensorsThatDisagree) {
  const auto z = sine(5e-3, 5.0, 20'000);
  auto a = z;
  const double omega = 2.0 * std::numbers::pi * 5.0;
  for (double& v : a) v *= -1.02 * omega * omega;
  EXPECT_TRUE(identification::disagree(z, a, 2e-5, 0.05, period));
}

// Law. Above 40 Hz a sine of 60 Hz counts with half the square of its amplitude (the edge is ± 16 Hz wide), one of 12
// Hz and white noise with nothing; the variance of 20 000 samples of that scatters by 1 %.
TEST(FootPoint, HasAVarianceAboveWhatIsKnown) {
  support::NormalNoise noise(3);
  auto shaken = sine(3.0, 60.0, 20'000);
  const auto slow = sine(5.0, 12.0, 20'000);
  for (std::size_t k = 0; k < shaken.size(); ++k) shaken[k] += slow[k] + 0.5 * noise();
  const identification::Window all{0, shaken.size()};
  EXPECT_NEAR(identification::variance_above(40.0, shaken, all, 0.5, period), 4.5, 0.1) << "seed 3";
}

}  // namespace
}  // namespace input_fusion_test
