#include "firmware/loop/duct_control/duct_policy.hpp"

namespace firmware {
namespace {

using model::CoreIndex;
constexpr int ring = Rollout::longest_delay + 1;

}  // namespace

std::string_view DuctPolicy::check(const DuctPolicySettings& settings, const model::RigParameters<double>& rig,
                                   double period) {
  if (!rig.has_fdva) return "valves.policy: expected \"plan\" without [fdva]";
  const double weights = settings.wheel_load + settings.body_acceleration + settings.component_force + settings.stroke;
  if (!(weights > 0.0 && weights < 1e12)) return "valves: expected a weight of the cost above 0";
  if (!(settings.horizon >= period && settings.horizon <= 1.0)) return "valves.horizon: expected a period to 1 s";
  if (!(settings.dwell >= period && settings.dwell <= 10.0)) return "valves.dwell: expected a period to 10 s";
  if (!(settings.delay >= 0.0 && settings.delay <= Rollout::longest_delay * period)) {
    return "valves.delay: expected 0 to 64 periods";
  }
  if (!(settings.closing_time > 0.0)) return "valves.closing_time: expected a time above 0 s";
  if (!(settings.pressure_peak > 0.0)) return "valves.pressure_peak: expected a pressure above 0 Pa";
  return {};
}

DuctPolicy::DuctPolicy(const EstimatorEquations& equations, SteadyGains& gains, const DuctPolicySettings& settings,
                       double period)
    : settings_(settings),
      rollout_(equations, gains, settings, period),
      ducts_(equations.ducts()),
      delay_(nearest_periods(settings.delay, period)),
      dwell_(nearest_periods(settings.dwell, period)),
      wheel_position_(equations.core(CoreIndex::wheel_position)),
      wheel_velocity_(equations.core(CoreIndex::wheel_velocity)),
      body_position_(equations.core(CoreIndex::body_position)),
      piston_travel_(equations.core(CoreIndex::piston_travel)),
      piston_velocity_(equations.core(CoreIndex::piston_velocity)),
      since_switching_(dwell_) {}

hal::Openings DuctPolicy::queued(int ahead) const {
  return queue_[static_cast<std::size_t>((newest_ + ring - delay_ + ahead) % ring)];
}

/// Every period does the same work; dwell decides whether its result counts.
hal::Openings DuctPolicy::choose(const EstimatorVector& x, hal::Openings planned) {
  if (settings_.policy == DuctPolicyKind::plan) return planned;
  EstimatorVector there = x;
  hal::Openings before = standing_;
  // Told in period k − d + i: stands from k + i on.
  for (int i = 1; i <= delay_; ++i) {
    const hal::Openings open = queued(i);
    rollout_.advance(there, before, open);
    before = open;
  }
  int wanted = 0;
  if (settings_.policy == DuctPolicyKind::rollout) {
    wanted = rollout_.best(there, before);
  } else {
    const double spring = there(wheel_position_) - there(body_position_) - there(piston_travel_);
    wanted = spring * there(wheel_velocity_) > 0.0 ? ducts_ : 0;
    const int open = model::count(static_cast<model::OpenDucts>(before.bits()));
    const double peak = rollout_.pressure_peak(there(piston_velocity_), open);
    if (wanted < open && peak > rollout_.highest_peak()) wanted = open;
  }
  const hal::Openings openings = hal::Openings::first(static_cast<std::size_t>(wanted));
  return since_switching_ < dwell_ ? last_ : openings;
}

void DuctPolicy::told(hal::Openings openings) {
  if (!started_) {
    started_ = true;
    queue_.fill(openings);
    last_ = openings;
  }
  if (openings != last_) {
    since_switching_ = 1;
  } else if (since_switching_ < dwell_) {
    ++since_switching_;
  }
  last_ = openings;
  newest_ = (newest_ + 1) % ring;
  queue_[static_cast<std::size_t>(newest_)] = openings;
  standing_ = queued(0);
}

}  // namespace firmware
