#include "firmware/loop/guards/lateness_guard.hpp"

namespace firmware {

LatenessGuard::LatenessGuard(const Limits& limits, const Supervision& supervision, hal::Time period)
    : late_after_(hal::seconds(limits.late_after * period.seconds())),
      period_(period.seconds()),
      gap_(supervision.gap),
      full_(static_cast<double>(limits.late_in_a_row)),
      leak_(supervision.late_leak) {}

bool LatenessGuard::follow(hal::Time lateness, hal::Time suspended) {
  slept_ = suspended_ == hal::never ? 0.0 : (suspended - suspended_).seconds();
  suspended_ = suspended;
  lateness_ = lateness.seconds();
  const bool late = lateness > late_after_;
  if (late) {
    const double most = most_at_once * full_, lost = lateness_ / period_;
    const double counted = lost < most ? lost : most;
    level_ += counted > 1.0 ? counted : 1.0;  // (1)
  } else {
    level_ -= leak_;  // (2)
  }
  if (level_ < 0.0) level_ = 0.0;
  if (level_ > full_ + 1.0) level_ = full_ + 1.0;
  return late;
}

std::optional<Trip> LatenessGuard::hazard(hal::Time now) const {
  if (lateness_ > gap_) return Trip{Reason::gap, std::nullopt, lateness_, gap_, now};
  if (slept_ > gap_) return Trip{Reason::gap, std::nullopt, slept_, gap_, now};
  if (level_ >= full_) return Trip{Reason::late, std::nullopt, level_, full_, now};
  return std::nullopt;
}

}  // namespace firmware
