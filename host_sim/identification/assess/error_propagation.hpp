// The uncertainty budgets of the parameters of a fit and of what its model predicts.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "host_sim/identification/assess/named_effect.hpp"
#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/estimate/uncertainty_sources.hpp"

namespace host_sim::identification {

/// What is known of the errors of one fit.
struct FitErrors {
  Uncertainty known;  ///< widened by the sources
  std::vector<UncertaintySource> sources{};
  Eigen::VectorXd discretisation{};  ///< |shift| of the coordinates by the steps of the simulation
};
[[nodiscard]] FitErrors fit_errors(const firmware::RigDescription& description, const IdentificationProblem& problem,
                                   const Fit& fit, Uncertainty known);

/// Of each of fit.parameters, in the unit of its value: noise, tolerances of fitted parameters and model by
/// Uncertainty::variance_parts(); calibration, and tolerances of parameters that are not fitted, by their sources. A parameter that is known to its bounds only has one part.
[[nodiscard]] std::vector<UncertaintyBudget> parameter_budgets(const Fit& fit, const FitErrors& errors);

/// A number that the model which was found predicts of a channel.
struct PredictedNumber {
  Interval interval{};  ///< value ± 1.96 u_c
  UncertaintyBudget budget;
};
/// Of a channel before its sensor, over the fitted windows of all recordings.
struct PredictedChannel {
  PredictedNumber rms, peak;  ///< peak: the largest absolute value
};

/// The numbers q of each explained channel, their uncertainty by the same sources:
///
///   (1)  noise, tolerances, model of fitted parameters: Uncertainty::variance_parts(∂q/∂u), by central differences over
///        half of a half width
///   (2)  an error e of uncertainty_sources(): q(u + ∂u/∂e, input and parameter corrected for e) − q(u): what is corrected
///        is the same in the estimate and in what is predicted
///   (3)  discretisation: |∂q/∂u · shift| + what twice the steps change of q, twice (discretisation_shift)
///   (4)  model, where `rest` says that more than noise is left: the power D² that a channel leaves beyond its noise moves
///        q by at most D, a uniform distribution
///
/// Sensors move no q.
[[nodiscard]] std::map<model::Channel, PredictedChannel> predicted_channels(const IdentificationProblem& problem,
                                                                            const Fit& fit, const FitErrors& errors,
                                                                            bool rest);

}  // namespace host_sim::identification
