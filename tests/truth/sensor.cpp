#include "tests/truth/sensor.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "tests/truth/random.hpp"

namespace truth {
namespace {

double of(const std::map<std::string, double>& values, const std::string& key) {
  const auto found = values.find(key);
  return found == values.end() ? 0.0 : found->second;
}

}  // namespace

Sensor::Sensor(const Truth& truth, const std::string& channel, std::vector<double> noise, double phase,
               int steps_per_sample)
    : steps_(static_cast<std::size_t>(steps_per_sample)),
      node_(1.0 / truth.sample_rate / steps_per_sample),
      lag_takes_noise_(truth.lag_takes_noise),
      noise_(std::move(noise)) {
  for (const Effect& effect : truth.effects) {
    if (effect.channel != channel) continue;
    if (effect.name == "sensor_gain") gain_ = effect.parameters.at("gain");
    if (effect.name == "sensor_offset") offset_ = effect.parameters.at("offset");
    if (effect.name == "sensor_lag") lag_ = effect.parameters.at("time_constant");
    if (effect.name == "sensor_delay") delay_ = effect.parameters.at("delay");
    if (effect.name == "sensor_hold") hold_ = effect.parameters.at("period");
    if (effect.name == "sensor_saturation") limit_ = effect.parameters.at("limit");
  }
  if (!truth.unknown.empty() && truth.unknown_channel == channel) {
    drift_ = of(truth.unknown_parameters, "gain_drift");
    hum_ = of(truth.unknown_parameters, "hum");
    hum_turn_ = 2.0 * std::numbers::pi * of(truth.unknown_parameters, "hum_frequency");
    jitter_ = of(truth.unknown_parameters, "jitter");
    jitter_turn_ = 2.0 * std::numbers::pi * of(truth.unknown_parameters, "jitter_frequency");
    delay_ = std::max(delay_, jitter_);
    rounding_ = of(truth.unknown_parameters, "rounding");
    zero_drift_ = of(truth.unknown_parameters, "zero_drift");
    clock_drift_ = of(truth.unknown_parameters, "clock_drift");
    delay_ = std::max(delay_, clock_drift_);
    bend_ = of(truth.unknown_parameters, "bend");
    turn_ = 2.0 * std::numbers::pi * of(truth.unknown_parameters, "sensor_frequency");
    ratio_ = of(truth.unknown_parameters, "sensor_ratio");
    Random when(11);
    constexpr double seldom = 1.0 / 300.0;
    const double spike = of(truth.unknown_parameters, "spikes");
    if (spike > 0.0)
      for (double& n : noise_)
        if (when.chance(seldom)) n += spike * when.sign();
  }
  next_renewal_ = -phase * hold_;
}

double Sensor::resonated(double value) {
  // ÿ/ω² + 2ζẏ/ω + y = u, u linear from one node to the next: Runge–Kutta, (ω h)⁵ is 1e-7 and less.
  if (history_.empty()) {
    resonating_ = pushed_ = value;
    return value;
  }
  const auto bend = [this](double y, double rate, double u) {
    return turn_ * turn_ * (u - y) - 2.0 * ratio_ * turn_ * rate;
  };
  const double h = node_;
  const double y = resonating_;
  const double v = resonating_rate_;
  const double middle = 0.5 * (pushed_ + value);
  const double a1 = bend(y, v, pushed_);
  const double v2 = v + 0.5 * h * a1;
  const double a2 = bend(y + 0.5 * h * v, v2, middle);
  const double v3 = v + 0.5 * h * a2;
  const double a3 = bend(y + 0.5 * h * v2, v3, middle);
  const double v4 = v + h * a3;
  const double a4 = bend(y + h * v3, v4, value);
  resonating_ += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
  resonating_rate_ += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  pushed_ = value;
  return resonating_;
}

void Sensor::push(double value) {
  if (turn_ > 0.0) value = resonated(value);
  if (lag_ > 0.0) {
    // T ẏ + y = u, u linear from one node to the next: exact; the noise of the step just gone is constant.
    const double noise = lag_takes_noise_ && !history_.empty() ? noise_at(history_.size() - 1) : 0.0;
    const double decay = std::exp(-node_ / lag_);
    const double slope = (value - last_input_) / node_;
    const double begin = last_input_ + noise - lag_ * slope;  // particular solution at the begin: u − T u̇
    const double next = history_.empty() ? value : begin + slope * node_ + (history_.back() - begin) * decay;
    last_input_ = value;
    history_.push_back(next);
  } else {
    history_.push_back(value);
  }
  if (hold_ > 0.0) {
    const double now = static_cast<double>(history_.size() - 1);
    while (next_renewal_ <= now * node_ + 1e-12) {
      held_ = at((next_renewal_ - delay_) / node_);
      next_renewal_ += hold_;
    }
  }
}

double Sensor::at(double place) const {
  const double end = static_cast<double>(history_.size() - 1);
  const double where = std::clamp(place, 0.0, end);
  const auto i = static_cast<std::size_t>(where + 1e-9);
  const bool noise_in_it = lag_ > 0.0 && lag_takes_noise_;
  const double noise = noise_in_it ? 0.0 : noise_at(i);
  const double u = where - static_cast<double>(i);
  if (u < 1e-9) return history_[i] + noise;
  if (i < 1 || i + 2 >= history_.size()) return (1.0 - u) * history_[i] + u * history_[i + 1] + noise;
  // Lagrange through four nodes.
  const double a = history_[i - 1];
  const double b = history_[i];
  const double c = history_[i + 1];
  const double d = history_[i + 2];
  return b + 0.5 * u * (c - a + u * (2.0 * a - 5.0 * b + 4.0 * c - d + u * (3.0 * (b - c) + d - a))) + noise;
}

double Sensor::shown(double now) const {
  if (hold_ > 0.0) return held_;
  if (history_.empty()) return 0.0;
  double late = delay_;
  if (jitter_ > 0.0) late *= 0.5 * (1.0 + std::sin(jitter_turn_ * now * node_));
  if (clock_drift_ > 0.0) late = clock_drift_ * now * node_;
  return at(now - late / node_);
}

double Sensor::limited(double value) const {
  if (limit_ > 0.0) value = std::clamp(value, -limit_, limit_);
  if (rounding_ > 0.0) value = std::round(value / rounding_) * rounding_;
  return value;
}

}  // namespace truth
