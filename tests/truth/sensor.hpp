#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/truth/truth.hpp"

namespace truth {

/// What lies between a true value and the recording, for one channel:
///   gain, offset (outside the catalogue: drifts, bend, hum) → noise (and spikes) → lag → (resonance) → delay → hold →
///   saturation → (rounding)
///
/// Fed at every node of the fine grid. Noise is drawn once a sample and held for it: signal plus noise is known at all
/// times.
class Sensor {
 public:
  /// Effects of `channel` in the truth; `phase` in 0 … 1 of the hold's period; `noise` one value per sample from the
  /// run's begin.
  Sensor(const Truth& truth, const std::string& channel, std::vector<double> noise, double phase, int steps_per_sample);

  /// Gain, offset, drifts, bend, hum: what acts before the noise. `time` since the run's begin [s].
  [[nodiscard]] double before_noise(double value, double time) const {
    double result = (gain_ + drift_ * time + bend_ * value * value) * value + offset_ + zero_drift_ * time;
    if (hum_ != 0.0) result += hum_ * std::sin(hum_turn_ * time);
    return result;
  }
  [[nodiscard]] double noise_at(std::size_t node) const { return noise_[node / steps_]; }
  [[nodiscard]] bool remembers() const { return delay_ > 0.0 || hold_ > 0.0 || turn_ > 0.0; }
  [[nodiscard]] bool lags() const { return lag_ > 0.0; }
  [[nodiscard]] double lag() const { return lag_; }
  [[nodiscard]] bool lag_takes_noise() const { return lag_takes_noise_; }
  [[nodiscard]] double gain() const { return gain_; }

  /// The next node: a value after before_noise.
  void push(double value);
  /// What the recording shows at the newest node, before `limited`.
  [[nodiscard]] double newest() const { return shown(static_cast<double>(history_.size() - 1)); }
  /// The same at a time counted in nodes, which with a delay may be later than the newest node.
  [[nodiscard]] double shown(double now) const;
  /// When a hold that has neither lag nor delay before it takes its next value [s]; else never.
  [[nodiscard]] double next_renewal() const {
    return hold_ > 0.0 && lag_ <= 0.0 && delay_ <= 0.0 ? next_renewal_ : 1e300;
  }
  /// Takes it now: `value` is signal plus noise.
  void renew(double value) {
    held_ = value;
    next_renewal_ += hold_;
  }
  /// Saturation and rounding.
  [[nodiscard]] double limited(double value) const;

 private:
  [[nodiscard]] double at(double place) const;   ///< after lag, before delay; place counted in nodes
  [[nodiscard]] double resonated(double value);  ///< the next node through the resonance

  std::size_t steps_;
  double node_;  ///< time between nodes [s]
  double gain_ = 1.0, offset_ = 0.0, drift_ = 0.0, hum_ = 0.0, hum_turn_ = 0.0;
  double lag_ = 0.0, delay_ = 0.0, jitter_ = 0.0, jitter_turn_ = 0.0, hold_ = 0.0, next_renewal_ = 0.0, held_ = 0.0;
  double limit_ = 0.0, rounding_ = 0.0;
  double zero_drift_ = 0.0, clock_drift_ = 0.0, bend_ = 0.0;
  double turn_ = 0.0, ratio_ = 0.0;  ///< of a resonance: ω, ζ
  double resonating_ = 0.0, resonating_rate_ = 0.0, pushed_ = 0.0;
  bool lag_takes_noise_;
  std::vector<double> noise_;
  std::vector<double> history_;  ///< without noise, unless the lag takes it
  double last_input_ = 0.0;
};

}  // namespace truth
