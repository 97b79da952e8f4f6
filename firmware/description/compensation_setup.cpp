#include "firmware/description/compensation_setup.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "firmware/description/compensation_reader.hpp"
#include "firmware/description/text/input_error.hpp"
#include "model/rig/lever_at_rest.hpp"

namespace firmware {
namespace {

using compensation::Kind;
using Rig = model::RigParameters<double>;

// Where the peak of the wheel load is looked for, around ω² = (k_t + k)/m_w + k/m_b, and in which steps.
constexpr double lowest_share = 0.6, highest_share = 1.6, grid_of_peak = 1.004;

/// A complex number whose operations are the same everywhere: std::complex divides by a library function.
struct Phasor {
  double re = 0.0, im = 0.0;
  friend Phasor operator+(Phasor a, Phasor b) { return {a.re + b.re, a.im + b.im}; }
  friend Phasor operator*(Phasor a, Phasor b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
  friend Phasor operator/(Phasor a, Phasor b) {
    const double size = b.square();
    return {(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
  }
  [[nodiscard]] double square() const { return re * re + im * im; }
};

double stiffness_with_fdva(const Rig& rig) {
  return model::spring_stiffness(rig) + (rig.has_fdva ? rig.fdva.coupling_stiffness : 0.0);
}

/// (2) at jω
Phasor component_at(const Rig& rig, double omega) {
  Phasor k{model::spring_stiffness(rig), rig.suspension.damping * omega};
  if (rig.has_fdva) {
    const auto& fdva = rig.fdva;
    const auto duct = model::Fdva<double>::duct(fdva);
    const double a =
        model::Fdva<double>::piston_acceleration(fdva, duct, fdva.open_ducts, 0.0, fdva.coupling_stiffness);
    const double r = -model::Fdva<double>::piston_acceleration(fdva, duct, fdva.open_ducts, 1.0, 0.0);
    const Phasor moving{-omega * omega, r * omega};
    k = k + (fdva.open_ducts > 0 ? Phasor{fdva.coupling_stiffness, 0.0} * moving / (moving + Phasor{a, 0.0})
                                 : Phasor{fdva.coupling_stiffness, 0.0});
  }
  return k;
}

/// |F_w/z_r|² by (1). The virtual damping acts at the car, before a lever.
double wheel_load_square(const Rig& rig, model::LeverAtRest lever, double omega) {
  const Phasor k = Phasor{lever.ratio * lever.ratio, 0.0} * component_at(rig, omega) +
                   Phasor{lever.stiffness, rig.machine.virtual_damping * omega};
  const Phasor body{-rig.body.mass * omega * omega, 0.0};
  const Phasor tyre{rig.tyre.stiffness, rig.tyre.damping * omega};
  const Phasor d = Phasor{-rig.wheel.mass * omega * omega, 0.0} + k * body / (body + k);
  return (tyre * d / (d + tyre)).square();
}

/// The numbers and lists of the description over those that follow from the rig.
void take_given(const CompensationDescription& given, compensation::Settings& s) {
  for (const CompensationKey& key : compensation_keys()) {
    if (const auto found = given.numbers.find(key.key); found != given.numbers.end()) key.value(s) = found->second;
  }
  if (const auto found = given.numbers.find("order"); found != given.numbers.end()) {
    s.order = static_cast<int>(found->second);
  }
  for (const auto& [name, values] : given.lists) {
    auto& target = name == "coefficients" ? s.given : name == "lowest" ? s.lowest : s.highest;
    std::copy(values.begin(), values.end(), target.begin());
  }
}

compensation::Settings settings_for(const RigDescription& description, Kind kind) {
  const Rig& rig = description.rig;
  compensation::Settings s;
  s.kind = kind;
  rig.effects.act_on(s.machine);
  s.machine.rate_limit = 0.0;
  s.machine.delay += rig.effects.sensor_paths()[model::index(model::Channel::F)].delay + description.delay_budget.sum();
  s.component = {.stiffness = model::spring_stiffness(rig),
                 .damping = rig.suspension.damping,
                 .has_fdva = rig.has_fdva,
                 .fdva = rig.fdva};
  if (description.compensation) take_given(*description.compensation, s);
  const double mode = wheel_mode(rig);
  if (s.damping == 0.0) {
    const double late = compensation::inverse_series(s.machine, 1.0)[1] + 0.5 * description.period();
    s.damping = std::max(0.0, compensation::damping_against_delay(stiffness_with_fdva(rig), mode, late));
  }
  // A third derivative makes the loop of a car unstable at high frequencies, and polynomials have no coefficients.
  const bool fits_mode =
      kind == Kind::inverse || kind == Kind::adaptive_time_series || kind == Kind::feedforward_feedback;
  if (fits_mode && s.given[0] == 0.0 && s.order <= 2) s.given = compensation::inverse_at(s.machine, s.gain, mode);
  return s;
}

}  // namespace

double wheel_mode(const Rig& rig) {
  const model::LeverAtRest lever = model::lever_at_rest(rig);
  const double k = lever.ratio * lever.ratio * stiffness_with_fdva(rig) + lever.stiffness;
  const double about = std::sqrt((rig.tyre.stiffness + k) / rig.wheel.mass + k / rig.body.mass);
  double best = about, highest = 0.0;
  for (double omega = lowest_share * about; omega < highest_share * about; omega *= grid_of_peak) {
    const double square = wheel_load_square(rig, lever, omega);
    if (square > highest) best = omega;
    highest = std::max(highest, square);
  }
  return best;
}

compensation::Settings compensation_settings(const RigDescription& description, Kind kind) {
  compensation::Settings s = settings_for(description, kind);
  if (const auto wrong = s.check(); !wrong.empty()) {
    const std::string_view key = wrong.substr(0, wrong.find_first_of(":,"));
    throw InputError(description.source, description.line_of(key),
                     "the compensation " + std::string(name(kind)) + " does not fit this rig", std::string(wrong));
  }
  if (!compensation::Compensator::fits(s, description.period())) {
    throw InputError(description.source, description.line_of("compensation"),
                     "the compensation " + std::string(name(kind)) + " would look back further than 252 periods",
                     "a shorter delay, a lower order, or a lower sample_rate");
  }
  return s;
}

std::optional<compensation::Settings> compensation_settings(const RigDescription& description) {
  if (!description.compensation) return std::nullopt;
  return compensation_settings(description, description.compensation->kind);
}

std::unique_ptr<Compensation> compensation_of(const RigDescription& description) {
  const auto settings = compensation_settings(description);
  if (!settings) return nullptr;
  return std::make_unique<compensation::Compensator>(*settings, description.period());
}

void refuse_compensation(const RigDescription& description, std::string_view command) {
  if (!description.compensation) return;
  throw InputError(description.source, description.line_of("compensation"),
                   std::string(command) + " computes with a loop without [compensation]",
                   "a description of machine and component alone, kind = \"component_bench\": the columns x_cmd, x_act "
                   "and F of the recording are a bench's");
}

}  // namespace firmware
