#include "host_sim/identification/predict/recording_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/identification/predict/low_pass.hpp"
#include "host_sim/identification/predict/sample_polynomial.hpp"
#include "host_sim/signal/weighted_sums.hpp"
#include "host_sim/signal/wide.hpp"

namespace host_sim::identification {

using model::Channel;

PlacedFault clock_fault(std::vector<Channel> channels, double offset, double rate) {
  PlacedFault fault;
  fault.kind = FaultKind::clock;
  fault.channels = std::move(channels);
  fault.values = {offset, rate};
  fault.fitted = {true, true};
  return fault;
}

PlacedFault filter_fault(std::vector<Channel> channels, double corner, int order) {
  PlacedFault fault;
  fault.kind = FaultKind::common_filter;
  fault.channels = std::move(channels);
  fault.order = order;
  fault.values = {corner};
  fault.fitted = {true};
  return fault;
}

bool PlacedFault::acts_on(Channel channel) const {
  return std::find(channels.begin(), channels.end(), channel) != channels.end();
}

bool alters(const std::vector<PlacedFault>& faults, Channel channel) {
  return std::any_of(faults.begin(), faults.end(), [&](const PlacedFault& fault) { return fault.acts_on(channel); });
}

bool drifts(const std::vector<PlacedFault>& faults) {
  return std::any_of(faults.begin(), faults.end(),
                     [](const PlacedFault& fault) { return fault.kind == FaultKind::drift; });
}

namespace {

/// moved[k] on the polynomial through samples[k] … samples[k + 5] at x + rate · k; moved holds zeros before.
RIGTWIN_WIDE void put_between(const double* samples, double x, double rate, double* moved, std::size_t count) {
  constexpr std::size_t piece = 64;
  std::array<double, piece> places;
  for (std::size_t first = 0; first < count; first += piece) {
    for (std::size_t j = 0; j < piece; ++j) places[j] = x + rate * static_cast<double>(first + j);
    const auto weights = weights_at_each(places);
    const std::size_t present = count - first < piece ? count - first : piece;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double* const sample = samples + first + i;
      for (std::size_t j = 0; j < present; ++j) moved[first + j] += weights[i][j] * sample[j];
    }
  }
}

}  // namespace

std::vector<double> shifted(const std::vector<double>& values, double offset, double rate, double period) {
  std::vector<double> moved(values.size());
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  const double late = -offset / period;
  const auto place = [&](std::ptrdiff_t k) { return static_cast<double>(k) * (1.0 + rate) + late; };
  std::ptrdiff_t k = 0;
  while (k < count) {
    const double whole = std::floor(place(k));
    const bool inside = whole >= 2.0 && whole <= static_cast<double>(count - 4);
    if (!inside) {
      moved[static_cast<std::size_t>(k)] = value_between(values, place(k));
      ++k;
      continue;
    }
    // As far as the same six samples stand around each place, but for k.
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(whole) - 2;
    const double x = place(k) - static_cast<double>(first), room = rate > 0.0 ? 3.0 - x : x - 2.0;
    std::ptrdiff_t end = count - polynomial_points + 1 - first + k;
    if (rate != 0.0) end = std::min(end, k + 1 + static_cast<std::ptrdiff_t>(std::min(room / std::abs(rate), 1e9)));
    end = std::min(end, count);
    const auto run = static_cast<std::size_t>(end - k);
    double* const to = moved.data() + k;
    if (rate == 0.0) {
      add_weighted_sums(weights_at(x).data(), polynomial_points, values.data() + first, to, run);
    } else {
      put_between(values.data() + first, x, rate, to, run);
    }
    k = end;
  }
  return moved;
}

namespace {

void add_hum(std::vector<double>& values, const PlacedFault& hum, Channel channel, double period) {
  const auto at = std::find(hum.channels.begin(), hum.channels.end(), channel) - hum.channels.begin();
  const auto c = static_cast<std::size_t>(1 + 2 * at);
  const double step = 2.0 * std::numbers::pi * hum.values[0] * period;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double phase = step * static_cast<double>(k);
    values[k] += hum.values[c] * std::cos(phase) + hum.values[c + 1] * std::sin(phase);
  }
}

/// A drifting parameter is renewed so often, [s] at least and [1] of the recording, with its value in the middle.
/// Derivation: of a change by 50 % each of 600 steps is 0.083 %, wrong by 0.024 % rms, which comes and goes faster than
/// 10 Hz: below 1e-4 of a signal whose sensitivity to the parameter is 1 (a test measures it). A smaller change needs
/// fewer steps for that: halved as often as the change is, so that a fit seldom meets another number of them, down to
/// 19, which are wrong by 1.5 % of the change. Half: twice the time for building models. Twice: 2e-4.
constexpr double drift_refresh = 0.05, drift_steps = 600.0, drift_of_steps = 0.5, fewest_drift_steps = 18.0;

/// Steps in which parameters drift.
double steps_of_drift(const std::vector<PlacedFault>& faults) {
  double largest = 0.0;
  for (const PlacedFault& fault : faults) {
    if (fault.kind == FaultKind::drift) largest = std::max(largest, std::abs(fault.values[0]));
  }
  double steps = drift_steps;
  for (double change = drift_of_steps; largest < 0.5 * change && steps > 2.0 * fewest_drift_steps; change *= 0.5) {
    steps *= 0.5;
  }
  return steps;
}

/// Those of `channels` that are not in `group`.
std::vector<Channel> without(const std::vector<Channel>& channels, const std::vector<Channel>& group) {
  std::vector<Channel> rest;
  for (const Channel channel : channels) {
    if (std::find(group.begin(), group.end(), channel) == group.end()) rest.push_back(channel);
  }
  return rest;
}

bool holds(const std::vector<Channel>& channels, Channel channel) {
  return std::find(channels.begin(), channels.end(), channel) != channels.end();
}

/// g of (4)
double warm_up(double s, double kappa) {
  return std::abs(kappa) < 1e-6 ? s : std::expm1(-kappa * s) / std::expm1(-kappa);
}

}  // namespace

std::vector<double> before_filter_of_input(const std::vector<PlacedFault>& faults, Channel channel,
                                           std::vector<double> values, double period) {
  if (values.empty()) return values;
  for (const PlacedFault& fault : faults) {
    if (fault.kind != FaultKind::common_filter || !fault.inverse || !fault.acts_on(channel)) continue;
    values = un_low_passed({fault.values[0], fault.order, fault.digital}, values, period);
  }
  return values;
}

std::vector<double> with_faults(const std::vector<PlacedFault>& faults, Channel channel, std::vector<double> values,
                                double period) {
  if (values.empty()) return values;
  for (const FaultKind kind : {FaultKind::common_filter, FaultKind::clock, FaultKind::mains_hum}) {
    for (const PlacedFault& fault : faults) {
      if (fault.kind != kind || fault.inverse || !fault.acts_on(channel)) continue;
      if (kind == FaultKind::common_filter) {
        values = low_passed({fault.values[0], fault.order, fault.digital}, values, period);
      }
      if (kind == FaultKind::clock) values = shifted(values, fault.values[0], fault.values[1], period);
      if (kind == FaultKind::mains_hum) add_hum(values, fault, channel, period);
    }
  }
  return values;
}

model::RigParameters<double> drifted(const model::RigParameters<double>& rig, const std::vector<PlacedFault>& faults,
                                     double share) {
  model::RigParameters<double> changed = rig;
  for (const PlacedFault& fault : faults) {
    if (fault.kind != FaultKind::drift) continue;
    double* const parameter = firmware::find_parameter(changed, fault.path);
    if (parameter != nullptr) *parameter *= 1.0 + fault.values[0] * warm_up(share, fault.values[1]);
  }
  return changed;
}

RigVariation variation_of(const model::RigParameters<double>& rig, const std::vector<PlacedFault>& faults,
                          std::size_t samples, double period) {
  if (!drifts(faults)) return {};
  const auto length = static_cast<double>(std::max<std::size_t>(samples, 1));
  const double every = std::max(drift_refresh / period, length / steps_of_drift(faults));
  return {std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(every))), [=](std::size_t k) {
            const double middle = (static_cast<double>(k) + 0.5 * every) / length;
            return drifted(rig, faults, std::min(middle, 1.0));
          }};
}

std::vector<PlacedFault> described_faults(const firmware::RecorderDescription& recorder, Channel input,
                                          const std::vector<Channel>& channels) {
  std::vector<PlacedFault> faults;
  const auto add = [&](PlacedFault fault) {
    if (fault.kind == FaultKind::drift || !fault.channels.empty()) faults.push_back(std::move(fault));
  };
  for (const auto& filter : recorder.common_filter) {
    const bool inverse = holds(filter.channels, input);
    PlacedFault fault =
        filter_fault(inverse ? without(channels, filter.channels) : filter.channels, filter.corner, filter.order);
    fault.digital = filter.digital;
    fault.inverse = inverse;
    add(std::move(fault));
  }
  for (const auto& clock : recorder.clock) {
    const bool of_input = holds(clock.channels, input);
    const double sign = of_input ? -1.0 : 1.0;
    add(clock_fault(of_input ? without(channels, clock.channels) : clock.channels, sign * clock.offset,
                    sign * 1e-6 * clock.ppm));
  }
  for (const auto& hum : recorder.hum) {
    PlacedFault fault;
    fault.kind = FaultKind::mains_hum;
    fault.channels = hum.channels;
    fault.values = {hum.frequency};
    for (const double amplitude : hum.amplitude) fault.values.insert(fault.values.end(), {amplitude, 0.0});
    fault.fitted.assign(fault.values.size(), false);
    add(std::move(fault));
  }
  for (const auto& drift : recorder.drift) {
    PlacedFault fault;
    fault.kind = FaultKind::drift;
    fault.path = drift.path;
    fault.values = {1e-2 * drift.per_cent, drift.bend};
    fault.fitted = {false, false};
    add(std::move(fault));
  }
  return faults;
}

firmware::RecorderDescription recorder_of(const std::vector<PlacedFault>& faults, Channel input,
                                          const std::vector<Channel>& channels) {
  firmware::RecorderDescription recorder;
  for (const PlacedFault& fault : faults) {
    switch (fault.kind) {
      case FaultKind::common_filter: {
        firmware::RecorderDescription::Filter filter{fault.channels, fault.values[0], fault.order, fault.digital};
        if (fault.inverse) {
          filter.channels = without(channels, fault.channels);
          filter.channels.insert(filter.channels.begin(), input);
        }
        recorder.common_filter.push_back(std::move(filter));
        break;
      }
      case FaultKind::clock:
        recorder.clock.push_back({fault.channels, fault.values[0], 1e6 * fault.values[1]});
        break;
      case FaultKind::mains_hum: {
        firmware::RecorderDescription::Hum hum{fault.channels, fault.values[0], {}};
        for (std::size_t i = 1; i + 1 < fault.values.size(); i += 2) {
          hum.amplitude.push_back(std::hypot(fault.values[i], fault.values[i + 1]));
        }
        recorder.hum.push_back(std::move(hum));
        break;
      }
      case FaultKind::drift:
        recorder.drift.push_back({fault.path, 1e2 * fault.values[0], fault.values[1]});
        break;
    }
  }
  return recorder;
}

void set_phases(PlacedFault& hum, const firmware::Recording& measured, const Response& read) {
  const double step = 2.0 * std::numbers::pi * hum.values[0] * measured.sample_period;
  for (std::size_t i = 0; i < hum.channels.size(); ++i) {
    const std::vector<double>&recorded = measured[hum.channels[i]], &simulated = read[index(hum.channels[i])];
    const std::size_t count = std::min(recorded.size(), simulated.size());
    double cosine = 0.0, sine = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const double left = recorded[k] - simulated[k], phase = step * static_cast<double>(k);
      if (!std::isfinite(left)) continue;
      cosine += left * std::cos(phase);
      sine += left * std::sin(phase);
    }
    double &a = hum.values[1 + 2 * i], &b = hum.values[2 + 2 * i];
    const double amplitude = std::hypot(a, b), length = std::hypot(cosine, sine);
    if (!(length > 0.0)) continue;
    a = amplitude * cosine / length;
    b = amplitude * sine / length;
  }
}

void record_with(const firmware::RecorderDescription& recorder, Channel input, const firmware::Recording& measured,
                 Response& channels) {
  std::vector<Channel> simulated;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (!channels[c].empty() && measured.has(model::channel_at(c))) simulated.push_back(model::channel_at(c));
  }
  std::vector<PlacedFault> faults = described_faults(recorder, input, simulated), hums;
  for (const PlacedFault& fault : faults) {
    if (fault.kind == FaultKind::mains_hum) hums.push_back(fault);
  }
  std::erase_if(faults, [](const PlacedFault& fault) { return fault.kind == FaultKind::mains_hum; });
  const auto pass = [&](const std::vector<PlacedFault>& by) {
    for (const Channel channel : simulated) {
      auto& values = channels[index(channel)];
      values = before_filter_of_input(by, channel, std::move(values), measured.sample_period);
      values = with_faults(by, channel, std::move(values), measured.sample_period);
    }
  };
  pass(faults);
  for (PlacedFault& hum : hums) {
    std::erase_if(hum.channels, [&](Channel channel) { return channels[index(channel)].empty(); });
    set_phases(hum, measured, channels);
  }
  pass(hums);
}

}  // namespace host_sim::identification
