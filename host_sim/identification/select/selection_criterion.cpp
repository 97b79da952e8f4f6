#include "host_sim/identification/select/selection_criterion.hpp"

#include <algorithm>

#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

double CandidateModel::penalised_chi_squared(const SelectionCriterion& criterion) const {
  double sum = fit.chi_squared;
  for (const firmware::PlacedEffect& effect : effects) {
    sum += criterion.effect + criterion.parameter * static_cast<double>(effect.values.size());
    sum += rarity(effect);
  }
  for (const PlacedFault& fault : faults()) sum += penalty(criterion, fault, channels);
  return sum;
}

double rarity(const firmware::PlacedEffect& effect) {
  return effect.channel && effect.entry->lateness != model::Lateness::none ? thresholds::late_sensor : 0.0;
}

double penalty(const SelectionCriterion& criterion, const PlacedFault& fault, std::size_t channels) {
  const auto fitted = static_cast<double>(std::count(fault.fitted.begin(), fault.fitted.end(), true));
  if (fault.seen) return criterion.parameter * fitted;
  const bool of_group = fault.kind == FaultKind::clock || fault.kind == FaultKind::common_filter;
  return criterion.effect + criterion.parameter * fitted +
         (of_group ? thresholds::group_choice * static_cast<double>(channels) : 0.0) +
         (fault.kind == FaultKind::drift ? thresholds::violation : 0.0);
}

bool SelectionCriterion::accepts(const CandidateModel& longer, const CandidateModel& shorter,
                                 double least_share) const {
  const double gained = shorter.fit.chi_squared - longer.fit.chi_squared;
  return prefers(longer, shorter) && gained > least_share * beyond_noise(shorter.fit);
}

double beyond_noise(const Fit& fit) {
  return std::max(fit.chi_squared - static_cast<double>(fit.residual.size()), 0.0);
}

}  // namespace host_sim::identification
