#include "host_sim/stability/margins/over_amplitude.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "model/components/quarter_car.hpp"
#include "model/laws/behind_spring.hpp"
#include "model/laws/branch.hpp"
#include "model/laws/curve.hpp"
#include "model/laws/surface.hpp"
#include "model/rig/rig_equations.hpp"

namespace host_sim::stability {
namespace {

using model::LawOver;
using model::LawPlace;

/// Points of a turn in (1). The rule's error is of second order at a kink: 1e-5 of the force.
constexpr std::size_t turn_points = 720;
using Turn = std::array<double, turn_points>;
using Description = firmware::RigDescription;

/// [rad/s] Slower is creep, not an oscillation of a rig.
constexpr double slowest = 0.1;
/// [1/s] Oscillations right of it are followed from the first amplitude on.
constexpr double followed_line = -150.0;

/// (1) of forces that are added up over a turn.
class FirstHarmonic {
 public:
  FirstHarmonic(double amplitude, double omega) : amplitude_(amplitude), omega_(omega) {
    for (std::size_t i = 0; i < turn_points; ++i) {
      const double phase = full_turn * (static_cast<double>(i) + 0.5) / turn_points;  // no point at a reversal
      sine_[i] = std::sin(phase);
      cosine_[i] = std::cos(phase);
    }
  }

  /// [s] between two points
  [[nodiscard]] double period() const { return full_turn / omega_ / turn_points; }

  /// force(x, ẋ)
  template <class Force>
  void add(const Force& force) {
    for (std::size_t i = 0; i < turn_points; ++i) sum(i, force(deflection(i), amplitude_ * omega_ * cosine_[i]));
  }
  /// The second turn, where a force with memory has forgotten how it began. after(w, travel): what it remembers;
  /// force(w).
  template <class After, class Force>
  void add_with_memory(const After& after, const Force& force) {
    double w = 0.0;
    for (std::size_t i = 1; i <= 2 * turn_points; ++i) {
      w = after(w, deflection(i % turn_points) - deflection((i - 1) % turn_points));
      if (i >= turn_points && i < 2 * turn_points) sum(i % turn_points, force(w));
    }
  }
  [[nodiscard]] EquivalentForce result() const {
    const double share = 2.0 / turn_points / amplitude_, rounding = 1e-13 * all_;
    const auto beyond = [rounding](double sum) { return std::abs(sum) > rounding ? sum : 0.0; };
    return {share * beyond(with_sine_), share * beyond(with_cosine_) / omega_};
  }

 private:
  [[nodiscard]] double deflection(std::size_t i) const { return amplitude_ * sine_[i]; }
  void sum(std::size_t i, double force) {
    with_sine_ += force * sine_[i];
    with_cosine_ += force * cosine_[i];
    all_ += std::abs(force);
  }

  double amplitude_, omega_;
  double with_sine_ = 0.0, with_cosine_ = 0.0, all_ = 0.0;
  Turn sine_{}, cosine_{};
};

/// Laws of one place, without Maxwell branches.
void add_laws(FirstHarmonic& harmonic, const model::Laws<double>& laws, LawPlace place) {
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    const auto& table = laws.curves[i];
    if (table.place != place) continue;
    const model::Curve<double> curve(table.at, table.value, table.count);
    if (table.behind > 0.0) {
      const model::BehindSpring<double> spring(table.behind, table.over, harmonic.period());
      if (table.over == LawOver::deflection) {
        harmonic.add([&](double x, double /*v*/) { return spring.at(curve, x); });
      } else {
        harmonic.add_with_memory([&](double u, double travel) { return spring.after(curve, u, travel); },
                                 [](double u) { return u; });
      }
      continue;
    }
    harmonic.add([&](double x, double v) { return curve(table.over == LawOver::velocity ? v : x); });
  }
  for (std::size_t i = 0; i < laws.surface_count; ++i) {
    if (laws.surfaces[i].place != place) continue;
    harmonic.add([surface = model::Surface<double>(laws.surfaces[i])](double x, double v) { return surface(x, v); });
  }
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    if (laws.branches[i].place == place && laws.branches[i].slip_force > 0.0) {
      const model::Branch<double> slider(laws.branches[i], 1.0);
      harmonic.add_with_memory([&slider](double w, double travel) { return slider.after(w, travel); },
                               [&slider](double w) { return slider.force(w); });
    }
  }
}

/// k ẋ-branch in steady state at ω: k (jωT)/(1 + jωT) = stiffness + jω damping.
EquivalentForce maxwell_branches(const model::Laws<double>& laws, LawPlace place, double omega) {
  EquivalentForce sum;
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    const auto& b = laws.branches[i];
    if (b.place != place || !(b.time_constant > 0.0)) continue;
    const double turns = omega * b.time_constant;
    sum.stiffness += b.stiffness * turns * turns / (1.0 + turns * turns);
    sum.damping += b.stiffness * b.time_constant / (1.0 + turns * turns);
  }
  return sum;
}

/// (2), its size
double tyre_per_deflection(const model::RigParameters<double>& rig, double omega) {
  const Complex s(0.0, omega);
  const Complex ratio = (rig.wheel.mass * s * s + rig.tyre.damping * s + rig.tyre.stiffness) / (rig.body.mass * s * s);
  return 1.0 / std::abs(1.0 + ratio);
}

/// Laws that stay as they are: of sensors, pistons and guides.
model::Laws<double> others(const model::Laws<double>& laws) {
  const auto taken = [](LawPlace place) { return place == LawPlace::suspension || place == LawPlace::tyre; };
  model::Laws<double> rest;
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    if (!taken(laws.curves[i].place)) rest.curves[rest.curve_count++] = laws.curves[i];
  }
  for (std::size_t i = 0; i < laws.surface_count; ++i) {
    if (!taken(laws.surfaces[i].place)) rest.surfaces[rest.surface_count++] = laws.surfaces[i];
  }
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    if (!taken(laws.branches[i].place)) rest.branches[rest.branch_count++] = laws.branches[i];
  }
  return rest;
}

/// The loop whose nonlinear forces oscillate at ω; `share` of them acts, for the way to the first amplitude.
LinearRig loop_at(const Description& description, double amplitude, double omega, double share = 1.0) {
  return linearise(equivalent_rig(description.rig, amplitude, omega, share).rig);
}
/// The loop that runs holds the force for a period: half a step of delay.
double hold_of(const Description& description) { return 0.5 * description.period(); }
DelayEquation equation_of(const LinearRig& rig, const Description& description) {
  return rig.equation(rig.delay() + description.delay_budget.sum() + hold_of(description));
}

/// A root s of the loop at ω = Im s, by Newton's method in both parts of s from a root near by.
std::optional<Complex> oscillation(const Description& description, double amplitude, Complex s, double share = 1.0) {
  constexpr int most_steps = 30;
  constexpr double close = 1e-9, beside = 1e-5;
  const auto value = [&](Complex at) {
    return equation_of(loop_at(description, amplitude, at.imag(), share), description)(at);
  };
  for (int i = 0; i < most_steps && s.imag() > slowest; ++i) {
    const double d = beside * std::abs(s);
    const Complex f = value(s), along_re = (value(s + d) - f) / d, along_im = (value(s + Complex(0.0, d)) - f) / d;
    const double determinant = along_re.real() * along_im.imag() - along_im.real() * along_re.imag();
    Complex step(-(f.real() * along_im.imag() - along_im.real() * f.imag()) / determinant,
                 -(along_re.real() * f.imag() - f.real() * along_re.imag()) / determinant);
    if (!std::isfinite(std::abs(step))) return {};
    step *= std::min(1.0, 0.2 * std::abs(s) / std::abs(step));
    s += step;
    if (std::abs(step) < close * std::abs(s)) return s.imag() > slowest ? std::optional(s) : std::nullopt;
  }
  return {};
}

/// The oscillations of the loop, followed from amplitude to amplitude.
class Modes {
 public:
  Modes(const Description& description, double amplitude) : description_(description), amplitude_(amplitude) {
    constexpr int stages = 20;
    const LinearRig none = loop_at(description, amplitude, full_turn, 0.0);
    for (Complex s : characteristic_roots(equation_of(none, description), followed_line).roots) {
      if (s.imag() <= slowest) continue;
      std::optional<Complex> root = s;
      for (int i = 1; i <= stages && root; ++i) {
        root = oscillation(description, amplitude, *root, static_cast<double>(i) / stages);
      }
      if (root) add(*root);
    }
    complete();
  }

  /// On to another amplitude, in steps of a tenth at most.
  void go_to(double amplitude) {
    const int steps = static_cast<int>(std::ceil(std::abs(std::log(amplitude / amplitude_)) / 0.1)) + 1;
    const double ratio = std::pow(amplitude / amplitude_, 1.0 / steps);
    std::vector<Complex> before = std::move(roots_);
    roots_.clear();
    for (Complex start : before) {
      std::optional<Complex> root = start;
      for (int i = 1; i <= steps && root; ++i) {
        root = oscillation(description_, amplitude_ * std::pow(ratio, i), *root);
      }
      if (root) add(*root);
    }
    amplitude_ = amplitude;
    complete();
  }

  [[nodiscard]] AtAmplitude worst() const {
    if (roots_.empty()) throw UnfitLoop("no oscillation of the loop can be followed over the amplitude");
    AtAmplitude at{.amplitude = amplitude_, .root = roots_.front()};
    at.omega = at.root.imag();
    const EquivalentRig rig = equivalent_rig(description_.rig, amplitude_, at.omega);
    at.suspension = rig.suspension;
    at.tyre = rig.tyre;
    const auto critical = margins(equation_of(linearise(rig.rig), description_), at.stable()).critical_delay;
    if (critical) at.critical_delay = std::max(0.0, *critical - hold_of(description_));
    return at;
  }

 private:
  void add(Complex s) {
    const bool known = std::any_of(roots_.begin(), roots_.end(),
                                   [s](Complex other) { return std::abs(s - other) < 1e-4 * std::abs(s); });
    if (!known) roots_.push_back(s);
    std::sort(roots_.begin(), roots_.end(), [](Complex a, Complex b) { return a.real() > b.real(); });
  }
  /// An oscillation that came from elsewhere stands among the roots of the loop of another.
  void complete() {
    const std::vector<Complex> known = roots_;
    for (const Complex mode : known) {
      const LinearRig rig = loop_at(description_, amplitude_, mode.imag());
      for (const Complex s : characteristic_roots(equation_of(rig, description_), usual_line).roots) {
        if (s.imag() <= slowest || s.real() < roots_.front().real()) continue;
        if (const auto root = oscillation(description_, amplitude_, s)) add(*root);
      }
    }
  }

  const Description& description_;
  double amplitude_;
  std::vector<Complex> roots_;  ///< rightmost first
};

/// Between two amplitudes of which one decays and the other grows, by bisection of log A.
AtAmplitude border_between(Modes modes, const AtAmplitude& below, const AtAmplitude& above) {
  double from = below.amplitude, to = above.amplitude;
  AtAmplitude middle = below;
  while (to > (1.0 + 1e-6) * from) {
    modes.go_to(std::sqrt(from * to));
    middle = modes.worst();
    (middle.stable() == below.stable() ? from : to) = middle.amplitude;
  }
  return middle;
}

}  // namespace

EquivalentRig equivalent_rig(const model::RigParameters<double>& rig, double amplitude, double omega, double share) {
  EquivalentRig result{rig};
  FirstHarmonic suspension(amplitude, omega);
  add_laws(suspension, rig.laws, LawPlace::suspension);
  FirstHarmonic tyre(amplitude * tyre_per_deflection(rig, omega), omega);
  add_laws(tyre, rig.laws, LawPlace::tyre);
  const double load = model::QuarterCar<double>::static_wheel_load(model::RigEquations<double>(rig).car());
  result.rig.effects.for_each([&](auto& slot) {
    if (!slot.active || slot.effect.card.linearisation == model::Linearisation::exact) return;
    if constexpr (requires(model::SuspensionComponent<double> & part) { slot.effect.act_on(part); }) {
      model::SuspensionComponent<double> part{};
      slot.effect.act_on(part);
      if (const double f = part.dry_friction; f > 0.0) {
        slot.active = false;
        suspension.add([f](double, double v) { return v > 0.0 ? f : v < 0.0 ? -f : 0.0; });
      }
    }
    if constexpr (requires { slot.effect.force_after(0.0, 0.0); }) {
      slot.active = false;
      suspension.add_with_memory([&](double u, double travel) { return slot.effect.force_after(u, travel); },
                                 [](double u) { return u; });
    }
    if constexpr (requires { slot.effect.suspension_force(0.0, 0.0); }) {
      slot.active = false;
      suspension.add([&](double x, double v) { return slot.effect.suspension_force(x, v); });
    }
    if constexpr (requires { slot.effect.tyre_force(0.0, 0.0, load); }) {
      slot.active = false;
      tyre.add([&](double x, double v) {
        const double linear = rig.tyre.stiffness * x + rig.tyre.damping * v;
        return slot.effect.tyre_force(linear, x, load) - linear;
      });
    }
  });
  const auto sum = [&](const FirstHarmonic& harmonic, LawPlace place) {
    const EquivalentForce a = harmonic.result(), b = maxwell_branches(rig.laws, place, omega);
    return EquivalentForce{share * (a.stiffness + b.stiffness), share * (a.damping + b.damping)};
  };
  result.suspension = sum(suspension, LawPlace::suspension);
  result.tyre = sum(tyre, LawPlace::tyre);
  result.rig.laws = others(rig.laws);
  result.rig.suspension.stiffness += result.suspension.stiffness;
  result.rig.suspension.damping += result.suspension.damping;
  result.rig.tyre.stiffness += result.tyre.stiffness;
  result.rig.tyre.damping += result.tyre.damping;
  return result;
}

OverAmplitude over_amplitude(const Description& description, double largest) try {
  OverAmplitude result;
  result.left_out = loop_at(description, largest, full_turn).left_out;
  Modes modes(description, 0.01 * largest);
  for (std::size_t i = 0; i < amplitudes; ++i) {
    const Modes before = modes;
    modes.go_to(0.01 * largest * std::pow(100.0, static_cast<double>(i) / static_cast<double>(amplitudes - 1)));
    result.rows.push_back(modes.worst());
    if (i == 0) continue;
    const AtAmplitude &below = result.rows[i - 1], &above = result.rows[i];
    if (below.stable() == above.stable()) continue;
    result.limit_cycles.push_back({border_between(before, below, above), above.stable()});
  }
  return result;
} catch (const UnfitLoop& unfit) {
  throw firmware::InputError(description.source, 0, unfit.what(), "a loop that has a linear part at every amplitude");
}

}  // namespace host_sim::stability
