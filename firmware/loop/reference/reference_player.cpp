#include "firmware/loop/reference/reference_player.hpp"

namespace firmware {
namespace {

/// So many whole periods, rounded up.
std::uint64_t whole_periods(double time, double period) {
  const double exact = time / period;
  const auto whole = static_cast<std::uint64_t>(exact);
  return static_cast<double>(whole) < exact ? whole + 1 : whole;
}

/// Between two samples, u = 0 … 1: the cubic through both with their velocities; the acceleration straight between.
Motion between(const Motion& a, const Motion& b, double u, double period) {
  const double way = b.position - a.position, va = period * a.velocity, vb = period * b.velocity;
  const double c = 3.0 * way - 2.0 * va - vb, d = va + vb - 2.0 * way;
  return {a.position + u * (va + u * (c + u * d)), (va + u * (2.0 * c + 3.0 * u * d)) / period,
          a.acceleration + u * (b.acceleration - a.acceleration)};
}

}  // namespace

ReferencePlayer::ReferencePlayer(Reference& reference, double period)
    : reference_(reference), period_(period), change_steps_(2 * whole_periods(0.5 * change_time, period)) {}

std::optional<Motion> ReferencePlayer::start() {
  pace_ = Pace::playing;
  holds_ = false;
  level_ = level_to_ = wanted_level_;
  level_step_ = level_steps_ = 0.0;
  clock_step_ = clock_rate_ = 1.0;
  clock_change_ = 0.0;
  index_ = 0;
  const std::optional<Motion> begin = reference_.at(0);
  if (!begin) return std::nullopt;
  begin_ = newest_ = *begin;
  return scaled(newest_);
}

std::optional<Motion> ReferencePlayer::next() {
  if (pace_ == Pace::playing && holds_) {
    pace_ = Pace::slowing;
    from_ = index_;
    pace_step_ = 0;
    paced_ = 0.0;
  } else if (pace_ == Pace::standing && !holds_) {
    pace_ = Pace::quickening;
    from_ = index_;
    pace_step_ = 0;
    paced_ = 0.0;
  }
  if (pace_ == Pace::playing && level_step_ == level_steps_ && wanted_level_ != level_) begin_level();
  const std::optional<Motion> motion = play();
  if (!motion) return std::nullopt;
  return scaled(*motion);
}

void ReferencePlayer::begin_level() {
  level_from_ = level_;
  level_to_ = wanted_level_;
  const double change = level_to_ > level_from_ ? level_to_ - level_from_ : level_from_ - level_to_;
  level_steps_ = static_cast<double>(whole_periods(change_time * (change > 1.0 ? change : 1.0), period_));
  level_step_ = 0.0;
}

std::optional<Motion> ReferencePlayer::play() {
  const bool stands = pace_ == Pace::standing;
  clock_step_ = clock_rate_ = stands ? 0.0 : 1.0;
  clock_change_ = 0.0;
  if (stands) return Motion{newest_.position, 0.0, 0.0};
  if (pace_ != Pace::playing) return change_pace();
  if (!take_until(index_ + 1)) return std::nullopt;
  return newest_;
}

std::optional<Motion> ReferencePlayer::change_pace() {
  const bool slowing = pace_ == Pace::slowing;
  ++pace_step_;
  const double steps = static_cast<double>(change_steps_), time = steps * period_;
  if (pace_step_ == change_steps_) {
    clock_step_ = 0.5 * steps - paced_;
    clock_rate_ = slowing ? 0.0 : 1.0;
    pace_ = slowing ? Pace::standing : Pace::playing;
    if (!take_until(from_ + change_steps_ / 2)) return std::nullopt;
    if (!slowing) return newest_;
    return Motion{newest_.position, 0.0, 0.0};
  }
  const double s = static_cast<double>(pace_step_) / steps;
  const double way = slowing ? steps * (s * (1.0 - s * s * (1.0 - 0.5 * s))) : steps * (s * s * s * (1.0 - 0.5 * s));
  const double smooth = s * s * (3.0 - 2.0 * s), steep = 6.0 * s * (1.0 - s) / time;
  const double rate = slowing ? 1.0 - smooth : smooth, change = slowing ? -steep : steep;
  clock_step_ = way - paced_;
  clock_rate_ = rate;
  clock_change_ = change;
  paced_ = way;
  auto samples = static_cast<std::uint64_t>(way);
  if (static_cast<double>(samples) < way) ++samples;
  if (!take_until(from_ + samples)) return std::nullopt;
  const double u = 1.0 - (static_cast<double>(samples) - way);
  const Motion there = between(before_, newest_, u, period_);
  return Motion{there.position, there.velocity * rate, there.acceleration * rate * rate + there.velocity * change};
}

bool ReferencePlayer::take_until(std::uint64_t index) {
  while (index_ < index) {
    const std::optional<Motion> there = reference_.at(index_ + 1);
    if (!there) return false;
    ++index_;
    before_ = newest_;
    newest_ = *there;
  }
  return true;
}

Motion ReferencePlayer::scaled(Motion motion) {
  if (level_step_ == level_steps_) {
    if (level_ == 1.0) return motion;  // to the bit
    return {begin_.position + level_ * (motion.position - begin_.position), level_ * motion.velocity,
            level_ * motion.acceleration};
  }
  level_step_ += clock_step_;
  constexpr double rounding = 1e-6;  // a change that was held ends a billionth of a second early
  if (level_step_ > level_steps_ - rounding) level_step_ = level_steps_;
  const double time = level_steps_ * period_, change = level_to_ - level_from_;
  const double s = level_step_ / level_steps_;
  level_ = level_step_ == level_steps_ ? level_to_ : level_from_ + change * (s * s * (3.0 - 2.0 * s));
  const double slope = change * (6.0 * s * (1.0 - s)) / time, rate = slope * clock_rate_;
  const double bend = change * (6.0 - 12.0 * s) / (time * time) * (clock_rate_ * clock_rate_) + slope * clock_change_;
  const double way = motion.position - begin_.position;
  return {begin_.position + level_ * way, level_ * motion.velocity + rate * way,
          level_ * motion.acceleration + 2.0 * rate * motion.velocity + bend * way};
}

}  // namespace firmware
