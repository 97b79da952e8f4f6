// The machine's inverse from what it was told and where it went.
#pragma once

#include <array>
#include <cstddef>

#include "firmware/loop/compensation/settings.hpp"
#include "firmware/loop/compensation/signal_filter.hpp"

namespace firmware::compensation {

/// Coefficients of the inverse u = Σ a_i x^(i), from command u, reached deflection x_m and wanted deflection x, all
/// behind the same SignalFilter. With p = (ẋ_m, ẍ_m, …), z = (ẋ, ẍ, …), each derivative times a power of 1/ω:
///
///   (1)  R ← λ R + h z pᵀ,   r ← λ r + h z u̇/ω,   λ = 1 − h/memory
///   (2)  (R + δ I) a = r + δ a⁰,   δ = (quiet/10)² · memory
///   (3)  a within its bounds, and by at most (highest − lowest) h/settling a period
///
/// Velocities are compared, not deflections: a command that is off feeds F ẋ into the loop, so that the wheel at 14 Hz
/// counts and not the body at 1 Hz, whose motion is larger. A cut series is right in one band only: with deflections the
/// peak of the paper's rig is 14 % too low, with velocities 2 %.
/// z instead of p on the left makes the estimate one of instrumental variables: the noise of the position sensor is
/// not in z, so it does not pull the coefficients towards zero, as it does with least squares. δ keeps the assumed
/// machine a⁰ while nothing moves. Gaussian elimination with pivots: the same work every period.
/// Source: Chae, Kazemibidokhti, Ricles, Adaptive time series compensator for delay compensation of servo-hydraulic
/// actuator systems, Earthquake Engng Struct. Dyn. 2013; (1) recursive instead of over a window, instruments after
/// Söderström and Stoica, Instrumental variable methods for system identification, 1983.
class TimeSeries {
 public:
  struct State {
    std::array<std::array<double, coefficients>, coefficients> products{};  ///< R
    std::array<double, coefficients> right{};                               ///< r
    Coefficients values{};                                                  ///< a [sⁱ]
    SignalFilter::State wanted{}, commanded{}, reached{};
  };

  TimeSeries(const Settings& settings, const Coefficients& assumed, double period);

  void start(State& x, double at) const;
  /// The same instant for all three: deflections wanted, commanded and measured there [m].
  void step(State& x, double wanted, double commanded, double measured) const;

 private:
  [[nodiscard]] Coefficients solve(const State& x) const;

  std::size_t count_;  ///< order + 1
  double period_;
  double memory_;  ///< λ
  double weight_;  ///< δ
  Coefficients assumed_{};
  Coefficients lowest_{}, highest_{}, step_{};
  Coefficients unit_{};   ///< ω^i [1/sⁱ]
  Coefficients scale_{};  ///< ω^(i+1)
  SignalFilter filter_;
};

}  // namespace firmware::compensation
