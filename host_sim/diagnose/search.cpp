#include "host_sim/diagnose/search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "host_sim/diagnose/golden_section.hpp"
#include "host_sim/diagnose/noise_bands.hpp"
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

double Price::share(const Explanation& base) const { return base.effects.empty() ? first_share : later_share; }

double Explanation::cost(const Price& price) const {
  double sum = fit.chi_squared;
  for (const PlacedEffect& effect : effects) {
    sum += price.effect + price.parameter * static_cast<double>(effect.values.size());
  }
  return sum;
}

namespace {

/// The directions in which what is fitted already can move, to see what is new about another.
class Known {
 public:
  explicit Known(const Fit& base) : base_(base) {
    Eigen::MatrixXd h = base.slope.transpose() * base.slope;
    for (Eigen::Index i = 0; i < h.rows(); ++i) {
      // What lies at a bound cannot make way for another.
      const bool free = !base.unknowns[static_cast<std::size_t>(i)].at_bound(base.hypothesis);
      h(i, i) += (free ? 1e-10 : 1e12) * h(i, i) + 1e-30;
    }
    factor_.compute(h);
    residual_ = base.slope.transpose() * base.residual;
  }

  /// What χ² falls by when the change d of the residuals may enter with a factor of 0 … 2, all else refitted linearly.
  [[nodiscard]] double gain(const Eigen::VectorXd& d) const {
    double square = d.squaredNorm(), along = base_.residual.dot(d);
    if (base_.slope.cols() > 0) {
      const Eigen::VectorXd projection = base_.slope.transpose() * d;
      const Eigen::VectorXd solved = factor_.solve(projection);
      square -= projection.dot(solved);
      along -= residual_.dot(solved);
    }
    if (!(square > 1e-9)) return 0.0;
    const double factor = std::clamp(-along / square, 0.0, 2.0);
    return -2.0 * factor * along - factor * factor * square;
  }

 private:
  const Fit& base_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd residual_;
};

PlacedEffect placed(const Candidate& candidate, const Start& start) {
  return {candidate.entry, candidate.channel, start.values};
}

Hypothesis with(const Hypothesis& hypothesis, const PlacedEffect& effect, const HoldClock& clock) {
  Hypothesis other = hypothesis;
  put_effect(other.rig, effect);
  if (is_hold(*effect.entry)) other.clocks[index(*effect.channel)] = clock;
  return other;
}

struct Scanned {
  Candidate candidate;
  std::vector<std::pair<double, Start>> starts;  ///< gain; best first
};

/// Leaves of a fit what it says, not what the next step would need: megabytes for minutes.
void lighten(Fit& fit) {
  fit.prediction = {};
  fit.slope.resize(0, 0);
}

/// The effects with their parameters as they are in a hypothesis.
std::vector<PlacedEffect> read_back(const Hypothesis& hypothesis, std::vector<PlacedEffect> effects) {
  for (PlacedEffect& effect : effects) {
    for (const PlacedEffect& now : effects_of(hypothesis.rig)) {
      if (now.entry == effect.entry && now.channel == effect.channel) effect.values = now.values;
    }
  }
  return effects;
}

std::vector<Unknown> in_a_row(std::vector<Unknown> first, const std::vector<Unknown>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

class Search {
 public:
  Search(const Case& all, std::vector<Unknown> common, const Price& price)
      : all_(all), common_(std::move(common)), price_(price) {}

  /// Everything that may move in a hypothesis with these effects: common unknowns first.
  [[nodiscard]] std::vector<Unknown> unknowns(const std::vector<PlacedEffect>& effects) const {
    std::vector<Unknown> list = common_;
    for (const PlacedEffect& effect : effects) {
      const auto own = effect_unknowns(effect);
      list.insert(list.end(), own.begin(), own.end());
    }
    return list;
  }

  [[nodiscard]] Explanation fitted(const Hypothesis& start, std::vector<PlacedEffect> effects, int most = 12,
                                   const Eigen::MatrixXd& known_slope = {}) const {
    Explanation result;
    result.fit = fit(all_, start, unknowns(effects), most, known_slope);
    simulations += result.fit.simulations;
    result.effects = read_back(result.fit.hypothesis, std::move(effects));
    return result;
  }

  /// The same with all slopes as they are in the end.
  [[nodiscard]] Explanation settled(const Hypothesis& start, std::vector<PlacedEffect> effects, int most = 12) const {
    Explanation result = fitted(start, std::move(effects), most);
    const std::size_t before = result.fit.simulations;
    refresh_slope(all_, result.fit);
    simulations += result.fit.simulations - before;
    return result;
  }
  void settle(Explanation& e, int most) const { e = settled(e.fit.hypothesis, e.effects, most); }

  /// Candidates beside an explanation, with what their starts promise; best first.
  [[nodiscard]] std::vector<Scanned> scan(const Explanation& base, const Scales& scales) const {
    auto list = candidates(all_, base.fit.hypothesis, scales);
    if (!price_.sensors) std::erase_if(list, [](const Candidate& c) { return c.channel.has_value(); });
    std::vector<Scanned> scanned(list.size());
    const Known known(base.fit);
    for_all(list.size(), [&](std::size_t i) {
      scanned[i].candidate = list[i];
      for (const Start& start : list[i].starts) {
        const Hypothesis other = with(base.fit.hypothesis, placed(list[i], start), start.clock);
        if (find_rig_fault(other.rig, all_.evidence.front().drive.period)) continue;
        const bool sensor_alone = list[i].channel.has_value();
        const Prediction prediction =
            sensor_alone ? predict_sensor(all_, other, base.fit.prediction, *list[i].channel) : predict(all_, other);
        const Eigen::VectorXd change = residuals(all_, prediction) - base.fit.residual;
        simulations += sensor_alone ? 0 : 1;
        if (change.allFinite()) scanned[i].starts.emplace_back(known.gain(change), start);
      }
      std::sort(scanned[i].starts.begin(), scanned[i].starts.end(),
                [](const auto& a, const auto& b) { return a.first > b.first; });
    });
    std::erase_if(scanned, [](const Scanned& s) { return s.starts.empty(); });
    std::sort(scanned.begin(), scanned.end(),
              [](const Scanned& a, const Scanned& b) { return a.starts.front().first > b.starts.front().first; });
    return scanned;
  }

  /// A hold renewed by a clock of its own, in step with the recorder: where between two samples its values are taken
  /// only they tell. Golden section over what the renewals allow; all else makes way inside its bounds, since a little
  /// damping looks like a little time.
  void set_clock(Explanation& e, Channel channel) const {
    const auto c = index(channel);
    const Fit& now = e.fit;
    if (!now.hypothesis.clocks[c].own) return;
    const Eigen::MatrixXd h = now.slope.transpose() * now.slope;
    const Box box = box_of(now.unknowns, now.hypothesis, 1.0);
    const auto with_place = [&](double place) {
      Hypothesis other = now.hypothesis;
      other.clocks[c].place = place;
      return other;
    };
    const auto power = [&](double place) {
      const Eigen::VectorXd r = residuals(all_, predict_sensor(all_, with_place(place), now.prediction, channel));
      const Eigen::VectorXd g = now.slope.transpose() * r;
      const Eigen::VectorXd d = bounded_step(h, g, box);
      return r.squaredNorm() + 2.0 * g.dot(d) + d.dot(h * d);
    };
    constexpr int rounds = 10;  // to 2 % of the room there is
    const LowestPoint best = golden_section(power, -1.0, 1.0, rounds);
    if (best.value >= now.chi_squared) return;
    e = fitted(with_place(best.at), e.effects, 6);
  }

  /// A candidate beside an explanation, fitted from its best start or two; slopes of what is there are kept.
  [[nodiscard]] Explanation refined(const Explanation& base, const Scanned& scanned) const {
    Explanation best;
    best.fit.chi_squared = INFINITY;
    for (std::size_t s = 0; s < std::min<std::size_t>(2, scanned.starts.size()); ++s) {
      if (s > 0 && scanned.starts[s].first < 0.3 * scanned.starts[0].first) break;
      std::vector<PlacedEffect> effects = base.effects;
      effects.push_back(placed(scanned.candidate, scanned.starts[s].second));
      Explanation other =
          fitted(with(base.fit.hypothesis, effects.back(), scanned.starts[s].second.clock), effects, 8, base.fit.slope);
      if (is_hold(*scanned.candidate.entry)) set_clock(other, *scanned.candidate.channel);
      if (other.fit.chi_squared < best.fit.chi_squared) best = std::move(other);
    }
    return best;
  }

  /// One more effect: the candidates that promise most, fitted, best first. At most `most`; no more than three of those
  /// that promise less than a third of the best, and none that promises less than `least`.
  [[nodiscard]] std::vector<Explanation> extended(const Explanation& base, const Scales& scales, std::size_t most,
                                                  double least = 0.0) const {
    auto scanned = scan(base, scales);
    tried += scanned.size();
    if (scanned.empty()) return {};
    constexpr std::size_t few = 3;
    const double good = scanned.front().starts.front().first / 3.0;
    const auto promises = [](const Scanned& s) { return s.starts.front().first; };
    while (!scanned.empty() && (scanned.size() > most || promises(scanned.back()) < least ||
                                (scanned.size() > few && promises(scanned.back()) < good))) {
      scanned.pop_back();
    }
    std::vector<Explanation> list(scanned.size());
    for_all(scanned.size(), [&](std::size_t i) {
      list[i] = refined(base, scanned[i]);
      lighten(list[i].fit);
    });
    std::sort(list.begin(), list.end(),
              [this](const Explanation& a, const Explanation& b) { return a.cost(price_) < b.cost(price_); });
    return list;
  }

  /// Whether an effect is a hold that the values themselves show, repeated in regular turns: nothing else repeats them,
  /// so it has no rivals, however alike they are below 90 Hz.
  [[nodiscard]] bool is_seen(const PlacedEffect& effect) const {
    return is_hold(*effect.entry) && repeats(*effect.channel);
  }

  /// The hold of a channel whose renewals are regular, where it is not there yet.
  [[nodiscard]] std::optional<Explanation> held(const Explanation& base, const Scales& scales, Channel channel) const {
    if (!repeats(channel)) return std::nullopt;
    for (Scanned& scanned : scan(base, scales)) {
      if (scanned.candidate.channel == channel && is_hold(*scanned.candidate.entry)) {
        const Explanation refined_one = refined(base, scanned);
        return settled(refined_one.fit.hypothesis, refined_one.effects, 6);
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] Explanation without(const Explanation& whole, std::size_t leave_out) const {
    Hypothesis hypothesis = whole.fit.hypothesis;
    std::vector<PlacedEffect> effects = whole.effects;
    remove_effect(hypothesis.rig, *effects[leave_out].entry, effects[leave_out].channel);
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(leave_out));
    return settled(hypothesis, std::move(effects), 6);
  }

  /// Fitted again in growing pieces; as it was where that is no better.
  void regrow(Explanation& e, const Shorten& shorten) const {
    Hypothesis hypothesis = e.fit.hypothesis;
    for (const double share : {0.1, 0.16, 0.25, 0.35, 0.5, 0.7}) {
      const Fit part = fit(shorten(share), hypothesis, unknowns(e.effects), 10);
      simulations += part.simulations;
      hypothesis = part.hypothesis;
    }
    Explanation grown = settled(hypothesis, e.effects, 8);
    if (grown.fit.chi_squared < e.fit.chi_squared) e = std::move(grown);
  }

  /// Whether what an explanation leaves is noise, in each band and altogether.
  [[nodiscard]] bool leaves_noise(const Explanation& e) const {
    constexpr double beyond = 4.0;  // standard deviations
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < all_.fit.size(); ++i) {
      const Whitening& whitening = all_.fit[i];
      const std::size_t channels = all_.evidence[all_.fitted[i]].channels.size();
      std::vector<std::array<Power, noise_bands + 1>> powers(channels);
      for (std::size_t k = 0; k < whitening.bins(); ++k) {
        const std::size_t b = noise_band_of(whitening.frequency(k));
        for (std::size_t c = 0; c < channels; ++c) {
          const double square = e.fit.residual.segment<2>(at).squaredNorm();
          at += 2;
          powers[c][b].squares += square;
          powers[c][b].count += 2.0;
        }
      }
      for (const auto& of_channel : powers) {
        for (const Power& power : of_channel) {
          if (power.significance() > beyond) return false;
        }
      }
    }
    return Power{e.fit.chi_squared, static_cast<double>(e.fit.residual.size())}.significance() < beyond;
  }

  mutable std::atomic<std::size_t> simulations{0};  ///< so far
  mutable std::atomic<std::size_t> tried{0};        ///< candidates, so far

 private:
  [[nodiscard]] bool repeats(Channel channel) const {
    const auto& renewals = all_.evidence.front().renewals[index(channel)];
    return renewals && renewals->regular;
  }

  const Case& all_;
  std::vector<Unknown> common_;
  const Price& price_;
};

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
std::vector<Rival> rivals_of(const Search& search, const Explanation& best, const Explanation& rest, std::size_t place,
                             const std::vector<Explanation>& with_others, const Price& price) {
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
    const Explanation again = search.fitted(rivals[r].hypothesis, std::move(effects), 6);
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
class Explorer {
 public:
  Explorer(Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts, const Tools& tools)
      : all_(all),
        common_(in_a_row(tolerated, starts)),
        tools_(tools),
        price_(tools.price),
        search_(all, common_, price_),
        share_scanned_(tools.shorten ? telling_share(all, seconds_telling) : 1.0) {}

  /// From nothing on, one effect more at a time.
  void forward(const Hypothesis& given, Findings& findings) {
    Explanation& nothing = findings.nothing;
    Explanation& best = findings.best;
    report(0.05, "tolerated parameters");
    nothing = search_.settled(given, {});
    look_at_scales(nothing);

    constexpr std::size_t most_effects = 4;
    const std::size_t beam_width = price_.beam;
    std::vector<Explanation> beam{nothing};
    std::vector<Explanation>& alone = findings.alone;
    best = nothing;
    // Values that repeat themselves in regular turns are a hold: no fit could say it better.
    for (const Channel channel : all_.evidence.front().channels) {
      const auto held = search_.held(best, scales_, channel);
      if (held && is_worth(*held, best, price_, 0.0)) beam.front() = best = *held;
    }
    if (!best.effects.empty() && tools_.rewhiten(best.fit.hypothesis)) {
      search_.settle(nothing, 4);
      search_.settle(best, 4);
      beam.front() = best;
    }
    for (std::size_t depth = 0; depth < most_effects && (depth == 0 || !search_.leaves_noise(best)); ++depth) {
      report(0.1 + 0.15 * static_cast<double>(depth), depth == 0 ? "one effect" : "one more effect");
      std::vector<Explanation> next;
      for (const Explanation& base : beam) {
        auto list = extended(base, false);
        if (base.effects.empty()) alone = list;
        for (std::size_t i = 0; i < std::min(beam_width, list.size()); ++i) {
          if (is_worth(list[i], base, price_, price_.share(base))) next.push_back(std::move(list[i]));
        }
      }
      if (next.empty()) break;
      std::sort(next.begin(), next.end(), Cheaper{price_});
      if (next.size() > beam_width) next.resize(beam_width);
      for (Explanation& e : next) search_.settle(e, 6);
      std::sort(next.begin(), next.end(), Cheaper{price_});
      if (next.front().cost(price_) >= best.cost(price_)) break;
      best = next.front();
      beam = std::move(next);
      // The noise of the input goes through what was found, too.
      if (tools_.rewhiten(best.fit.hypothesis)) {
        search_.settle(nothing, 4);
        for (Explanation& e : beam) search_.settle(e, 4);
        std::sort(beam.begin(), beam.end(), Cheaper{price_});
        best = beam.front();
        for_all(alone.size(), [&](std::size_t i) {
          alone[i] = search_.fitted(alone[i].fit.hypothesis, alone[i].effects, 0);
          lighten(alone[i].fit);
        });
      }
      if (tools_.shorten && has_corners(best.fit.hypothesis.rig) && !search_.leaves_noise(best)) {
        search_.regrow(best, tools_.shorten);
        beam.front() = best;
      }
    }
    count(findings);
  }

  /// Backward: what is not needed any more. Swap: each effect against every other candidate.
  void backward(Findings& findings) {
    Explanation& nothing = findings.nothing;
    Explanation& best = findings.best;
    if (best.effects.empty()) return;
    look_at_scales(nothing);
    for (int round = 0; round < 4 && !best.effects.empty(); ++round) {
      bool changed = false;
      findings.rivals.assign(best.effects.size(), {});
      findings.gains.assign(best.effects.size(), 0.0);
      for (std::size_t i = 0; i < best.effects.size() && !changed; ++i) {
        if (search_.is_seen(best.effects[i])) continue;
        report(0.6 + 0.3 * static_cast<double>(i) / static_cast<double>(best.effects.size()),
               "rivals of " + std::string(best.effects[i].entry->name));
        const bool only_one = best.effects.size() == 1;
        Explanation rest = only_one ? nothing : search_.without(best, i);
        // With corners the fit without may only be in a worse one of many minima.
        if (tools_.shorten && !only_one && has_corners(rest.fit.hypothesis.rig)) search_.regrow(rest, tools_.shorten);
        if (rest.cost(price_) <= best.cost(price_)) {
          best = rest;
          changed = true;
          break;
        }
        const bool known = only_one && !findings.alone.empty();
        std::vector<Explanation> others = known ? findings.alone : extended(rest, true);
        for (const Explanation& e : others) {
          if (same_place(e.effects.back(), best.effects[i]) || e.cost(price_) >= best.cost(price_) - 1.0) continue;
          Explanation full = search_.settled(e.fit.hypothesis, e.effects, 6);
          if (full.cost(price_) >= best.cost(price_) - 1.0) continue;
          best = std::move(full);
          changed = true;
          break;
        }
        if (changed) break;
        findings.rivals[i] = rivals_of(search_, best, rest, i, others, price_);
        findings.gains[i] = rest.fit.chi_squared - best.fit.chi_squared;
      }
      if (!changed) break;
      if (tools_.rewhiten(best.fit.hypothesis)) {
        search_.settle(nothing, 4);
        search_.settle(best, 6);
        findings.alone.clear();
      }
    }
    findings.alone.clear();
    count(findings);
  }

 private:
  void look_at_scales(const Explanation& nothing) {
    scales_ = scales_of(all_, nothing.fit.hypothesis, respond(all_, nothing.fit.hypothesis));
  }

  /// One more effect beside an explanation, cheapest first; `unpromising`: those, too, that will hardly be worth it.
  [[nodiscard]] std::vector<Explanation> extended(const Explanation& base, bool unpromising) const {
    const std::size_t most = unpromising ? price_.compared : price_.tried;
    // A promise is linear: a third of what an effect must gain is worth a fit.
    const auto least = [&](const Explanation& e) {
      const double left = std::max(e.fit.chi_squared - static_cast<double>(e.fit.residual.size()), 0.0);
      return unpromising ? 0.0 : std::max(price_.effect, price_.share(e) * left) / 3.0;
    };
    if (share_scanned_ < 1.0 && is_loud(base)) {
      const Case part = tools_.shorten(share_scanned_);
      const Search on_part(part, common_, price_);
      const Explanation start = on_part.settled(base.fit.hypothesis, base.effects, 2);
      auto list = on_part.extended(start, scales_, most, least(start));
      search_.simulations += on_part.simulations;
      search_.tried += on_part.tried;
      for_all(list.size(), [&](std::size_t i) {
        list[i] = search_.fitted(list[i].fit.hypothesis, list[i].effects, i < price_.beam ? 6 : 0, base.fit.slope);
        lighten(list[i].fit);
      });
      std::sort(list.begin(), list.end(), Cheaper{price_});
      // What shows itself seldom may not be in the part.
      if (!list.empty() && is_worth(list.front(), base, price_, price_.share(base))) return list;
    }
    return search_.extended(base, scales_, most, least(base));
  }

  void report(double share, const std::string& what) const {
    if (tools_.tell) tools_.tell(share, what, search_.simulations, search_.tried);
  }

  void count(Findings& findings) {
    findings.simulations += search_.simulations.exchange(0);
    findings.tried += search_.tried.exchange(0);
  }

  Case& all_;
  std::vector<Unknown> common_;
  const Tools& tools_;
  const Price& price_;
  Search search_;
  double share_scanned_;
  Scales scales_;
};

}  // namespace

Findings search(Case& all, const Hypothesis& given, const std::vector<Unknown>& tolerated,
                const std::vector<Unknown>& starts, const Tools& tools) {
  Findings findings;
  Explorer(all, tolerated, starts, tools).forward(given, findings);
  return findings;
}

void compare(Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts, const Tools& tools,
             Findings& findings) {
  Explorer(all, tolerated, starts, tools).backward(findings);
}

void settle_on(const Case& all, const std::vector<Unknown>& tolerated, const std::vector<Unknown>& starts,
               const Price& price, Findings& findings) {
  const Search search(all, in_a_row(tolerated, starts), price);
  const double before = findings.best.cost(price);
  const auto part = static_cast<double>(findings.best.fit.residual.size());
  search.settle(findings.nothing, 8);
  search.settle(findings.best, 8);
  findings.simulations += search.simulations;
  const double larger = static_cast<double>(findings.best.fit.residual.size()) / part;
  const double after = findings.best.cost(price);
  for (auto& rivals : findings.rivals) {
    for (Rival& rival : rivals) rival.cost = after + larger * (rival.cost - before);
  }
  for (double& gain : findings.gains) gain *= larger;
}

}  // namespace host_sim::diagnose
