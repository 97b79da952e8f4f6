#include "host_sim/diagnose/search.hpp"

#include <algorithm>

#include "host_sim/diagnose/parallel.hpp"
#include "host_sim/diagnose/readings.hpp"

namespace host_sim::diagnose {

using model::Channel;

double telling_share(const Case& all, double enough) {
  constexpr double most = 0.75;  // more saves nothing
  double longest = 0.0;
  for (const Evidence& e : all.evidence) {
    longest = std::max(longest, static_cast<double>(e.fit.size()) * e.drive.period);
  }
  return longest > 0.0 && enough / longest < most ? enough / longest : 1.0;
}

namespace {

std::vector<Unknown> in_a_row(std::vector<Unknown> first, const std::vector<Unknown>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// What tells candidates apart where what is left is far above noise [s].
constexpr double seconds_telling = 12.0;

/// Whether what an explanation leaves is so loud that a part of it tells candidates apart.
bool is_loud(const Explanation& e) {
  constexpr double beyond = 40.0;  // times the power of noise
  return e.fit.chi_squared > beyond * static_cast<double>(e.fit.residual.size());
}

/// What is to be believed of a longer explanation: that it pays, and that it explains enough of what was left.
bool is_worth(const Explanation& longer, const Explanation& shorter, const Price& price, double share) {
  const auto count = static_cast<double>(shorter.fit.residual.size());
  const double left = std::max(shorter.fit.chi_squared - count, 0.0);
  const double gained = shorter.fit.chi_squared - longer.fit.chi_squared;
  return longer.cost(price) < shorter.cost(price) && gained > share * left;
}

bool same_place(const PlacedEffect& a, const PlacedEffect& b) { return a.entry == b.entry && a.channel == b.channel; }

/// Rivals of an effect, the nearest first, each fitted again beside the others as they are now. `rest`: what is left
/// without the effect.
std::vector<Rival> rivals_of(const Explainer& explainer, const Explanation& best, const Explanation& rest,
                             std::size_t place, const std::vector<Explanation>& with_others, const Price& price) {
  std::vector<Rival> rivals;
  for (const Explanation& e : with_others) {
    if (same_place(e.effects.back(), best.effects[place])) continue;
    rivals.push_back({e.effects.back(), e.cost(price), e.fit.hypothesis});
  }
  std::sort(rivals.begin(), rivals.end(), [](const Rival& a, const Rival& b) { return a.cost < b.cost; });
  constexpr std::size_t near = 2;   // the others are further away than a few steps would bring them
  constexpr double explains = 0.3;  // and so is what explains less of what the effect does
  const double far = rest.cost(price) - explains * (rest.cost(price) - best.cost(price));
  for_all(std::min(near, rivals.size()), [&](std::size_t r) {
    if (rivals[r].cost > far) return;
    std::vector<PlacedEffect> effects = best.effects;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(place));
    effects.push_back(rivals[r].effect);
    const Explanation again = explainer.fitted(rivals[r].hypothesis, std::move(effects), 6);
    rivals[r] = {again.effects.back(), again.cost(price), again.fit.hypothesis};
  });
  std::sort(rivals.begin(), rivals.end(), [](const Rival& a, const Rival& b) { return a.cost < b.cost; });
  return rivals;
}

struct Cheaper {
  const Price& price;
  bool operator()(const Explanation& a, const Explanation& b) const { return a.cost(price) < b.cost(price); }
};

/// What forward, backward and swap share: one case, its prices and its reports.
class Search {
 public:
  Search(Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts, const Tools& tools)
      : all_(all),
        common_(in_a_row(tolerated, starts)),
        tools_(tools),
        price_(tools.price),
        explainer_(all, common_, price_),
        share_scanned_(tools.shorten ? telling_share(all, seconds_telling) : 1.0) {}

  /// From nothing on, one effect more at a time.
  void forward(const Hypothesis& given, Findings& findings) {
    Explanation& nothing = findings.nothing;
    Explanation& best = findings.best;
    report(0.05, "tolerated parameters");
    nothing = explainer_.settled(given, {});
    findings.scales = scales_of(all_, nothing.fit.hypothesis, respond(all_, nothing.fit.hypothesis));

    constexpr std::size_t most_effects = 4;
    const std::size_t beam_width = price_.beam;
    std::vector<Explanation> beam{nothing};
    std::vector<Explanation>& alone = findings.alone;
    best = nothing;
    // Values that repeat themselves in regular turns are a hold: no fit could say it better.
    for (const Channel channel : all_.evidence.front().channels) {
      const auto held = explainer_.held(best, findings.scales, channel);
      if (held && is_worth(*held, best, price_, 0.0)) beam.front() = best = *held;
    }
    if (!best.effects.empty() && tools_.rewhiten(best.fit.hypothesis)) {
      explainer_.settle(nothing, 4);
      explainer_.settle(best, 4);
      beam.front() = best;
    }
    for (std::size_t depth = 0; depth < most_effects && (depth == 0 || !explainer_.leaves_noise(best)); ++depth) {
      report(0.1 + 0.15 * static_cast<double>(depth), depth == 0 ? "one effect" : "one more effect");
      std::vector<Explanation> next;
      for (const Explanation& base : beam) {
        auto list = extended(base, findings.scales, false);
        if (base.effects.empty()) alone = list;
        for (std::size_t i = 0; i < std::min(beam_width, list.size()); ++i) {
          if (is_worth(list[i], base, price_, price_.share(base))) next.push_back(std::move(list[i]));
        }
      }
      if (next.empty()) break;
      std::sort(next.begin(), next.end(), Cheaper{price_});
      if (next.size() > beam_width) next.resize(beam_width);
      for (Explanation& e : next) explainer_.settle(e, 6);
      std::sort(next.begin(), next.end(), Cheaper{price_});
      if (next.front().cost(price_) >= best.cost(price_)) break;
      best = next.front();
      beam = std::move(next);
      // The noise of the input goes through what was found, too.
      if (tools_.rewhiten(best.fit.hypothesis)) {
        explainer_.settle(nothing, 4);
        for (Explanation& e : beam) explainer_.settle(e, 4);
        std::sort(beam.begin(), beam.end(), Cheaper{price_});
        best = beam.front();
        for_all(alone.size(), [&](std::size_t i) {
          alone[i] = explainer_.fitted(alone[i].fit.hypothesis, alone[i].effects, 0);
          lighten(alone[i].fit);
        });
      }
      if (tools_.shorten && has_corners(best.fit.hypothesis.rig) && !explainer_.leaves_noise(best)) {
        explainer_.regrow(best, tools_.shorten);
        beam.front() = best;
      }
    }
    count(findings);
  }

  /// Backward: what is not needed any more. Swap: each effect against every other candidate.
  void backward(Findings& findings) {
    Explanation& nothing = findings.nothing;
    Explanation& best = findings.best;
    explainer_.simulations = findings.simulations;
    explainer_.tried = findings.tried;
    for (int round = 0; round < 4 && !best.effects.empty(); ++round) {
      bool changed = false;
      findings.rivals.assign(best.effects.size(), {});
      findings.gains.assign(best.effects.size(), 0.0);
      for (std::size_t i = 0; i < best.effects.size() && !changed; ++i) {
        if (explainer_.is_seen(best.effects[i])) continue;
        report(0.6 + 0.3 * static_cast<double>(i) / static_cast<double>(best.effects.size()),
               "rivals of " + std::string(best.effects[i].entry->name));
        const bool only_one = best.effects.size() == 1;
        Explanation rest = only_one ? nothing : explainer_.without(best, i);
        // With corners the fit without may only be in a worse one of many minima.
        if (tools_.shorten && !only_one && has_corners(rest.fit.hypothesis.rig))
          explainer_.regrow(rest, tools_.shorten);
        if (rest.cost(price_) <= best.cost(price_)) {
          best = rest;
          changed = true;
          break;
        }
        const bool known = only_one && !findings.alone.empty();
        std::vector<Explanation> others = known ? findings.alone : extended(rest, findings.scales, true);
        for (const Explanation& e : others) {
          if (same_place(e.effects.back(), best.effects[i]) || e.cost(price_) >= best.cost(price_) - 1.0) continue;
          Explanation full = explainer_.settled(e.fit.hypothesis, e.effects, 6);
          if (full.cost(price_) >= best.cost(price_) - 1.0) continue;
          best = std::move(full);
          changed = true;
          break;
        }
        if (changed) break;
        findings.rivals[i] = rivals_of(explainer_, best, rest, i, others, price_);
        findings.gains[i] = rest.fit.chi_squared - best.fit.chi_squared;
      }
      if (!changed) break;
      if (tools_.rewhiten(best.fit.hypothesis)) {
        explainer_.settle(nothing, 4);
        explainer_.settle(best, 6);
        findings.alone.clear();
      }
    }
    findings.alone.clear();
    count(findings);
  }

 private:
  /// One more effect beside an explanation, cheapest first; `unpromising`: those, too, that will hardly be worth it.
  [[nodiscard]] std::vector<Explanation> extended(const Explanation& base, const Scales& scales,
                                                  bool unpromising) const {
    const std::size_t most = unpromising ? price_.compared : price_.tried;
    // A promise is linear: a third of what an effect must gain is worth a fit.
    const auto least = [&](const Explanation& e) {
      const double left = std::max(e.fit.chi_squared - static_cast<double>(e.fit.residual.size()), 0.0);
      return unpromising ? 0.0 : std::max(price_.effect, price_.share(e) * left) / 3.0;
    };
    if (share_scanned_ < 1.0 && is_loud(base)) {
      const Case part = tools_.shorten(share_scanned_);
      const Explainer on_part(part, common_, price_);
      const Explanation start = on_part.settled(base.fit.hypothesis, base.effects, 2);
      auto list = on_part.extended(start, scales, most, least(start));
      explainer_.simulations += on_part.simulations;
      explainer_.tried += on_part.tried;
      for_all(list.size(), [&](std::size_t i) {
        list[i] = explainer_.fitted(list[i].fit.hypothesis, list[i].effects, i < price_.beam ? 6 : 0, base.fit.slope);
        lighten(list[i].fit);
      });
      std::sort(list.begin(), list.end(), Cheaper{price_});
      // What shows itself seldom may not be in the part.
      if (!list.empty() && is_worth(list.front(), base, price_, price_.share(base))) return list;
    }
    return explainer_.extended(base, scales, most, least(base));
  }

  void report(double share, const std::string& what) const {
    if (tools_.tell) tools_.tell(share, what, explainer_.simulations, explainer_.tried);
  }

  void count(Findings& findings) {
    findings.simulations = explainer_.simulations;
    findings.tried = explainer_.tried;
  }

  Case& all_;
  std::vector<Unknown> common_;
  const Tools& tools_;
  const Price& price_;
  Explainer explainer_;
  double share_scanned_;
};

}  // namespace

Findings search(Case& all, const Hypothesis& given, const std::vector<Unknown>& tolerated,
                const std::vector<Unknown>& starts, const Tools& tools) {
  Findings findings;
  Search(all, tolerated, starts, tools).forward(given, findings);
  return findings;
}

void compare(Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts, const Tools& tools,
             Findings& findings) {
  Search(all, tolerated, starts, tools).backward(findings);
}

void settle_on(const Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts,
               const Price& price, Findings& findings) {
  const Explainer explainer(all, in_a_row(tolerated, starts), price);
  const double before = findings.best.cost(price);
  const auto part = static_cast<double>(findings.best.fit.residual.size());
  explainer.settle(findings.nothing, 8);
  explainer.settle(findings.best, 8);
  findings.simulations += explainer.simulations;
  const double larger = static_cast<double>(findings.best.fit.residual.size()) / part;
  const double after = findings.best.cost(price);
  for (auto& rivals : findings.rivals) {
    for (Rival& rival : rivals) rival.cost = after + larger * (rival.cost - before);
  }
  for (double& gain : findings.gains) gain *= larger;
}

}  // namespace host_sim::diagnose
