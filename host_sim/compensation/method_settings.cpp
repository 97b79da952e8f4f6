#include "host_sim/compensation/method_settings.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/compensation/compensator.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::compensation {
namespace {

// Where the peak of the wheel load is looked for, around ω² = (k_t + k)/m_w + k/m_b, and in which steps.
constexpr double lowest_share = 0.6, highest_share = 1.6, grid = 1.004;

double component_stiffness(const model::RigParameters<double>& rig) {
  return rig.suspension.stiffness + (rig.has_fdva ? rig.fdva.coupling_stiffness : 0.0);
}

}  // namespace

model::RigParameters<double> without_delay(model::RigParameters<double> rig) {
  rig.effects.for_each([](auto& slot) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    if constexpr (model::ActsOn<Effect, model::MachinePath<double>>) slot.active = false;
  });
  rig.effects.for_each_sensor([](auto& slot, model::Channel) { slot.active = false; });
  return rig;
}

double wheel_mode(const model::RigParameters<double>& rig) {
  const double k = component_stiffness(rig);
  const double about = std::sqrt((rig.tyre.stiffness + k) / rig.wheel.mass + k / rig.body.mass);
  const stability::RoadResponse response(stability::linearise(without_delay(stability::linear_part(rig))), 0.0, 0.0);
  double best = about, highest = 0.0;
  for (double omega = lowest_share * about; omega < highest_share * about; omega *= grid) {
    const double magnitude = std::abs(response(model::Channel::F_w, omega));
    if (magnitude > highest) best = omega;
    highest = std::max(highest, magnitude);
  }
  return best;
}

firmware::compensation::Coefficients inverse_at(const model::MachinePath<double>& machine, double omega) {
  const std::complex<double> s(0.0, omega);
  std::complex<double> inverse = std::exp(s * machine.delay) * (1.0 + machine.lag * s);
  if (machine.resonance_frequency > 0.0) {
    const std::complex<double> x = s / (6.283185307179586 * machine.resonance_frequency);
    inverse *= 1.0 + 2.0 * machine.resonance_damping * x + x * x;
  }
  return {1.0, std::max(0.0, inverse.imag() / omega), std::max(0.0, (1.0 - inverse.real()) / (omega * omega)), 0.0};
}

firmware::compensation::Settings method_settings(const firmware::RigDescription& description,
                                                 firmware::compensation::Kind kind) {
  const auto& rig = description.rig;
  firmware::compensation::Settings s;
  s.kind = kind;
  rig.effects.act_on(s.machine);
  s.machine.rate_limit = 0.0;
  s.machine.delay += rig.effects.sensor_paths()[model::index(model::Channel::F)].delay +
                     description.delay_budget.sensor_age + description.delay_budget.transport;
  const auto fitted = inverse_at(s.machine, wheel_mode(rig));
  using firmware::compensation::Kind;
  if (kind == Kind::inverse || kind == Kind::adaptive_time_series || kind == Kind::feedforward_feedback)
    s.given = fitted;
  s.component = {.stiffness = rig.suspension.stiffness,
                 .damping = rig.suspension.damping,
                 .has_fdva = rig.has_fdva,
                 .fdva = rig.fdva};
  s.damping = std::max(0.0, firmware::compensation::damping_against_delay(component_stiffness(rig), wheel_mode(rig),
                                                                          s.delay() + 0.5 * description.period()));
  if (const auto wrong = s.check(); !wrong.empty()) {
    throw firmware::InputError(description.source, 0, "no compensation fits the machine of this rig", wrong);
  }
  if (!firmware::compensation::Compensator::fits(s, description.period())) {
    throw firmware::InputError(description.source, 0,
                               "compensation " + std::string(name(kind)) + " would look back further than 252 periods",
                               "a shorter delay or a lower sample_rate");
  }
  return s;
}

}  // namespace host_sim::compensation
