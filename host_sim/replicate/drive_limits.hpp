// Limits of the machine as constraints of a drive.
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/replicate/band_inverse.hpp"

namespace host_sim::replicate {

/// What a drive may do: that of the controller, of which thresholds::usable_limit is used.
struct DriveLimits {
  double stroke;        ///< to either side of the middle [m]
  double speed;         ///< [m/s]
  double acceleration;  ///< [m/s²]
  double force;         ///< |F_w| of a quarter car, |F| of a bench [N]
};
[[nodiscard]] DriveLimits limits_of(const firmware::RigDescription& description);

/// Largest value ÷ limit.
struct LimitsUsed {
  double stroke = 0.0, speed = 0.0, acceleration = 0.0, force = 0.0;
  [[nodiscard]] double largest() const;
};
[[nodiscard]] LimitsUsed limits_used(const std::vector<double>& drive, double period, const DriveLimits& limits);

/// The drive nearest to a wanted one that stays within stroke, speed and acceleration:
///
///   (1)  min Σ_f (M + μ) |u − wanted|²   subject to |u| ≤ S, |u̇| ≤ V, |ü| ≤ A
///
/// M as BandInverse (1): what matters is the error that the limits cost, not the drive; μ, its mean, outside of the
/// bands. Alternating directions of multipliers: one division by frequency, one clamp by sample, one multiplier, in
/// turn. The multipliers are kept for the next drive, which is near. What is left beyond a limit after these rounds is
/// scaled away. Source: S. Boyd et al., Found. Trends Mach. Learn. 3 (2011), section 5.2.
class LimitProjection {
 public:
  LimitProjection(const BandInverse& inverse, const DriveLimits& limits, double period);

  [[nodiscard]] std::vector<double> operator()(std::vector<double> wanted);
  [[nodiscard]] bool acted() const { return acted_; }  ///< on the last drive

 private:
  using Bins = std::vector<std::complex<double>>;

  const BandInverse& inverse_;
  DriveLimits limits_;
  double period_;
  std::array<Bins, 3> operators_;  ///< derivatives, each in terms of its limit
  std::vector<double> penalty_, metric_;
  double sigma_ = 0.0;
  std::array<std::vector<double>, 3> multiplier_;
  bool acted_ = false;
};

}  // namespace host_sim::replicate
