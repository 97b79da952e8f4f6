// Late outputs: found, compensated, and what happens if they are not.
#include "host_sim/frf/delay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/frf/response_estimate.hpp"
#include "tests/host_sim/frf/signals.hpp"

namespace delay_test {
namespace {

using firmware::Recording;
using host_sim::WindowShape;
using host_sim::frf::CrossSpectra;
using host_sim::frf::find_delay;
using host_sim::frf::OutputResponse;
using host_sim::frf::Request;
using host_sim::frf::Responses;
using host_sim::frf::window_match;
using model::Channel;
using support::recording;
using support::sum;
using support::white;

constexpr double pi = std::numbers::pi;

std::vector<double> delayed(std::size_t samples) {
  std::vector<double> taps(samples + 1, 0.0);
  taps.back() = 1.0;
  return taps;
}

Request request(double block, bool compensate = true) {
  Request request;
  request.outputs = {Channel::F_w};
  request.blocks.block = block;
  request.compensate_delay = compensate;
  return request;
}

Responses responses(const Recording& recording, const Request& request) {
  return host_sim::frf::estimate_responses(std::span(&recording, 1), request);
}

// Point. Equation (1): 1 − d/N for a rectangular window; for Hann its first term 1 − (2π²/3)(d/N)², and by half a block
// 1/6.
TEST(WindowMatch, IsTheShareOfABlockThatStillBelongs) {
  const auto box = host_sim::make_window(WindowShape::rectangular, 100);
  EXPECT_DOUBLE_EQ(window_match(box, 0), 1.0);
  EXPECT_DOUBLE_EQ(window_match(box, 30), 0.7);
  EXPECT_DOUBLE_EQ(window_match(box, -30), 0.7);
  EXPECT_EQ(window_match(box, 100), 0.0);
  const auto hann = host_sim::hann_window(1000);
  EXPECT_NEAR(1.0 - window_match(hann, 20), 2.0 * pi * pi / 3.0 * 4e-4, 1e-5);
  EXPECT_NEAR(window_match(hann, 500), 1.0 / 6.0, 1e-9);
}

// The sign, once and for all: an output that is the input 8 samples later has the phase −ωτ – at 10 Hz and 1 kHz −28.8°
// – and magnitude 1. Compensated or not: 8 samples of a block of 1000 do not count.
TEST(Delay, HasThePhaseMinusOmegaTau) {
  const auto x = white(20000, 1.0, 1);
  const Recording late = recording(1000.0, {{Channel::z_r, x}, {Channel::F_w, support::filtered(x, delayed(8))}});
  const Responses r = responses(late, request(1.0));
  const OutputResponse& o = r.outputs.front();
  EXPECT_FALSE(o.compensated);
  for (std::size_t k = 0; r.frequency[k] <= 50.0; ++k) {
    EXPECT_NEAR(o.phase[k], -2.0 * pi * r.frequency[k] * 0.008, 0.02) << r.frequency[k];
    EXPECT_NEAR(o.magnitude[k], 1.0, 0.02) << r.frequency[k];
  }
  EXPECT_NEAR(o.phase[9] * 180.0 / pi, -28.8, 0.5);
  ASSERT_TRUE(o.delay.has_value());
  EXPECT_EQ(*o.delay, 8);
}

// A delay of a fifth of the block: uncompensated, H is r(0.2) = 0.77 of what it should be, and the bounds – built on a
// coherence that is too low for the wrong reason – miss it; compensated, it is 1 within them. The phase runs on to
// −2π · 100 · 0.2 where it is unwrapped.
TEST(Delay, OfAPartOfTheBlockBiasesUnlessCompensated) {
  const std::uint64_t seed = 3;
  const auto x = white(60000, 1.0, seed);
  const auto y = sum(support::filtered(x, delayed(200)), white(x.size(), 0.1, seed, 5));
  const Recording late = recording(1000.0, {{Channel::z_r, x}, {Channel::F_w, y}});
  Request with = request(1.0);
  with.unwrap = true;
  const Responses compensated = responses(late, with), not_compensated = responses(late, request(1.0, false));
  const double expected = window_match(host_sim::hann_window(1000), 200);
  ASSERT_NEAR(expected, 0.7671, 1e-4);  // (1 − u)(2 + cos 2πu)/3 + sin(2πu)/2π at u = 0.2

  const auto mean = [](const OutputResponse& o) {
    double total = 0.0;
    for (const double magnitude : o.magnitude) total += magnitude;
    return total / static_cast<double>(o.magnitude.size());
  };
  const auto held = [](const OutputResponse& o) {
    std::size_t count = 0;
    for (const auto& bounds : o.magnitude_ci95) count += bounds.low <= 1.0 && 1.0 <= bounds.high ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(o.magnitude.size());
  };
  const OutputResponse &good = compensated.outputs[0], &bad = not_compensated.outputs[0];
  EXPECT_EQ(good.delay, std::optional<std::ptrdiff_t>(200));
  EXPECT_TRUE(good.compensated);
  EXPECT_FALSE(bad.compensated);
  EXPECT_NEAR(good.delay_bias, 1.0 - expected, 1e-12);
  EXPECT_NEAR(bad.delay_bias, 1.0 - expected, 1e-12) << "said even if nothing is done";
  EXPECT_NEAR(mean(good), 1.0, 0.003);
  EXPECT_NEAR(mean(bad), expected, 0.03) << "and |H| of a noisy estimate is a little too high";
  EXPECT_GT(held(good), 0.93);
  EXPECT_LT(held(good), 0.97);
  EXPECT_LT(held(bad), 0.1);
  EXPECT_GT(good.coherence[100], 0.98);
  EXPECT_LT(bad.coherence[100], 0.75);
  EXPECT_NEAR(good.phase[99], -2.0 * pi * 100.0 * 0.2, 0.05) << "100 Hz, seed " << seed;
}

// An input that is late against its output – a sensor with a lag in z_r – is a negative delay.
TEST(Delay, MayBeNegative) {
  const auto y = white(40000, 1.0, 11);
  const Recording early = recording(1000.0, {{Channel::z_r, support::filtered(y, delayed(150))}, {Channel::F_w, y}});
  const Responses r = responses(early, request(0.5));
  EXPECT_EQ(r.outputs[0].delay, std::optional<std::ptrdiff_t>(-150));
  EXPECT_NEAR(r.outputs[0].magnitude[10], 1.0, 0.03);
  EXPECT_NEAR(r.outputs[0].phase[9], std::remainder(2.0 * pi * r.frequency[9] * 0.15, 2.0 * pi), 0.05);
}

// What has a phase but no delay – a differentiated or inverted signal – is not taken for late, nor is a signal with
// nothing of the input.
TEST(Delay, IsNotSeenWhereThereIsNone) {
  const std::uint64_t seed = 8;
  const auto x = white(40000, 1.0, seed);
  CrossSpectra spectra(1000.0, {2000, 1000}, 5, 1);
  const auto differentiated = support::filtered(x, {1.0, 0.0, -1.0}), inverted = support::filtered(x, {-1.0});
  const auto unrelated = white(x.size(), 1.0, seed, 4),
             late = sum(support::filtered(x, delayed(37)), white(x.size(), 2.0, seed, 9));
  const host_sim::frf::ShiftedSignal signals[] = {{x}, {differentiated}, {inverted}, {unrelated}, {late}};
  spectra.add(signals);
  ASSERT_TRUE(find_delay(spectra, 1).has_value());
  EXPECT_LE(std::abs(*find_delay(spectra, 1)), 1) << "centred a sample late";
  EXPECT_EQ(find_delay(spectra, 2), std::optional<std::ptrdiff_t>(0));
  EXPECT_EQ(find_delay(spectra, 3), std::nullopt) << "seed " << seed;
  EXPECT_EQ(find_delay(spectra, 4), std::optional<std::ptrdiff_t>(37)) << "four times as much noise power as signal";
}

}  // namespace
}  // namespace delay_test
