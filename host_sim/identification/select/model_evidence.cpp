#include "host_sim/identification/select/model_evidence.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "host_sim/identification/estimate/free_parameter.hpp"
#include "host_sim/identification/select/thresholds.hpp"
#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {
namespace {

/// visit(row, channel and band) of each pair of residuals.
template <class Visit>
void for_each_pair(const IdentificationProblem& problem, const Visit& visit) {
  const std::size_t channels = problem.channels().size();
  Eigen::Index row = 0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (!r.is_fitted()) continue;
    for (std::size_t k = 0; k < r.fit_whitening->bins(); ++k) {
      const std::size_t band = std::min(noise_band_of(r.fit_whitening->frequency(k)), noise_bands - 1);
      for (std::size_t c = 0; c < channels; ++c, row += 2) visit(row, c * noise_bands + band);
    }
  }
}

/// In the coordinate of a parameter of an effect.
double prior_width(const FreeParameter& parameter, const model::EffectParameter& card, const Scales& scales,
                   std::optional<model::Channel> channel) {
  const double bounds = parameter.upper - parameter.lower;
  if (card.kept_within > 0.0) return bounds;
  if (parameter.logarithmic) return std::min(thresholds::prior_decades, bounds);
  model::MotionScales motion = scales.motion;
  if (channel) motion.channel = scales.rms[index(*channel)];
  const double unit = card.starts.scale != nullptr ? card.starts.scale(motion) : 1.0;
  return std::min(thresholds::prior_scales * unit / parameter.scale, bounds);
}

/// Of all parameters of a fit, in their coordinates. Those of effects stand last.
std::vector<double> prior_widths(const CandidateModel& model, const Scales& scales) {
  std::vector<double> widths;
  for (const FreeParameter& parameter : model.fit.parameters) widths.push_back(parameter.upper - parameter.lower);
  std::size_t next = widths.size();
  for (const firmware::PlacedEffect& effect : model.effects) next -= effect_parameters(effect).size();
  for (const firmware::PlacedEffect& effect : model.effects) {
    for (const model::EffectParameter& card : effect.entry->parameters) {
      if (!card.fitted) continue;
      widths[next] = prior_width(model.fit.parameters[next], card, scales, effect.channel);
      ++next;
    }
  }
  return widths;
}

}  // namespace

std::vector<Power> power_by_band(const IdentificationProblem& problem, const Eigen::VectorXd& residual) {
  std::vector<Power> powers(problem.channels().size() * noise_bands);
  for_each_pair(problem, [&](Eigen::Index row, std::size_t band) {
    powers[band].squares += residual.segment<2>(row).squaredNorm();
    powers[band].count += 2.0;
  });
  return powers;
}

double Tempering::power(const Power& left) const {
  return by_power ? tempered_power(left, discrepancy) : tempered_power(left, discrepancy.directions);
}

double Tempering::weight(const Power& left) const {
  return by_power ? weight_of(left, discrepancy) : tempered_weight(left, discrepancy.directions);
}

ModelEvidence evidence_of(const IdentificationProblem& problem, const CandidateModel& model, const Scales& scales,
                          const Tempering& tempering) {
  const Fit& fit = model.fit;
  const std::vector<Power> powers = power_by_band(problem, fit.residual);
  ModelEvidence evidence;
  for (const Power& power : powers) evidence.left += tempering.power(power);
  evidence.causes -= 2.0 * thresholds::effect_log_prior * static_cast<double>(model.effects.size());
  for (const PlacedFault& fault : model.faults()) {
    if (fault.seen) continue;  // the noises say that it is there, and of which channels
    const bool of_group = fault.kind == FaultKind::clock || fault.kind == FaultKind::common_filter;
    evidence.causes -= 2.0 * thresholds::fault_log_prior;
    if (of_group) evidence.causes += thresholds::group_choice * static_cast<double>(problem.channels().size());
  }
  if (fit.jacobian.cols() == 0) return evidence;
  const Fit believed = weighted(fit, roots_of_weights(problem, fit.residual, tempering));
  evidence.parameters = occam_factor(prior_widths(model, scales), believed.covariance());
  return evidence;
}

Eigen::VectorXd roots_of_weights(const IdentificationProblem& problem, const Eigen::VectorXd& residual,
                                 const Tempering& tempering) {
  std::vector<double> roots;
  for (const Power& power : power_by_band(problem, residual)) roots.push_back(std::sqrt(tempering.weight(power)));
  Eigen::VectorXd of_each(residual.size());
  for_each_pair(problem, [&](Eigen::Index row, std::size_t band) { of_each.segment<2>(row).setConstant(roots[band]); });
  return of_each;
}

Fit weighted(const Fit& fit, const Eigen::VectorXd& roots) {
  Fit result;
  result.hypothesis = fit.hypothesis;
  result.parameters = fit.parameters;
  result.residual = roots.cwiseProduct(fit.residual);
  result.chi_squared = result.residual.squaredNorm();
  result.jacobian = roots.asDiagonal() * fit.jacobian;
  return result;
}

}  // namespace host_sim::identification
