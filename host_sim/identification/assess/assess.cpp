#include "host_sim/identification/assess/assess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/assess/cause_support.hpp"
#include "host_sim/identification/assess/error_propagation.hpp"
#include "host_sim/identification/assess/experiment.hpp"
#include "host_sim/identification/assess/lost_samples.hpp"
#include "host_sim/identification/assess/noise_faults.hpp"
#include "host_sim/identification/assess/recording_causes.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/estimate/left_by_fit.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/learn/describe_law.hpp"
#include "host_sim/identification/parity/fault_location.hpp"
#include "host_sim/identification/select/model_evidence.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

/// Back to the tolerated parameters alone.
void give_up(SearchResult& found) {
  found.best = found.nothing;
  found.causes.clear();
  found.freed.clear();
  found.suspects.clear();
}

/// What is known of the model that stays when causes have left that the recordings do not bear out.
struct Supported {
  Uncertainty known;     ///< of its parameters
  CauseSupport support;  ///< of its effects
};
/// What is said of the causes that left enters the result.
Supported leave_out_unsupported(const IdentificationProblem& problem, const IdentificationProblem& whole,
                                const SearchSpace& space, SearchResult& found, Diagnosis& result) {
  Supported supported{uncertainty(problem, space.suspects, found.best.fit), {}};
  const std::vector<Undetermined> open = leave_out_undetermined(problem, space, supported.known, found);
  supported.support = support_of_causes(problem, whole, space, left_by(problem, found.best.fit).any(), found);
  const std::vector<std::string>& left_out = supported.support.left_out;
  for (const std::string& name : left_out) {
    result.remarks.push_back(name + " was left out: it raises the error on held-out data");
  }
  if (!open.empty() || !left_out.empty()) {
    estimate_held_out_starts(found.best.fit.hypothesis, problem.samples());
    supported.known = uncertainty(problem, space.suspects, found.best.fit);
  }
  result.undetermined = supported.known.undetermined;
  result.undetermined.insert(result.undetermined.end(), open.begin(), open.end());
  return supported;
}

/// chance_of_discrepancy() of estimate/evidence.hpp over all channels and bands of the fitted windows; together they hold
/// something unknown as often as p = thresholds::outside_share says. Where the tests of estimate/left_by_fit.hpp find a
/// rest, which noise makes them do with a probability ε, at least
///
///   (1)  p/(p + (1 − p) ε)
double chance_of_a_rest(const IdentificationProblem& problem, const Fit& fit, bool found) {
  constexpr double p = thresholds::outside_share;
  const double by_tests = found ? p / (p + (1.0 - p) * thresholds::family_error) : 0.0;
  std::vector<Power> left = power_by_band(problem, fit.residual);
  std::erase_if(left, [](const Power& power) { return !(power.count > 0.0); });
  if (left.empty()) return by_tests;
  DiscrepancyModel discrepancy;
  // The least share of noise that counts as more than noise is three deviations of what is known of its power.
  discrepancy.noise_error =
      (corners_are_blurred(problem, fit.hypothesis) ? thresholds::corner_power_error : thresholds::significant_share) /
      3.0;
  discrepancy.chance = 1.0 - std::pow(1.0 - p, 1.0 / static_cast<double>(left.size()));
  return std::max(by_tests, chance_of_discrepancy(left, discrepancy));
}

/// The test that tells the two kinds of law apart that explain most.
std::optional<NextStep> next_step(const IdentificationProblem& problem, const Learned& learned) {
  if (learned.contenders.size() < 2) return std::nullopt;
  const Contender &one = learned.contenders[0], &other = learned.contenders[1];
  const auto test = best_sine(problem, one.hypothesis, other.hypothesis);
  if (!test) return std::nullopt;
  return NextStep{one.kind, other.kind, *test};
}

Interval interval_of(const Estimate& e) {
  constexpr double deviations = 1.96;  // 95 % of a normal distribution: numbers without noise need no allowance
  return {e.value, e.value - deviations * e.error, e.value + deviations * e.error};
}

/// Numbers of the program carry no noise: their error is that of velocities by differences.
UncertaintyBudget budget_of(const Estimate& e) {
  UncertaintyBudget budget;
  if (!(e.error > 0.0)) return budget;
  budget.combined = e.error;
  budget.coverage = (interval_of(e).upper - e.value) / e.error;
  budget.parts.push_back({UncertaintyBudget::Source::discretisation, "", e.error});
  return budget;
}

/// Of the effects that were found, whose parameters stand last in the fit.
void add_budgets(const SearchResult& found, const std::vector<UncertaintyBudget>& budgets, Diagnosis& result) {
  std::size_t next = budgets.size();
  for (const firmware::PlacedEffect& effect : found.best.effects) next -= effect_parameters(effect).size();
  for (std::size_t i = 0; i < found.best.effects.size(); ++i) {
    const std::size_t count = effect_parameters(found.best.effects[i]).size();
    for (std::size_t p = 0; p < count; ++p) result.effects[i].budgets.push_back(budgets[next++]);
  }
}

ResidualPower residual_power(const IdentificationProblem& problem, const SearchSpace& space,
                             const SearchResult& found) {
  const auto count = static_cast<double>(problem.residual_count());
  const auto per_residual = [&](const Hypothesis& hypothesis) {
    return residuals(problem, predict(problem, hypothesis)).squaredNorm() / count;
  };
  return {per_residual(space.given), per_residual(found.nothing.fit.hypothesis),
          per_residual(found.best.fit.hypothesis)};
}

/// Beside an unexplained residual a name is worth what it explains: nearly all of the power, or at most half of a
/// certainty for the share of the error that goes away.
double worth_beside_residual(const IdentificationProblem& problem, const SearchResult& found, double explained) {
  const double refit = pooled_error(problem, found.nothing.fit.hypothesis);
  const double after = pooled_error(problem, found.best.fit.hypothesis);
  const double shrinks = std::max(1.0 - after / std::max(refit, 1e-300), 0.0);
  constexpr double all = thresholds::explains_all;
  return std::max((explained - all) / (1.0 - all), thresholds::worth_of_shrinking * shrinks);
}

Certainty certainty_of(const IdentificationProblem& problem, const SearchResult& found, bool unexplained,
                       double explained) {
  const auto count = static_cast<double>(found.best.fit.residual.size());
  return {unexplained ? worth_beside_residual(problem, found, explained) : 1.0,
          std::max(1.0, found.best.fit.chi_squared / count), seen_from(count, problem.channels().size()), unexplained};
}

/// True if a channel's error is as large as its signal, and more than noise: the model then explains nothing.
bool leaves_a_whole_signal(const std::map<Channel, PredictionError>& errors) {
  return std::any_of(errors.begin(), errors.end(), [](const auto& error) {
    return error.second.after >= std::max(1.0, 2.0 * error.second.noise_floor);
  });
}

/// Effects of the virtual tyre. Their rival is the tyre without them; the residual of its equation has one channel and
/// one band, whose noise is what the estimate leaves.
void add_tyre_effects(const VirtualCarEstimate& car, const SelectionCriterion& criterion, Diagnosis& result) {
  for (const TyreEffect& tyre : car.effects) {
    const double penalty = criterion.effect + criterion.parameter * static_cast<double>(tyre.effect.values.size());
    const double odds = std::exp(std::min(0.5 * (tyre.gain - penalty), thresholds::most_logarithmic_odds));
    // Held-out data that the effects do not improve take the name away.
    const TyreError& error = car.tyre_error;
    const double worth = error.with_effects < error.refitted ? 1.0 : 0.0;
    const double seen = std::max(thresholds::significant_deviations * std::sqrt(2.0 * tyre.count),
                                 thresholds::significant_share * tyre.count);
    NamedEffect named{tyre.effect, {}, confidence({odds}, tyre.gain, {worth, 1.0, seen, false}), {}, {}};
    for (const Estimate& e : tyre.parameters) {
      named.parameters.push_back(interval_of(e));
      named.budgets.push_back(budget_of(e));
    }
    result.effects.push_back(std::move(named));
  }
  if (car.effects.empty()) return;
  // No sensor is between the program and its recording: a perfect model leaves nothing.
  result.prediction_errors[Channel::F_w] = {car.tyre_error.described, car.tyre_error.refitted,
                                            car.tyre_error.with_effects, 0.0};
}

/// Relative; 0: there is none.
double tolerance_of(const firmware::RigDescription& description, const std::string& path) {
  const auto tolerance = description.tolerance.find(path);
  return tolerance != description.tolerance.end() ? tolerance->second : 0.0;
}

/// Numbers of the virtual car that are not as described: nothing of the rig does that, so no effect is a rival.
void add_numbers_off(const firmware::RigDescription& description, const VirtualCarEstimate& car, double price,
                     const Certainty& certainty, Diagnosis& result) {
  for (const VirtualNumberOff& off : car.off) {
    const double odds = std::exp(std::clamp(0.5 * (off.gain - price), 0.0, thresholds::most_logarithmic_odds));
    result.parameters_off.push_back({off.path,
                                     off.described,
                                     tolerance_of(description, off.path),
                                     interval_of(car.parameters.at(off.path)),
                                     confidence({odds}, INFINITY, certainty),
                                     {}});
  }
}

/// Something is there that the catalogue does not hold; `text` joins what is said of it.
void add_unexplained(const std::string& text, Diagnosis& result) {
  result.unexplained = true;
  result.residual += (result.residual.empty() ? "" : "; ") + text;
}

/// Where no effect is named, a relation that fails counts as a residual: what drives the simulation, or is computed by
/// the program, shows in the relations alone.
void add_failed_relations(Diagnosis& result) {
  if (!result.effects.empty() || !result.laws.empty() || !result.parameters_off.empty() ||
      result.has_cause_in_recording())
    return;
  for (const ParityResidual& r : result.relations) {
    if (!r.significant()) continue;
    add_unexplained("the balance " + r.relation + " fails" + (r.description.empty() ? "" : ": " + r.description),
                    result);
  }
}

/// An effect whose size changes with its amplitude or with time is not the law that acts there.
void add_inconstant_laws(const SearchResult& found, Diagnosis& result) {
  for (std::size_t i = 0; i < found.causes.size(); ++i) {
    const LawConstancy& constancy = found.causes[i].constancy;
    if (!constancy.fails()) continue;
    const char* const how =
        constancy.with_time ? ": its size changes over the record" : ": its size depends on the amplitude";
    add_unexplained(words(found.best.effects[i]) + how, result);
  }
}

/// An effect that rather is a law outside the catalogue.
void add_lookalikes(Diagnosis& result) {
  for (const NamedEffect& named : result.effects) {
    if (!is_close(named.other)) continue;
    const std::string text =
        words(named.effect) + " may be " + std::string(named.other.law) + ", which the catalogue does not hold";
    if (named.other.chance > 0.5) {
      add_unexplained(text, result);
    } else {
      result.remarks.push_back(text);
    }
  }
}

Verdict verdict_of(const Diagnosis& result, double explained, bool close) {
  const bool by_chance = std::all_of(result.effects.begin(), result.effects.end(),
                                     [](const NamedEffect& named) { return named.is_by_chance(); });
  if (by_chance && result.laws.empty() && result.parameters_off.empty() && !result.has_cause_in_recording())
    return result.unexplained ? Verdict::unexplained : Verdict::no_discrepancy;
  if (result.unexplained && explained < thresholds::explains_all) return Verdict::unexplained;
  return close ? Verdict::ambiguous : Verdict::named;
}

/// Parameters that are off: rated as an effect is. One that is described without a tolerance is fitted, and not off
/// where it is as described but for the rounding of a number.
std::vector<ParameterOff> parameters_off(const firmware::RigDescription& description,
                                         const IdentificationProblem& problem, const SearchResult& found,
                                         const std::map<std::string, Interval>& parameters,
                                         const Certainty& certainty) {
  std::vector<ParameterOff> list;
  for (const SuspectParameter& suspect : found.suspects) {
    model::RigParameters<double> rig = description.rig;
    const double* const described = firmware::find_parameter(rig, suspect.path);
    ParameterOff off{suspect.path,
                     described != nullptr ? *described : 0.0,
                     tolerance_of(description, suspect.path),
                     parameters.at(suspect.path),
                     0.0,
                     {}};
    if (off.tolerance == 0.0 &&
        std::abs(off.value.value - off.described) <= thresholds::rounding * std::abs(off.described)) {
      continue;
    }
    const FoundCause& cause = suspect.cause;
    RatedRivals rivals =
        rated(cause.rivals, 0.0, 0.0, cause.parameters, certainty.temper,
              [&](const Hypothesis& rival) { return best_experiment(problem, found.best.fit.hypothesis, rival); });
    off.alternatives = std::move(rivals.alternatives);
    off.confidence = confidence(rivals.odds, cause.gain, certainty);
    list.push_back(std::move(off));
  }
  return list;
}

void locate(const IdentificationProblem& problem, const SearchResult& found, bool tyre_effects, Diagnosis& result) {
  result.left_by_refit = band_powers(problem, found.nothing.fit.hypothesis);
  result.left_after = band_powers(problem, found.best.fit.hypothesis);
  result.locations = localise(result.left_by_refit, found, likely_fault_location(result.relations));
  if (!tyre_effects) return;
  // The virtual tyre shows in no residual: half of the disagreement is its own, all of it where there is no other.
  const double other = result.locations.empty() ? 0.0 : 0.5;
  for (RecordingLocation& location : result.locations) location.share *= other;
  result.locations.push_back({Channel::F_w, 0.0, 0.5 / problem.sample_period(), "tyre", 1.0 - other});
}

/// A parameter that drifts has its value at the beginning of the recording; its change stands in [recording].
void put_into_rig(const firmware::RigDescription& description, const PreparedRecording& recording,
                  const Hypothesis& found, Diagnosis& result) {
  result.rig = description;
  for (const auto& [path, value] : result.parameters) {
    if (double* const parameter = firmware::find_parameter(result.rig.rig, path)) *parameter = value.value;
  }
  for (const NamedEffect& named : result.effects) firmware::put_effect(result.rig.rig, named.effect);
  put_laws(found.laws, result.rig.rig);
  const auto add = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  const firmware::RecorderDescription recorder = recorder_of(found.faults, recording.input.channel, recording.channels);
  add(result.rig.recorder.common_filter, recorder.common_filter);
  add(result.rig.recorder.clock, recorder.clock);
  add(result.rig.recorder.hum, recorder.hum);
  add(result.rig.recorder.drift, recorder.drift);
}

}  // namespace

std::string_view name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> names{"no_discrepancy", "named", "ambiguous", "unexplained"};
  return names[static_cast<std::size_t>(verdict)];
}

Diagnosis assess(const firmware::RigDescription& description, const IdentificationProblem& problem,
                 const SearchSpace& space, std::vector<ParityResidual> relations, SearchResult found, Learned learned) {
  estimate_held_out_starts(found.nothing.fit.hypothesis, problem.samples());
  estimate_held_out_starts(found.best.fit.hypothesis, problem.samples());
  if (learned.without) estimate_held_out_starts(*learned.without, problem.samples());
  const bool diverges = !stays_finite(problem, found.best.fit.hypothesis);
  if (diverges) give_up(found);

  // What is said of the rig is what it does as one.
  std::optional<IdentificationProblem> joined;
  const IdentificationProblem& whole = problem.is_apart() ? joined.emplace(problem.joined()) : problem;
  Diagnosis result;
  const Supported supported = leave_out_unsupported(problem, whole, space, found, result);
  const FitErrors errors = fit_errors(description, problem, found.best.fit, supported.known);
  const Uncertainty& known = errors.known;
  const Hypothesis &refit = found.nothing.fit.hypothesis, &after = found.best.fit.hypothesis;
  result.relations = std::move(relations);
  result.simulations = whole.work().simulations();
  result.candidates = whole.work().candidates();
  const auto of_noise = noise_remarks(problem);
  result.remarks.insert(result.remarks.begin(), of_noise.begin(), of_noise.end());
  result.remarks.insert(result.remarks.end(), found.remarks.begin(), found.remarks.end());
  result.not_tried = whole.work().left_out();
  if (!result.not_tried.empty()) {
    result.remarks.push_back("the work that a diagnosis may cost was spent; not tried: " +
                             identification::joined(result.not_tried));
  }
  result.residual_power = residual_power(whole, space, found);
  const LeftByFit left = left_by(problem, found.best.fit);
  result.unexplained = left.any();
  result.unexplained_probability = chance_of_a_rest(problem, found.best.fit, left.any());
  result.residual = left.words();
  if (diverges) {
    result.unexplained = true;
    result.residual = "the model that fits best does not stay finite over the whole recording";
  }
  result.prediction_errors =
      prediction_errors(whole, space.given, refit, after, learned.without ? &*learned.without : nullptr);
  const bool nothing = result.unexplained && leaves_a_whole_signal(result.prediction_errors);
  const double explained = nothing ? 0.0
                                   : explained_share(result.residual_power.refit, result.residual_power.after,
                                                     static_cast<double>(problem.residual_count()));

  const SelectionCriterion criterion;
  const Certainty certainty = certainty_of(whole, found, result.unexplained, explained);
  add_inconstant_laws(found, result);
  const SearchSpace fitted_space = untied(space, found.freed);
  const std::vector<Interval> parameters = intervals(found.best.fit, known.half_widths);
  const std::vector<FreeParameter>& tolerated = fitted_space.tolerated;
  const std::vector<UncertaintyBudget> budgets = parameter_budgets(found.best.fit, errors);
  for (std::size_t i = 0; i < tolerated.size(); ++i) {
    result.parameters[tolerated[i].path] = parameters[i];
    result.budgets[tolerated[i].path] = budgets[i];
  }
  result.parameters_off = parameters_off(description, problem, found, result.parameters, certainty);
  result.laws = describe_laws(problem, found.best.fit, known);
  for (DescribedLaw& law : result.laws) law.confidence = confidence(learned.odds_against, learned.gain, certainty);
  result.next_step = next_step(problem, learned);
  result.described_curves = described_curves(problem, description, refit);
  result.effects = named_effects(problem, found, criterion, parameters, certainty);
  for (std::size_t i = 0; i < supported.support.shares.size(); ++i) {
    result.effects[i].share = supported.support.shares[i];
    result.effects[i].chance = supported.support.chances[i];
    result.effects[i].confidence *= 1.0 - result.effects[i].chance;
  }
  add_budgets(found, budgets, result);
  result.predictions = predicted_channels(problem, found.best.fit, errors, result.unexplained);
  add_lookalikes(result);
  const auto has_close = [](const auto& named) { return has_close_rival(named.alternatives); };
  const auto has_lookalike = [](const NamedEffect& named) { return is_close(named.other); };
  result.recording_faults = recording_causes(problem, found, criterion, parameters, certainty);
  const bool close = std::any_of(result.effects.begin(), result.effects.end(), has_close) ||
                     std::any_of(result.effects.begin(), result.effects.end(), has_lookalike) ||
                     std::any_of(result.parameters_off.begin(), result.parameters_off.end(), has_close) ||
                     std::any_of(result.recording_faults.begin(), result.recording_faults.end(), has_close);
  const VirtualCarEstimate car = estimate_virtual_car(description, problem.samples());
  for (const auto& [path, estimate] : car.parameters) {
    result.parameters[path] = interval_of(estimate);
    result.budgets[path] = budget_of(estimate);
  }
  add_tyre_effects(car, criterion, result);
  add_numbers_off(description, car, criterion.effect + criterion.parameter + thresholds::violation,
                  {1.0, 1.0, 1.0, false}, result);
  for (const auto& faults : {static_value_faults(problem), noise_faults(problem), lost_samples(problem, after)}) {
    result.recording_faults.insert(result.recording_faults.end(), faults.begin(), faults.end());
  }
  if (found.freed.empty()) add_failed_relations(result);  // they hold with the parameters as described
  result.verdict = verdict_of(result, explained, close);
  if (result.unexplained) {
    std::stable_sort(result.effects.begin(), result.effects.end(),
                     [](const NamedEffect& a, const NamedEffect& b) { return a.share > b.share; });
  }

  locate(whole, found, !car.effects.empty(), result);
  result.power_over_time = power_over_time(whole, refit, after);
  result.overlays = overlays_of(whole, space.given, refit, after);
  put_into_rig(description, problem.samples().front(), after, result);
  return result;
}

}  // namespace host_sim::identification
