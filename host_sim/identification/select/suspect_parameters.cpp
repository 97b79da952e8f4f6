#include "host_sim/identification/select/suspect_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/linear_refit.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// What freeing each of some parameters promises beside a fitted model.
void find_promises(const IdentificationProblem& problem, const Fit& base,
                   std::vector<std::pair<double, FreeParameter>>& suspects) {
  const LinearRefit others(base);
  std::vector<Variation> variations;
  for (const auto& [promise, parameter] : suspects) {
    variations.push_back({base.hypothesis, std::nullopt});
    Hypothesis& moved = variations.back().hypothesis;
    parameter.put(moved, parameter.get(moved) + parameter.difference);
  }
  const std::vector<Eigen::VectorXd> values = residuals_of_each(problem, variations, false, &base.prediction);
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    const Eigen::VectorXd d = (values[i] - base.residual) / suspects[i].second.difference;
    suspects[i].first = d.allFinite() ? others.free_gain(d) : 0.0;
  }
}

bool is_same(const FreeParameter& a, const FreeParameter& b) { return a.path == b.path; }

bool holds(const std::vector<FreeParameter>& list, const FreeParameter& parameter) {
  return std::any_of(list.begin(), list.end(), [&](const FreeParameter& p) { return is_same(p, parameter); });
}

/// A model, and the parameters that no tolerance binds in it.
struct FreedModel {
  CandidateModel model;
  std::vector<FreeParameter> freed;
};

/// Frees one parameter after the other.
class ParameterSearch {
 public:
  ParameterSearch(IdentificationProblem& problem, const SearchSpace& space) : problem_(problem), space_(space) {}

  /// (1) without the effects' part.
  [[nodiscard]] double price(std::size_t count) const {
    return (criterion_.effect + criterion_.parameter + thresholds::violation) * static_cast<double>(count);
  }
  [[nodiscard]] const SelectionCriterion& criterion() const { return criterion_; }
  [[nodiscard]] double value(const FreedModel& m) const {
    return m.model.penalised_chi_squared(criterion_) + price(m.freed.size());
  }

  /// The models with one more freed parameter, of those that promise most; only what is worth it, best first.
  [[nodiscard]] std::vector<FreedModel> one_more(const FreedModel& from, double least_gain) {
    std::vector<std::pair<double, FreeParameter>> suspects;
    for (const FreeParameter& parameter : space_.suspects) {
      if (!holds(from.freed, parameter)) suspects.emplace_back(0.0, parameter);
    }
    find_promises(problem_, from.model.fit, suspects);
    problem_.work().add_candidates(suspects.size());
    std::sort(suspects.begin(), suspects.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    if (suspects.size() > thresholds::fitted_suspects) suspects.resize(thresholds::fitted_suspects);
    std::erase_if(suspects, [&](const auto& s) { return s.first < thresholds::promising * least_gain; });
    std::vector<FreedModel> models(suspects.size());
    for_all(suspects.size(), [&](std::size_t i) {
      models[i].freed = from.freed;
      models[i].freed.push_back(suspects[i].second);
      models[i].model = fitted(from.model.fit.hypothesis, models[i].freed, from.model.effects);
    });
    std::erase_if(models, [&](const FreedModel& m) {
      const double gain = from.model.fit.chi_squared - m.model.fit.chi_squared;
      return !std::isfinite(gain) || gain < least_gain || gain <= price(1);
    });
    std::stable_sort(models.begin(), models.end(), [](const FreedModel& a, const FreedModel& b) {
      return a.model.fit.chi_squared < b.model.fit.chi_squared;
    });
    return models;
  }

  /// The best of them takes the place of `now`. false: none is worth it.
  bool free_one_more(FreedModel& now, double least_gain) {
    std::vector<FreedModel> models = one_more(now, least_gain);
    if (models.empty()) return false;
    now = std::move(models.front());
    return true;
  }

  /// Whether an effect of a model does what the last freed parameter of `other` does: a damper, a relaxation of
  /// microseconds. From the model without either, their changes of the residuals point the same way
  /// (thresholds::at_the_limit).
  [[nodiscard]] bool is_at_its_limit(const CandidateModel& whole, std::size_t effect, const FreedModel& other) {
    const firmware::PlacedEffect& left_out = whole.effects[effect];
    std::vector<Variation> variations(2, {whole.fit.hypothesis, std::nullopt});
    for (Variation& v : variations) firmware::remove_effect(v.hypothesis.rig, *left_out.entry, left_out.channel);
    const FreeParameter& parameter = other.freed.back();
    parameter.put(variations[1].hypothesis, parameter.get(other.model.fit.hypothesis));
    const std::vector<Eigen::VectorXd> values = residuals_of_each(problem_, variations, false, &whole.fit.prediction);
    const Eigen::VectorXd by_effect = whole.fit.residual - values[0], by_parameter = values[1] - values[0];
    return by_effect.dot(by_parameter) >= thresholds::at_the_limit * by_effect.norm() * by_parameter.norm();
  }

  /// The model without one of its effects, these parameters free.
  [[nodiscard]] CandidateModel without(const CandidateModel& whole, std::size_t effect,
                                       const std::vector<FreeParameter>& freed) {
    return ModelFitter(problem_, untied(space_, freed).common, criterion_).without(whole, effect);
  }

  /// The model without one of its faults.
  [[nodiscard]] CandidateModel without_fault(const CandidateModel& whole, std::size_t fault,
                                             const std::vector<FreeParameter>& freed) {
    return ModelFitter(problem_, untied(space_, freed).common, criterion_).without_fault(whole, fault);
  }

  /// The model with one of its parameters within its tolerance again: from where it is, if that is within, else as
  /// described.
  [[nodiscard]] CandidateModel tied(const CandidateModel& whole, const std::vector<FreeParameter>& others,
                                    const FreeParameter& parameter) {
    Hypothesis start = whole.fit.hypothesis;
    const auto within = [&](const FreeParameter& tolerated) {
      const double at = tolerated.get(start);
      return is_same(tolerated, parameter) && at >= tolerated.lower && at <= tolerated.upper;
    };
    if (std::none_of(space_.tolerated.begin(), space_.tolerated.end(), within))
      parameter.put(start, parameter.get(space_.given));
    return fitted(start, others, whole.effects);
  }

  [[nodiscard]] bool is_seen(const firmware::PlacedEffect& effect) {
    return ModelFitter(problem_, space_.common, criterion_).is_seen(effect);
  }

  [[nodiscard]] CandidateModel fitted(const Hypothesis& start, const std::vector<FreeParameter>& freed,
                                      const std::vector<firmware::PlacedEffect>& effects) {
    return ModelFitter(problem_, untied(space_, freed).common, criterion_).refitted(start, effects, 12);
  }

  [[nodiscard]] bool leaves_noise(const CandidateModel& model) {
    return ModelFitter(problem_, space_.common, criterion_).leaves_noise(model);
  }

  /// What could stand in the place of the freed parameter i: single effects and other parameters, everything else
  /// refitted.
  [[nodiscard]] SuspectParameter suspect(const CandidateModel& best, const std::vector<FreeParameter>& freed,
                                         std::size_t i, const Scales& scales) {
    std::vector<FreeParameter> others = freed;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    Hypothesis start = best.fit.hypothesis;
    freed[i].put(start, freed[i].get(space_.given));
    const ModelFitter fitter(problem_, untied(space_, others).common, criterion_);
    const CandidateModel reduced = fitter.refitted(start, best.effects);
    SuspectParameter result{freed[i].path, {.gain = reduced.fit.chi_squared - best.fit.chi_squared}};
    const double to_best = best.penalised_chi_squared(criterion_) + price(1);
    for (const CandidateModel& other : fitter.extended(reduced, scales, thresholds::suspect_rivals)) {
      result.cause.rivals.push_back(
          {other.effects.back(), other.penalised_chi_squared(criterion_) - to_best, other.fit.hypothesis});
    }
    // A length of a duct and its diameter may be one number to these channels.
    for (const FreedModel& other : one_more({reduced, others}, 0.5 * result.cause.gain)) {
      const FreeParameter& parameter = other.freed.back();
      if (is_same(parameter, freed[i])) continue;
      result.cause.parameters.push_back({parameter.path, parameter.value(parameter.get(other.model.fit.hypothesis)),
                                         other.model.fit.chi_squared - best.fit.chi_squared,
                                         other.model.fit.hypothesis});
    }
    return result;
  }

 private:
  IdentificationProblem& problem_;
  const SearchSpace& space_;
  SelectionCriterion criterion_;
};

}  // namespace

SearchSpace untied(const SearchSpace& space, const std::vector<FreeParameter>& parameters) {
  SearchSpace result = space;
  for (const FreeParameter& parameter : parameters) {
    for (std::vector<FreeParameter>* list : {&result.tolerated, &result.common}) {
      const auto same = std::find_if(list->begin(), list->end(), [&](const FreeParameter& p) {
        return p.role == FreeParameter::Role::tolerated && is_same(p, parameter);
      });
      if (same != list->end()) {
        *same = parameter;
      } else {  // behind the tolerated ones, before the states at the start
        list->insert(
            list->begin() + static_cast<std::ptrdiff_t>(result.tolerated.size() - (list == &result.common ? 1 : 0)),
            parameter);
      }
    }
  }
  return result;
}

namespace {

/// Effects that a parameter explains as well: each is left out and, where that costs something, a parameter freed in
/// its place.
struct Replacement : FreedModel {
  std::vector<std::size_t> effects, faults;  ///< what is left of the first model's, by their place in it
};

/// A parameter more beside all effects, where more than noise is left. false: none is worth it.
bool free_beside(ParameterSearch& search_for, Replacement& now) {
  if (now.freed.size() >= thresholds::most_freed || search_for.leaves_noise(now.model)) return false;
  const double least = search_for.criterion().later_share * beyond_noise(now.model.fit);
  return search_for.free_one_more(now, least);
}

/// A parameter less, which everything else makes superfluous. false: each is worth its price.
bool tie_again(ParameterSearch& search_for, FreedModel& now) {
  const double to_beat = search_for.value(now);
  for (std::size_t i = 0; i < now.freed.size(); ++i) {
    FreedModel fewer;
    fewer.freed = now.freed;
    fewer.freed.erase(fewer.freed.begin() + static_cast<std::ptrdiff_t>(i));
    fewer.model = search_for.tied(now.model, fewer.freed, now.freed[i]);
    if (search_for.value(fewer) > to_beat) continue;
    now = std::move(fewer);
    return true;
  }
  return false;
}

/// Beside a parameter that was freed in the place of one effect, another effect less: a softer spring is a gain of F,
/// but for a damper that makes up for what the gain takes from the damping. nullopt: none of these is better than
/// `to_beat`; else the place of that effect.
std::optional<std::size_t> leave_out_another(ParameterSearch& search_for, FreedModel& other, double to_beat) {
  for (std::size_t i = 0; i < other.model.effects.size(); ++i) {
    if (search_for.is_seen(other.model.effects[i])) continue;
    FreedModel less;
    less.freed = other.freed;
    less.model = search_for.without(other.model, i, other.freed);
    if (search_for.value(less) >= to_beat) continue;
    other = std::move(less);
    return i;
  }
  return std::nullopt;
}

/// The model without something, or with a parameter freed in its place. `effect`: what is left out, of the effects of
/// `now`, whose places go with it; none: the caller's. `keeps_name`: an effect that no parameter replaces by doing the
/// same. false: that is no better.
bool free_instead(ParameterSearch& search_for, Replacement& now, CandidateModel reduced,
                  std::optional<std::size_t> effect, bool keeps_name = false) {
  const double value = search_for.value(now);
  FreedModel other;
  other.model = std::move(reduced);
  other.freed = now.freed;
  std::optional<std::size_t> another;
  if (search_for.value(other) >= value - thresholds::replaces) {
    const double needed = other.model.fit.chi_squared - now.model.fit.chi_squared;
    if (now.freed.size() == thresholds::most_freed || !search_for.free_one_more(other, 0.5 * needed)) return false;
    // Together with what is left out, another parameter may have been in the wrong one's place.
    while (!now.freed.empty() && tie_again(search_for, other)) {
    }
    if (effect && search_for.value(other) >= value - thresholds::replaces) {
      another = leave_out_another(search_for, other, value - thresholds::replaces);
    }
    const double worse = search_for.value(other) - value;
    const double error = std::clamp(other.model.fit.chi_squared - now.model.fit.chi_squared, 0.0,
                                    thresholds::model_error_of_limit * needed);
    const bool limit = worse >= -thresholds::replaces && worse - error < thresholds::tie && effect && !keeps_name &&
                       !other.freed.empty() && search_for.is_at_its_limit(now.model, *effect, other);
    if (worse >= -thresholds::replaces && !limit) return false;
  }
  if (search_for.leaves_noise(now.model) && !search_for.leaves_noise(other.model)) return false;
  now.FreedModel::operator=(std::move(other));
  if (effect) now.effects.erase(now.effects.begin() + static_cast<std::ptrdiff_t>(*effect));
  if (another) now.effects.erase(now.effects.begin() + static_cast<std::ptrdiff_t>(*another));
  return true;
}

/// One effect or drift less, a parameter more or none. false: nothing is better.
bool replace_one(ParameterSearch& search_for, Replacement& now) {
  const SelectionCriterion& criterion = search_for.criterion();
  for (std::size_t f = 0; f < now.model.faults().size(); ++f) {
    if (now.model.faults()[f].kind != FaultKind::drift) continue;
    if (!free_instead(search_for, now, search_for.without_fault(now.model, f, now.freed), std::nullopt)) continue;
    now.faults.erase(now.faults.begin() + static_cast<std::ptrdiff_t>(f));
    return true;
  }
  const bool clean = search_for.leaves_noise(now.model);
  for (std::size_t i = 0; i < now.model.effects.size(); ++i) {
    const firmware::PlacedEffect& effect = now.model.effects[i];
    const double own_price = criterion.effect + criterion.parameter * static_cast<double>(effect.values.size());
    if (search_for.is_seen(effect)) continue;
    // A clean effect that is cheaper than a parameter keeps its name, unless two of them are dearer.
    const bool keeps_name = clean && now.freed.empty() && own_price < search_for.price(1);
    if (keeps_name && now.model.effects.size() < 2) continue;
    if (free_instead(search_for, now, search_for.without(now.model, i, now.freed), i, keeps_name)) return true;
  }
  return false;
}

/// Two effects less, a parameter more or none, where a parameter stands at the bound of its tolerance: it would go on,
/// and two effects may be what keeps the rest in place (a gain of F and a stop of no clearance for a weaker damper).
/// false: nothing is better.
bool replace_two(ParameterSearch& search_for, Replacement& now) {
  const auto at_bound = [&](const FreeParameter& p) {
    return p.role == FreeParameter::Role::tolerated && p.at_bound(now.model.fit.hypothesis);
  };
  const auto& parameters = now.model.fit.parameters;
  if (std::none_of(parameters.begin(), parameters.end(), at_bound)) return false;
  for (std::size_t second = 1; second < now.model.effects.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      if (search_for.is_seen(now.model.effects[first]) || search_for.is_seen(now.model.effects[second])) continue;
      CandidateModel reduced = search_for.without(search_for.without(now.model, second, now.freed), first, now.freed);
      if (!free_instead(search_for, now, std::move(reduced), std::nullopt)) continue;
      now.effects.erase(now.effects.begin() + static_cast<std::ptrdiff_t>(second));
      now.effects.erase(now.effects.begin() + static_cast<std::ptrdiff_t>(first));
      return true;
    }
  }
  return false;
}

/// What was found of a model, for the parts of it that are left, relative to what it is now.
std::vector<FoundCause> of_kept(const std::vector<FoundCause>& all, const std::vector<std::size_t>& kept,
                                double shift) {
  std::vector<FoundCause> left;
  for (const std::size_t i : kept) {
    left.push_back(i < all.size() ? all[i] : FoundCause());
    left.back().shift_rivals(shift);
  }
  return left;
}

/// (4) of suspect_parameters.hpp: `found` becomes the better model.
void exchange(IdentificationProblem& problem, const SearchSpace& space, SearchResult& found) {
  ParameterSearch search_for(problem, space);
  const StageBudget budget(problem);
  Replacement now{{found.best, found.freed}, {}, {}};
  for (std::size_t i = 0; i < found.best.effects.size(); ++i) now.effects.push_back(i);
  for (std::size_t i = 0; i < found.best.faults().size(); ++i) now.faults.push_back(i);
  while (budget.allows(problem, "some parameters in the place of effects") &&
         (tie_again(search_for, now) || free_beside(search_for, now) || replace_one(search_for, now) ||
          replace_two(search_for, now))) {
  }
  const SelectionCriterion& criterion = search_for.criterion();
  const double shift = now.model.penalised_chi_squared(criterion) - found.best.penalised_chi_squared(criterion);
  found.best = std::move(now.model);
  found.freed = std::move(now.freed);
  found.causes = of_kept(found.causes, now.effects, shift);
  found.faults = of_kept(found.faults, now.faults, shift);
  for (std::size_t i = 0; i < found.freed.size(); ++i) {
    found.suspects.push_back(search_for.suspect(found.best, found.freed, i, found.scales));
  }
}

/// The rig as it would be without effects or, with those that the values themselves show, with the recordings' faults.
CandidateModel only_seen(ParameterSearch& search_for, const SearchResult& found, bool with_faults) {
  Hypothesis start = found.nothing.fit.hypothesis;
  if (with_faults) start.faults = found.best.faults();
  std::vector<firmware::PlacedEffect> seen;  // what the values themselves show needs no other cause
  for (const firmware::PlacedEffect& effect : found.best.effects) {
    if (!search_for.is_seen(effect)) continue;
    firmware::put_effect(start.rig, effect);
    if (effect.channel) start.clocks[index(*effect.channel)] = found.best.fit.hypothesis.clocks[index(*effect.channel)];
    seen.push_back(effect);
  }
  return search_for.fitted(start, {}, seen);
}

/// Parameters instead of effects.
struct FreedInstead {
  CandidateModel tied;              ///< with none
  FreedModel best;                  ///< one after the other, the best each time
  std::vector<FreedModel> singles;  ///< the first alone, and each that explains nearly as much
};

/// (1) of suspect_parameters.hpp, without the recordings' faults first: a parameter that is off may look like one.
FreedInstead free_instead_of_effects(ParameterSearch& search_for, const SearchResult& found, bool clean) {
  const SelectionCriterion& criterion = search_for.criterion();
  FreedInstead result;
  for (const bool with_faults : {false, true}) {
    if (with_faults && (found.best.faults().empty() || search_for.leaves_noise(result.best.model))) break;
    result = FreedInstead();
    result.tied = only_seen(search_for, found, with_faults);
    result.best.model = result.tied;
    // Beside clean effects, parameters must explain as much as these; else as much as an effect must.
    const double share = clean ? 0.5 * (result.tied.fit.chi_squared - found.best.fit.chi_squared)
                               : criterion.first_share * std::max(beyond_noise(result.tied.fit), 0.0);
    while (result.best.freed.size() < thresholds::most_freed && !search_for.leaves_noise(result.best.model)) {
      const bool first = result.best.freed.empty();
      std::vector<FreedModel> more =
          search_for.one_more(result.best, first ? share : criterion.later_share * beyond_noise(result.best.model.fit));
      if (more.empty()) break;
      result.best = more.front();
      if (!first) continue;
      const double gain = result.tied.fit.chi_squared - result.best.model.fit.chi_squared;
      std::erase_if(more, [&](const FreedModel& m) {
        return result.tied.fit.chi_squared - m.model.fit.chi_squared < thresholds::equal_suspects * gain;
      });
      result.singles = std::move(more);
    }
  }
  return result;
}

/// Effects that were found beside freed parameters.
struct BesideFreed {
  SearchResult result;
  double advantage;  ///< how much lower (1) is than with effects alone
};

/// Effects beside freed parameters. nullopt: no better than effects alone.
std::optional<BesideFreed> search_beside(IdentificationProblem& problem, const SearchSpace& space,
                                         const ParameterSearch& search_for, const ProgressCallback& progress,
                                         const FreedModel& start, const SearchResult& found, bool whole) {
  const SelectionCriterion& criterion = search_for.criterion();
  SearchSpace space_of_freed = untied(space, start.freed);
  space_of_freed.given = start.model.fit.hypothesis;
  // What is described has no name: holds that the values show are found again.
  for (const firmware::PlacedEffect& effect : start.model.effects) {
    firmware::remove_effect(space_of_freed.given.rig, *effect.entry, effect.channel);
  }
  const SearchOptions options{{}, true, progress};
  SearchResult other = search(problem, space_of_freed, options);
  // Compared under the weights of that search; without a replacement those of the effects alone come back, since
  // their rivals were rated under them.
  const CandidateModel effects_alone = ModelFitter::refitted_in(problem, space, criterion, found.best);
  const double to_beat = effects_alone.penalised_chi_squared(criterion) - search_for.price(start.freed.size());
  // Leaving out its effects could save no more than their price.
  if (other.best.fit.chi_squared >= to_beat) return std::nullopt;
  if (whole && leaves_more(problem, other.best, found.nothing, thresholds::explains_most)) return std::nullopt;
  compare(problem, space_of_freed, options, other);
  const double value = other.best.penalised_chi_squared(criterion);
  if (value >= to_beat ||
      pooled_error(problem, other.best.fit.hypothesis) >
          thresholds::parameters_replace_error * pooled_error(problem, effects_alone.fit.hypothesis)) {
    return std::nullopt;
  }
  other.freed = start.freed;
  return BesideFreed{std::move(other), to_beat - value};
}

/// (3) of suspect_parameters.hpp: the best of what is found beside each of these. nullopt: effects alone are better;
/// the problem weights residuals for what is returned.
std::optional<SearchResult> search_beside_each(IdentificationProblem& problem, const SearchSpace& space,
                                               const ParameterSearch& search_for, const ProgressCallback& progress,
                                               const FreedInstead& instead, const SearchResult& found, bool whole) {
  std::vector<FreedModel> starts = instead.singles;
  if (instead.best.freed.size() > 1) starts.push_back(instead.best);
  std::optional<BesideFreed> best;
  const StageBudget budget(problem);
  for (const FreedModel& start : starts) {
    if (!budget.allows(problem, "effects beside some parameters that may be off")) break;
    std::optional<BesideFreed> other = search_beside(problem, space, search_for, progress, start, found, whole);
    if (other && (!best || other->advantage > best->advantage)) best = std::move(other);
  }
  problem.update_input_noise(best ? best->result.best.fit.hypothesis : found.best.fit.hypothesis);
  if (!best) return std::nullopt;
  return std::move(best->result);
}

/// (1) to (3) of suspect_parameters.hpp. true: `found` has become the better model.
bool parameters_first(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                      SearchResult& found, bool whole) {
  ParameterSearch search_for(problem, space);
  const SelectionCriterion& criterion = search_for.criterion();
  const bool clean = search_for.leaves_noise(found.best);
  const double alone = found.best.penalised_chi_squared(criterion);
  // One parameter costs more than nothing, or than a clean effect with one parameter.
  const bool has_faults = !found.best.faults().empty();
  if (clean && !has_faults && alone - found.best.fit.chi_squared <= search_for.price(1)) return false;
  if (progress) progress(0.92, "parameters off", problem.work().simulations(), problem.work().candidates());

  const FreedInstead instead = free_instead_of_effects(search_for, found, clean);
  if (instead.best.freed.empty()) return false;

  SearchResult other;
  if (search_for.leaves_noise(instead.best.model)) {
    if (search_for.value(instead.best) >= alone) return false;
    other.best = instead.best.model;
    other.freed = instead.best.freed;
    other.scales = found.scales;
  } else {
    const double tied = instead.tied.fit.chi_squared;
    const double noise = static_cast<double>(instead.tied.fit.residual.size());
    const bool helps = tied - instead.best.model.fit.chi_squared > criterion.later_share * (tied - noise);
    if (clean || !helps) return false;
    auto beside = search_beside_each(problem, space, search_for, progress, instead, found, whole);
    if (!beside) return false;
    other = std::move(*beside);
  }
  other.causes.resize(other.best.effects.size());
  if (other.faults.empty()) other.faults = found.faults;
  other.faults.resize(other.best.faults().size());
  other.nothing = std::move(found.nothing);
  found = std::move(other);
  return true;
}

}  // namespace

void compare_parameters(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                        SearchResult& found) {
  const bool replaced = parameters_first(problem, space, progress, found, false);
  if (replaced || !found.best.effects.empty() || !found.best.faults().empty()) exchange(problem, space, found);
}

bool parameters_instead(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                        SearchResult& found, bool whole) {
  if (!parameters_first(problem, space, progress, found, whole)) return false;
  exchange(problem, space, found);
  return true;
}

}  // namespace host_sim::identification
