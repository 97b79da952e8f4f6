// A velocity from a displacement and an acceleration.
#pragma once

#include <Eigen/Core>

#include "firmware/loop/common/settings.hpp"

namespace firmware {

/// Velocity of one point, by joining its differentiated displacement y below a cross-over frequency with its integrated
/// acceleration a above it. Third-order observer with the bias β of the accelerometer as a state, e = y − ẑ:
///
///   (1)  ẑ' = v̂ + 2ω e      v̂' = a − β̂ + 2ω² e      β̂' = −ω³ e                     ω = 2π · cross_over
///   (2)  V̂ = [(2ω² s² + ω³ s) Y + (s² + 2ω s) A] / (s³ + 2ω s² + 2ω² s + ω³)
///
/// With Y = Z, A = s² Z (2) is V̂ = s Z: exact at every frequency; a constant bias of a leaves no trace. The poles are a
/// Butterworth filter's. Where there is only one of the two,
///
///   (3)  displacement alone:  V̂ = ω² s Y / (s² + √2 ω s + ω²)    ω = 2π · differentiation: late by √2/ω
///   (4)  acceleration alone:  V̂ = s A / (s² + √2 ω s + ω²)       ω = 2π · cross_over: nothing below it
///
/// Each is one linear system of three states, solved exactly (model::ExactDiscretisation) for inputs that go straight
/// from sample to sample. Straight lines cut a sine's peaks: relative error below (2πf · period)²/12 at frequency f,
/// 6e-4 at 13 Hz and 1 kHz.
///
/// Noise: white of rms σ_y, σ_a at sampling period h gives (integrals of (2))
///
///   (5)  σ_v² = h (3/2 ω³ σ_y² + σ_a²/ω),   smallest at ω² = (√2/3) σ_a/σ_y;    (3): σ_v² = h ω³ σ_y²/(2√2)
///
/// Default cross-over. Table 2 of the paper: laser 0.25 mm, accelerometer ±98 m/s² with a linearity of 0.98 m/s².
/// Taking that as an error growing with the square of the excursion, 0.98 (a/98)², the wheel's 11.3 m/s² rms on a
/// class-B road at 100 km/h (linear component) leave a bias and, around it, σ_a = 0.98 √2 (11.3/98)² = 0.018 m/s². (5)
/// then gives ω = 5.8 1/s, 0.93 Hz, hence 1 Hz, and there σ_v = 0.27 mm/s; twice the optimal frequency costs 54 % more
/// noise, half of it 24 %.
///
/// Default differentiation: 30 Hz, twice the wheel mode; noise 12 mm/s from 0.25 mm, against a wheel's 0.16 m/s on that
/// road.
class VelocityObserver {
 public:
  enum class Inputs : unsigned char { nothing, displacement, acceleration, both };

  /// Frequencies above a quarter of the sampling rate are taken down to it.
  VelocityObserver(Inputs inputs, const Observers& settings, double period);

  /// The velocity at this instant [m/s], from the samples of this instant [m], [m/s²]. The first call starts at rest;
  /// what has been wrong there is forgotten with time constant 1/ω. An input that is not used may hold any number.
  double step(double displacement, double acceleration);

  /// The next call starts at rest again.
  void restart() {
    started_ = false;
    state_.setZero();
  }

  [[nodiscard]] Inputs inputs() const { return inputs_; }
  [[nodiscard]] double velocity() const { return state_(1); }

 private:
  Inputs inputs_;
  bool started_ = false;
  Eigen::Matrix<double, 3, 1> state_;  ///< (1): ẑ, v̂, β̂; (3): ẑ, v̂; (4): ∫v̂, v̂
  double displacement_ = 0.0;          ///< of the last sample
  double acceleration_ = 0.0;
  Eigen::Matrix<double, 3, 3> transition_;
  Eigen::Matrix<double, 3, 2> by_displacement_;
  Eigen::Matrix<double, 3, 2> by_acceleration_;
};

}  // namespace firmware
