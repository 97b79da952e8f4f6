#include "host_sim/replicate/drive_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "firmware/description/control_settings.hpp"
#include "firmware/simulation/road.hpp"
#include "host_sim/replicate/thresholds.hpp"

namespace host_sim::replicate {

DriveLimits limits_of(const firmware::RigDescription& description) {
  const firmware::Limits limits = firmware::control_settings(description).limits;
  return {0.5 * limits.stroke, limits.speed, limits.highest_acceleration(), limits.force};
}

double LimitsUsed::largest() const { return std::max({stroke, speed, acceleration, force}); }

LimitsUsed limits_used(const std::vector<double>& drive, double period, const DriveLimits& limits) {
  LimitsUsed used;
  for (const auto& m : firmware::through_samples(drive, 1.0 / period)) {
    used.stroke = std::max(used.stroke, std::abs(m.position) / limits.stroke);
    used.speed = std::max(used.speed, std::abs(m.velocity) / limits.speed);
    used.acceleration = std::max(used.acceleration, std::abs(m.acceleration) / limits.acceleration);
  }
  return used;
}

LimitProjection::LimitProjection(const BandInverse& inverse, const DriveLimits& limits, double period)
    : inverse_(inverse), limits_(limits), period_(period) {
  const RealTransform& transform = inverse.transform();
  const std::size_t bins = transform.bins();
  const double most = thresholds::usable_limit;
  penalty_.assign(bins, 0.0);
  double metric_sum = 0.0, penalty_sum = 0.0, inside = 0.0;
  for (std::size_t k = 0; k < bins; ++k) {  // derivatives as the differences of through_samples() have them
    const double w = full_turn * static_cast<double>(k) / static_cast<double>(transform.length());
    const std::complex<double> first(0.0, (8.0 * std::sin(w) - std::sin(2.0 * w)) / (6.0 * period));
    const double second = (-2.5 + (8.0 * std::cos(w) - 0.5 * std::cos(2.0 * w)) / 3.0) / (period * period);
    operators_[0].emplace_back(1.0 / (most * limits.stroke));
    operators_[1].push_back(first / (most * limits.speed));
    operators_[2].emplace_back(second / (most * limits.acceleration));
    for (const Bins& o : operators_) penalty_[k] += std::norm(o[k]);
    if (!(inverse.metric()[k] > 0.0)) continue;
    inside += 1.0;
    metric_sum += inverse.metric()[k];
    penalty_sum += penalty_[k];
  }
  const double mean = metric_sum / std::max(inside, 1.0);
  sigma_ = metric_sum / std::max(penalty_sum, 1e-300);
  for (std::size_t k = 0; k < bins; ++k) {
    metric_.push_back(inverse.metric()[k] + (inverse.metric()[k] > 0.0 ? 1e-3 : 1.0) * mean);
  }
}

std::vector<double> LimitProjection::operator()(std::vector<double> wanted) {
  acted_ = limits_used(wanted, period_, limits_).largest() > thresholds::usable_limit;
  if (!acted_) return wanted;
  RealTransform& transform = inverse_.transform();
  const std::size_t size = wanted.size(), bins = transform.bins();
  const auto forward = [&](const std::vector<double>& signal) {
    const auto spectrum = transform(signal);
    return Bins(spectrum.begin(), spectrum.end());
  };
  for (auto& m : multiplier_) m.resize(transform.length(), 0.0);
  const Bins wish = forward(wanted);
  Bins drive = wish;
  for (int round = 0; round < thresholds::limit_rounds; ++round) {
    Bins sum(bins);
    for (std::size_t i = 0; i < operators_.size(); ++i) {
      Bins derived(bins);
      for (std::size_t k = 0; k < bins; ++k) derived[k] = operators_[i][k] * drive[k];
      std::vector<double> value = transform.inverse(derived);
      for (std::size_t k = 0; k < value.size(); ++k) {
        const double wished = value[k] + multiplier_[i][k];
        const double kept = std::clamp(wished, -1.0, 1.0);
        multiplier_[i][k] = wished - kept;
        value[k] = kept - multiplier_[i][k];
      }
      const Bins back = forward(value);
      for (std::size_t k = 0; k < bins; ++k) sum[k] += std::conj(operators_[i][k]) * back[k];
    }
    for (std::size_t k = 0; k < bins; ++k) {
      drive[k] = (metric_[k] * wish[k] + sigma_ * sum[k]) / (metric_[k] + sigma_ * penalty_[k]);
    }
  }
  std::vector<double> result = transform.inverse(drive);
  result.resize(size);
  const double begin = result.front();
  for (double& value : result) value -= begin;
  const double over = limits_used(result, period_, limits_).largest() / thresholds::usable_limit;
  if (over > 1.0) {
    for (double& value : result) value /= over;
  }
  return result;
}

}  // namespace host_sim::replicate
