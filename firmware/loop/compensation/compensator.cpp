#include "firmware/loop/compensation/compensator.hpp"

#include "firmware/loop/compensation/arithmetic.hpp"
#include "model/numerics/require.hpp"

namespace firmware::compensation {
bool Compensator::fits(const Settings& settings, double period) {
  const double lead = settings.delay() / period;
  if (settings.kind == Kind::polynomial) {
    return lead * settings.order <= static_cast<double>(LeadPolynomial::longest);
  }
  return settings.kind != Kind::smith ||
         settings.machine.delay / period <= static_cast<double>(SpecimenPredictor::Line::longest);
}

Compensator::Compensator(const Settings& settings, double period)
    : settings_(settings),
      period_(period),
      inverse_(settings.assumed()),
      polynomial_(settings.kind == Kind::polynomial ? settings.order : 0, settings.delay(), period),
      series_(settings, inverse_, period),
      feedback_(inverse_, settings.kind == Kind::feedforward_feedback ? settings.feedback_bandwidth : 0.0, period),
      specimen_(
          [&] {
            Settings used = settings;
            if (settings.kind != Kind::smith) used.machine.delay = 0.0;
            return used;
          }(),
          period),
      damper_(settings, period) {
  model::require(settings.check().empty() && fits(settings, period), "settings of a compensation that fit the period");
  do_start(0.0);
}

std::size_t Compensator::reach() const {
  if (settings_.kind == Kind::polynomial) return polynomial_.reach();
  return settings_.kind == Kind::smith ? specimen_.reach() : 0;
}

void Compensator::do_start(double deflection) {
  const model::Stroke<double> at{deflection, 0.0};
  polynomial_.start(state_.past, at);
  series_.start(state_.series, deflection);
  feedback_.start(state_.feedback);
  specimen_.start(state_.specimen, at);
  damper_.start(state_.damper, deflection);
  state_.wanted = {deflection, 0.0, 0.0};
  state_.last_force = state_.held_force = state_.added = state_.added_force = 0.0;
  state_.elapsed = state_.last_feedback = 0.0;
  state_.begun = false;
}

double Compensator::do_force(double measured) {
  double whole = measured;
  if (settings_.kind == Kind::smith) {
    whole += specimen_.force(state_.specimen);
  } else if (!leads_command(settings_.kind)) {
    whole += damper_.force(state_.damper, state_.wanted.velocity);
  }
  if (!state_.begun) state_.last_force = whole;
  state_.begun = true;
  const double added = whole - measured + settings_.force_lead * (whole - state_.last_force);  // (6)
  state_.last_force = whole;
  state_.added_force = added;
  state_.held_force = measured;
  return measured + added;
}

/// (1) … (4)
model::Stroke<double> Compensator::lead(const Instant& instant) {
  const model::Motion<double>& wanted = instant.wanted;
  if (settings_.kind == Kind::polynomial) return polynomial_.next(state_.past, {wanted.position, wanted.velocity});
  const Coefficients& a = values();
  const double jerk = (wanted.acceleration - state_.wanted.acceleration) / period_;
  model::Stroke<double> u{a[0] * wanted.position + a[1] * wanted.velocity + a[2] * wanted.acceleration + a[3] * jerk,
                          a[0] * wanted.velocity + a[1] * wanted.acceleration + a[2] * jerk};
  if (settings_.kind == Kind::feedforward_feedback && settings_.feedback_bandwidth > 0.0) {
    if (instant.measured) {
      const double before = state_.last_feedback;
      state_.last_feedback = feedback_.next(state_.feedback, instant.reached - state_.wanted.position);
      u.velocity += (state_.last_feedback - before) / period_;
    }
    u.position += state_.last_feedback;
  }
  return u;
}

Compensation::Answer Compensator::do_command(const Instant& instant) {
  const model::Motion<double>& wanted = instant.wanted;
  Answer answer;
  answer.command = {wanted.position, wanted.velocity, wanted.acceleration};
  if (settings_.kind == Kind::adaptive_time_series && instant.measured) {
    series_.step(state_.series, state_.wanted.position, instant.commanded, instant.reached);
  }
  if (settings_.kind == Kind::smith) {
    specimen_.step(state_.specimen, {wanted.position, wanted.velocity}, instant.open_ducts);
  }
  damper_.step(state_.damper, state_.held_force, wanted.position);
  if (leads_command(settings_.kind)) {
    const model::Stroke<double> u = lead(instant);
    double share = 1.0;
    if (state_.elapsed < settings_.start_ramp) {
      const double s = state_.elapsed / settings_.start_ramp;
      share = s * s * (3.0 - 2.0 * s);
      state_.elapsed += period_;
    }
    const double most = settings_.rate * period_;
    const double asked = share * (u.position - wanted.position);
    const double added = limited(asked, state_.added - most, state_.added + most);
    answer.command.velocity = added == asked ? wanted.velocity + share * (u.velocity - wanted.velocity)
                                             : wanted.velocity + (added - state_.added) / period_;
    state_.added = added;
    answer.command.position += added;
  }
  state_.wanted = wanted;
  if (!(magnitude(state_.added) <= settings_.limit)) {
    answer.excess = Excess{state_.added, settings_.limit};
  } else if (!(magnitude(state_.added_force) <= settings_.force_limit)) {
    answer.excess = Excess{state_.added_force, settings_.force_limit, true};
  }
  return answer;
}

}  // namespace firmware::compensation
