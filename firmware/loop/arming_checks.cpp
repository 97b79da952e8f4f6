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
  uu_ = ux_ = xx_ = xf_ = uf_ = vf_ = wf_ = 0.0;
  failures_ = 0;
  enter(Step::compare);
}

void ArmingChecks::enter(Step step) {
  step_ = step;
  count_ = 0;
  if (step == Step::rest || step == Step::tare) force_ = position_ = {};
  if (step == Step::back) back_ = SmoothMove(home_, ramps_.rest, ramps_.rate, period_);
}

std::optional<Trip> ArmingChecks::look(const Seen& seen) {
  failures_ = 0;
  switch (step_) {
    case Step::compare:
      compare(seen);
      break;
    case Step::rest:
    case Step::tare:
      rest(seen);
      break;
    case Step::probe:
      probe(seen);
      break;
    case Step::back:
      if (back_.arrived()) {
        home_ = ramps_.rest;
        enter(Step::tare);
      }
      judge_distance(seen, settings_.position_tolerance);
      break;
    case Step::done:
      break;
  }
  if (failures_ == 0) return std::nullopt;
  return failed_[0];
}

void ArmingChecks::list(const Seen& seen) {
  failures_ = 0;
  if (step_ == Step::compare) judge_place(seen);
}

void ArmingChecks::refuse(Reason reason, std::optional<model::Channel> channel, double value, double limit,
                          hal::Time now) {
  if (failures_ < failed_.size()) failed_[failures_++] = {reason, channel, value, limit, now};
}

void ArmingChecks::judge_distance(const Seen& seen, double tolerance) {
  if (settings_.position_tolerance <= 0.0 || !seen.position) return;
  const double error = *seen.position - seen.command;
  if (size_of(error) > tolerance) refuse(Reason::arming_position, expected_.position, error, tolerance, seen.now);
}

void ArmingChecks::judge_place(const Seen& seen) {
  const double tolerance = settings_.position_tolerance;
  if (tolerance <= 0.0) return;
  judge_distance(seen, tolerance);
  if (!known_ && seen.position && size_of(*seen.position) > tolerance) {
    refuse(Reason::arming_off_centre, expected_.position, *seen.position, tolerance, seen.now);
  }
}

void ArmingChecks::compare(const Seen& seen) {
  const double tolerance = settings_.position_tolerance;
  const bool differs = tolerance > 0.0 && seen.read_back && size_of(*seen.read_back - seen.command) > tolerance;
  const bool silent = tolerance > 0.0 && seen.silent;
  if ((differs || silent) && (seen.now - since_).seconds() < patience) return;
  if (differs || silent) {
    const double away = silent ? never_reached : *seen.read_back - seen.command;
    refuse(Reason::arming_read_back, std::nullopt, away, tolerance, seen.now);
  }
  judge_place(seen);
  if (failures_ == 0) enter(rest_periods_ > 0 ? Step::rest : Step::done);
}

void ArmingChecks::rest(const Seen& seen) {
  judge_distance(seen, settings_.position_tolerance);
  if (failures_ > 0) return;
  if (seen.force) force_.add(*seen.force);
  if (seen.position) position_.add(*seen.position);
  if (++count_ < rest_periods_) return;

  const bool probes = step_ == Step::rest && settings_.probe_amplitude > 0.0 && seen.position.has_value();
  const bool goes_back = step_ == Step::rest && expected_.returns && home_ != ramps_.rest;
  judge_rest(seen.now, !probes && !goes_back);
  if (failures_ > 0) return;
  if (probes) {
    last_position_ = last_command_ = 0.0;
    enter(Step::probe);
  } else {
    enter(goes_back ? Step::back : Step::done);
  }
}

void ArmingChecks::judge_rest(hal::Time now, bool last) {
  const double sway = force_.highest - force_.lowest, wander = position_.highest - position_.lowest;
  if (settings_.sway > 0.0 && sway > settings_.sway) {
    refuse(Reason::arming_not_at_rest, expected_.force, sway, settings_.sway, now);
  }
  if (settings_.wander > 0.0 && wander > settings_.wander) {
    refuse(Reason::arming_not_at_rest, expected_.position, wander, settings_.wander, now);
  }
  if (!last) return;
  tare_ = force_.mean();
  if (size_of(tare_) > settings_.preload) {
    refuse(Reason::arming_preload, expected_.force, tare_, settings_.preload, now);
  }
}

void ArmingChecks::probe(const Seen& seen) {
  // Beyond twice the probe and the tolerance something else moves the drive.
  judge_distance(seen, settings_.position_tolerance + 2.0 * settings_.probe_amplitude);
  if (failures_ > 0) return;
  const double u = seen.command - home_;
  const double x = seen.position ? *seen.position - position_.mean() : 0.0;
  const double f = seen.force ? *seen.force - force_.mean() : 0.0;
  uu_ += u * u;
  ux_ += u * x;
  xx_ += x * x;
  xf_ += x * f;
  uf_ += u * f;
  vf_ += (x - last_position_) * f;
  wf_ += (u - last_command_) * f;
  last_position_ = x;
  last_command_ = u;
  if (++count_ <= probe_periods_) return;
  judge_probe(seen.now);
  if (failures_ == 0) enter(expected_.returns ? Step::back : Step::tare);
}

void ArmingChecks::judge_probe(hal::Time now) {
  const double gain = ux_ / uu_;  // (1)
  const bool correlated = ux_ * ux_ >= lowest_correlation * lowest_correlation * uu_ * xx_;
  if (!(gain >= lowest_gain && gain <= highest_gain)) {
    refuse(Reason::arming_polarity_x_act, expected_.position, gain, gain < 1.0 ? lowest_gain : highest_gain, now);
  } else if (!correlated) {
    refuse(Reason::arming_noise, expected_.position, ux_ / std::sqrt(uu_ * xx_), lowest_correlation, now);
  }
  if (expected_.force_answers) judge_force(now, failures_ > 0);
}

void ArmingChecks::judge_force(hal::Time now, bool by_command) {
  using model::Channel;
  if (expected_.lowest_stiffness <= 0.0) {
    const double work = by_command ? wf_ : vf_;
    if (!(work > 0.0)) refuse(Reason::arming_polarity_F, Channel::F, work, 0.0, now);
    return;
  }
  const double squares = by_command ? uu_ : xx_;
  const double lowest = expected_.lowest_stiffness / stiffness_factor;
  const double highest = expected_.highest_stiffness * stiffness_factor;
  const double uncertainty = 3.0 * std::sqrt(force_.variance() / squares);  // (3)
  if (uncertainty > lowest) return refuse(Reason::arming_noise, Channel::F, uncertainty, lowest, now);
  const double stiffness = (by_command ? uf_ : xf_) / squares;  // (2)
  if (!(stiffness >= lowest && stiffness <= highest)) {
    refuse(Reason::arming_polarity_F, Channel::F, stiffness, stiffness > highest ? highest : lowest, now);
  }
  if (settings_.probe_stiffness <= 0.0 || settings_.allowed_gain <= 0.0) return;
  const double gain = stiffness / settings_.probe_stiffness;
  if (gain > settings_.allowed_gain) {  // (4)
    refuse(Reason::arming_gain_F, Channel::F, gain, settings_.allowed_gain, now);
  }
}

hal::Command ArmingChecks::next() {
  if (step_ == Step::back) return back_.next();
  if (step_ != Step::probe || count_ >= probe_periods_) return {home_, 0.0, 0.0};
  const double s = static_cast<double>(count_ + 1) / static_cast<double>(probe_periods_);
  const double amplitude = home_ > 0.0 ? -settings_.probe_amplitude : settings_.probe_amplitude;  // towards the middle
  const hal::Command probe = probe_at(s, amplitude);
  return {home_ + probe.position, probe.velocity, probe.acceleration};
}

hal::Command ArmingChecks::probe_at(double s, double amplitude) {
  const double r = 1.0 - s, a = 16.0 * amplitude;
  constexpr double time = probe_time;
  return {a * (s * s * r * r), a * (2.0 * s * r * (r - s)) / time, a * (2.0 - 12.0 * s * r) / (time * time)};
}

}  // namespace firmware
