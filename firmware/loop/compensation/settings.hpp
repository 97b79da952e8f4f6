// What can be set about the compensation of the machine's delay.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "model/components/fdva.hpp"
#include "model/components/subsystems.hpp"

namespace firmware::compensation {

enum class Kind : unsigned char {
  polynomial,                ///< extrapolation of the wanted deflection over the delay: LeadPolynomial
  inverse,                   ///< truncated inverse of the machine, on derivatives: MachineInverse
  adaptive_time_series,      ///< the same with coefficients from commanded and reached deflection: TimeSeries
  smith,                     ///< force predicted by a model of the component: SpecimenPredictor
  virtual_damping,           ///< constant damping between wheel and body of the computed car: InterfaceDamper
  adaptive_virtual_damping,  ///< the same while the interface feeds energy
  feedforward_feedback,      ///< the inverse, and LQG on the tracking error: TrackingFeedback
};

inline constexpr auto kind_names =
    std::to_array<std::string_view>({"polynomial", "inverse", "adaptive_time_series", "smith", "virtual_damping",
                                     "adaptive_virtual_damping", "feedforward_feedback"});

[[nodiscard]] constexpr std::string_view name(Kind kind) { return kind_names[static_cast<std::size_t>(kind)]; }

/// Whether a method computes with a model of the component that the rig measures. Such a rig cannot validate that
/// model.
[[nodiscard]] constexpr bool needs_component_model(Kind kind) { return kind == Kind::smith; }
/// Whether it changes the command, and not only the force that enters the car.
[[nodiscard]] constexpr bool leads_command(Kind kind) {
  return kind != Kind::smith && kind != Kind::virtual_damping && kind != Kind::adaptive_virtual_damping;
}

/// The numbers of the inverse a₀ … a₃ [sⁱ].
inline constexpr std::size_t coefficients = 4;
using Coefficients = std::array<double, coefficients>;

/// What the Smith predictor takes the component for.
struct Component {
  double stiffness = 0.0;  ///< k_b [N/m]
  double damping = 0.0;    ///< b_b [N s/m]
  bool has_fdva = false;
  model::Fdva<double>::Parameters fdva{};
};

/// Defaults and bounds: README.md of this folder says where each number comes from.
struct Settings {
  Kind kind = Kind::inverse;
  model::MachinePath<double> machine{};  ///< the machine as assumed: delay, lag, resonance; its rate limit is not used
  double gain = 1.0;                     ///< x_act/x_cmd of the assumed machine at rest [1]
  Coefficients given{};      ///< a₀ … a₃ of the inverse in place of the series of `machine`; a₀ = 0: none given
  int order = 2;             ///< polynomial: degree of the extrapolation; else highest derivative that is used; 1 … 3
  double start_ramp = 0.1;   ///< the compensation comes in over so long from the start of a run [s]
  double limit = 0.02;       ///< largest |u − x|; beyond: trips [m]
  double force_limit = 5e3;  ///< largest force added to the measured one; beyond: trips [N]
  double rate = 2.0;         ///< u − x changes by at most so much [m/s]
  double force_lead = 0.5;   ///< the force is extrapolated over so many periods, 0 … 2 [1]

  // adaptive_time_series
  double memory = 1.0;      ///< of the estimate [s]
  double bandwidth = 20.0;  ///< of the filters that all its signals pass [Hz]
  double quiet = 2e-5;      ///< motion of this rms weighs as much as the assumed machine [m]
  double settling = 0.25;   ///< a coefficient takes at least so long from one bound to the other [s]
  Coefficients lowest{0.9, 0.0, 0.0, 0.0};
  Coefficients highest{1.1, 0.060, 3.2e-3, 1.3e-4};

  // feedforward_feedback
  double feedback_bandwidth = 1.0;  ///< of the disturbance estimate [Hz]

  // virtual_damping, adaptive_virtual_damping
  double damping = 0.0;        ///< b [N s/m]
  double energy_memory = 0.5;  ///< of the energy that the interface feeds [s]
  double damping_time = 0.05;  ///< from 0 to b, and back [s]

  Component component{};  ///< smith

  /// a₀ … a₃ as assumed, up to `order`.
  [[nodiscard]] Coefficients assumed() const;
  /// a₁/a₀: the delay of the assumed machine at low frequencies [s].
  [[nodiscard]] double delay() const;

  /// What is wrong (key and what is expected), or an empty text.
  [[nodiscard]] std::string_view check() const;
};

/// The assumed machine's inverse as a power series, cut behind s³:
///
///   (1)  1/M(s) = e^{sτ} (1 + T s) (1 + 2ζ s/ω + s²/ω²)/g = a₀ + a₁ s + a₂ s² + a₃ s³ + …
[[nodiscard]] Coefficients inverse_series(const model::MachinePath<double>& machine, double gain);

/// Coefficients up to ẍ that are exact at rest and at ω [rad/s], where the series is cut:
///
///   (2)  a₀ + j a₁ ω − a₂ ω² = 1/M(jω),   a₀ = 1/g,   a₁, a₂ ≥ 0
///
/// The time series arrives at them where one mode dominates the motion.
[[nodiscard]] Coefficients inverse_at(const model::MachinePath<double>& machine, double gain, double omega);

/// The damping that takes out of the car what a delay τ feeds into it at ω (Osaki et al. 2010):  b = k/ω sin ωτ,
/// [N s/m], with the stiffness k of the component [N/m], its wheel mode ω [rad/s].
[[nodiscard]] double damping_against_delay(double stiffness, double omega, double delay);

}  // namespace firmware::compensation
