#include "host_sim/identification/predict/recording_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/identification/predict/low_pass.hpp"
#include "host_sim/identification/predict/sample_polynomial.hpp"

namespace host_sim::identification {

using model::Channel;

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

std::vector<double> shifted(const std::vector<double>& values, double offset, double rate, double period) {
  std::vector<double> moved(values.size());
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  const double late = -offset / period, whole = std::floor(late);
  const auto back = static_cast<std::ptrdiff_t>(std::clamp(whole, -1e9, 1e9));
  const SampleWeights between = weights_at(late - whole + 2.0);  // the same between all samples, but for the ends
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const std::ptrdiff_t first = k + back - 2;
    const bool inside = rate == 0.0 && first >= 0 && first <= count - polynomial_points;
    const double at = static_cast<double>(k);
    moved[static_cast<std::size_t>(k)] =
        inside ? weighted(between, values.data() + first) : value_between(values, at + late + rate * at);
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
