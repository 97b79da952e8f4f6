// Errors that move an estimate and that the noise of the channels does not hold: calibration, tolerances, steps.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

/// The law of propagation of uncertainty (JCGM 100:2008, 5.1.2) for a least-squares estimate. Where an error e was made,
/// a fit to what is corrected for it ends elsewhere:
///
///   (1)  ∂u/∂e = −A⁻¹ Jᵀ ∂r/∂e,   A = JᵀJ + diag(12/width²) of tolerated parameters (fit.hpp, 3)
///
/// r: whitened residuals after the correction. A sensor reads (1 + δ) y + o of the true y, with standard deviations from
/// its certificate (firmware::CalibrationDescription). Of a channel that is explained, y is what the fit predicts and W
/// its whitening:
///
///   (2)  ∂r/∂δ = −W y,   ∂r/∂o = −W 1
///
/// Of the sensor of the input, whose samples m drive the simulation, the rig has moved by m − δ m − o:
///
///   (3)  ∂r/∂δ = (r(m − σ m) − r(m + σ m))/2σ,   σ: standard deviation of δ; of o alike
///
/// Of two sensors of one foot point each has its share of their fusion (prepare/input_fusion.hpp), which is linear. The
/// mean of an integrated acceleration is not used, so its o moves nothing. A tolerated parameter p that is not fitted is
/// anywhere in its width, whose variance is width²/12:
///
///   (4)  ∂r/∂p = (r(p + σ) − r(p − σ))/2σ,   σ = width/√12
///
/// One error is the same in all recordings. In (1) J stands at the minimum, by central differences.
struct UncertaintySource {
  enum class Kind : unsigned char { calibration_gain, calibration_offset, tolerance } kind;
  std::string of;         ///< the channel, or the path of the parameter
  Eigen::VectorXd shift;  ///< (1) · standard deviation, of the coordinates of fit.parameters
  /// What else is corrected by one standard deviation: the input, by recording (empty: none), or the parameter [SI].
  std::vector<SimulationInput> input{};
  std::vector<InitialState> input_starts{};
  double parameter_step = 0.0;
};
[[nodiscard]] std::vector<UncertaintySource> uncertainty_sources(const firmware::RigDescription& description,
                                                                 const IdentificationProblem& problem, const Fit& fit);

/// The shifts of all sources, a column each: Uncertainty::add_shifts().
[[nodiscard]] Eigen::MatrixXd shifts_of(const std::vector<UncertaintySource>& sources);

/// What the steps of the simulation move, by (1), where no corner does (else Uncertainty (6)):
///
///   (5)  |A⁻¹ Jᵀ 2 (r(h) − r(h/2))|     h: the step
///
/// 2 is the sum 1 + ½ + ¼ … of an error of first order; one of higher order is less. Source: L. F. Richardson, Phil.
/// Trans. R. Soc. A 226, 1927.
[[nodiscard]] Eigen::VectorXd discretisation_shift(const IdentificationProblem& problem, const Fit& fit);

}  // namespace host_sim::identification
