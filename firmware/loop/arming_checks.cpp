#include "firmware/loop/arming_checks.hpp"

#include <cmath>

namespace firmware {
namespace {

std::uint64_t periods_of(double time, double period) {
  const double exact = time / period;
  const auto whole = static_cast<std::uint64_t>(exact);
  return static_cast<double>(whole) < exact ? whole + 1 : whole;
}

double size_of(double x) { return x < 0.0 ? -x : x; }

Trip refusal(Reason reason, std::optional<model::Channel> channel, double value, double limit, hal::Time now) {
  return {reason, channel, value, limit, now};
}

}  // namespace

void ArmingChecks::Average::add(double value) {
  if (count == 0) first = lowest = highest = value;
  ++count;
  const double x = value - first;
  sum += x;
  squares += x * x;
  if (value < lowest) lowest = value;
  if (value > highest) highest = value;
}

double ArmingChecks::Average::mean() const { return count == 0 ? 0.0 : first + sum / static_cast<double>(count); }

double ArmingChecks::Average::variance() const {
  if (count < 2) return 0.0;
  const auto n = static_cast<double>(count);
  const double v = (squares - sum * sum / n) / (n - 1.0);
  return v > 0.0 ? v : 0.0;
}

ArmingChecks::ArmingChecks(const Settings& settings, const Expected& expected)
    : settings_(settings.arming),
      ramps_(settings.ramps),
      period_(settings.period.seconds()),
      expected_(expected),
      rest_periods_(periods_of(settings.arming.tare_time, period_)),
      probe_periods_(periods_of(probe_time, period_)) {}

void ArmingChecks::begin(double home, hal::Time now, bool known) {
  home_ = home;
  known_ = known || settings_.off_centre || settings_.probe_amplitude <= 0.0;
  since_ = now;
  tare_ = 0.0;
  uu_ = ux_ = xx_ = xf_ = vf_ = 0.0;
  enter(Step::compare);
}

void ArmingChecks::enter(Step step) {
  step_ = step;
  count_ = 0;
  if (step == Step::rest || step == Step::tare) force_ = position_ = {};
  if (step == Step::back) back_ = SmoothMove(home_, ramps_.rest, ramps_.rate, period_);
}

std::optional<Trip> ArmingChecks::look(const Seen& seen) {
  switch (step_) {
    case Step::compare:
      return compare(seen);
    case Step::rest:
    case Step::tare:
      return rest(seen);
    case Step::probe:
      return probe(seen);
    case Step::back:
      if (back_.arrived()) {
        home_ = ramps_.rest;
        enter(Step::tare);
      }
      return away(seen, settings_.position_tolerance);
    case Step::done:
      break;
  }
  return std::nullopt;
}

std::optional<Trip> ArmingChecks::away(const Seen& seen, double tolerance) const {
  if (settings_.position_tolerance <= 0.0 || !seen.position) return std::nullopt;
  const double error = *seen.position - seen.command;
  if (size_of(error) <= tolerance) return std::nullopt;
  return refusal(Reason::arming_position, expected_.position, error, tolerance, seen.now);
}

std::optional<Trip> ArmingChecks::compare(const Seen& seen) {
  if (settings_.position_tolerance > 0.0) {
    if (seen.read_back && size_of(*seen.read_back - seen.command) > settings_.position_tolerance) {
      if ((seen.now - since_).seconds() < patience) return std::nullopt;
      return refusal(Reason::arming_read_back, std::nullopt, *seen.read_back - seen.command,
                     settings_.position_tolerance, seen.now);
    }
    if (const auto hazard = away(seen, settings_.position_tolerance)) return hazard;
    if (!known_ && seen.position && size_of(*seen.position) > settings_.position_tolerance) {
      return refusal(Reason::arming_off_centre, expected_.position, *seen.position, settings_.position_tolerance,
                     seen.now);
    }
  }
  enter(rest_periods_ > 0 ? Step::rest : Step::done);
  return std::nullopt;
}

std::optional<Trip> ArmingChecks::rest(const Seen& seen) {
  if (const auto hazard = away(seen, settings_.position_tolerance)) return hazard;
  if (seen.force) force_.add(*seen.force);
  if (seen.position) position_.add(*seen.position);
  if (++count_ < rest_periods_) return std::nullopt;

  const double sway = force_.highest - force_.lowest;
  if (settings_.sway > 0.0 && sway > settings_.sway) {
    return refusal(Reason::arming_not_at_rest, expected_.force, sway, settings_.sway, seen.now);
  }
  const double wander = position_.highest - position_.lowest;
  if (settings_.wander > 0.0 && wander > settings_.wander) {
    return refusal(Reason::arming_not_at_rest, expected_.position, wander, settings_.wander, seen.now);
  }
  const bool probes = step_ == Step::rest && settings_.probe_amplitude > 0.0 && seen.position.has_value();
  if (probes) {
    last_position_ = 0.0;
    enter(Step::probe);
    return std::nullopt;
  }
  if (step_ == Step::rest && expected_.returns && home_ != ramps_.rest) {
    enter(Step::back);
    return std::nullopt;
  }
  tare_ = force_.mean();
  if (size_of(tare_) > settings_.preload) {
    return refusal(Reason::arming_preload, expected_.force, tare_, settings_.preload, seen.now);
  }
  enter(Step::done);
  return std::nullopt;
}

std::optional<Trip> ArmingChecks::probe(const Seen& seen) {
  // Beyond twice the probe and the tolerance something else moves the drive.
  if (const auto hazard = away(seen, settings_.position_tolerance + 2.0 * settings_.probe_amplitude)) return hazard;
  const double u = seen.command - home_;
  const double x = seen.position ? *seen.position - position_.mean() : 0.0;
  const double f = seen.force ? *seen.force - force_.mean() : 0.0;
  uu_ += u * u;
  ux_ += u * x;
  xx_ += x * x;
  xf_ += x * f;
  vf_ += (x - last_position_) * f;
  last_position_ = x;
  if (++count_ <= probe_periods_) return std::nullopt;
  if (const auto hazard = judge_probe(seen.now)) return hazard;
  enter(expected_.returns ? Step::back : Step::tare);
  return std::nullopt;
}

std::optional<Trip> ArmingChecks::judge_probe(hal::Time now) const {
  using model::Channel;
  const double gain = ux_ / uu_;  // (1)
  const bool correlated = ux_ * ux_ >= lowest_correlation * lowest_correlation * uu_ * xx_;
  if (!(gain >= lowest_gain && gain <= highest_gain)) {
    return refusal(Reason::arming_polarity_x_act, expected_.position, gain, gain < 1.0 ? lowest_gain : highest_gain,
                   now);
  }
  if (!correlated) {
    return refusal(Reason::arming_noise, expected_.position, ux_ / std::sqrt(uu_ * xx_), lowest_correlation, now);
  }
  if (!expected_.force_answers) return std::nullopt;
  if (expected_.lowest_stiffness <= 0.0) {
    if (vf_ > 0.0) return std::nullopt;
    return refusal(Reason::arming_polarity_F, Channel::F, vf_, 0.0, now);
  }
  const double lowest = expected_.lowest_stiffness / stiffness_factor;
  const double highest = expected_.highest_stiffness * stiffness_factor;
  const double uncertainty = 3.0 * std::sqrt(force_.variance() / xx_);  // (3)
  if (uncertainty > lowest) return refusal(Reason::arming_noise, Channel::F, uncertainty, lowest, now);
  const double stiffness = xf_ / xx_;  // (2)
  if (!(stiffness >= lowest && stiffness <= highest)) {
    return refusal(Reason::arming_polarity_F, Channel::F, stiffness, stiffness > highest ? highest : lowest, now);
  }
  return std::nullopt;
}

hal::Command ArmingChecks::next() {
  if (step_ == Step::back) return back_.next();
  if (step_ != Step::probe || count_ >= probe_periods_) return {home_, 0.0, 0.0};
  const double time = static_cast<double>(probe_periods_) * period_;
  const double s = static_cast<double>(count_ + 1) / static_cast<double>(probe_periods_), r = 1.0 - s;
  const double a = (home_ > 0.0 ? -16.0 : 16.0) * settings_.probe_amplitude;  // towards the middle
  return {home_ + a * (s * s * r * r), a * (2.0 * s * r * (r - s)) / time, a * (2.0 - 12.0 * s * r) / (time * time)};
}

}  // namespace firmware
