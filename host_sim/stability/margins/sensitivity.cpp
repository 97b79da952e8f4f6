#include "host_sim/stability/margins/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/description/rig_description.hpp"

namespace host_sim::stability {

std::vector<std::string> real_parameters(const model::RigParameters<double>& rig) {
  model::RigParameters<double> copy = rig;
  std::vector<std::string> paths;
  const auto add = [&](const std::string& path) {
    if (firmware::find_parameter(copy, path) != nullptr) paths.push_back(path);
  };
  for (const firmware::ParameterPath& p : firmware::parameter_paths())
    add(std::string(p.table) + "." + std::string(p.key));
  rig.effects.for_each([&](const auto& slot) {
    if (!slot.active) return;
    for (const auto& parameter : slot.effect.card.parameters) {
      add("effects." + std::string(slot.effect.card.name) + "." + std::string(parameter.name));
    }
  });
  rig.effects.for_each_sensor([&](const auto& slot, model::Channel channel) {
    if (!slot.active) return;
    for (const auto& parameter : slot.effect.card.parameters) {
      add("effects." + std::string(slot.effect.card.name) + "." + std::string(model::name(channel)) + "." +
          std::string(parameter.name));
    }
  });
  return paths;
}

std::vector<ParameterSensitivity> sensitivities(const model::RigParameters<double>& rig, double extra_delay,
                                                Complex root, Complex critical_root, double critical_delay,
                                                double critical_omega) {
  const LinearRig linear = linearise(rig);
  const DelayEquation given = linear.equation(linear.delay() + extra_delay);
  const DelayEquation border = linear.equation(critical_delay);
  const Complex on_border(0.0, critical_omega);
  const Complex slope = given.jet(root)[1], critical_slope = given.jet(critical_root)[1];
  const Complex border_slope = times(Complex(0.0, 1.0), border.jet(on_border)[1]);
  const Complex border_by_delay = border.by_delay(on_border);

  // (2): two real equations for dω and dτ
  const auto delay_change = [&](Complex by_parameter) {
    if (!(critical_omega > 0.0)) return 0.0;
    const double determinant =
        border_slope.real() * border_by_delay.imag() - border_slope.imag() * border_by_delay.real();
    return -(border_slope.real() * by_parameter.imag() - border_slope.imag() * by_parameter.real()) / determinant;
  };

  std::vector<ParameterSensitivity> result;
  const double tau = given.delay();
  if (tau > 0.0) {
    result.push_back({"loop delay", tau, tau * -given.by_delay(root) / slope,
                      tau * -given.by_delay(critical_root) / critical_slope, 0.0, 0.0});
  }
  struct Values {
    Complex at_root, at_critical, at_border;
  };
  double largest = 0.0;
  for (const std::string& path : real_parameters(rig)) {
    model::RigParameters<double> changed = rig;
    double* const parameter = firmware::find_parameter(changed, path);
    const double value = *parameter;
    if (value == 0.0) continue;
    const auto at = [&](double relative) {
      *parameter = value * (1.0 + relative);
      const LinearRig l = linearise(changed);
      const DelayEquation f = l.equation(l.delay() + extra_delay);
      return Values{f(root), f(critical_root), l.equation(critical_delay)(on_border)};
    };
    const auto difference = [&](double h) {
      const Values up = at(h), down = at(-h);
      return Values{(up.at_root - down.at_root) / (2.0 * h), (up.at_critical - down.at_critical) / (2.0 * h),
                    (up.at_border - down.at_border) / (2.0 * h)};
    };
    constexpr double h = 5e-4;
    const Values coarse = difference(2.0 * h), fine = difference(h);
    const auto better = [](Complex c, Complex f) { return f + (f - c) / 3.0; };
    ParameterSensitivity s;
    s.path = path;
    s.value = value;
    s.root_change = -better(coarse.at_root, fine.at_root) / slope;
    s.critical_root_change = -better(coarse.at_critical, fine.at_critical) / critical_slope;
    s.critical_delay_change = delay_change(better(coarse.at_border, fine.at_border));
    s.error = std::abs(fine.at_root - coarse.at_root) / 3.0 / std::abs(slope);
    largest = std::max(largest, std::abs(s.root_change));
    result.push_back(std::move(s));
  }
  for (ParameterSensitivity& s : result) s.error = largest > 0.0 ? s.error / largest : 0.0;
  return result;
}

std::optional<Complex> critical_root(DelayEquation f, double omega, double delay, double line) {
  Complex s(0.0, omega);
  double tau = f.delay();
  constexpr int most = 100'000;
  for (int step = 0; step < most && tau != delay; ++step) {
    const Complex drift = -f.by_delay(s) / f.jet(s)[1];  // ds/dτ
    const double longest = 1.0 / std::max(std::abs(drift), 1e-12);
    const double change = std::clamp(delay - tau, -longest, longest);
    const Complex predicted = s + drift * change;
    tau = std::abs(change) == longest ? tau + change : delay;
    f.set_delay(tau);
    s = predicted;
    for (int i = 0; i < 8; ++i) {
      const auto [value, slope] = f.jet(s);
      s -= value / slope;
    }
    if (!(std::abs(s - predicted) < 1.0) || !(s.real() > line)) return std::nullopt;
  }
  if (tau != delay) return std::nullopt;
  return s;
}

}  // namespace host_sim::stability
