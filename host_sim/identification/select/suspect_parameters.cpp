#include "host_sim/identification/select/suspect_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/linear_refit.hpp"
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

/// Frees one parameter after the other.
class ParameterSearch {
 public:
  ParameterSearch(IdentificationProblem& problem, const SearchSpace& space) : problem_(problem), space_(space) {}

  /// (1) without the effects' part.
  [[nodiscard]] double price(std::size_t count) const {
    return (criterion_.effect + criterion_.parameter + thresholds::violation) * static_cast<double>(count);
  }
  [[nodiscard]] const SelectionCriterion& criterion() const { return criterion_; }

  /// The model with one more freed parameter; its list of parameters grows. false: none is worth it.
  bool free_one_more(CandidateModel& model, std::vector<FreeParameter>& freed, double least_gain) {
    std::vector<std::pair<double, FreeParameter>> suspects;
    for (const FreeParameter& parameter : space_.suspects) {
      if (!holds(freed, parameter)) suspects.emplace_back(0.0, parameter);
    }
    find_promises(problem_, model.fit, suspects);
    effort_.simulations += suspects.size();
    effort_.candidates += suspects.size();
    std::sort(suspects.begin(), suspects.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    if (suspects.size() > thresholds::fitted_suspects) suspects.resize(thresholds::fitted_suspects);
    std::erase_if(suspects, [&](const auto& s) { return s.first < thresholds::promising * least_gain; });
    std::vector<CandidateModel> models(suspects.size());
    for_all(suspects.size(), [&](std::size_t i) {
      std::vector<FreeParameter> longer = freed;
      longer.push_back(suspects[i].second);
      models[i] = fitted(model.fit.hypothesis, longer, model.effects);
    });
    std::size_t best = models.size();
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (!std::isfinite(models[i].fit.chi_squared)) continue;
      if (best == models.size() || models[i].fit.chi_squared < models[best].fit.chi_squared) best = i;
    }
    if (best == models.size()) return false;
    const double gain = model.fit.chi_squared - models[best].fit.chi_squared;
    if (gain < least_gain || gain <= price(1)) return false;
    freed.push_back(suspects[best].second);
    model = std::move(models[best]);
    return true;
  }

  /// The model without one of its effects, these parameters free.
  [[nodiscard]] CandidateModel without(const CandidateModel& whole, std::size_t effect,
                                       const std::vector<FreeParameter>& freed) {
    return ModelFitter(problem_, untied(space_, freed).common, criterion_, effort_).without(whole, effect);
  }

  /// The model without one of its faults.
  [[nodiscard]] CandidateModel without_fault(const CandidateModel& whole, std::size_t fault,
                                             const std::vector<FreeParameter>& freed) {
    return ModelFitter(problem_, untied(space_, freed).common, criterion_, effort_).without_fault(whole, fault);
  }

  /// The model with one of its parameters as described again, within its tolerance.
  [[nodiscard]] CandidateModel tied(const CandidateModel& whole, const std::vector<FreeParameter>& others,
                                    const FreeParameter& parameter) {
    Hypothesis start = whole.fit.hypothesis;
    parameter.put(start, parameter.get(space_.given));
    return fitted(start, others, whole.effects);
  }

  [[nodiscard]] bool is_seen(const firmware::PlacedEffect& effect) {
    return ModelFitter(problem_, space_.common, criterion_, effort_).is_seen(effect);
  }

  [[nodiscard]] CandidateModel fitted(const Hypothesis& start, const std::vector<FreeParameter>& freed,
                                      const std::vector<firmware::PlacedEffect>& effects) {
    return ModelFitter(problem_, untied(space_, freed).common, criterion_, effort_).refitted(start, effects, 12);
  }

  [[nodiscard]] bool leaves_noise(const CandidateModel& model) {
    return ModelFitter(problem_, space_.common, criterion_, effort_).leaves_noise(model);
  }

  /// What could stand in the place of the freed parameter i: single effects, everything else refitted.
  [[nodiscard]] SuspectParameter suspect(const CandidateModel& best, const std::vector<FreeParameter>& freed,
                                         std::size_t i, const Scales& scales) {
    std::vector<FreeParameter> others = freed;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    Hypothesis start = best.fit.hypothesis;
    freed[i].put(start, freed[i].get(space_.given));
    const ModelFitter fitter(problem_, untied(space_, others).common, criterion_, effort_);
    const CandidateModel reduced = fitter.refitted(start, best.effects);
    SuspectParameter result{freed[i].path, reduced.fit.chi_squared - best.fit.chi_squared, {}};
    const double to_best = best.penalised_chi_squared(criterion_) + price(1);
    for (const CandidateModel& other : fitter.extended(reduced, scales, thresholds::suspect_rivals)) {
      result.rivals.push_back(
          {other.effects.back(), other.penalised_chi_squared(criterion_) - to_best, other.fit.hypothesis});
    }
    return result;
  }

  [[nodiscard]] std::size_t simulations() const { return effort_.simulations; }
  [[nodiscard]] std::size_t candidates() const { return effort_.candidates; }

 private:
  IdentificationProblem& problem_;
  const SearchSpace& space_;
  SelectionCriterion criterion_;
  Effort effort_;
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
struct Replacement {
  CandidateModel model;
  std::vector<FreeParameter> freed;
  std::vector<std::size_t> effects, faults;  ///< what is left of the first model's, by their place in it
};

/// A parameter more beside all effects, where more than noise is left. false: none is worth it.
bool free_beside(ParameterSearch& search_for, Replacement& now) {
  if (now.freed.size() >= thresholds::most_freed || search_for.leaves_noise(now.model)) return false;
  const double least = search_for.criterion().later_share * beyond_noise(now.model.fit);
  return search_for.free_one_more(now.model, now.freed, least);
}

double value_of(const ParameterSearch& search_for, const CandidateModel& model, std::size_t freed) {
  return model.penalised_chi_squared(search_for.criterion()) + search_for.price(freed);
}

/// A parameter less, which everything else makes superfluous. false: each is worth its price.
bool tie_again(ParameterSearch& search_for, Replacement& now) {
  const double to_beat = value_of(search_for, now.model, now.freed.size());
  for (std::size_t i = 0; i < now.freed.size(); ++i) {
    std::vector<FreeParameter> freed = now.freed;
    freed.erase(freed.begin() + static_cast<std::ptrdiff_t>(i));
    CandidateModel tied = search_for.tied(now.model, freed, now.freed[i]);
    if (value_of(search_for, tied, freed.size()) > to_beat) continue;
    now.model = std::move(tied);
    now.freed = std::move(freed);
    return true;
  }
  return false;
}

/// The model without something, or with a parameter freed in its place. false: that is no better.
bool free_instead(ParameterSearch& search_for, Replacement& now, CandidateModel reduced) {
  const double to_beat = value_of(search_for, now.model, now.freed.size()) - thresholds::replaces;
  std::vector<FreeParameter> freed = now.freed;
  if (value_of(search_for, reduced, freed.size()) >= to_beat) {
    const double needed = reduced.fit.chi_squared - now.model.fit.chi_squared;
    if (freed.size() == thresholds::most_freed || !search_for.free_one_more(reduced, freed, 0.5 * needed)) return false;
    if (value_of(search_for, reduced, freed.size()) >= to_beat) return false;
  }
  if (search_for.leaves_noise(now.model) && !search_for.leaves_noise(reduced)) return false;
  now.model = std::move(reduced);
  now.freed = std::move(freed);
  return true;
}

/// One effect or drift less, a parameter more or none. false: nothing is better.
bool replace_one(ParameterSearch& search_for, Replacement& now) {
  const SelectionCriterion& criterion = search_for.criterion();
  for (std::size_t f = 0; f < now.model.faults().size(); ++f) {
    if (now.model.faults()[f].kind != FaultKind::drift) continue;
    if (!free_instead(search_for, now, search_for.without_fault(now.model, f, now.freed))) continue;
    now.faults.erase(now.faults.begin() + static_cast<std::ptrdiff_t>(f));
    return true;
  }
  const bool clean = search_for.leaves_noise(now.model);
  for (std::size_t i = 0; i < now.model.effects.size(); ++i) {
    const firmware::PlacedEffect& effect = now.model.effects[i];
    const double own_price = criterion.effect + criterion.parameter * static_cast<double>(effect.values.size());
    // A clean effect that is cheaper than a parameter keeps its name.
    if (search_for.is_seen(effect) || (clean && now.freed.empty() && own_price < search_for.price(1))) continue;
    if (!free_instead(search_for, now, search_for.without(now.model, i, now.freed))) continue;
    now.effects.erase(now.effects.begin() + static_cast<std::ptrdiff_t>(i));
    return true;
  }
  return false;
}

/// What was found of a model, for the parts of it that are left, relative to what it is now.
template <class T>
std::vector<T> of_kept(const std::vector<T>& all, const std::vector<std::size_t>& kept) {
  std::vector<T> left;
  for (const std::size_t i : kept) left.push_back(i < all.size() ? all[i] : T());
  return left;
}

/// (4) of suspect_parameters.hpp: `found` becomes the better model.
void exchange(IdentificationProblem& problem, const SearchSpace& space, SearchResult& found) {
  ParameterSearch search_for(problem, space);
  Replacement now{found.best, found.freed, {}, {}};
  for (std::size_t i = 0; i < found.best.effects.size(); ++i) now.effects.push_back(i);
  for (std::size_t i = 0; i < found.best.faults().size(); ++i) now.faults.push_back(i);
  while (tie_again(search_for, now) || free_beside(search_for, now) || replace_one(search_for, now)) {
  }
  const SelectionCriterion& criterion = search_for.criterion();
  const double shift = now.model.penalised_chi_squared(criterion) - found.best.penalised_chi_squared(criterion);
  found.best = std::move(now.model);
  found.freed = std::move(now.freed);
  found.rivals = of_kept(found.rivals, now.effects);
  found.gains = of_kept(found.gains, now.effects);
  found.faults = of_kept(found.faults, now.faults);
  for (std::vector<Rival>& rivals : found.rivals) {
    for (Rival& rival : rivals) rival.penalised_chi_squared += shift;
  }
  for (FaultSupport& support : found.faults) {
    for (Rival& rival : support.rivals) rival.penalised_chi_squared += shift;
  }
  for (std::size_t i = 0; i < found.freed.size(); ++i) {
    found.suspects.push_back(search_for.suspect(found.best, found.freed, i, found.scales));
  }
  found.simulations += search_for.simulations();
  found.candidates += search_for.candidates();
}

/// (1) to (3) of suspect_parameters.hpp. true: `found` has become the better model.
bool parameters_first(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                      SearchResult& found) {
  ParameterSearch search_for(problem, space);
  const SelectionCriterion& criterion = search_for.criterion();
  const bool clean = search_for.leaves_noise(found.best);
  const double alone = found.best.penalised_chi_squared(criterion);
  // One parameter costs more than nothing, or than a clean effect with one parameter.
  const bool has_faults = !found.best.faults().empty();
  if (clean && !has_faults && alone - found.best.fit.chi_squared <= search_for.price(1)) return false;
  if (progress) progress(0.92, "parameters off", found.simulations, found.candidates);

  CandidateModel model;
  double tied = 0.0;
  std::vector<FreeParameter> freed;
  // Without the recordings' faults first: a parameter that is off may look like one.
  for (const bool with_faults : {false, true}) {
    if (with_faults && (!has_faults || search_for.leaves_noise(model))) break;
    Hypothesis start = found.nothing.fit.hypothesis;
    if (with_faults) start.faults = found.best.faults();
    std::vector<firmware::PlacedEffect> seen;  // what the values themselves show needs no other cause
    for (const firmware::PlacedEffect& effect : found.best.effects) {
      if (!search_for.is_seen(effect)) continue;
      firmware::put_effect(start.rig, effect);
      if (effect.channel)
        start.clocks[index(*effect.channel)] = found.best.fit.hypothesis.clocks[index(*effect.channel)];
      seen.push_back(effect);
    }
    freed.clear();
    model = search_for.fitted(start, {}, seen);
    tied = model.fit.chi_squared;
    // Beside clean effects, parameters must explain as much as these; else as much as an effect must.
    const double share = clean ? 0.5 * (tied - found.best.fit.chi_squared)
                               : criterion.first_share * std::max(beyond_noise(model.fit), 0.0);
    while (freed.size() < thresholds::most_freed && !search_for.leaves_noise(model)) {
      const double least = freed.empty() ? share : criterion.later_share * beyond_noise(model.fit);
      if (!search_for.free_one_more(model, freed, least)) break;
    }
  }
  found.simulations += search_for.simulations();
  found.candidates += search_for.candidates();
  if (freed.empty()) return false;

  SearchResult other;
  other.best = model;
  other.scales = found.scales;
  const bool explains = search_for.leaves_noise(model);
  if (!explains && clean) return false;
  const bool helps =
      tied - model.fit.chi_squared > criterion.later_share * (tied - static_cast<double>(model.fit.residual.size()));
  if (!explains) {
    if (!helps) return false;
    SearchSpace space_of_freed = untied(space, freed);
    space_of_freed.given = model.fit.hypothesis;
    const SearchOptions options{{}, true, progress};
    other = search(problem, space_of_freed, options);
    // Compared under the weights of that search; without a replacement those of the effects alone come back, since
    // their rivals were rated under them.
    const CandidateModel effects_alone = ModelFitter::refitted_in(problem, space, criterion, found.best);
    const double to_beat = effects_alone.penalised_chi_squared(criterion) - search_for.price(freed.size());
    // Leaving out its effects could save no more than their price.
    const bool may_replace = other.best.fit.chi_squared < to_beat;
    if (may_replace) compare(problem, space_of_freed, options, other);
    const bool replaces =
        may_replace && other.best.penalised_chi_squared(criterion) < to_beat &&
        pooled_error(problem, other.best.fit.hypothesis) <=
            thresholds::parameters_replace_error * pooled_error(problem, effects_alone.fit.hypothesis);
    if (!replaces) {
      problem.update_input_noise(found.best.fit.hypothesis);
      return false;
    }
  } else if (model.penalised_chi_squared(criterion) + search_for.price(freed.size()) >= alone) {
    return false;
  }
  other.rivals.resize(other.best.effects.size());
  other.gains.resize(other.best.effects.size());
  if (other.faults.empty()) other.faults = found.faults;
  other.faults.resize(other.best.faults().size());
  other.freed = std::move(freed);
  other.nothing = std::move(found.nothing);
  other.remarks = std::move(found.remarks);
  other.simulations += found.simulations;
  other.candidates += found.candidates;
  found = std::move(other);
  return true;
}

}  // namespace

void compare_parameters(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                        SearchResult& found) {
  const bool replaced = parameters_first(problem, space, progress, found);
  if (replaced || !found.best.effects.empty() || !found.best.faults().empty()) exchange(problem, space, found);
}

}  // namespace host_sim::identification
