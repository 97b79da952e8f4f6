#include "host_sim/diagnose/search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

namespace host_sim::diagnose {
namespace {

/// work(i) for i = 0 … count − 1 on all processors.
template <class Work>
void for_all(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> threads;
  const std::size_t helpers = std::min<std::size_t>(count, std::max(1U, std::thread::hardware_concurrency()));
  for (std::size_t t = 1; t < helpers; ++t) threads.emplace_back(run);
  run();
}

/// The directions in which what is fitted already can move, to see what is new about another.
class Known {
 public:
  explicit Known(const Fit& base) : base_(base) {
    Eigen::MatrixXd h = base.slope.transpose() * base.slope;
    for (Eigen::Index i = 0; i < h.rows(); ++i) h(i, i) += 1e-10 * h(i, i) + 1e-30;
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

PlacedEffect placed(const Candidate& candidate, const std::vector<double>& values) {
  return {candidate.entry, candidate.channel, values};
}

Hypothesis with(const Hypothesis& hypothesis, const PlacedEffect& effect) {
  Hypothesis other = hypothesis;
  put_effect(other.rig, effect);
  return other;
}

struct Scanned {
  Candidate candidate;
  std::vector<std::pair<double, std::vector<double>>> starts;  ///< gain, values; best first
};

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

  [[nodiscard]] Explanation fitted(const Hypothesis& start, std::vector<PlacedEffect> effects, int most = 12) const {
    Explanation result;
    result.fit = fit(all_, start, unknowns(effects), most);
    if (result.fit.slope.cols() > 0) {
      result.fit.slope = jacobian(all_, result.fit.hypothesis, result.fit.unknowns, result.fit.residual);
    }
    result.effects = read_back(result.fit.hypothesis, std::move(effects));
    return result;
  }

  /// Candidates beside an explanation, with what their starts promise; best first.
  [[nodiscard]] std::vector<Scanned> scan(const Explanation& base, const Scales& scales) const {
    const auto list = candidates(all_, base.fit.hypothesis, scales);
    std::vector<Scanned> scanned(list.size());
    const Known known(base.fit);
    for_all(list.size(), [&](std::size_t i) {
      scanned[i].candidate = list[i];
      for (const auto& values : list[i].starts) {
        const Hypothesis other = with(base.fit.hypothesis, placed(list[i], values));
        if (find_rig_fault(other.rig, all_.evidence.front().drive.period)) continue;
        const Eigen::VectorXd change = residuals(all_, other) - base.fit.residual;
        ++simulations;
        if (change.allFinite()) scanned[i].starts.emplace_back(known.gain(change), values);
      }
      std::sort(scanned[i].starts.begin(), scanned[i].starts.end(),
                [](const auto& a, const auto& b) { return a.first > b.first; });
    });
    std::erase_if(scanned, [](const Scanned& s) { return s.starts.empty(); });
    std::sort(scanned.begin(), scanned.end(),
              [](const Scanned& a, const Scanned& b) { return a.starts.front().first > b.starts.front().first; });
    return scanned;
  }

  /// A candidate beside an explanation, fitted from its best start or two; slopes of what is there are kept.
  [[nodiscard]] Explanation refined(const Explanation& base, const Scanned& scanned) const {
    Explanation best;
    best.fit.chi_squared = INFINITY;
    for (std::size_t s = 0; s < std::min<std::size_t>(2, scanned.starts.size()); ++s) {
      if (s > 0 && scanned.starts[s].first < 0.3 * scanned.starts[0].first) break;
      std::vector<PlacedEffect> effects = base.effects;
      effects.push_back(placed(scanned.candidate, scanned.starts[s].second));
      Explanation other;
      other.fit = fit(all_, with(base.fit.hypothesis, effects.back()), unknowns(effects), 8, base.fit.slope);
      simulations += 16;
      other.effects = read_back(other.fit.hypothesis, std::move(effects));
      if (other.fit.chi_squared < best.fit.chi_squared) best = std::move(other);
    }
    return best;
  }

  /// The best of adding one more effect, at most `keep` of them, best first.
  [[nodiscard]] std::vector<Explanation> extended(const Explanation& base, const Scales& scales, std::size_t tried,
                                                  std::size_t keep) const {
    auto scanned = scan(base, scales);
    if (scanned.size() > tried) scanned.resize(tried);
    std::vector<Explanation> list(scanned.size());
    for_all(scanned.size(), [&](std::size_t i) { list[i] = refined(base, scanned[i]); });
    std::sort(list.begin(), list.end(),
              [this](const Explanation& a, const Explanation& b) { return a.cost(price_) < b.cost(price_); });
    if (list.size() > keep) list.resize(keep);
    return list;
  }

  static std::vector<PlacedEffect> read_back(const Hypothesis& hypothesis, std::vector<PlacedEffect> effects) {
    for (PlacedEffect& effect : effects) {
      for (const PlacedEffect& now : effects_of(hypothesis.rig)) {
        if (now.entry == effect.entry && now.channel == effect.channel) effect.values = now.values;
      }
    }
    return effects;
  }

  [[nodiscard]] Explanation without(const Explanation& whole, std::size_t leave_out) const {
    Hypothesis hypothesis = whole.fit.hypothesis;
    std::vector<PlacedEffect> effects = whole.effects;
    remove_effect(hypothesis.rig, *effects[leave_out].entry, effects[leave_out].channel);
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(leave_out));
    return fitted(hypothesis, std::move(effects), 6);
  }

  mutable std::atomic<std::size_t> simulations{0};

 private:
  const Case& all_;
  std::vector<Unknown> common_;
  const Price& price_;
};

}  // namespace

double Explanation::cost(const Price& price) const {
  double sum = fit.chi_squared;
  for (const PlacedEffect& effect : effects) {
    sum += price.effect + price.parameter * static_cast<double>(effect.values.size());
  }
  return sum;
}

Findings search(const Case& all, const Hypothesis& given, const std::vector<Unknown>& tolerated,
                const std::vector<Unknown>& starts, const Price& price, const Tell& tell) {
  std::vector<Unknown> common = tolerated;
  common.insert(common.end(), starts.begin(), starts.end());
  const Search search(all, common, price);
  Findings findings;
  findings.nothing = search.fitted(given, {});
  const Scales scales = scales_of(all, findings.nothing.fit.hypothesis, respond(all, findings.nothing.fit.hypothesis));
  const auto count = static_cast<double>(findings.nothing.fit.residual.size());

  constexpr std::size_t beam_width = 2, most_effects = 4, tried = 8;
  std::vector<Explanation> beam{findings.nothing};
  findings.best = findings.nothing;
  for (std::size_t depth = 0; depth < most_effects; ++depth) {
    if (tell) tell(0.1 + 0.15 * static_cast<double>(depth), "effect " + std::to_string(depth + 1));
    std::vector<Explanation> next;
    for (const Explanation& base : beam) {
      const double left = std::max(base.fit.chi_squared - count, 0.0);
      const double share = depth == 0 ? price.first_share : price.later_share;
      for (Explanation& e : search.extended(base, scales, tried, beam_width)) {
        const double gained = base.fit.chi_squared - e.fit.chi_squared;
        const double paid = e.cost(price) - e.fit.chi_squared - (base.cost(price) - base.fit.chi_squared);
        if (gained > paid && gained > share * left) next.push_back(std::move(e));
      }
    }
    if (next.empty()) break;
    std::sort(next.begin(), next.end(), [&](const auto& a, const auto& b) { return a.cost(price) < b.cost(price); });
    if (next.size() > beam_width) next.resize(beam_width);
    for (Explanation& e : next) e = search.fitted(e.fit.hypothesis, e.effects, 6);
    std::sort(next.begin(), next.end(), [&](const auto& a, const auto& b) { return a.cost(price) < b.cost(price); });
    if (next.front().cost(price) < findings.best.cost(price)) findings.best = next.front();
    beam = std::move(next);
  }

  // Backward: what is not needed any more. Swap: each effect against every other candidate.
  for (bool changed = true; changed && !findings.best.effects.empty();) {
    changed = false;
    findings.rivals.assign(findings.best.effects.size(), {});
    for (std::size_t i = 0; i < findings.best.effects.size() && !changed; ++i) {
      if (tell) tell(0.8, "rivals of " + std::string(findings.best.effects[i].entry->name));
      const Explanation rest = search.without(findings.best, i);
      if (rest.cost(price) <= findings.best.cost(price)) {
        findings.best = rest;
        changed = true;
        break;
      }
      for (Explanation& e : search.extended(rest, scales, tried, tried)) {
        const PlacedEffect& other = e.effects.back();
        if (other.entry == findings.best.effects[i].entry && other.channel == findings.best.effects[i].channel)
          continue;
        if (e.cost(price) < findings.best.cost(price) - 1.0) {
          Explanation full = search.fitted(e.fit.hypothesis, e.effects, 6);
          if (full.cost(price) < findings.best.cost(price) - 1.0) {
            findings.best = std::move(full);
            changed = true;
            break;
          }
        }
        findings.rivals[i].push_back({other, e.cost(price), e.fit.hypothesis});
      }
    }
  }
  findings.simulations = search.simulations;
  return findings;
}

Findings polish(const Case& all, const Findings& found, const std::vector<Unknown>& tolerated,
                const std::vector<Unknown>& starts, const Price& price) {
  std::vector<Unknown> common = tolerated;
  common.insert(common.end(), starts.begin(), starts.end());
  const Search search(all, common, price);
  Findings findings;
  findings.nothing = search.fitted(found.nothing.fit.hypothesis, {}, 6);
  findings.best = search.fitted(found.best.fit.hypothesis, found.best.effects, 8);
  findings.simulations = found.simulations;
  findings.rivals.resize(found.rivals.size());
  for (std::size_t i = 0; i < found.rivals.size(); ++i) {
    for (std::size_t r = 0; r < found.rivals[i].size(); ++r) {
      const Rival& rival = found.rivals[i][r];
      std::vector<PlacedEffect> effects = found.best.effects;
      effects[i] = rival.effect;
      // Only the nearest matter enough to be fitted again.
      const Explanation again = search.fitted(rival.hypothesis, effects, r < 2 ? 4 : 0);
      findings.rivals[i].push_back({again.effects[i], again.cost(price), again.fit.hypothesis});
    }
  }
  return findings;
}

}  // namespace host_sim::diagnose
