#include "host_sim/identification/learn/learn_laws.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/learn/curve_family.hpp"
#include "host_sim/identification/learn/law_and_effects.hpp"
#include "host_sim/identification/learn/law_beside.hpp"
#include "host_sim/identification/learn/stack_fit.hpp"
#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/law_constancy.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "host_sim/identification/select/select_model.hpp"

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
    default:
      break;
  }
  std::string text = "a law over the ";
  text += name(law.over);
  if (law.place != CurvePlace::suspension) text.append(" of the ").append(name(law.place));
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

class LawSearch {
 public:
  LawSearch(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
            const Reasons& reasons, SearchResult& found)
      : problem_(problem),
        part_(part_of(problem)),
        space_(space),
        progress_(progress),
        reasons_(reasons),
        found_(found) {}

  Learned learn();

 private:
  struct Curve {
    Beside beside;
    CurveFit fit;
    double cost = 0.0;  ///< as that of a candidate model, at the price of the simplest family
  };
  /// A law on the whole problem.
  struct Candidate {
    CandidateModel model;
    double cost = 0.0;
    LawFamily family = LawFamily::points;
  };

  [[nodiscard]] std::vector<Beside> places() const;
  [[nodiscard]] std::optional<Hypothesis> start_of(const Beside& beside) const;
  [[nodiscard]] std::vector<Curve> curves() const;
  void grow(Curve& curve) const;
  [[nodiscard]] std::optional<Candidate> fitted_as(LawFamily family, const IdentificationProblem& problem,
                                                   const Hypothesis& start, const EffectsBeside& effects) const;
  [[nodiscard]] std::vector<Candidate> candidates(const std::vector<Curve>& curves) const;
  [[nodiscard]] std::optional<Hypothesis> start_of_stack(LawFamily family, const EffectsBeside& effects,
                                                         double gap) const;
  [[nodiscard]] std::vector<Candidate> stacks() const;
  [[nodiscard]] std::optional<Hypothesis> start_of_surface(LawFamily family, const EffectsBeside& effects) const;
  [[nodiscard]] std::vector<Candidate> surfaces() const;
  [[nodiscard]] std::vector<Contender> contenders(const std::vector<Candidate>& list) const;
  [[nodiscard]] double cost_of(const CandidateModel& model, double freedom) const;
  [[nodiscard]] static bool is_possible(const Candidate& candidate);
  void eliminate(Candidate& law) const;
  [[nodiscard]] static bool can_be_described(const PlacedLaw& law);
  [[nodiscard]] bool is_kept(const Candidate& law, Learned& learned) const;
  [[nodiscard]] bool replace_by_effect(const Candidate& law);
  void weigh_anew();
  void adopt(Candidate law);
  void tell(double share, const char* what) const {
    if (progress_) progress_(share, what, found_.simulations, found_.candidates);
  }

  /// As much of the recordings as tells laws apart, at a coarse step.
  [[nodiscard]] static IdentificationProblem part_of(const IdentificationProblem& problem) {
    const double seconds = thresholds::seconds_of_curves / static_cast<double>(problem.fitted_count());
    return problem.truncated_and_coarse(share_with(problem, seconds));
  }

  IdentificationProblem& problem_;
  const IdentificationProblem part_;
  const SearchSpace& space_;
  const ProgressCallback& progress_;
  const Reasons& reasons_;
  SearchResult& found_;
  SelectionCriterion criterion_{};
  mutable std::vector<double> gains_{};  ///< of the effects beside the law
  std::size_t slot_ = 0;                 ///< of the rig's laws that is free
  /// Of the effects found, under the problem's present weights: cost and χ².
  double best_cost_ = 0.0, chi_squared_without_ = 0.0;
};

std::vector<Beside> LawSearch::places() const {
  std::vector<std::pair<CurvePlace, CurveOver>> where{{CurvePlace::suspension, CurveOver::velocity},
                                                      {CurvePlace::suspension, CurveOver::deflection}};
  const bool is_car = space_.given.rig.kind == model::RigKind::quarter_car;
  if (is_car && !problem_.samples().front().input.wheel_prescribed) {
    where.emplace_back(CurvePlace::tyre, CurveOver::deflection);
    where.emplace_back(CurvePlace::body_guide, CurveOver::velocity);
    where.emplace_back(CurvePlace::wheel_guide, CurveOver::velocity);
  }
  std::vector<Beside> list;
  const auto& laws = found_.best.fit.hypothesis.laws;
  for (const auto& [place, over] : where) {
    if (std::any_of(laws.begin(), laws.end(),
                    [&, p = place, o = over](const PlacedLaw& law) { return law.place == p && law.over == o; }))
      continue;
    if (!reasons_.holds(place, over)) continue;
    if (!reasons_.rest) {  // in the place of all such effects
      list.push_back({place, over, effects_beside(found_.best.effects, place, over).back()});
      continue;
    }
    if (is_guide(place)) {
      list.push_back({place, over, effects_beside_guide(found_.best.effects, place)});
      continue;
    }
    for (EffectsBeside& effects : effects_beside(found_.best.effects, place, over)) {
      list.push_back({place, over, std::move(effects)});
    }
  }
  return list;
}

/// Friction falls with velocity by a part of it; what falls by more, or rises, is another law. So is a family with a
/// value at its bound.
bool LawSearch::is_possible(const Candidate& candidate) {
  const Hypothesis& hypothesis = candidate.model.fit.hypothesis;
  if (!has_grid(candidate.family)) {
    const std::vector<FreeParameter> free = law_parameters(hypothesis.laws);
    if (std::any_of(free.begin(), free.end(), [&](const FreeParameter& value) {
          return value.law + 1 == hypothesis.laws.size() && value.at_bound(hypothesis);
        }))
      return false;
  }
  if (candidate.family != LawFamily::falling) return true;
  const double fall = hypothesis.laws.back().values.front();
  const auto& effects = candidate.model.effects;
  const auto friction = std::find_if(effects.begin(), effects.end(), is_friction);
  return friction != effects.end() && fall > 0.0 && fall < friction->values.front();
}

/// χ² with a penalty for each law and effect, and for each parameter of effects and laws.
double LawSearch::cost_of(const CandidateModel& model, double freedom) const {
  double cost = model.fit.chi_squared + criterion_.effect + criterion_.parameter * freedom;
  for (const firmware::PlacedEffect& effect : model.effects)
    cost += criterion_.effect + criterion_.parameter * static_cast<double>(effect_parameters(effect).size());
  for (const PlacedFault& fault : model.faults()) cost += penalty(criterion_, fault, model.channels);
  return cost;
}

std::optional<Hypothesis> LawSearch::start_of(const Beside& beside) const {
  Hypothesis start = with_effects(space_, found_.best.fit.hypothesis, beside.effects);
  // A described value that was freed stood in for the law.
  for (const FreeParameter& freed : found_.freed) freed.put(start, freed.get(space_.given));
  const auto range = excited_range(problem_, start, beside.place, beside.over);
  if (!range) return std::nullopt;
  start.laws.push_back(flat_curve(beside.place, beside.over, *range));
  PlacedLaw& law = start.laws.back();
  law.slot = slot_;
  const auto along = excited_range(problem_, start, beside.place, CurveOver::deflection);
  const double stiffness = beside.place == CurvePlace::tyre ? start.rig.tyre.stiffness : start.rig.suspension.stiffness;
  law.size = std::max(thresholds::force_share * stiffness * (along ? along->rms : 0.0), 1e-3);
  const ForceOfEffects replaced(found_.best.effects, beside.effects, beside.place, beside.over);
  for (std::size_t i = 0; i < law.at.size(); ++i) {
    law.values[i] = replaced(law.at[i]);
    law.size = std::max(law.size, std::abs(law.values[i]));
  }
  put_laws(start.laws, start.rig);
  return start;
}

/// Effects beside a curve that the search without it has not found, one after the other. What took its place has hidden
/// them: of a real damper the mount and the mass behind the load cell are seen only beside the curve.
void LawSearch::grow(Curve& curve) const {
  IdentificationProblem part = part_;
  Effort effort;
  for (std::size_t more = 0; more < thresholds::grown_effects; ++more) {
    const Hypothesis& hypothesis = curve.fit.model.fit.hypothesis;
    std::vector<FreeParameter> free = space_.common;
    const auto of_laws = law_parameters(hypothesis.laws);
    free.insert(free.end(), of_laws.begin(), of_laws.end());
    const ModelFitter fitter(part, std::move(free), criterion_, effort);
    if (fitter.leaves_noise(curve.fit.model)) return;
    const CandidateModel base = fitter.refitted(hypothesis, curve.beside.effects, 0);
    auto list = fitter.extended(base, found_.scales, thresholds::grown_candidates);
    std::erase_if(list, [&](const CandidateModel& model) {
      return ends_at_bound(model.effects.back()) || model.effects.size() <= base.effects.size() ||
             !may_act_beside(model.effects.back(), curve.beside.place, curve.beside.over);
    });
    if (list.empty() || !criterion_.accepts(list.front(), base, criterion_.later_share)) return;
    const Hypothesis& start = list.front().fit.hypothesis;
    auto longer = fit_curve(part_, space_, start, list.front().effects, thresholds::curve_steps);
    if (!longer) return;
    const double cost = cost_of(longer->model, std::min(longer->freedom, thresholds::fewest_values));
    if (cost >= curve.cost) return;
    curve = {{curve.beside.place, curve.beside.over, list.front().effects}, std::move(*longer), cost};
  }
}

/// The curves worth fitting on the whole, best first.
std::vector<LawSearch::Curve> LawSearch::curves() const {
  const std::vector<Beside> all = places();
  std::vector<std::optional<Curve>> fitted(all.size());
  const auto fit_from = [&](std::size_t i, const Hypothesis& start, int most) {
    auto curve = fit_curve(part_, space_, start, all[i].effects, most);
    if (!curve) return;
    const double cost = cost_of(curve->model, std::min(curve->freedom, thresholds::fewest_values));
    fitted[i] = Curve{all[i], std::move(*curve), cost};
  };
  for_all(all.size(), [&](std::size_t i) {
    if (const auto start = start_of(all[i])) fit_from(i, *start, 1);
  });
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (fitted[i]) order.push_back(i);
  }
  const auto better = [&](std::size_t a, std::size_t b) { return fitted[a]->cost < fitted[b]->cost; };
  // So many, and the best of each kind: after one step those beside many effects are ahead.
  const auto best = [&](std::vector<std::size_t> list, std::size_t most) {
    std::sort(list.begin(), list.end(), better);
    std::vector<std::size_t> kept;
    for (const std::size_t i : list) {
      const bool first_of_kind = std::none_of(kept.begin(), kept.end(), [&](std::size_t k) {
        return all[k].place == all[i].place && all[k].over == all[i].over;
      });
      if (kept.size() < most || first_of_kind) kept.push_back(i);
    }
    return kept;
  };
  order = best(order, thresholds::continued_curves);
  for_all(order.size(), [&](std::size_t i) {
    const Hypothesis start = fitted[order[i]]->fit.model.fit.hypothesis;
    fit_from(order[i], start, thresholds::curve_steps);
  });
  order = best(order, thresholds::fitted_curves);
  if (reasons_.rest) {
    for (const std::size_t i : best(order, 0)) grow(*fitted[i]);
    std::sort(order.begin(), order.end(), better);
  }
  std::vector<Curve> list;
  for (const std::size_t i : order) list.push_back(std::move(*fitted[i]));
  return list;
}

std::optional<LawSearch::Candidate> LawSearch::fitted_as(LawFamily family, const IdentificationProblem& problem,
                                                         const Hypothesis& start, const EffectsBeside& effects) const {
  if (family == LawFamily::points) {
    auto curve = fit_curve(problem, space_, start, effects, thresholds::curve_steps);
    if (!curve) return std::nullopt;
    const double cost = cost_of(curve->model, curve->freedom);
    return Candidate{std::move(curve->model), cost, family};
  }
  CandidateModel model = fitted_with_laws(problem, space_, start, effects, thresholds::family_steps);
  if (!std::isfinite(model.fit.chi_squared)) return std::nullopt;
  const double cost = cost_of(model, static_cast<double>(values_of(family).size()));
  return Candidate{std::move(model), cost, family};
}

/// Curves and the families nearest to them, on the part; those that explain most there, on the whole.
std::vector<LawSearch::Candidate> LawSearch::candidates(const std::vector<Curve>& curves) const {
  struct Task {
    Hypothesis start;
    const Curve* curve;
    LawFamily family;
    Candidate fitted{};
  };
  std::vector<Task> tasks;
  for (const Curve& curve : curves) {
    const EffectsBeside& effects = curve.beside.effects;
    const bool friction = !is_guide(curve.beside.place) && std::any_of(effects.begin(), effects.end(), is_friction);
    Hypothesis start = curve.fit.model.fit.hypothesis;
    tasks.push_back({start, &curve, LawFamily::points});
    std::vector<FamilyMember> members = families_of(curve.fit, friction);
    if (members.size() > thresholds::fitted_families) members.resize(thresholds::fitted_families);
    for (const FamilyMember& member : members) {
      start.laws.back() = member.law;
      put_laws(start.laws, start.rig);
      tasks.push_back({start, &curve, member.law.family});
    }
  }
  const auto fit_on = [&](const IdentificationProblem& problem) {
    for_all(tasks.size(), [&](std::size_t i) {
      auto fitted = fitted_as(tasks[i].family, problem, tasks[i].start, tasks[i].curve->beside.effects);
      tasks[i].fitted = fitted ? std::move(*fitted) : Candidate{{}, INFINITY};
    });
    std::erase_if(tasks,
                  [](const Task& task) { return !std::isfinite(task.fitted.cost) || !is_possible(task.fitted); });
  };
  fit_on(part_);
  std::sort(tasks.begin(), tasks.end(), [](const Task& a, const Task& b) { return a.fitted.cost < b.fitted.cost; });
  if (tasks.size() > thresholds::fitted_on_whole) tasks.resize(thresholds::fitted_on_whole);
  for (Task& task : tasks) task.start = task.fitted.model.fit.hypothesis;
  fit_on(problem_);
  std::vector<Candidate> list;
  for (Task& task : tasks) list.push_back(std::move(task.fitted));
  return list;
}

/// `gap`: as a share of the deflection's range.
std::optional<Hypothesis> LawSearch::start_of_stack(LawFamily family, const EffectsBeside& effects, double gap) const {
  Hypothesis start = with_effects(space_, found_.best.fit.hypothesis, effects);
  for (const FreeParameter& freed : found_.freed) freed.put(start, freed.get(space_.given));
  const auto range = excited_range(problem_, start, CurvePlace::suspension, CurveOver::deflection);
  const std::size_t slot = space_.given.rig.laws.branch_count;
  if (!range || slot == model::usual_laws.branches) return std::nullopt;
  start.laws.push_back(empty_stack(family, *range, slot, gap * (range->highest - range->lowest)));
  PlacedLaw& law = start.laws.back();
  const ForceOfEffects replaced(found_.best.effects, effects, law.place, CurveOver::velocity);
  const double friction = std::max(replaced(1e-9), 0.0);  // [m/s]: dry friction alone
  law.size = std::max({thresholds::force_share * start.rig.suspension.stiffness * range->rms, friction, 1e-3});
  if (family == LawFamily::sliders) law.values.back() = friction;
  put_laws(start.laws, start.rig);
  return start;
}

/// Stacks of branches with memory on the whole: of each kind the one beside the right effects. Sliders are tried with
/// lost motion, too.
std::vector<LawSearch::Candidate> LawSearch::stacks() const {
  const auto& laws = found_.best.fit.hypothesis.laws;
  if (std::any_of(laws.begin(), laws.end(), [](const PlacedLaw& law) { return has_memory(law.family); })) return {};
  struct Stack {
    LawFamily family;
    EffectsBeside effects;
    double gap = 0.0;
    std::optional<CandidateModel> model{};
    double cost = INFINITY;
  };
  const auto fit_on = [&](const IdentificationProblem& problem, Stack& stack) {
    stack.cost = INFINITY;
    stack.model.reset();
    const auto start = start_of_stack(stack.family, stack.effects, stack.gap);
    if (!start) return;
    stack.model = fit_stack(problem, space_, *start, stack.effects, criterion_);
    if (!stack.model) return;
    const auto branches = static_cast<double>(branch_count(stack.model->fit.hypothesis));
    stack.cost = cost_of(*stack.model, 2.0 * branches + (stack.gap > 0.0 ? 1.0 : 0.0));
  };
  const auto better = [](const Stack& a, const Stack& b) { return a.cost < b.cost; };
  std::vector<Stack> best;
  for (const LawFamily family : {LawFamily::sliders, LawFamily::maxwell}) {
    if (!reasons_.rest && !(reasons_.memory && family == LawFamily::maxwell)) continue;
    std::vector<Stack> tried;
    for (EffectsBeside& effects : effects_beside_stack(found_.best.effects)) {
      tried.push_back({family, std::move(effects)});
    }
    for_all(tried.size(), [&](std::size_t i) { fit_on(part_, tried[i]); });
    Stack nearest = *std::min_element(tried.begin(), tried.end(), better);
    if (family == LawFamily::sliders && nearest.model) {
      std::vector<Stack> with_play;
      for (const double gap : thresholds::gaps) with_play.push_back({family, nearest.effects, gap});
      for_all(with_play.size(), [&](std::size_t i) { fit_on(part_, with_play[i]); });
      const Stack& play = *std::min_element(with_play.begin(), with_play.end(), better);
      const double margin = thresholds::law_margin * temper_of(nearest.model->fit);
      if (play.cost + margin < nearest.cost) nearest = play;
    }
    if (nearest.model) best.push_back(std::move(nearest));
  }
  for_all(best.size(), [&](std::size_t i) { fit_on(problem_, best[i]); });
  std::vector<Candidate> list;
  for (Stack& stack : best) {
    if (stack.model) list.push_back({std::move(*stack.model), stack.cost, stack.family});
  }
  return list;
}

std::optional<Hypothesis> LawSearch::start_of_surface(LawFamily family, const EffectsBeside& effects) const {
  Hypothesis start = with_effects(space_, found_.best.fit.hypothesis, effects);
  for (const FreeParameter& freed : found_.freed) freed.put(start, freed.get(space_.given));
  const auto deflection = excited_range(problem_, start, CurvePlace::suspension, CurveOver::deflection);
  const auto velocity = excited_range(problem_, start, CurvePlace::suspension, CurveOver::velocity);
  if (!deflection || !velocity) return std::nullopt;
  PlacedLaw law{.over = CurveOver::both, .family = family, .rms = deflection->rms, .largest = deflection->largest()};
  law.farthest = thresholds::table_beyond * deflection->farthest;
  law.rms_velocity = velocity->rms;
  law.largest_velocity = velocity->largest();
  law.slot = space_.given.rig.laws.surface_count;
  const ForceOfEffects replaced(found_.best.effects, effects, law.place, CurveOver::velocity);
  const double least = thresholds::force_share * start.rig.suspension.stiffness * law.rms;
  law.size = std::max({least, std::abs(replaced(law.rms_velocity)), 1e-3});
  law.values = {replaced(law.rms_velocity), family == LawFamily::follows_load
                                                ? thresholds::sets_in_at_first * law.rms_velocity
                                                : thresholds::stroke_exponent_at_first};
  if (law.values.front() == 0.0) law.values.front() = least;
  start.laws.push_back(std::move(law));
  put_laws(start.laws, start.rig);
  return start;
}

/// Families of surfaces on the whole: of each the one beside the right effects.
std::vector<LawSearch::Candidate> LawSearch::surfaces() const {
  const auto& laws = found_.best.fit.hypothesis.laws;
  if (!reasons_.rest || space_.given.rig.laws.surface_count == space_.given.rig.laws.surfaces.size() ||
      std::any_of(laws.begin(), laws.end(), [](const PlacedLaw& law) { return is_surface(law.family); }))
    return {};
  const auto fit_on = [&](const IdentificationProblem& problem, LawFamily family, const EffectsBeside& effects,
                          const Hypothesis& start) -> std::optional<Candidate> {
    CandidateModel model = fitted_with_laws(problem, space_, start, effects, thresholds::family_steps);
    if (!std::isfinite(model.fit.chi_squared)) return std::nullopt;
    const double cost = cost_of(model, static_cast<double>(values_of(family).size()));
    return Candidate{std::move(model), cost, family};
  };
  const std::vector<EffectsBeside> beside =
      effects_beside(found_.best.effects, CurvePlace::suspension, CurveOver::velocity);
  std::vector<std::optional<Candidate>> tried(2 * beside.size());
  const auto family_of = [](std::size_t i) { return i % 2 == 0 ? LawFamily::follows_load : LawFamily::along_stroke; };
  for_all(tried.size(), [&](std::size_t i) {
    if (const auto start = start_of_surface(family_of(i), beside[i / 2]))
      tried[i] = fit_on(part_, family_of(i), beside[i / 2], *start);
  });
  std::vector<std::size_t> best;
  for (std::size_t family = 0; family < 2; ++family) {
    std::optional<std::size_t> nearest;
    for (std::size_t i = family; i < tried.size(); i += 2) {
      if (tried[i] && (!nearest || tried[i]->cost < tried[*nearest]->cost)) nearest = i;
    }
    if (nearest) best.push_back(*nearest);
  }
  std::vector<std::optional<Candidate>> fitted(best.size());
  for_all(best.size(), [&](std::size_t i) {
    const std::size_t b = best[i];
    fitted[i] = fit_on(problem_, family_of(b), beside[b / 2], tried[b]->model.fit.hypothesis);
  });
  std::vector<Candidate> list;
  for (auto& candidate : fitted) {
    if (candidate) list.push_back(std::move(*candidate));
  }
  return list;
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
  if (is_surface(law.family))
    return law.largest <= firmware::law_limits::farthest && law.largest_velocity <= firmware::law_limits::fastest;
  namespace limits = firmware::law_limits;
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
  if (before > 0.0 && after < share * before && !draws_friction(curve, all, kept)) return true;
  const auto noise = static_cast<double>(held_out_count(problem_));
  if (before > noise && after - noise < thresholds::refines_error * (before - noise) && refines(curve, all, kept))
    return true;
  const Explained now{law.model.fit.chi_squared, static_cast<double>(law.model.fit.residual.size()), after};
  return leaves_at_most(thresholds::nearly_all, now, {chi_squared_without_, now.residuals, before}) ||
         is_whole(problem_, law.model.fit);
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
  found_.rivals.clear();
  found_.gains.clear();
  found_.freed.clear();
  found_.suspects.clear();
  if (found_.best.fit.hypothesis.laws.empty()) {
    compare(problem_, space_, {{}, true, progress_}, found_);
  } else {
    found_.rivals.resize(found_.best.effects.size());
    found_.gains.assign(found_.best.effects.size(), best_cost_ - cost);
  }
  found_.constancy = law_constancy(problem_, found_);
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
  std::vector<std::vector<Rival>> rivals;
  for (const firmware::PlacedEffect& kept : law.model.effects) {
    std::vector<Rival>& of_effect = rivals.emplace_back();  // none of one that was found beside the law
    for (std::size_t i = 0; i < std::min(found_.best.effects.size(), found_.rivals.size()); ++i) {
      const firmware::PlacedEffect& old = found_.best.effects[i];
      if (old.entry == kept.entry && old.channel == kept.channel) of_effect = found_.rivals[i];
    }
  }
  const double before = found_.best.penalised_chi_squared(criterion_);
  found_.best = std::move(law.model);
  weigh_anew();
  // Rivals keep their distance, which was found under other weights.
  const double shift = found_.best.penalised_chi_squared(criterion_) - before;
  for (auto& of_effect : rivals) {
    for (Rival& rival : of_effect) rival.penalised_chi_squared += shift;
  }
  found_.rivals = std::move(rivals);
  found_.gains = gains_;
  found_.constancy.assign(found_.best.effects.size(), {});
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
  tell(0.96, "learning a law");
  std::vector<Candidate> list = candidates(curves());
  for (Candidate& stack : stacks()) list.push_back(std::move(stack));
  for (Candidate& surface : surfaces()) list.push_back(std::move(surface));
  std::sort(list.begin(), list.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  if (list.empty()) return learned;
  learned.contenders = contenders(list);
  eliminate(list.front());
  if (!is_kept(list.front(), learned)) return learned;
  if (replace_by_effect(list.front())) return {};
  learned.found = true;
  for (std::size_t i = 1; i < list.size(); ++i) {
    learned.odds_against.push_back(
        std::exp(std::min(0.5 * (list[i].cost - list[0].cost) / temper_of(list[0].model.fit), thresholds::most_odds)));
  }
  adopt(list.front());
  return learned;
}

}  // namespace

Learned learn_laws(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                   SearchResult& found) {
  if (drifts(found.best.faults()) || !std::isfinite(found.best.fit.chi_squared)) return {};
  const Reasons reasons = reasons_for(problem, found);
  if (!reasons.any()) return {};
  Hypothesis without = found.best.fit.hypothesis;
  Learned learned = LawSearch(problem, space, progress, reasons, found).learn();
  if (learned.found) learned.without = std::move(without);
  if (!learned.found || !leaves_a_rest(problem, found)) return learned;
  // A curve beside branches with memory, or one over the other variable.
  const Reasons rest{.rest = true};
  const Learned second = LawSearch(problem, space, progress, rest, found).learn();
  if (!second.found) return learned;
  learned.gain += second.gain;
  learned.gain_held_out += second.gain_held_out;
  learned.odds_against.insert(learned.odds_against.end(), second.odds_against.begin(), second.odds_against.end());
  return learned;
}

}  // namespace host_sim::identification
