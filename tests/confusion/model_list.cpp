#include "tests/confusion/model_list.hpp"

#include <algorithm>

#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/select/model_evidence.hpp"
#include "host_sim/identification/select/model_fitter.hpp"

namespace confusion {

using namespace host_sim::identification;

std::vector<ComparedModel> compared_models(Identified& identified) {
  const SelectionCriterion criterion;
  const SearchResult& found = identified.found;
  const ModelFitter fitter(identified.problem, identified.space.common, criterion);
  std::vector<ComparedModel> list;
  const auto add = [&](const CandidateModel& model) {
    ComparedModel compared;
    for (const auto& effect : model.effects) compared.causes.push_back(host_sim::identification::words(effect));
    for (const auto& fault : model.faults())
      compared.causes.push_back("fault " + std::to_string(static_cast<int>(fault.kind)));
    std::sort(compared.causes.begin(), compared.causes.end());
    compared.penalised = model.penalised_chi_squared(criterion);
    for (const double directions : {2.0, 4.0, 8.0}) {
      for (const bool by_power : {false, true}) {
        Tempering tempering;
        tempering.discrepancy.directions = directions;
        tempering.by_power = by_power;
        const std::string key = (by_power ? "P" : "K") + std::to_string(static_cast<int>(directions));
        const ModelEvidence evidence = evidence_of(identified.problem, model, found.scales, tempering);
        compared.evidence[key] = evidence.total();
        compared.evidence[key + " left"] = evidence.left;
        compared.evidence[key + " parameters"] = evidence.parameters;
      }
    }
    list.push_back(std::move(compared));
  };
  const CandidateModel best = fitter.refitted(found.best.fit.hypothesis, found.best.effects, 2);
  add(best);
  if (best.effects.empty()) return list;
  add(fitter.refitted(found.nothing.fit.hypothesis, {}, 2));
  constexpr std::size_t nearest = 3;
  for (std::size_t i = 0; i < best.effects.size(); ++i) {
    if (best.effects.size() > 1) add(fitter.without(best, i));
    for (std::size_t r = 0; i < found.causes.size() && r < std::min(nearest, found.causes[i].rivals.size()); ++r) {
      std::vector<firmware::PlacedEffect> effects = best.effects;
      effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(i));
      effects.push_back(found.causes[i].rivals[r].effect);
      add(fitter.refitted(found.causes[i].rivals[r].hypothesis, std::move(effects), 4));
    }
  }
  return list;
}

}  // namespace confusion
