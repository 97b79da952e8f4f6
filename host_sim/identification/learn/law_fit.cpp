#include "host_sim/identification/learn/law_fit.hpp"

#include <utility>

namespace host_sim::identification {

std::vector<FreeParameter> parameters_with_laws(const SearchSpace& space, const Hypothesis& hypothesis,
                                                const std::vector<firmware::PlacedEffect>& effects) {
  std::vector<FreeParameter> list = space.common;
  const auto append = [&list](const std::vector<FreeParameter>& more) {
    list.insert(list.end(), more.begin(), more.end());
  };
  append(law_parameters(hypothesis.laws));
  append(fault_parameters(hypothesis.faults));
  for (const firmware::PlacedEffect& effect : effects) append(effect_parameters(effect));
  return list;
}

Hypothesis with_effects(const SearchSpace& space, const Hypothesis& from,
                        const std::vector<firmware::PlacedEffect>& kept) {
  Hypothesis hypothesis = from;
  hypothesis.rig.effects = space.given.rig.effects;
  for (const firmware::PlacedEffect& effect : kept) firmware::put_effect(hypothesis.rig, effect);
  return hypothesis;
}

CandidateModel fitted_with_laws(const IdentificationProblem& problem, const SearchSpace& space, const Hypothesis& start,
                                std::vector<firmware::PlacedEffect> effects, int most) {
  CandidateModel model;
  model.fit = fit(problem, start, parameters_with_laws(space, start, effects), most);
  refresh_jacobian(problem, model.fit);
  model.channels = problem.channels().size();
  for (firmware::PlacedEffect& effect : effects) {
    for (const firmware::PlacedEffect& now : firmware::effects_of(model.fit.hypothesis.rig)) {
      if (now.entry == effect.entry && now.channel == effect.channel) effect.values = now.values;
    }
  }
  model.effects = std::move(effects);
  return model;
}

}  // namespace host_sim::identification
