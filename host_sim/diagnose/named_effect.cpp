#include "host_sim/diagnose/named_effect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/diagnose/experiment.hpp"
#include "host_sim/diagnose/noise_bands.hpp"
#include "host_sim/diagnose/rest.hpp"

namespace host_sim::diagnose {
namespace {

/// Odds below which two explanations count as not told apart. (A simpler effect that is a limit of its rival wins by
/// the price of a parameter, e^5.)
constexpr double too_close = 20.0;

/// How likely it is that something which is not in the catalogue looks like an effect that gained so much of χ².
///
/// Were the law a neighbour of the effect's that shares all but q of its power, q gain of χ² would be left over, and be
/// seen from `seen` on. Of rigs that have something to find so many have something that is not in the catalogue, and
/// before anything is known its q is as likely to be around 0.001 as around 0.1 (uniform in log q, 0.001 … 1).
double outside_chance(double gain, double seen) {
  constexpr double outside = 0.2, closest = 1e-3;
  return outside * std::clamp(std::log(seen / (std::max(gain, 1e-9) * closest)) / std::log(1.0 / closest), 0.0, 1.0);
}

}  // namespace

double seen_from(const Case& all, double count) {
  const double per_band = 2.0 * count / static_cast<double>(noise_bands * all.evidence.front().channels.size());
  return std::max(significant * std::sqrt(2.0 * per_band), loud_share * per_band);
}

// Standard deviations: 1.96 for noise that is known; what carries it through the rig is itself known to some per cent
// only, which over the recordings of tests/confusion takes 1.2 times as much.
std::vector<Interval> intervals(const Fit& fit, double temper) {
  constexpr double deviations = 1.2 * 1.96;
  const Eigen::MatrixXd covariance = fit.covariance();
  std::vector<Interval> list;
  for (std::size_t i = 0; i < fit.unknowns.size(); ++i) {
    const Unknown& unknown = fit.unknowns[i];
    const auto k = static_cast<Eigen::Index>(i);
    const double u = unknown.get(fit.hypothesis);
    const double half = deviations * std::sqrt(std::max(covariance(k, k), 0.0) * temper);
    const double low = std::max(u - half, unknown.lower), high = std::min(u + half, unknown.upper);
    list.push_back({unknown.value(u), unknown.value(low), unknown.value(high)});
  }
  return list;
}

bool has_close_rival(const NamedEffect& effect) {
  return std::any_of(effect.alternatives.begin(), effect.alternatives.end(),
                     [](const Alternative& other) { return other.odds_against < too_close; });
}

std::vector<NamedEffect> named_effects(const Case& all, const Findings& findings, const Price& price,
                                       const std::vector<Interval>& unknowns, const Certainty& certainty) {
  constexpr std::size_t most_alternatives = 5;
  const Explanation& best = findings.best;
  std::size_t unknown = unknowns.size();  // those of the effects stand last
  for (const PlacedEffect& effect : best.effects) unknown -= effect_unknowns(effect).size();
  std::vector<NamedEffect> list;
  for (std::size_t i = 0; i < best.effects.size(); ++i) {
    NamedEffect named{best.effects[i], {}, 0.0, {}};
    const bool is_read_off = is_hold(*named.effect.entry);
    for (std::size_t p = 0; p < effect_unknowns(named.effect).size(); ++p, ++unknown) {
      named.parameters.push_back(unknowns[unknown]);
    }
    if (is_read_off) {
      const HoldPeriod period = hold_period(all.evidence, *named.effect.channel).value();
      named.parameters.push_back({period.value, period.value - period.half_width, period.value + period.half_width});
    }
    double against = 0.0;
    for (const Rival& rival : findings.rivals[i]) {
      const double apart = rival.cost - best.cost(price);
      const double odds = std::exp(std::min(apart / (2.0 * certainty.temper), 300.0));
      against += 1.0 / odds;
      if (named.alternatives.size() == most_alternatives) continue;
      Alternative alternative{rival.effect, odds, {}};
      if (odds < too_close) {
        alternative.separate_by = best_experiment(all, best.fit.hypothesis, rival.hypothesis);
      }
      named.alternatives.push_back(std::move(alternative));
    }
    // A hold is seen in the values themselves.
    const double known_law =
        is_read_off ? 1.0 : 1.0 - outside_chance(findings.gains[i] / certainty.temper, certainty.seen);
    named.confidence = 0.999 / (1.0 + against) * certainty.worth * known_law;
    list.push_back(std::move(named));
  }
  return list;
}

}  // namespace host_sim::diagnose
