#include "firmware/loop/compensation/settings.hpp"

#include "firmware/loop/compensation/arithmetic.hpp"
#include "model/numerics/elementary.hpp"

namespace firmware::compensation {
namespace {

bool within(double value, double lowest, double highest) { return value >= lowest && value <= highest; }

}  // namespace

Coefficients inverse_series(const model::MachinePath<double>& machine, double gain) {
  const double delay = machine.delay, square = 0.5 * delay * delay;
  Coefficients a{1.0, delay, square, square * delay / 3.0};
  for (std::size_t i = coefficients - 1; i > 0; --i) a[i] += machine.lag * a[i - 1];
  if (machine.resonance_frequency > 0.0) {
    const double omega = turn * machine.resonance_frequency;
    const double first = 2.0 * machine.resonance_damping / omega, second = 1.0 / (omega * omega);
    for (std::size_t i = coefficients - 1; i > 0; --i) a[i] += first * a[i - 1] + (i > 1 ? second * a[i - 2] : 0.0);
  }
  for (double& value : a) value /= gain;
  return a;
}

Coefficients inverse_at(const model::MachinePath<double>& machine, double gain, double omega) {
  const auto lead = model::turned(omega * machine.delay / turn);
  double re = 1.0 + lead.cosine_less_one, im = lead.sine;
  const auto times = [&](double other_re, double other_im) {
    const double product = re * other_re - im * other_im;
    im = re * other_im + im * other_re;
    re = product;
  };
  times(1.0, machine.lag * omega);
  if (machine.resonance_frequency > 0.0) {
    const double x = omega / (turn * machine.resonance_frequency);
    times(1.0 - x * x, 2.0 * machine.resonance_damping * x);
  }
  const double first = im / omega, second = (1.0 - re) / (omega * omega);
  return {1.0 / gain, first > 0.0 ? first / gain : 0.0, second > 0.0 ? second / gain : 0.0, 0.0};
}

Coefficients Settings::assumed() const {
  Coefficients a = given[0] > 0.0 ? given : inverse_series(machine, gain);
  for (std::size_t i = static_cast<std::size_t>(order) + 1; i < coefficients; ++i) a[i] = 0.0;
  return a;
}

double Settings::delay() const {
  const Coefficients a = assumed();
  return a[1] / a[0];
}

double damping_against_delay(double stiffness, double omega, double delay) {
  return stiffness / omega * model::turned(omega * delay / turn).sine;
}

std::string_view Settings::check() const {
  if (!within(machine.delay, 0.0, 0.2)) return "compensation.delay: expected 0 to 0.2 s";
  if (!within(machine.lag, 0.0, 0.2)) return "compensation.lag: expected 0 to 0.2 s";
  if (!within(machine.resonance_frequency, 0.0, 1e4)) return "compensation.frequency: expected 0 to 10000 Hz";
  if (!within(machine.resonance_damping, 0.0, 10.0)) return "compensation.damping_ratio: expected 0 to 10";
  if (!within(gain, 0.5, 2.0)) return "compensation.gain: expected 0.5 to 2";
  if (given[0] != 0.0 && !within(given[0], 0.5, 2.0))
    return "compensation.coefficients: expected the first within 0.5 … 2";
  for (std::size_t i = 1; i < coefficients; ++i) {
    if (!within(given[i], 0.0, 0.2)) return "compensation.coefficients: expected 0 to 0.2 behind the first";
  }
  if (order < 1 || order > 3) return "compensation.order: expected 1, 2 or 3";
  if (!within(start_ramp, 0.0, 10.0)) return "compensation.start_ramp: expected 0 to 10 s";
  if (!within(limit, 1e-6, 1.0)) return "compensation.limit: expected above 0, at most 1 m";
  if (!within(force_limit, 1e-3, 1e6)) return "compensation.force_limit: expected above 0, at most 1e6 N";
  if (!within(rate, 1e-3, 100.0)) return "compensation.rate: expected 0.001 to 100 m/s";
  if (!within(force_lead, 0.0, 2.0)) return "compensation.force_lead: expected 0 to 2 periods";
  if (!within(memory, 0.1, 100.0)) return "compensation.memory: expected 0.1 to 100 s";
  if (!within(bandwidth, 0.5, 200.0)) return "compensation.bandwidth: expected 0.5 to 200 Hz";
  if (!within(quiet, 1e-9, 1e-2)) return "compensation.quiet: expected 1e-9 to 0.01 m";
  if (!within(settling, 1e-3, 100.0)) return "compensation.settling: expected 0.001 to 100 s";
  for (std::size_t i = 0; i < coefficients; ++i) {
    if (!within(lowest[i], -2.0, 2.0) || !within(highest[i], lowest[i], 2.0)) {
      return "compensation.lowest, compensation.highest: expected four bounds each, lowest first, within ± 2";
    }
  }
  if (!within(feedback_bandwidth, 0.0, 20.0)) return "compensation.feedback_bandwidth: expected 0 to 20 Hz";
  if (!within(damping, 0.0, 1e5)) return "compensation.damping: expected 0 to 100000 N s/m";
  if (!within(energy_memory, 0.01, 100.0)) return "compensation.energy_memory: expected 0.01 to 100 s";
  if (!within(damping_time, 1e-3, 10.0)) return "compensation.damping_time: expected 0.001 to 10 s";
  return {};
}

}  // namespace firmware::compensation
