// Roads: ISO 8608 classes.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "model/numerics/motion.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// Motion of a foot point, one sample per period.
using FootPointMotion = std::vector<model::Motion<double>>;

/// Spectral density of the vertical displacement that a vehicle at speed v sees (ISO 8608, waviness 2):
///
///   G_z(f) = G_d(n₀) n₀² v/(f² + f_c²)    one-sided [m²/Hz],  n₀ = 0.1 1/m
///
/// f_c = 0 is the formula of the standard; a positive cut-off keeps the displacement finite.
[[nodiscard]] double road_density(double roughness, double speed, double frequency, double cut_off = 0.0);

/// An ISO 8608 road and the speed over it.
struct IsoRoad {
  double roughness = 64e-6;  ///< G_d(n₀) [m³]
  double speed = 27.78;      ///< [m/s]
  double cut_off = 0.05;     ///< f_c [Hz]
  double bandwidth = 100.0;  ///< −3 dB of the Butterworth low-pass of fourth order [Hz], see default_bandwidth
  std::uint64_t seed = 1;
};

/// G_d(n₀) of class 'A' … 'H', the geometric mean of the class [m³]: 16 · 4^k · 10⁻⁶. UsageError for another letter.
[[nodiscard]] double class_roughness(std::string_view letter);

/// 30 Hz where a cylinder or machine follows in hardware: a class B road at 100 km/h then has 0.15 m/s and 17 m/s² rms,
/// a fifth of the limits of the paper's cylinder (0.7 m/s) and acceleration sensors (98 m/s²). 100 Hz where the foot
/// point is computed and only the tyre's contact patch averages (hil: −3 dB at 0.44 v/L, L = 0.12 m). Never above a
/// fifth of the sample rate, beyond which a step no longer follows the cubic between samples.
[[nodiscard]] double default_bandwidth(model::RigKind kind, double sample_rate);
/// The same of a described rig. Of a driven_mass three times the frequency of mass and spring, so that the force drives
/// them below, at and above their resonance.
[[nodiscard]] double default_bandwidth(const model::RigParameters<double>& rig, double sample_rate);

/// The motion over such a road, starting flat (model::RoadFilter at rest), `samples` samples.
[[nodiscard]] FootPointMotion drive_over(const IsoRoad& road, double sample_rate, std::size_t samples);

/// The input of a rig for a road motion: the motion itself; for a component_bench the deflection of the component (with
/// derivatives) in its car on this road; for a driven_mass
///
///   (1)  F = √(k m) ż_r      of an ISO 8608 road a flat spectrum up to its bandwidth; the impedance of mass and spring
///                            makes the deflection at their resonance one of the road's, whatever they weigh
[[nodiscard]] FootPointMotion excitation(const model::RigParameters<double>& rig, FootPointMotion road,
                                         double sample_rate);

/// Motion through samples a period apart: velocities and accelerations by differences of fourth order, at the ends of
/// second. Error of the velocity h⁴/30 · max|z⁽⁵⁾|.
[[nodiscard]] FootPointMotion through_samples(const std::vector<double>& positions, double sample_rate);

}  // namespace firmware
