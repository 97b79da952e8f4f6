// Channels that are held: when they were renewed, read off the recording.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace host_sim::identification {

/// When a held channel takes its value: with the sample at which it shows, or by a clock of its own, at a phase and
/// with a period inside what the renewals allow: −1 the earliest and the shortest, 1 the latest and the longest.
struct HoldClock {
  bool own = false;
  double phase = 0.0, stretch = 0.0;
};

/// The renewals of a held channel.
///
/// A sensor with a clock of its own, t_n = t_0 + n P, shows what it took at t_n from the next sample k_n on:
///
///   (1)  k_n − 1 < t_0 + n P ≤ k_n    [samples]
///
/// (1) for all n leaves t_0 and P a narrow range: t_0 = first ± slack, P = period ± period_slack. Whether the sensor
/// took its value at t_n or at the sample k_n (a sensor that the recorder triggers) shows in the values only
/// (HoldClock).
struct Renewals {
  std::vector<std::size_t> at;      ///< k_n
  std::vector<bool> seen;           ///< the sample before k_n was recorded; else k_n may be too late: (1) says ≤ only
  std::vector<double> turn;         ///< n; turns that brought the same value again are skipped
  double period = 0.0;              ///< P [samples]
  double period_slack = 0.0;        ///< half width of what (1) allows
  double first = 0.0, slack = 0.0;  ///< t_0, and half width of what (1) allows, at this P
  bool regular = false;             ///< (1) can be met
};

/// When the value n of `at` was taken [samples]: by a clock of its own at t_n, stretched about the middle, else at k_n.
[[nodiscard]] double taken_at(const Renewals& renewals, std::size_t n, const HoldClock& clock);

/// The signal of a channel before its hold, whose renewals must be regular. Through the 16 held values around a sample,
/// taken at t_n, goes a polynomial; before the first and behind the last the value stays. Of a sine of f it is wrong by
/// 1e-3 at f P = 0.25, 1e-2 at 0.3, 6e-2 at 0.35. Source: J.-P. Berrut and L. N. Trefethen, Barycentric Lagrange
/// Interpolation, 2004.
[[nodiscard]] std::vector<double> before_hold(const std::vector<double>& held, const Renewals& renewals,
                                              const HoldClock& clock);

/// nullopt: the samples do not repeat themselves, or do so without a period (a limit), or because they are rounded:
/// half of the new values are one `step` (sample_faults.hpp) from the old ones, and their instants do not meet (1).
/// `filled`: samples that were not recorded (recording_gaps.hpp); each counts as the one before.
[[nodiscard]] std::optional<Renewals> renewals_of(const std::vector<double>& samples, double step = 0.0,
                                                  const std::vector<bool>& filled = {});

}  // namespace host_sim::identification
