// Does the program keep up with its rig?
#pragma once

#include <optional>

#include "firmware/loop/settings.hpp"
#include "firmware/loop/trip.hpp"

namespace firmware {

/// Counts late periods in a leaky bucket:
///
///   (1)  level ← level + 1                 a period that begins more than late_after periods after it was due
///   (2)  level ← max(0, level − leak)      a punctual one
///
/// A hazard (late) when the level reaches late_in_a_row: with a leak of ¼ five in a row, or any lasting share above one
/// in five; one in five or less never fills the bucket. One period that begins later than `gap` is a hazard at once
/// (gap): for so long nobody watched the rig.
class LatenessGuard {
 public:
  LatenessGuard(const Limits& limits, const Supervision& supervision, hal::Time period);

  /// One period that begins so long after its instant; true: late.
  bool follow(hal::Time lateness);

  /// Of the last period.
  [[nodiscard]] std::optional<Trip> hazard(hal::Time now = hal::never) const;

 private:
  hal::Time late_after_;
  double gap_;  ///< [s]
  double full_;
  double leak_;
  double level_ = 0.0;
  double lateness_ = 0.0;  ///< of the last period [s]
};

}  // namespace firmware
