#include "host_sim/identification/assess/named_effect.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/identification/assess/experiment.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/identification/select/law_constancy.hpp"

namespace host_sim::identification {
namespace {

/// (3)
double outside_chance(double gain, double seen) {
  constexpr double closest = thresholds::closest_outside;
  const double share = std::log(seen / (std::max(gain, 1e-9) * closest)) / std::log(1.0 / closest);
  return thresholds::outside_share * std::clamp(share, 0.0, 1.0);
}

/// The sum of squares by which the residuals change when the step is doubled [χ²]; 0 without corners. The error that
/// the present step leaves is about as large.
double changed_by_steps(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  if (!has_corners(hypothesis.rig)) return 0.0;
  return (residuals(problem, predict(problem, hypothesis, true)) - residuals(problem, predict(problem, hypothesis)))
      .squaredNorm();
}

}  // namespace

double seen_from(double count, std::size_t channels) {
  const double per_band = 2.0 * count / static_cast<double>(noise_bands * channels);
  return std::max(thresholds::significant_deviations * std::sqrt(2.0 * per_band),
                  thresholds::significant_share * per_band);
}

double confidence(const std::vector<double>& odds, double gain, const Certainty& certainty) {
  double against = 0.0;
  for (const double each : odds) against += 1.0 / each;
  const double known_law = 1.0 - outside_chance(gain / certainty.temper, certainty.seen);
  return thresholds::highest_confidence / (1.0 + against) * certainty.worth * known_law;
}

PossibleLaw lookalike_of(const firmware::PlacedEffect& effect, const std::vector<Interval>& parameters) {
  constexpr double deviations = 1.96;  // 95 % of a normal distribution
  PossibleLaw nearest;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const model::EffectParameter& card = effect.entry->parameters[i];
    if (card.lookalike.law.empty()) continue;
    const double sigma = 0.5 * (parameters[i].upper - parameters[i].lower) / deviations;
    const double variance = card.lookalike.deviation * card.lookalike.deviation + sigma * sigma;
    const double away = parameters[i].value - card.lookalike.at;
    const double density = std::exp(-0.5 * away * away / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
    const double odds = thresholds::outside_share / (1.0 - thresholds::outside_share) * card.lookalike.range * density;
    const double chance = odds / (1.0 + odds);
    if (chance > nearest.chance) nearest = {card.lookalike.law, chance};
  }
  return nearest;
}

bool is_close(const PossibleLaw& other) { return other.chance * thresholds::close_odds > 1.0 - other.chance; }

std::vector<Interval> intervals(const Fit& fit, const Eigen::VectorXd& half_widths) {
  std::vector<Interval> list;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FreeParameter& parameter = fit.parameters[i];
    const double u = parameter.get(fit.hypothesis), half = half_widths(static_cast<Eigen::Index>(i));
    const double low = std::max(u - half, parameter.lower), high = std::min(u + half, parameter.upper);
    list.push_back({parameter.value(u), parameter.value(low), parameter.value(high)});
  }
  return list;
}

bool is_close(const Alternative& other) { return other.odds_against < thresholds::close_odds; }

bool has_close_rival(const std::vector<Alternative>& alternatives) {
  return std::any_of(alternatives.begin(), alternatives.end(),
                     [](const Alternative& other) { return is_close(other); });
}

RatedRivals rated(const std::vector<Rival>& effects, double of_best, double own_rarity,
                  const std::vector<RivalParameter>& parameters, double temper,
                  const std::function<std::string(const Hypothesis&)>& experiment) {
  RatedRivals result;
  const auto add = [&](const Alternative::Cause& cause, double apart, double rarer, const Hypothesis& hypothesis) {
    const double logarithm = 0.5 * ((apart - rarer) / temper + rarer);
    const double odds = std::exp(std::min(logarithm, thresholds::most_logarithmic_odds));
    result.odds.push_back(odds);
    const bool close = odds < thresholds::close_odds;
    result.alternatives.push_back({cause, odds, close ? experiment(hypothesis) : std::string()});
  };
  for (const Rival& rival : effects) {
    add(rival.effect, rival.penalised_chi_squared - of_best, rarity(rival.effect) - own_rarity, rival.hypothesis);
  }
  for (const RivalParameter& rival : parameters) {
    add(ParameterValue{rival.path, rival.value}, rival.penalised_chi_squared, -own_rarity, rival.hypothesis);
  }
  std::stable_sort(result.alternatives.begin(), result.alternatives.end(),
                   [](const Alternative& a, const Alternative& b) { return a.odds_against < b.odds_against; });
  if (result.alternatives.size() > thresholds::most_alternatives) {
    result.alternatives.resize(thresholds::most_alternatives);
  }
  return result;
}

std::vector<NamedEffect> named_effects(const IdentificationProblem& problem, const SearchResult& found,
                                       const SelectionCriterion& criterion, const std::vector<Interval>& parameters,
                                       const Certainty& certainty) {
  const CandidateModel& best = found.best;
  std::size_t next = parameters.size();  // those of the effects stand last
  for (const firmware::PlacedEffect& effect : best.effects) next -= effect_parameters(effect).size();
  const double of_steps = changed_by_steps(problem, best.fit.hypothesis);
  std::vector<NamedEffect> list;
  for (std::size_t i = 0; i < best.effects.size(); ++i) {
    NamedEffect named{best.effects[i], {}, 0.0, {}, {}};
    const std::size_t count = effect_parameters(named.effect).size();
    for (std::size_t p = 0; p < count; ++p) named.parameters.push_back(parameters[next++]);
    // A hold is read off the values themselves, so no law outside the catalogue can look like it.
    double gain = found.causes[i].gain;
    if (is_hold(*named.effect.entry)) {
      const HoldPeriod period = hold_period(problem.samples(), *named.effect.channel).value();
      named.parameters.push_back({period.value, period.value - period.half_width, period.value + period.half_width});
      gain = INFINITY;
    }
    std::vector<Rival> others = found.causes[i].rivals;
    std::erase_if(others, [&](const Rival& rival) {  // the same in another minimum
      return rival.effect.entry == named.effect.entry && rival.effect.channel == named.effect.channel;
    });
    RatedRivals rivals = rated(others, best.penalised_chi_squared(criterion), rarity(named.effect),
                               found.causes[i].parameters, certainty.temper, [&](const Hypothesis& rival) {
                                 return best_experiment(problem, best.fit.hypothesis, rival);
                               });
    named.alternatives = std::move(rivals.alternatives);
    named.confidence = confidence(rivals.odds, gain, certainty);
    // What could imitate other laws does so where it leaves a rest.
    const bool imitation = certainty.rest && named.effect.entry->imitates;
    const bool lost_in_steps = gain < of_steps;
    if (imitation || lost_in_steps || law_in_doubt(found, i)) {
      named.confidence *= thresholds::inconstant_worth;
    }
    named.other = lookalike_of(named.effect, named.parameters);
    named.confidence *= 1.0 - named.other.chance;
    list.push_back(std::move(named));
  }
  return list;
}

}  // namespace host_sim::identification
