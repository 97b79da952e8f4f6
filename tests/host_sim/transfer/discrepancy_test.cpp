// A rest of the component's force: found on the first rig, and what it makes of the parameters.
#include "host_sim/transfer/posterior/discrepancy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/signal/spectrum.hpp"
#include "tests/host_sim/transfer/linear_pair.hpp"

namespace {

namespace id = host_sim::identification;
namespace transfer = host_sim::transfer;
using Complex = std::complex<double>;
using model::Channel;

/// Σ factor(f)·part of a signal between two frequencies: by direct sums over the lines of the whole length.
std::vector<double> part_between(const std::vector<double>& signal, double from, double to, Complex factor) {
  const std::size_t n = signal.size() / 2 * 2;
  host_sim::RealTransform transform(n);
  const auto spectrum = transform(std::span<const double>(signal).first(n));
  const double line = linear_pair::rate / static_cast<double>(n),
               turn = 2.0 * std::numbers::pi / static_cast<double>(n);
  std::vector<double> part(signal.size());
  for (auto k = static_cast<std::size_t>(std::ceil(from / line)); static_cast<double>(k) * line < to; ++k) {
    const Complex x = 2.0 / static_cast<double>(n) * factor * spectrum[k],
                  step = std::polar(1.0, turn * static_cast<double>(k));
    Complex phase = 1.0;
    for (std::size_t i = 0; i < n; ++i, phase *= step) part[i] += (x * phase).real();
  }
  return part;
}

constexpr double lowest = 4.5, highest = 6.5;  // one of identification::noise_band_edges
const std::string tolerance = "[tolerance]\n\"suspension.stiffness\" = 0.1\n";

/// The spring's recording with `delta` times its own force more in that band.
firmware::Recording with_rest(const firmware::RigDescription& rig, Complex delta, double seconds = 40.0) {
  firmware::Recording recording = linear_pair::recorded(rig, seconds);
  std::vector<double>& force = recording[Channel::F];
  const std::vector<double> rest = part_between(force, lowest, highest, delta);
  for (std::size_t k = 0; k < force.size(); ++k) force[k] += rest[k];
  return recording;
}

transfer::Discrepancy found_in(const linear_pair::Problem& p, std::vector<id::FreeParameter> parameters) {
  id::Fit fit = id::fit(p.problem, p.given, std::move(parameters));
  if (!fit.parameters.empty()) id::refresh_jacobian(p.problem, fit);
  return transfer::find_discrepancy(p.problem, fit, fit.covariance());
}

// Point. (1): 5 % of the force, a quarter period ahead so that no stiffness imitates it, between 4.5 and 6.5 Hz. In
// that band the whole rest is that: 2 Hz are 80 lines of 40 s, of which the window mixes two at each end with their
// neighbours, 5 % of the power and 2.5 % of its root. Elsewhere there is nothing but noise.
TEST(TransferDiscrepancy, IsFoundInItsBandWithItsSize) {
  const auto rig = linear_pair::bench();
  const transfer::Discrepancy found = found_in(linear_pair::problem_of(rig, with_rest(rig, {0.0, 0.05})), {});
  EXPECT_TRUE(found.measured);
  EXPECT_EQ(found.channel, Channel::F);
  ASSERT_TRUE(found.any());
  for (const auto& band : found.bands) {
    if (band.lowest == lowest) {
      EXPECT_NEAR(band.relative / 0.05, 1.0, 0.03);
      EXPECT_GT(band.significance, 50.0);
    } else if (band.highest < lowest - 1.0 || band.lowest > highest + 1.0) {
      EXPECT_EQ(band.relative, 0.0) << band.lowest << " Hz";
    }
  }
  EXPECT_EQ(found.relative_at(5.5), found.relative_at(4.5));
  EXPECT_GT(found.relative_at(5.5), 0.0);
  EXPECT_EQ(found.relative_at(30.0), 0.0);
}

// Law. A component that is as described leaves nothing to carry over: 13 bands exceed three standard deviations once in
// 60 recordings.
TEST(TransferDiscrepancy, IsNotFoundInNoise) {
  const auto rig = linear_pair::bench();
  EXPECT_FALSE(found_in(linear_pair::problem_of(rig, linear_pair::recorded(rig, 40.0)), {}).any());
}

// Point. (2) of a spring alone: F δ in the band moves the stiffness by δ w in phase and not at all a quarter period
// away, w: the band's share of the power that the fit weighs; of a linear spring with white noise Σ_b|F|²/Σ|F|². So V =
// ½ (δ w)². The window's ends and the prior leave a few per cent of w.
TEST(TransferDiscrepancy, WidensWhatItCouldHaveMoved) {
  const auto rig = linear_pair::bench(tolerance);
  const linear_pair::Problem p = linear_pair::problem_of(rig, with_rest(rig, {0.0, 0.05}));
  ASSERT_EQ(p.space.common.size(), 1U);
  const transfer::Discrepancy found = found_in(p, p.space.common);
  ASSERT_TRUE(found.any());
  const std::vector<double>& force = p.problem.samples().front().recording[Channel::F];
  const auto power_of = [](const std::vector<double>& values) {
    double sum = 0.0;
    for (const double v : values) sum += v * v;
    return sum;
  };
  const double all = power_of(part_between(force, 0.05, 60.0, 1.0));
  double expected = 0.0;
  for (const auto& band : found.bands) {
    if (!(band.relative > 0.0)) continue;
    const double share = power_of(part_between(force, std::max(band.lowest, 0.05), band.highest, 1.0)) / all;
    expected += 0.5 * std::pow(band.relative * share, 2);
  }
  const double scale = p.space.common.front().scale / linear_pair::stiffness;  // of u in relative stiffness
  EXPECT_NEAR(std::sqrt(found.widening(0, 0)) * scale / std::sqrt(expected), 1.0, 0.1);
}

}  // namespace
