// Faults of a recording as they act on samples, against closed forms.
#include "host_sim/identification/predict/recording_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using host_sim::identification::drifted;
using host_sim::identification::FaultKind;
using host_sim::identification::Hypothesis;
using host_sim::identification::PlacedFault;
using host_sim::identification::true_channels;
using host_sim::identification::with_faults;
using model::Channel;

constexpr double period = 1e-3, two_pi = 2.0 * std::numbers::pi;

std::vector<double> cosine(double frequency, std::size_t count, double late = 0.0, double stretch = 0.0) {
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) {
    const double t = period * static_cast<double>(k);
    values.push_back(std::cos(two_pi * frequency * (t + stretch * t - late)));
  }
  return values;
}

PlacedFault fault(FaultKind kind, std::vector<double> values, int order = 1) {
  PlacedFault placed;
  placed.kind = kind;
  placed.channels = {Channel::F};
  placed.order = order;
  placed.fitted.assign(values.size(), true);
  placed.values = std::move(values);
  return placed;
}

// (1): a clock that is late by 2.3 ms and slow by 300 ppm shows the signal then. 90 Hz is the fastest that is fitted;
// the bound is what the header of value_between() says.
TEST(RecordingFaults, AClockShowsAnotherInstant) {
  for (const double frequency : {1.0, 12.0, 90.0}) {
    const auto seen =
        with_faults({fault(FaultKind::clock, {2.3e-3, 3e-4})}, Channel::F, cosine(frequency, 5000), period);
    const auto expected = cosine(frequency, 5000, 2.3e-3, 3e-4);
    const double bound = frequency < 50.0 ? 1e-6 : 2e-4;
    for (std::size_t k = 10; k < 4900; ++k) ASSERT_NEAR(seen[k], expected[k], bound) << frequency << " Hz, " << k;
  }
  // Another channel keeps its time.
  EXPECT_EQ(with_faults({fault(FaultKind::clock, {2.3e-3, 3e-4})}, Channel::x_act, cosine(5.0, 100), period),
            cosine(5.0, 100));
}

/// A Butterworth low-pass by its polynomials: 1/(1 + s), 1/(1 + √2 s + s²), 1/(1 + 2s + 2s² + s³), 1/(1 + 2.6131 (s +
/// s³) + 3.4142 s² + s⁴).
std::complex<double> gain_of(const PlacedFault& filter, double frequency) {
  const double corner = filter.values[0];
  const double analogue = frequency / corner;
  const double digital = std::tan(0.5 * two_pi * frequency * period) / std::tan(0.5 * two_pi * corner * period);
  const std::complex<double> s(0.0, filter.digital ? digital : analogue);
  switch (filter.order) {
    case 1:
      return 1.0 / (1.0 + s);
    case 2:
      return 1.0 / (1.0 + std::numbers::sqrt2 * s + s * s);
    case 3:
      return 1.0 / (1.0 + 2.0 * s + 2.0 * s * s + s * s * s);
    default:
      const double a = std::sqrt(4.0 + 2.0 * std::numbers::sqrt2), b = 2.0 + std::numbers::sqrt2;
      return 1.0 / (1.0 + a * s + b * s * s + a * s * s * s + s * s * s * s);
  }
}

std::vector<PlacedFault> filters(std::initializer_list<double> corners) {
  std::vector<PlacedFault> list;
  for (const int order : {1, 2, 3, 4}) {
    for (const bool digital : {false, true}) {
      for (const double corner : corners) {
        list.push_back(fault(FaultKind::common_filter, {corner}, order));
        list.back().digital = digital;
      }
    }
  }
  return list;
}

/// A signal after a filter, or after the inverse of one.
std::vector<double> behind(const PlacedFault& filter, const std::vector<double>& values) {
  return with_faults({filter}, Channel::F, before_filter_of_input({filter}, Channel::F, values, period), period);
}

void expect_gain(const PlacedFault& filter, std::complex<double> gain, double frequency, std::size_t first) {
  const auto seen = behind(filter, cosine(frequency, first + 500));
  for (std::size_t k = first; k < first + 490; ++k) {
    const double phase = two_pi * frequency * period * static_cast<double>(k) + std::arg(gain);
    ASSERT_NEAR(seen[k], std::abs(gain) * std::cos(phase), 1e-3 * std::max(1.0, std::abs(gain)))
        << "order " << filter.order << (filter.digital ? " digital" : " analogue") << ", corner " << filter.values[0]
        << ", " << frequency << " Hz";
  }
}

// (2b): the inverse has the inverse gain and phase, at corners above what is fitted.
TEST(RecordingFaults, AnInverseFilterUndoesIt) {
  for (PlacedFault& inverse : filters({60.0, 390.0})) {
    inverse.inverse = true;
    for (const double frequency : {0.0, 12.0, 60.0, 90.0}) {
      expect_gain(inverse, 1.0 / gain_of(inverse, frequency), frequency, 10);
    }
  }
}

// (2b): what is beyond 160 Hz of 1 kHz is no larger behind the inverse than the inverse of 160 Hz makes it, by a
// factor.
TEST(RecordingFaults, AnInverseFilterIsBounded) {
  for (PlacedFault& inverse : filters({60.0})) {
    inverse.inverse = true;
    const auto seen = behind(inverse, cosine(430.0, 500));
    const double largest = *std::max_element(seen.begin() + 10, seen.end() - 10);
    EXPECT_LT(largest, 5.0 / std::abs(gain_of(inverse, 160.0))) << inverse.order;
  }
}

// (2): gain and phase at 12, 60 and 90 Hz, after 1 s; corners from 20 to 390 Hz.
TEST(RecordingFaults, AFilterHasItsGainAndPhase) {
  for (const PlacedFault& filter : filters({20.0, 150.0, 390.0})) {
    for (const double frequency : {0.0, 12.0, 60.0, 90.0})
      expect_gain(filter, gain_of(filter, frequency), frequency, 1000);
  }
}

// (3)
TEST(RecordingFaults, HumIsAddedToItsChannels) {
  const std::vector<double> silence(100, 0.0);
  const auto seen = with_faults({fault(FaultKind::mains_hum, {50.0, 0.3, -0.4})}, Channel::F, silence, period);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double phase = two_pi * 50.0 * period * static_cast<double>(k);
    ASSERT_NEAR(seen[k], 0.3 * std::cos(phase) - 0.4 * std::sin(phase), 1e-12);
  }
}

// (4): value at both ends and in the middle; with κ the middle is reached early.
TEST(RecordingFaults, AParameterDrifts) {
  const model::RigParameters<double> rig = sample::bench().rig;
  PlacedFault drift = fault(FaultKind::drift, {-0.2, 0.0});
  drift.channels.clear();
  drift.path = "suspension.damping";
  const auto at = [&](double share) {
    return drifted(rig, {drift}, share).suspension.damping / rig.suspension.damping;
  };
  EXPECT_NEAR(at(0.0), 1.0, 1e-12);
  EXPECT_NEAR(at(0.5), 0.9, 1e-12);
  EXPECT_NEAR(at(1.0), 0.8, 1e-12);
  drift.values[1] = 3.0;
  EXPECT_NEAR(at(0.0), 1.0, 1e-12);
  EXPECT_NEAR(at(0.5), 1.0 - 0.2 * (1.0 - std::exp(-1.5)) / (1.0 - std::exp(-3.0)), 1e-12);
  EXPECT_NEAR(at(1.0), 0.8, 1e-12);
}

// A drift of 50 % in the steps of the prediction, 0.1 s of 60, against steps of one sample: the force differs by less
// than 1e-4 of its rms.
TEST(RecordingFaults, StepsOfADriftAreSmallEnough) {
  const firmware::RigDescription d = sample::bench();
  Hypothesis hypothesis;
  hypothesis.rig = d.rig;
  PlacedFault drift = fault(FaultKind::drift, {-0.5, 0.0});
  drift.channels.clear();
  drift.path = "suspension.damping";
  hypothesis.faults = {drift};
  const auto recordings = sample::prepared(d, d, host_sim::identification::Use::fitted, 60.0);
  const host_sim::SimulationInput& input = recordings.front().input;
  const auto start = host_sim::resting(d.rig, input);
  const host_sim::RigVariation each_sample{1, [&](std::size_t k) {
                                             const double share =
                                                 static_cast<double>(k) / static_cast<double>(input.size());
                                             return drifted(d.rig, hypothesis.faults, share);
                                           }};
  const auto coarse = true_channels(hypothesis, recordings.front(), input, start, 0, {})[index(Channel::F)];
  const auto fine = host_sim::simulate(d.rig, input, start, 0, 1, each_sample)[index(Channel::F)];
  double error = 0.0, size = 0.0;
  for (std::size_t k = 0; k < fine.size(); ++k) {
    error += std::pow(coarse[k] - fine[k], 2);
    size += fine[k] * fine[k];
  }
  EXPECT_LT(std::sqrt(error / size), 1e-4);
}

}  // namespace
