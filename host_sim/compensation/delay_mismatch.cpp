#include "host_sim/compensation/delay_mismatch.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/compensation/compensated_loop.hpp"

namespace host_sim::compensation {
namespace {

constexpr double widest_mismatch = 1.5;  ///< of the delay, for the map
constexpr int steps_of_mismatch = 12;    ///< of the map, to each side
constexpr int bisections = 12;           ///< of a border: its step / 4096

double radius_at(const Rig& rig, double period, const Settings* settings, double change) {
  return compensated_loop(with_delay_change(rig, change), period, settings).spectral_radius();
}

/// Border between a stable and an unstable change of the delay.
double border_of_mismatch(const Rig& rig, double period, const Settings* settings, double stable, double unstable) {
  for (int i = 0; i < bisections; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (radius_at(rig, period, settings, middle) < 1.0 ? stable : unstable) = middle;
  }
  return 0.5 * (stable + unstable);
}

}  // namespace

double machine_delay(const Rig& rig) {
  model::MachinePath<double> path;
  rig.effects.act_on(path);
  return firmware::compensation::inverse_series(path, 1.0)[1];
}

double pure_delay(const Rig& rig) {
  model::MachinePath<double> path;
  rig.effects.act_on(path);
  return path.delay;
}

/// A machine without a delay of its own gets one.
Rig with_delay_change(Rig rig, double change) {
  model::MachinePath<double> path;
  rig.effects.act_on(path);
  rig.effects.add(model::ActuatorDelay<double>{std::max(0.0, path.delay + change)});
  return rig;
}

std::optional<double> DelayMismatch::smallest() const {
  std::optional<double> found;
  for (const auto& side : {later, earlier}) {
    if (side) found = std::min(found.value_or(std::abs(*side)), std::abs(*side));
  }
  return found;
}

DelayMismatch delay_mismatch(const Rig& rig, double period, const Settings* settings) {
  DelayMismatch result;
  const double unit = std::max(machine_delay(rig), period);
  for (int i = -steps_of_mismatch; i <= steps_of_mismatch; ++i) {
    const double error = i == 0 ? 0.0 : widest_mismatch * unit * i / steps_of_mismatch;
    if (pure_delay(rig) + error < 0.0) continue;
    result.error.push_back(error);
    result.radius.push_back(radius_at(rig, period, settings, error));
  }
  const auto& error = result.error;
  const auto& radius = result.radius;
  const auto zero = static_cast<std::size_t>(std::find(error.begin(), error.end(), 0.0) - error.begin());
  if (radius[zero] >= 1.0) {
    for (std::size_t i = 0; i < error.size(); ++i) {
      if (radius[i] >= 1.0) continue;
      const std::size_t towards = error[i] > 0.0 ? i - 1 : i + 1;  // the neighbour nearer to the described delay
      if (radius[towards] < 1.0) continue;
      const double border = border_of_mismatch(rig, period, settings, error[i], error[towards]);
      if (!result.nearest_stable || std::abs(border) < std::abs(*result.nearest_stable)) result.nearest_stable = border;
    }
    return result;
  }
  for (std::size_t i = zero + 1; i < error.size() && !result.later; ++i) {
    if (radius[i] >= 1.0) result.later = border_of_mismatch(rig, period, settings, error[i - 1], error[i]);
  }
  for (std::size_t i = zero; i-- > 0 && !result.earlier;) {
    if (radius[i] >= 1.0) result.earlier = border_of_mismatch(rig, period, settings, error[i + 1], error[i]);
  }
  return result;
}

}  // namespace host_sim::compensation
