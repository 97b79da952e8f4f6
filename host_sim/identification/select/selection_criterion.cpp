#include "host_sim/identification/select/selection_criterion.hpp"

#include <algorithm>

namespace host_sim::identification {

double CandidateModel::penalised_chi_squared(const SelectionCriterion& criterion) const {
  double sum = fit.chi_squared;
  for (const firmware::PlacedEffect& effect : effects) {
    sum += criterion.effect + criterion.parameter * static_cast<double>(effect.values.size());
  }
  return sum;
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
