#include "firmware/loop/lateness_guard.hpp"

namespace firmware {

LatenessGuard::LatenessGuard(const Limits& limits, const Supervision& supervision, hal::Time period)
    : late_after_(hal::seconds(limits.late_after * period.seconds())),
      gap_(supervision.gap),
      full_(static_cast<double>(limits.late_in_a_row)),
      leak_(supervision.late_leak) {}

bool LatenessGuard::follow(hal::Time lateness) {
  lateness_ = lateness.seconds();
  const bool late = lateness > late_after_;
  level_ += late ? 1.0 : -leak_;  // (1), (2)
  if (level_ < 0.0) level_ = 0.0;
  if (level_ > full_ + 1.0) level_ = full_ + 1.0;
  return late;
}

std::optional<Trip> LatenessGuard::hazard(hal::Time now) const {
  if (lateness_ > gap_) return Trip{Reason::gap, std::nullopt, lateness_, gap_, now};
  if (level_ >= full_) return Trip{Reason::late, std::nullopt, level_, full_, now};
  return std::nullopt;
}

}  // namespace firmware
