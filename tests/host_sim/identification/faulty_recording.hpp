// Recordings of tests/truth with a fault of the recorder: made without noise, changed, noise added behind.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "tests/support/reference_road.hpp"
#include "tests/truth/truth.hpp"

namespace sample {

/// A quarter car with linear suspension, 20 s at 1 kHz.
inline truth::Truth quarter_car(std::uint64_t seed, const std::string& group = "none:quarter_car") {
  truth::Wanted wanted;
  wanted.duration = 20.0;
  truth::Truth truth = truth::draw(group, seed, wanted);
  truth.records.resize(1);
  truth.records[0].duration = 20.0;
  return truth;
}

using Columns = std::map<std::string, std::vector<double>>;

/// The record without noise after `change`, with the noise that the description declares.
inline firmware::Recording changed_recording(const truth::Truth& truth, const std::function<void(Columns&)>& change,
                                             std::uint64_t noise_seed = 77) {
  truth::Record record = truth::simulate(truth, {20, false}).front();
  change(record.channels);
  support::NormalNoise noise(noise_seed);
  for (auto& [channel, values] : record.channels) {
    const auto level = truth.noise.find(channel);
    if (level == truth.noise.end()) continue;
    for (double& v : values) v += level->second * noise();
  }
  return firmware::parse_recording_csv(truth::csv(truth, record), "rec.csv");
}

inline host_sim::identification::Diagnosis diagnosis_of(const truth::Truth& truth,
                                                        const std::function<void(Columns&)>& change) {
  return host_sim::identification::diagnose(
      firmware::parse_rig(truth::rig_toml(truth), "rig.toml"),
      {{changed_recording(truth, change), host_sim::identification::Use::shared}});
}

/// All records of a truth as they were drawn.
inline host_sim::identification::Diagnosis diagnosis_of_all(const truth::Truth& truth) {
  std::vector<host_sim::identification::Record> records;
  for (const truth::Record& record : truth::simulate(truth)) {
    records.push_back(
        {firmware::parse_recording_csv(truth::csv(truth, record), "rec.csv"), host_sim::identification::Use::shared});
  }
  return host_sim::identification::diagnose(firmware::parse_rig(truth::rig_toml(truth), "rig.toml"),
                                            std::move(records));
}

/// The value at `place` [samples] by a sinc interpolation through a Hann window of 2 × 16 samples.
inline double sinc_value(const std::vector<double>& values, double place) {
  constexpr int reach = 16;
  const auto nearest = static_cast<std::ptrdiff_t>(std::floor(place));
  double sum = 0.0, weights = 0.0;
  for (std::ptrdiff_t i = nearest - reach + 1; i <= nearest + reach; ++i) {
    const double x = place - static_cast<double>(i);
    const double sinc = std::abs(x) < 1e-12 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
    const double weight = sinc * (0.5 + 0.5 * std::cos(std::numbers::pi * x / (reach + 0.5)));
    const auto k =
        std::min<std::ptrdiff_t>(std::max<std::ptrdiff_t>(i, 0), static_cast<std::ptrdiff_t>(values.size()) - 1);
    sum += weight * values[static_cast<std::size_t>(k)];
    weights += weight;
  }
  return sum / weights;
}

/// Channels on a clock of their own: late by `offset` [s], slow by `rate` [1].
inline void put_on_clock(Columns& columns, const std::vector<std::string>& channels, double offset, double rate,
                         double sample_period = 1e-3) {
  for (const std::string& channel : channels) {
    std::vector<double>& values = columns.at(channel);
    std::vector<double> moved;
    for (std::size_t k = 0; k < values.size(); ++k) {
      moved.push_back(sinc_value(values, static_cast<double>(k) * (1.0 + rate) - offset / sample_period));
    }
    values = std::move(moved);
  }
}

/// A Butterworth low-pass of second order, integrated with steps of a twentieth of a sample on a sinc interpolation.
inline void put_through_filter(Columns& columns, const std::vector<std::string>& channels, double corner,
                               double sample_period = 1e-3) {
  constexpr int steps = 20;
  const double omega = 2.0 * std::numbers::pi * corner, h = sample_period / steps;
  for (const std::string& channel : channels) {
    std::vector<double>& values = columns.at(channel);
    std::vector<double> filtered{values.front()};
    double y = values.front(), v = 0.0;
    for (std::size_t k = 1; k < values.size(); ++k) {
      for (int i = 0; i < steps; ++i) {
        const double u = sinc_value(values, static_cast<double>(k - 1) + (i + 0.5) / steps);
        // Midpoint rule.
        const double ym = y + 0.5 * h * v;
        const double vm = v + 0.5 * h * (omega * omega * (u - y) - std::numbers::sqrt2 * omega * v);
        y += h * vm;
        v += h * (omega * omega * (u - ym) - std::numbers::sqrt2 * omega * vm);
      }
      filtered.push_back(y);
    }
    values = std::move(filtered);
  }
}

}  // namespace sample
