// Whether the second rig's recordings lie in the predicted bands.
#pragma once

#include <string>
#include <vector>

#include "host_sim/transfer/predict/prediction.hpp"

namespace host_sim::transfer {

/// A band of one response. With d_k = H_measured − mean of the draws at the lines k of the band:
///
///   (1)  T = Σ |d_k|²/σ_k²,   p = P(T_draw ≥ T), of the scaled χ² that the draws' own T have
///   (2)  deviation = √((Σ|d_k|² − Σ noise_k)/Σ|H_k|²)
///   (3)  force = Σ e_k* d_k/Σ|e_k|²        e: effect of the component's force (Prediction): what must be added to the
///                                          force, as a share of it. Real: stiffness; imaginary: damping
///
/// (1) needs no independence of lines: a parameter that is off moves all of them, in the draws as well.
/// Source of (1): A. Gelman, X.-L. Meng, H. Stern, Stat. Sinica 6, 1996.
struct BandCheck {
  std::size_t response;
  double lowest, highest;        ///< [Hz]
  double p = 1.0;                ///< (1)
  double deviation = 0.0;        ///< (2)
  double level = 0.0;            ///< √(Σ|H_measured|²/Σ|H|²) − 1
  double half_width = 0.0;       ///< of the 95 % band of |H|, relative, rms over the lines
  std::complex<double> force{};  ///< (3)
  bool holds = true;             ///< p ≥ family_error/tests, or a deviation not worth saying
};

struct Validation {
  double coverage50 = 0.0, coverage95 = 0.0;  ///< share of lines of both responses with |H| inside its band
  /// Area metric: ∫|F_draws(x) − F_measured(x)| dx, which is E|X − measured| of one measured value; mean over the
  /// lines. Source: S. Ferson, W. Oberkampf, L. Ginzburg, Comput. Methods Appl. Mech. Eng. 197, 2008.
  std::array<double, 2> area{}, area_share{};  ///< in the response's unit; ÷ rms of the measured |H| over the lines
  std::array<double, quantity_count> quantity_area{};
  double log_score = 0.0;  ///< mean over the lines of −ln p(H_measured), p: complex normal with mean and variance of
                           ///< the draws, H in units of its rms; smaller is better
  std::vector<BandCheck> bands;
  Outcome measured;
  bool holds = true;

  [[nodiscard]] double smallest_p() const;
};

[[nodiscard]] Validation validate(const Prediction& prediction, const SecondRig& second);

}  // namespace host_sim::transfer
