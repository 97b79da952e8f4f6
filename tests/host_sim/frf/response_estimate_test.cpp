// Frequency responses of recordings: joined, through an instrument, and what is refused.
#include "host_sim/frf/response_estimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "tests/host_sim/frf/scipy_numbers.hpp"
#include "tests/host_sim/frf/signals.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::InputError;
using firmware::Recording;
using host_sim::frf::Complex;
using host_sim::frf::Estimator;
using host_sim::frf::OutputResponse;
using host_sim::frf::Request;
using host_sim::frf::Responses;
using model::Channel;
using support::filtered;
using support::recording;
using support::sum;
using support::white;

constexpr double pi = std::numbers::pi;

Responses responses(const std::vector<Recording>& recordings, const Request& request) {
  return host_sim::frf::estimate_responses(recordings, request);
}

Request request(Channel input, std::vector<Channel> outputs, double block) {
  Request request;
  request.input = input;
  request.outputs = std::move(outputs);
  request.blocks.block = block;
  return request;
}

/// The share of points from 1 to `to` Hz whose bounds hold the truth, of magnitude and of phase.
template <class Truth>
std::array<double, 2> held(const Responses& r, const Truth& truth, double to) {
  std::array<double, 2> count{};
  double points = 0.0;
  const OutputResponse& o = r.outputs.front();
  for (std::size_t k = 0; k < r.frequency.size() && r.frequency[k] <= to; ++k) {
    if (r.frequency[k] < 1.0) continue;
    points += 1.0;
    const Complex h = truth(r.frequency[k]);
    if (std::abs(h) >= o.magnitude_ci95[k].low && std::abs(h) <= o.magnitude_ci95[k].high) count[0] += 1.0;
    const double middle = 0.5 * (o.phase_ci95[k].low + o.phase_ci95[k].high);
    const double half = 0.5 * (o.phase_ci95[k].high - o.phase_ci95[k].low);
    if (std::abs(std::remainder(std::arg(h) - middle, 2.0 * pi)) <= half) count[1] += 1.0;
  }
  return {count[0] / points, count[1] / points};
}

// Golden. From recording to response: SciPy's S_xy/S_xx, S_yy/S_yx, their mean and coherence, line by line to 1e-10 –
// where the signals have power, as these have everywhere.
TEST(Responses, AgreeWithScipy) {
  const support::ScipyNumbers scipy = support::scipy_numbers();
  const Recording measured = recording(scipy.rate, {{Channel::z_r, scipy.x}, {Channel::F_w, scipy.y}});
  for (const auto& [scheme, lines] : scipy.spectra) {
    Request wish = request(Channel::z_r, {Channel::F_w}, static_cast<double>(scheme.length) / scipy.rate);
    wish.blocks.overlap = 1.0 - static_cast<double>(scheme.hop) / static_cast<double>(scheme.length);
    wish.blocks.window = scheme.window;
    wish.blocks.detrend = scheme.detrend;
    wish.compensate_delay = false;
    for (const Estimator estimator : {Estimator::h1, Estimator::h2, Estimator::hv}) {
      wish.estimator = estimator;
      const Responses r = responses({measured}, wish);
      ASSERT_EQ(r.blocks.scheme.length, scheme.length);
      ASSERT_EQ(r.blocks.scheme.hop, scheme.hop);
      ASSERT_EQ(r.frequency.size() + 2, lines.size());
      for (std::size_t k = 1; k + 1 < lines.size(); ++k) {
        const auto& line = lines[k];
        const Complex h1 = line.xy / line.xx, h2 = line.yy / std::conj(line.xy);
        const Complex expected = estimator == Estimator::h1   ? h1
                                 : estimator == Estimator::h2 ? h2
                                                              : std::sqrt(std::abs(h2 / h1)) * h1;
        const OutputResponse& o = r.outputs.front();
        EXPECT_NEAR(o.magnitude[k - 1] / std::abs(expected), 1.0, 1e-10) << name(estimator) << ' ' << line.frequency;
        EXPECT_NEAR(std::remainder(o.phase[k - 1] - std::arg(expected), 2.0 * pi), 0.0, 1e-10) << line.frequency;
        EXPECT_NEAR(o.coherence[k - 1], std::norm(line.xy) / line.xx / line.yy, 1e-10) << line.frequency;
      }
    }
  }
}

// Journey. All outputs over one input, of recordings that are joined: what is known of each filter lies in its bounds,
// and two recordings know more than one.
TEST(Responses, JoinRecordingsOfSeveralChannels) {
  const std::vector<double> taps{0.5, 1.0, 0.3}, other{-2.0, 1.0};
  std::vector<Recording> recordings;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto x = white(20000, 1.0, seed);
    const auto noise = white(x.size(), 0.5, seed, 1);
    recordings.push_back(recording(
        200.0, {{Channel::z_r, x}, {Channel::F_w, sum(filtered(x, taps), noise)}, {Channel::z_w, filtered(x, other)}}));
  }
  const Request wish = request(Channel::z_r, {Channel::z_w, Channel::F_w}, 2.0);
  const Responses all = responses(recordings, wish), one = responses({recordings[0]}, wish);
  EXPECT_EQ(all.averages, 3U * 99U);
  EXPECT_NEAR(all.effective_averages, 3.0 * one.effective_averages, 1e-9);
  EXPECT_NEAR(all.duration, 300.0, 1e-9);
  EXPECT_EQ(all.frequency.size(), 199U) << "without 0 and 100 Hz";
  EXPECT_NEAR(all.frequency.front(), 0.5, 1e-12);
  ASSERT_EQ(all.outputs.size(), 2U);
  EXPECT_EQ(all.outputs[0].output, Channel::z_w);
  EXPECT_EQ(all.outputs[1].output, Channel::F_w);
  for (std::size_t k = 0; k < all.frequency.size(); ++k) {
    const Complex h = support::response(other, all.frequency[k] / 200.0);
    EXPECT_LT(std::abs(std::polar(all.outputs[0].magnitude[k], all.outputs[0].phase[k]) - h), 0.05);
  }
  Responses of_force = all;
  std::swap(of_force.outputs[0], of_force.outputs[1]);
  const auto [magnitude, phase] = held(
      of_force, [&](double f) { return support::response(taps, f / 200.0); }, 99.0);
  EXPECT_GT(magnitude, 0.91) << "of 197 points 95 % ± 1.6 % standard error";
  EXPECT_GT(phase, 0.91);
  const auto& wide = one.outputs[1].magnitude_ci95[50];
  const auto& narrow = all.outputs[1].magnitude_ci95[50];
  EXPECT_LT(narrow.high - narrow.low, 0.75 * (wide.high - wide.low)) << "1/√3 but for chance";
}

// Law, in a loop made by hand: x = r − y delayed, y = 2 x + n. With n as large as y, H1 tends to something between 2
// and the inverse of the feedback; through r the bounds hold 2 as often as they promise.
TEST(Responses, ThroughAnInstrumentForgetCirculatingNoise) {
  const std::uint64_t seed = 50;
  std::array<double, 2> by_instrument{}, direct{};
  constexpr int runs = 10;
  for (int run = 0; run < runs; ++run) {
    const auto r = white(40000, 1.0, seed, static_cast<std::uint32_t>(run));
    const auto n = white(r.size(), 1.5, seed + 1, static_cast<std::uint32_t>(run));
    std::vector<double> x(r.size(), 0.0), y(r.size(), 0.0);
    for (std::size_t k = 1; k < r.size(); ++k) {
      x[k] = r[k] - 0.4 * y[k - 1];
      y[k] = 2.0 * x[k] + n[k];
    }
    const Recording loop = recording(1000.0, {{Channel::z_r, r}, {Channel::x_act, x}, {Channel::F, y}});
    Request wish = request(Channel::x_act, {Channel::F}, 0.5);
    const auto truth = [](double) { return Complex(2.0); };
    const auto of_direct = held(responses({loop}, wish), truth, 499.0);
    wish.instrument = Channel::z_r;
    wish.estimator = Estimator::instrument;
    const auto of_instrument = held(responses({loop}, wish), truth, 499.0);
    for (std::size_t i = 0; i < 2; ++i) {
      direct[i] += of_direct[i] / runs;
      by_instrument[i] += of_instrument[i] / runs;
    }
  }
  for (const double share : by_instrument) {  // 2490 points
    EXPECT_GT(share, 0.93) << "seed " << seed;
    EXPECT_LT(share, 0.97) << "seed " << seed;
  }
  EXPECT_LT(direct[0], 0.35);
  EXPECT_LT(direct[1], 0.35);
}

// The rig itself: the paper's linear component, k + jωb, in the closed loop of firmware and machine, over a good road,
// with a force sensor of 500 N noise. H1 of F over x_act is wrong by far more than its bounds where the road has little
// to say; through z_r the component comes out as it is.
TEST(Responses, OfAComponentInTheClosedLoopNeedTheRoadAsInstrument) {
  firmware::RigDescription rig = support::rig("paper_linear");
  rig.noise[model::index(Channel::F)] = 500.0;
  firmware::IsoRoad road;
  road.roughness = 16e-6;
  road.bandwidth = 100.0;
  std::vector<Recording> recordings;
  for (const std::uint64_t seed : {1U, 2U}) {
    road.seed = seed;
    host_sim::RunOptions options;
    options.seed = seed;
    const auto run = host_sim::run_closed_loop(rig, firmware::drive_over(road, rig.sample_rate, 120000), options);
    ASSERT_EQ(run.trip.reason, firmware::Reason::reference_ended);
    recordings.push_back(run.recording);
  }
  const auto truth = [](double f) { return Complex(31500.0, 1140.0 * 2.0 * pi * f); };
  Request wish = request(Channel::x_act, {Channel::F}, 4.0);
  const Responses direct = responses(recordings, wish);
  wish.instrument = Channel::z_r;
  wish.estimator = Estimator::instrument;
  const Responses by_road = responses(recordings, wish);
  const auto [m1, p1] = held(direct, truth, 40.0);
  const auto [m2, p2] = held(by_road, truth, 40.0);
  for (const double share : {m1, p1}) EXPECT_LT(share, 0.35);
  for (const double share : {m2, p2}) EXPECT_GT(share, 0.90) << "of 157 points 95 % ± 1.7 % standard error";
  const auto relative = [&](const Responses& r, double f) {
    const auto k = static_cast<std::size_t>(std::lround(f / r.resolution())) - 1;
    return r.outputs[0].magnitude[k] / std::abs(truth(r.frequency[k]));
  };
  EXPECT_LT(relative(direct, 8.0), 0.75);
  EXPECT_GT(relative(direct, 20.0), 1.5);
  EXPECT_NEAR(relative(by_road, 8.0), 1.0, 0.12) << "its bounds are ± 12 % wide there";
  EXPECT_EQ(by_road.instrument_coherence.size(), by_road.frequency.size());
  EXPECT_TRUE(direct.instrument_coherence.empty());
}

TEST(Responses, RefuseWhatCannotBeAnswered) {
  const auto x = white(20000, 1.0, 1), y = white(20000, 1.0, 2);
  const Recording good = recording(1000.0, {{Channel::z_r, x}, {Channel::F_w, y}}, "good.csv");
  const auto refused = [](const std::vector<Recording>& recordings, const Request& wish, const char* words) {
    try {
      static_cast<void>(responses(recordings, wish));
      ADD_FAILURE() << "not refused: " << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  };
  const Request wish = request(Channel::z_r, {Channel::F_w}, 1.0);
  refused({good}, request(Channel::z_r, {Channel::F_w, Channel::z_w}, 1.0),
          "good.csv: there is no channel z_w, expected");
  refused({good, recording(500.0, {{Channel::z_r, x}, {Channel::F_w, y}}, "slow.csv")}, wish,
          "slow.csv: the sample rate is 500 Hz, expected 1000 Hz as in good.csv");
  refused({recording(1000.0, {{Channel::z_r, std::vector<double>(20000, 0.5)}, {Channel::F_w, y}}, "still.csv")}, wish,
          "still.csv: channel z_r never changes, expected a signal");
  const Recording stub =
      recording(1000.0, {{Channel::z_r, white(900, 1.0, 3)}, {Channel::F_w, white(900, 1.0, 4)}}, "short.csv");
  refused({good, stub}, wish,
          "short.csv: the recording is too short: 0.9 s, expected at least 2 s for two blocks of 1 s");
  Request automatic = wish;
  automatic.blocks.block.reset();
  refused({stub}, automatic,
          "short.csv: the recording is too short: 0.9 s, expected at least 6.25 s for a peak 0.48 Hz wide, or other "
          "--lowest-damping");
}

}  // namespace
