// Does the program keep up with its rig?
#pragma once

#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"

namespace firmware {

/// Counts late periods in a leaky bucket:
///
///   (1)  level ← level + min(max(1, l/h), m)   a period that begins l > late_after · h after it was due, h the period
///   (2)  level ← max(0, level − leak)          a punctual one
///   (3)  m = 0.4 · late_in_a_row
///
/// A hazard (late) when the level reaches late_in_a_row: with a leak of ¼ five in a row, or any lasting share above one
/// in five, of periods that are late by less than a period; three in a row, or any lasting share above one in nine, of
/// periods that are later than two (l/h ≥ m = 2). By m one alone never is one. One period that begins later than `gap`
/// is a hazard at once (gap): for so long nobody watched the rig.
class LatenessGuard {
 public:
  LatenessGuard(const Limits& limits, const Supervision& supervision, hal::Time period);

  /// One period that begins so long after its instant, on a machine that has been suspended for so long in all; true:
  /// late. What it was suspended since the last period is a gap like a late period, of which the clock knows nothing.
  bool follow(hal::Time lateness, hal::Time suspended = {});

  /// Of the last period.
  [[nodiscard]] std::optional<Trip> hazard(hal::Time now = hal::never) const;

 private:
  static constexpr double most_at_once = 0.4;  ///< of late_in_a_row: the third in a row fills the bucket

  hal::Time late_after_;
  double period_;  ///< h [s]
  double gap_;     ///< [s]
  double full_;
  double leak_;
  double level_ = 0.0;
  double lateness_ = 0.0;  ///< of the last period [s]
  double slept_ = 0.0;     ///< before the last period [s]
  hal::Time suspended_ = hal::never;
};

}  // namespace firmware
