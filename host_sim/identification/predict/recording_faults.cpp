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

}  // namespace host_sim::identification
