#include "host_sim/identification/assess/uncertainty_budget.hpp"

#include <array>
#include <cstddef>
#include <cstdio>

namespace host_sim::identification {

double UncertaintyBudget::share(const Part& part) const {
  return combined > 0.0 ? part.standard * part.standard / (combined * combined) : 0.0;
}

std::string_view name(UncertaintyBudget::Source source) {
  constexpr std::array<std::string_view, 5> names{"noise", "calibration", "tolerance", "discretisation", "model"};
  return names[static_cast<std::size_t>(source)];
}

std::string words(const UncertaintyBudget::Part& part) {
  return std::string(name(part.source)) + (part.of.empty() ? "" : " of " + part.of);
}

std::string largest_part(const UncertaintyBudget& budget) {
  if (budget.parts.empty() || budget.parts.front().source == UncertaintyBudget::Source::noise) return "";
  char share[16];
  std::snprintf(share, sizeof share, "%.0f %%", 100.0 * budget.share(budget.parts.front()));
  return "mostly " + words(budget.parts.front()) + ": " + share;
}

}  // namespace host_sim::identification
