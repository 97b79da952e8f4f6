// Which effects, alone or together, explain what is left over.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/diagnose/explainer.hpp"

namespace host_sim::diagnose {

/// An effect that could stand in the place of one that was named.
struct Rival {
  PlacedEffect effect;
  double cost;            ///< of the explanation with it
  Hypothesis hypothesis;  ///< that explanation
};

struct Findings {
  Explanation nothing;  ///< only the tolerated parameters refitted
  Explanation best;
  std::vector<std::vector<Rival>> rivals;  ///< of each effect in `best`, nearest first
  std::vector<double> gains;       ///< of each effect in `best`: what χ² is larger by without it, all else refitted
  std::vector<Explanation> alone;  ///< single effects that were tried, cheapest first; until they are compared
  Scales scales{};                 ///< from `nothing` before any effect was tried
  std::size_t simulations = 0;
  std::size_t tried = 0;  ///< candidates
};

/// Told while it lasts: share of the whole, what is being done, simulations and candidates so far.
using Tell =
    std::function<void(double share, const std::string& what, std::size_t simulations, std::size_t candidates)>;

/// Whitens the case anew for a hypothesis; false where its noise does not depend on one.
using Rewhiten = std::function<bool(const Hypothesis&)>;

struct Tools {
  Price price;
  Rewhiten rewhiten;
  Shorten shorten;
  Tell tell;
};

/// Forward with a beam. After each effect that is accepted the case is whitened anew; where it leaves more than noise
/// it is fitted again from the beginning of the recordings on, in growing pieces: with free play or stops a long
/// recording has many minima, a short one few.
[[nodiscard]] Findings search(Case& all, const Hypothesis& given, const std::vector<Unknown>& tolerated,
                              const std::vector<Unknown>& starts, const Tools& tools);

/// What was found is tried without each effect, then with each other candidate in the place of each: what is better
/// stands, what is not is its rivals.
void compare(Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts, const Tools& tools,
             Findings& findings);

/// The share of the fitted windows that has `enough` seconds of the longest; 1 where that would not save much.
[[nodiscard]] double telling_share(const Case& all, double enough);

/// What was found in a part of the recordings, fitted again in the whole of them; rivals keep their distance, in
/// proportion to the number of residuals.
void settle_on(const Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts,
               const Price& price, Findings& findings);

}  // namespace host_sim::diagnose
