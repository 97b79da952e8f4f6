#include "host_sim/identification/select/select_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host_sim/identification/estimate/left_by_fit.hpp"
#include "host_sim/identification/estimate/lower_minimum.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/law_constancy.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "host_sim/identification/select/search_apart.hpp"
#include "host_sim/identification/select/search_under_model_error.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Whether χ² falls in one step, and not on the way to the size of an effect (thresholds::on_the_way): dry friction of
/// 40 N turns in another sample, which is worth 200. Asked of effects that have one size.
bool comes_in_a_step(const IdentificationProblem& problem, const Fit& best, const firmware::PlacedEffect& effect) {
  if (effect.values.size() != 1 || effect.entry->parameters.front().neutral != 0.0) return false;
  const auto chi_squared = [&](double share) {
    Hypothesis hypothesis = best.hypothesis;
    firmware::PlacedEffect smaller = effect;
    smaller.values.front() *= share;
    firmware::remove_effect(hypothesis.rig, *effect.entry, effect.channel);
    if (share > 0.0) firmware::put_effect(hypothesis.rig, smaller);
    return residuals(problem, predict(problem, hypothesis)).squaredNorm();
  };
  const double without = chi_squared(0.0), gain = without - best.chi_squared;
  constexpr std::array shares{0.25, 0.5, 0.75};
  double come = 0.0;
  for (const double share : shares) come += (without - chi_squared(share)) / (1.0 - std::pow(1.0 - share, 2));
  return come < thresholds::on_the_way * gain * static_cast<double>(shares.size());
}

/// Leaves out weak effects beside friction and free play that a step of χ² has let in. Not where the model leaves more
/// than noise: there each effect may stand in for a part of what is missing.
void leave_out_steps(IdentificationProblem& problem, const SearchSpace& space, const SelectionCriterion& criterion,
                     SearchResult& found) {
  if (!found.freed.empty() || found.causes.size() != found.best.effects.size()) return;
  const ModelFitter fitter(problem, space.common, criterion);
  if (!fitter.leaves_noise(found.best)) return;
  for (std::size_t i = 0; i < found.causes.size();) {
    const firmware::PlacedEffect& effect = found.best.effects[i];
    model::RigParameters<double> others = found.best.fit.hypothesis.rig;
    firmware::remove_effect(others, *effect.entry, effect.channel);
    if (found.causes[i].gain >= thresholds::gain_of_steps || fitter.is_seen(effect) || !has_corners(others) ||
        !comes_in_a_step(problem, found.best.fit, effect)) {
      ++i;
      continue;
    }
    found.best = fitter.without(found.best, i);
    found.causes.erase(found.causes.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
}

/// The end of a selection. Free play that was found last was a guess when its knocks were looked for
/// (noise/identification_problem.hpp), and its model may have lower minima.
void settle(IdentificationProblem& problem, const SearchSpace& space, const SelectionCriterion& criterion,
            SearchResult& found) {
  if (has_free_play(found.best.fit.hypothesis.rig) && problem.update_input_noise(found.best.fit.hypothesis)) {
    for (Fit* const each : {&found.nothing.fit, &found.best.fit})
      *each = fit(problem, each->hypothesis, each->parameters, 8);
  }
  find_lower_minimum(problem, found.best.fit);
  leave_out_steps(problem, space, criterion, found);
}

/// Steps 1, 2 and 4. false: the search was stopped behind step 1, since it explains less than `worth_comparing`, or
/// leaves more than noise and has spent what it may.
bool select_in_noise(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                     const SelectionCriterion& criterion, double worth_comparing, SearchResult& found) {
  const SearchOptions options{criterion, true, progress};
  const StageBudget budget(problem);
  found = search(problem, space, options);
  const auto may_go_on = [&] {
    return is_whole(problem, found.best.fit) || budget.allows(problem, "rivals of laws that could imitate others");
  };
  if (worth_comparing > 0.0 && (leaves_more(problem, found.best, found.nothing, worth_comparing) || !may_go_on())) {
    return false;
  }
  compare(problem, space, options, found);
  compare_parameters(problem, space, progress, found);
  settle(problem, space, criterion, found);
  find_constancy(problem, found);
  return true;
}

/// Parameters that are off, with effects beside them, where these leave nothing but noise. Asked before the search
/// under model error, whose χ² is no measure for them: a tyre 8 % too soft left 80 times the noise behind every effect,
/// and was called a law. false: `problem` and `found` stay.
bool parameters_explain_all(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                            SearchResult& found) {
  IdentificationProblem other = problem;
  SearchResult off = found;
  const bool better = parameters_instead(other, space, progress, off, true);
  if (!better || off.freed.empty() || !is_whole(other, off.best.fit)) {
    return false;
  }
  problem = std::move(other);
  found = std::move(off);
  return true;
}

/// Whether the size of an effect changes, so that it is another law.
bool changes(const SearchResult& found) {
  return std::any_of(found.causes.begin(), found.causes.end(),
                     [](const FoundCause& cause) { return cause.constancy.fails(); });
}

/// Whether two of the effects may be one law that could imitate them: it contains one of them, at the same place.
bool may_be_one_law(const SearchResult& found) {
  const auto at_suspension = [](const firmware::PlacedEffect& e) {
    return e.entry->subsystem == model::Subsystem::suspension;
  };
  const auto& effects = found.best.effects;
  if (std::count_if(effects.begin(), effects.end(), at_suspension) < 2) return false;
  return std::any_of(effects.begin(), effects.end(), [](const firmware::PlacedEffect& e) {
    const auto all = firmware::catalogue();
    return std::any_of(all.begin(), all.end(), [&](const firmware::CatalogueEntry& other) {
      return other.imitates && other.contains == e.entry->name;
    });
  });
}

/// true: at least one effect could imitate others, and each that could has one parameter.
bool bends_into_nothing(const SearchResult& found) {
  const auto& effects = found.best.effects;
  const auto imitates = [](const firmware::PlacedEffect& e) { return e.entry->imitates; };
  return std::any_of(effects.begin(), effects.end(), imitates) &&
         std::all_of(effects.begin(), effects.end(),
                     [&](const firmware::PlacedEffect& e) { return !imitates(e) || e.entry->parameters.size() == 1; });
}

/// Whether laws that could imitate others explain what the rest of the catalogue leaves, or the same with fewer
/// effects.
bool takes_its_place(const IdentificationProblem& problem, const SearchResult& imitating, const SearchResult& found,
                     bool rest) {
  const Hypothesis& hypothesis = imitating.best.fit.hypothesis;
  if (!std::isfinite(imitating.best.fit.chi_squared) || !stays_finite(problem, hypothesis)) return false;
  const auto leaves = [&](double share) {
    return leaves_at_most(share, explained(problem, hypothesis), explained(problem, found.best.fit.hypothesis));
  };
  const SelectionCriterion criterion;
  const bool better = criterion.prefers(imitating.best, found.best);
  const bool fewer = imitating.best.effects.size() < found.best.effects.size();
  if (rest && fewer && better && bends_into_nothing(imitating) && leaves(1.0)) return true;
  if (changes(imitating)) return false;
  if (rest && leaves(thresholds::nearly_all)) return true;
  return (rest || (fewer && better)) && is_whole(problem, imitating.best.fit);
}

}  // namespace

double explained_share(double refit_per_residual, double after_per_residual, double count) {
  return 1.0 - std::max(after_per_residual - 1.0, 0.0) / std::max(refit_per_residual - 1.0, 1.0 / count);
}

bool leaves_more(const IdentificationProblem& problem, const CandidateModel& model, const CandidateModel& nothing,
                 double share) {
  const auto count = static_cast<double>(model.fit.residual.size());
  const double explained = explained_share(nothing.fit.chi_squared / count, model.fit.chi_squared / count, count);
  return explained < share && unexplained_residual(problem, model.fit.hypothesis).significant;
}

double temper_of(const Fit& fit) {
  return std::max(1.0, fit.chi_squared / std::max(1.0, static_cast<double>(fit.residual.size())));
}

bool leaves_a_rest(const IdentificationProblem& problem, const SearchResult& found) {
  return changes(found) || !is_whole(problem, found.best.fit);
}

bool is_whole(const IdentificationProblem& problem, const Fit& fit) { return !left_by(problem, fit).any(); }

SearchResult select_in_noise(IdentificationProblem& problem, const SearchSpace& space,
                             const ProgressCallback& progress) {
  SearchResult found;
  select_in_noise(problem, space, progress, {}, 0.0, found);
  return found;
}

SearchResult select_model(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress) {
  const IdentificationProblem before = problem;
  const SearchOptions options{{}, true, progress};
  SearchResult found = search(problem, space, options);
  bool far = leaves_more(problem, found.best, found.nothing, thresholds::explains_most);
  const std::size_t causes = found.best.effects.size() + found.best.faults().size();
  const bool off = far ? parameters_explain_all(problem, space, progress, found)
                       : causes >= thresholds::many_causes && parameters_instead(problem, space, progress, found);
  if (off) far = false;
  if (!far && !off) compare(problem, space, options, found);
  if (far || leaves_more(problem, found.best, found.nothing, thresholds::explains_all)) {
    const bool replaced =
        may_begin(problem, "search under model error") && search_under_model_error(problem, space, progress, found);
    if (far && !replaced) compare(problem, space, options, found);
  }
  if (found.freed.empty() && may_begin(problem, "parameters in the place of effects")) {
    compare_parameters(problem, space, progress, found);
  }
  settle(problem, space, {}, found);
  find_constancy(problem, found);
  const bool rest = leaves_a_rest(problem, found);
  if (!rest && !may_be_one_law(found)) return found;
  if (rest && may_begin(problem, "machine and component apart") && search_apart(problem, space, progress, found)) {
    find_constancy(problem, found);
    return found;
  }
  if (!may_begin(problem, "laws that could imitate others")) return found;
  IdentificationProblem other = before;
  SearchResult imitating;
  // What leaves that much is no answer, however its effects are exchanged.
  const bool compared =
      select_in_noise(other, space, progress, {.imitating = true}, thresholds::explains_most, imitating);
  if (!compared || !takes_its_place(other, imitating, found, rest)) {
    return found;
  }
  problem = std::move(other);
  return imitating;
}

}  // namespace host_sim::identification
