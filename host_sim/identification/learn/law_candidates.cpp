#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/learn/curve_family.hpp"
#include "host_sim/identification/learn/law_and_effects.hpp"
#include "host_sim/identification/learn/law_search.hpp"
#include "host_sim/identification/learn/stack_fit.hpp"
#include "host_sim/identification/learn/surface_fit.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "host_sim/identification/select/select_model.hpp"

namespace host_sim::identification {

std::vector<Beside> LawSearch::places() {
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
    // A search without this law has put a lag, a mass or friction in the place of the mount.
    if (place != CurvePlace::suspension || over != CurveOver::velocity || is_car || !laws.empty()) continue;
    behind_mount_ = law_behind_mount(part_);
    if (!behind_mount_) continue;
    EffectsBeside effects = effects_of(*behind_mount_, problem_, space_.given.rig);
    if (!effects.empty()) list.push_back({place, over, std::move(effects), &*behind_mount_});
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

/// The model that the search found, with only these effects. Parameters that the search freed go back to their
/// described values: they stood in for the law.
Hypothesis LawSearch::start_beside(const EffectsBeside& effects) const {
  Hypothesis start = with_effects(space_, found_.best.fit.hypothesis, effects);
  for (const FreeParameter& freed : found_.freed) freed.put(start, freed.get(space_.given));
  return start;
}

std::optional<Hypothesis> LawSearch::start_of(const Beside& beside) const {
  Hypothesis start = start_beside(beside.effects);
  if (beside.read_off != nullptr) start.faults.clear();
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
    const LawBehindMount* const read_off = beside.read_off;
    law.values[i] = read_off == nullptr
                        ? replaced(law.at[i])
                        : between(read_off->at, read_off->force, law.at[i]) - start.rig.suspension.damping * law.at[i];
    law.size = std::max(law.size, std::abs(law.values[i]));
  }
  put_laws(start.laws, start.rig);
  return start;
}

/// Effects beside a curve that the search without it has not found, one after the other. What took its place has hidden
/// them: of a real damper the mount and the mass behind the load cell are seen only beside the curve.
void LawSearch::grow(Curve& curve) const {
  IdentificationProblem part = part_;
  for (std::size_t more = 0; more < thresholds::grown_effects; ++more) {
    const Hypothesis& hypothesis = curve.fit.model.fit.hypothesis;
    std::vector<FreeParameter> free = space_.common;
    const auto of_laws = law_parameters(hypothesis.laws);
    free.insert(free.end(), of_laws.begin(), of_laws.end());
    const ModelFitter fitter(part, std::move(free), criterion_);
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
    curve.beside.effects = list.front().effects;
    curve = {curve.beside, std::move(*longer), cost};
  }
}

/// The curves worth fitting on the whole, best first.
std::vector<LawSearch::Curve> LawSearch::curves() {
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
  const double cost = cost_of(model, static_cast<double>(start.laws.back().values.size()));
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
  Hypothesis start = start_beside(effects);
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
  Hypothesis start = start_beside(effects);
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

bool LawSearch::may_have_surface() const {
  const auto& laws = found_.best.fit.hypothesis.laws;
  return reasons_.rest && space_.given.rig.laws.surface_count < space_.given.rig.laws.surfaces.size() &&
         std::none_of(laws.begin(), laws.end(), [](const PlacedLaw& law) { return is_surface(law.family); });
}

/// Families of surfaces on the whole: of each the one beside the right effects.
std::vector<LawSearch::Candidate> LawSearch::surfaces() const {
  if (!may_have_surface()) return {};
  const std::vector<EffectsBeside> beside =
      effects_beside(found_.best.effects, CurvePlace::suspension, CurveOver::velocity);
  std::vector<std::optional<Candidate>> tried(2 * beside.size());
  const auto family_of = [](std::size_t i) { return i % 2 == 0 ? LawFamily::follows_load : LawFamily::along_stroke; };
  for_all(tried.size(), [&](std::size_t i) {
    if (const auto start = start_of_surface(family_of(i), beside[i / 2]))
      tried[i] = fitted_as(family_of(i), part_, *start, beside[i / 2]);
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
    fitted[i] = fitted_as(family_of(b), problem_, tried[b]->model.fit.hypothesis, beside[b / 2]);
  });
  std::vector<Candidate> list;
  for (auto& candidate : fitted) {
    if (candidate) list.push_back(std::move(*candidate));
  }
  return list;
}

std::optional<Hypothesis> LawSearch::start_of_free_surface(const EffectsBeside& effects) const {
  Hypothesis start = start_beside(effects);
  const auto deflection = excited_range(problem_, start, CurvePlace::suspension, CurveOver::deflection);
  const auto velocity = excited_range(problem_, start, CurvePlace::suspension, CurveOver::velocity);
  if (!deflection || !velocity) return std::nullopt;
  const ForceOfEffects over_x(found_.best.effects, effects, CurvePlace::suspension, CurveOver::deflection);
  const ForceOfEffects over_v(found_.best.effects, effects, CurvePlace::suspension, CurveOver::velocity);
  PlacedLaw law = surface_through(*deflection, *velocity, [&](double x, double v) { return over_x(x) + over_v(v); });
  law.slot = space_.given.rig.laws.surface_count;
  law.size = std::max(thresholds::force_share * start.rig.suspension.stiffness * law.rms, 1e-3);
  for (const double force : law.values) law.size = std::max(law.size, std::abs(force));
  start.laws.push_back(std::move(law));
  put_laws(start.laws, start.rig);
  return start;
}

/// A free surface on the whole, where no law with fewer values is kept: beside what is no law of the suspension's
/// deflection or velocity but dry friction. Held-out data must prefer it to the best of the others, which are sorted.
std::optional<LawSearch::Candidate> LawSearch::free_surface(const std::vector<Candidate>& others) const {
  if (!may_have_surface()) return std::nullopt;
  std::vector<EffectsBeside> beside = effects_beside(found_.best.effects, CurvePlace::suspension, CurveOver::velocity);
  std::erase_if(beside, [](const EffectsBeside& effects) {
    return std::any_of(effects.begin(), effects.end(), [](const firmware::PlacedEffect& e) {
      return !may_act_beside(e, CurvePlace::suspension, CurveOver::deflection);
    });
  });
  const auto fitted = [&](const EffectsBeside& effects, int steps) -> std::optional<Candidate> {
    const auto start = start_of_free_surface(effects);
    if (!start) return std::nullopt;
    auto model = fit_surface(part_, space_, *start, effects, steps);
    if (!model) return std::nullopt;
    const double cost = cost_of(*model, static_cast<double>(model->fit.hypothesis.laws.back().values.size()));
    return Candidate{std::move(*model), cost, LawFamily::free_surface};
  };
  std::vector<std::optional<Candidate>> tried(beside.size());
  for_all(tried.size(), [&](std::size_t i) { tried[i] = fitted(beside[i], 1); });
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (tried[i] && (!best || tried[i]->cost < tried[*best]->cost)) best = i;
  }
  if (!best) return std::nullopt;
  const auto on_part = fitted(beside[*best], thresholds::curve_steps);
  if (!on_part) return std::nullopt;
  auto whole = fitted_as(LawFamily::free_surface, problem_, on_part->model.fit.hypothesis, beside[*best]);
  if (!whole || others.empty()) return whole;
  const double left = held_out_chi_squared(problem_, others.front().model.fit.hypothesis);
  const double margin = thresholds::law_margin_held_out * temper_of(whole->model.fit);
  if (left > 0.0 && held_out_chi_squared(problem_, whole->model.fit.hypothesis) + margin > left) return std::nullopt;
  return whole;
}

}  // namespace host_sim::identification
