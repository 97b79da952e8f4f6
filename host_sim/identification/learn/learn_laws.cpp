#include "host_sim/identification/learn/learn_laws.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/learn/law_and_effects.hpp"
#include "host_sim/identification/learn/law_search.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/law_constancy.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// What a law is, in words that tell it from laws of another kind.
std::string kind_of(const PlacedLaw& law) {
  switch (law.family) {
    case LawFamily::sliders:
      return "hysteresis";
    case LawFamily::maxwell:
      return "lag";
    case LawFamily::follows_load:
      return "friction that follows the load";
    case LawFamily::along_stroke:
      return "damping that changes along the stroke";
    case LawFamily::free_surface:
      return "a law over deflection and velocity";
    default:
      break;
  }
  std::string text = "a law over the ";
  text += name(law.over);
  if (law.place != CurvePlace::suspension) text.append(" of the ").append(name(law.place));
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

}  // namespace

/// χ² with a penalty for each law and effect, and for each parameter of effects and laws.
double LawSearch::cost_of(const CandidateModel& model, double freedom) const {
  double cost = model.fit.chi_squared + criterion_.effect + criterion_.parameter * freedom;
  for (const firmware::PlacedEffect& effect : model.effects)
    cost += criterion_.effect + criterion_.parameter * static_cast<double>(effect_parameters(effect).size());
  for (const PlacedFault& fault : model.faults()) cost += penalty(criterion_, fault, model.channels);
  return cost;
}

/// The best of `list`, which is sorted, and the best of another kind; none where even the best does not explain more
/// than the effects do.
std::vector<Contender> LawSearch::contenders(const std::vector<Candidate>& list) const {
  if (list.empty() || best_cost_ - list.front().cost < thresholds::law_margin * temper_of(list.front().model.fit))
    return {};
  const Hypothesis& first = list.front().model.fit.hypothesis;
  const std::string kind = kind_of(first.laws.back());
  for (const Candidate& other : list) {
    const Hypothesis& hypothesis = other.model.fit.hypothesis;
    const std::string other_kind = kind_of(hypothesis.laws.back());
    if (other_kind == kind || !stays_finite(problem_, hypothesis)) continue;
    return {{kind, first}, {other_kind, hypothesis}};
  }
  return {};
}

/// Effects that earlier explanations needed and this one does not; what each that stays gains goes to gains_.
void LawSearch::eliminate(Candidate& law) const {
  const double freedom = (law.cost - cost_of(law.model, 0.0)) / criterion_.parameter;
  for (bool changed = true; changed;) {
    changed = false;
    gains_.assign(law.model.effects.size(), 0.0);
    std::vector<CandidateModel> without(law.model.effects.size());
    for_all(without.size(), [&](std::size_t i) {
      EffectsBeside effects = law.model.effects;
      effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(i));
      const Hypothesis start = with_effects(space_, law.model.fit.hypothesis, effects);
      without[i] = fitted_with_laws(problem_, space_, start, effects, thresholds::curve_steps);
    });
    std::size_t best = 0;
    for (std::size_t i = 0; i < without.size(); ++i) {
      gains_[i] = without[i].fit.chi_squared - law.model.fit.chi_squared;
      if (cost_of(without[i], freedom) < cost_of(without[best], freedom)) best = i;
    }
    if (without.empty() || !(cost_of(without[best], freedom) < law.cost)) return;
    law.cost = cost_of(without[best], freedom);
    law.model = std::move(without[best]);
    changed = true;
  }
}

/// True if a rig description accepts the law's table. That of a recording in wrong units reaches over metres and is
/// refused.
bool LawSearch::can_be_described(const PlacedLaw& law) {
  if (has_memory(law.family)) return true;
  namespace limits = firmware::law_limits;
  if (is_surface(law.family)) {
    const model::SurfaceTable<double> table = surface_of(law);
    const bool strong = std::any_of(table.value.begin(), table.value.end(), [](const auto& row) {
      return std::any_of(row.begin(), row.end(), [](double force) { return std::abs(force) > limits::strongest; });
    });
    return !strong && law.largest <= limits::farthest && law.largest_velocity <= limits::fastest;
  }
  const LawTable table = table_of(law);
  const double far = law.over == CurveOver::velocity ? limits::fastest : limits::farthest;
  const auto within = [](const std::vector<double>& values, double limit) {
    return std::all_of(values.begin(), values.end(), [limit](double v) { return std::abs(v) <= limit; });
  };
  return within(table.at, far) && within(table.value, limits::strongest);
}

bool LawSearch::is_kept(const Candidate& law, Learned& learned) const {
  if (!can_be_described(law.model.fit.hypothesis.laws.back())) return false;
  const Hypothesis &with = law.model.fit.hypothesis, &without = found_.best.fit.hypothesis;
  const double temper = temper_of(law.model.fit);
  learned.gain = best_cost_ - law.cost;
  if (learned.gain < thresholds::law_margin * temper) return false;
  const double before = held_out_chi_squared(problem_, without), after = held_out_chi_squared(problem_, with);
  learned.gain_held_out = before - after;
  // A law in the place of effects that leave nothing but noise gains their price, which held-out data do not know: they
  // must only not speak for the effects.
  const double wanted = (reasons_.rest ? 1.0 : -1.0) * thresholds::law_margin_held_out * temper;
  if (before > 0.0 && learned.gain_held_out < wanted) return false;
  if (!stays_finite(problem_, with)) return false;
  const PlacedLaw& curve = with.laws.back();
  const EffectsBeside &all = found_.best.effects, &kept = law.model.effects;
  constexpr double share = thresholds::law_replaces_error * thresholds::law_replaces_error;
  const bool is_free = curve.family == LawFamily::free_surface;  // it could take a share of any error
  if (before > 0.0 && after < share * before && !is_free && !draws_friction(curve, all, kept)) return true;
  const auto noise = static_cast<double>(held_out_count(problem_));
  if (is_free && before > noise && after - noise < thresholds::surface_leaves * (before - noise)) return true;
  if (before > noise && after - noise < thresholds::refines_error * (before - noise) && refines(curve, all, kept))
    return true;
  const Explained now{law.model.fit.chi_squared, static_cast<double>(law.model.fit.residual.size()), after};
  return leaves_at_most(thresholds::nearly_all, now, {chi_squared_without_, now.residuals, before}) ||
         is_whole(problem_, law.model.fit);
}

/// The same without the effects that `law` makes needless.
bool LawSearch::is_kept_alone(Candidate& law, Learned& learned) const {
  eliminate(law);
  return is_kept(law, learned);
}

/// Puts an effect of the catalogue in the place of a law of the same shape, if it explains as much: the search does not
/// always reach it from the starts on its card. Returns true if `found` holds the effect now.
bool LawSearch::replace_by_effect(const Candidate& law) {
  EffectsBeside effects = law.model.effects;
  const auto effect = effect_like(law.model.fit.hypothesis.laws.back(), effects);
  if (!effect) return false;
  std::erase_if(effects, [&](const firmware::PlacedEffect& e) { return e.entry->name == effect->entry->contains; });
  effects.push_back(*effect);
  Hypothesis start = with_effects(space_, law.model.fit.hypothesis, effects);
  start.laws.pop_back();
  start.rig.laws = found_.best.fit.hypothesis.rig.laws;
  CandidateModel model = fitted_with_laws(problem_, space_, start, effects, thresholds::effect_steps);
  if (!std::isfinite(model.fit.chi_squared) || !stays_finite(problem_, model.fit.hypothesis)) return false;
  // cost_of counts a law that is not there any more.
  const double cost = cost_of(model, 0.0) - criterion_.effect;
  if (!(cost < law.cost + thresholds::law_margin * temper_of(law.model.fit))) return false;
  found_.best = std::move(model);
  weigh_anew();
  found_.alone.clear();
  found_.causes.clear();
  found_.freed.clear();
  found_.suspects.clear();
  if (found_.best.fit.hypothesis.laws.empty()) {
    compare(problem_, space_, {{}, true, progress_}, found_);
  } else {
    found_.causes.assign(found_.best.effects.size(), FoundCause{.gain = best_cost_ - cost});
  }
  find_constancy(problem_, found_);
  return true;
}

/// Noise as the model that was found leaves it.
void LawSearch::weigh_anew() {
  if (!problem_.update_input_noise(found_.best.fit.hypothesis)) return;
  const EffectsBeside effects = found_.best.effects;
  found_.nothing = fitted_with_laws(problem_, space_, found_.nothing.fit.hypothesis, found_.nothing.effects, 4);
  found_.best = fitted_with_laws(problem_, space_, found_.best.fit.hypothesis, effects, 4);
}

/// The law takes the place of the effects that it makes needless.
void LawSearch::adopt(Candidate law) {
  std::vector<FoundCause> causes;
  for (const firmware::PlacedEffect& kept : law.model.effects) {
    FoundCause& cause = causes.emplace_back();  // without rivals where it was found beside the law
    for (std::size_t i = 0; i < std::min(found_.best.effects.size(), found_.causes.size()); ++i) {
      const firmware::PlacedEffect& old = found_.best.effects[i];
      if (old.entry == kept.entry && old.channel == kept.channel) cause.rivals = found_.causes[i].rivals;
    }
    if (causes.size() <= gains_.size()) cause.gain = gains_[causes.size() - 1];
  }
  const double before = found_.best.penalised_chi_squared(criterion_);
  found_.best = std::move(law.model);
  weigh_anew();
  // Rivals keep their distance, which was found under other weights.
  const double shift = found_.best.penalised_chi_squared(criterion_) - before;
  for (FoundCause& cause : causes) cause.shift_rivals(shift);
  found_.causes = std::move(causes);
  found_.freed.clear();
  found_.suspects.clear();
}

Learned LawSearch::learn() {
  Learned learned;
  slot_ = space_.given.rig.laws.curve_count;
  for (const PlacedLaw& law : found_.best.fit.hypothesis.laws) {
    slot_ += has_memory(law.family) || is_surface(law.family) ? 0 : 1;
  }
  if (slot_ == space_.given.rig.laws.curves.size()) return learned;
  chi_squared_without_ = residuals(problem_, predict(problem_, found_.best.fit.hypothesis)).squaredNorm();
  best_cost_ = found_.best.penalised_chi_squared(criterion_) - found_.best.fit.chi_squared + chi_squared_without_;
  const StageBudget budget(problem_);
  tell(0.96, "learning a law");
  std::vector<Candidate> list = candidates(curves());
  if (budget.allows(problem_, "laws with memory")) {
    for (Candidate& stack : stacks()) list.push_back(std::move(stack));
  }
  if (budget.allows(problem_, "laws over deflection and velocity")) {
    for (Candidate& surface : surfaces()) list.push_back(std::move(surface));
  }
  std::sort(list.begin(), list.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  learned.contenders = contenders(list);
  if (list.empty() || !is_kept_alone(list.front(), learned)) {
    auto surface = may_begin(problem_, "a free law over deflection and velocity") ? free_surface(list) : std::nullopt;
    if (!surface || !is_kept_alone(*surface, learned)) return learned;
    list.insert(list.begin(), std::move(*surface));
    learned.contenders = contenders(list);
  }
  if (replace_by_effect(list.front())) return {};
  learned.found = true;
  for (std::size_t i = 1; i < list.size(); ++i) {
    learned.odds_against.push_back(
        std::exp(std::min(0.5 * (list[i].cost - list[0].cost) / temper_of(list[0].model.fit), thresholds::most_odds)));
  }
  adopt(list.front());
  return learned;
}

Learned learn_laws(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                   SearchResult& found) {
  if (drifts(found.best.faults()) || !std::isfinite(found.best.fit.chi_squared)) return {};
  const Reasons reasons = reasons_for(problem, found);
  if (!reasons.any()) return {};
  Hypothesis without = found.best.fit.hypothesis;
  Learned learned = LawSearch(problem, space, progress, reasons, found).learn();
  if (learned.found) learned.without = std::move(without);
  if (!learned.found || !leaves_a_rest(problem, found) || !may_begin(problem, "a second law")) return learned;
  // A curve beside branches with memory, or one over the other variable; a free surface holds both variables.
  if (found.best.fit.hypothesis.laws.back().family == LawFamily::free_surface) return learned;
  const Reasons rest{.rest = true};
  const Learned second = LawSearch(problem, space, progress, rest, found).learn();
  if (!second.found) return learned;
  learned.gain += second.gain;
  learned.gain_held_out += second.gain_held_out;
  learned.odds_against.insert(learned.odds_against.end(), second.odds_against.begin(), second.odds_against.end());
  return learned;
}

}  // namespace host_sim::identification