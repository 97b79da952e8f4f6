#include "host_sim/diagnose/explainer.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "host_sim/diagnose/golden_section.hpp"
#include "host_sim/diagnose/noise_bands.hpp"
#include "host_sim/diagnose/parallel.hpp"
#include "host_sim/diagnose/readings.hpp"

namespace host_sim::diagnose {

using model::Channel;

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

/// The effects with their parameters as they are in a hypothesis.
std::vector<PlacedEffect> read_back(const Hypothesis& hypothesis, std::vector<PlacedEffect> effects) {
  for (PlacedEffect& effect : effects) {
    for (const PlacedEffect& now : effects_of(hypothesis.rig)) {
      if (now.entry == effect.entry && now.channel == effect.channel) effect.values = now.values;
    }
  }
  return effects;
}

}  // namespace

void lighten(Fit& fit) {
  fit.prediction = {};
  fit.slope.resize(0, 0);
}

struct Explainer::Scanned {
  Candidate candidate;
  std::vector<std::pair<double, Start>> starts;  ///< gain; best first
};

std::vector<Unknown> Explainer::unknowns(const std::vector<PlacedEffect>& effects) const {
  std::vector<Unknown> list = common_;
  for (const PlacedEffect& effect : effects) {
    const auto own = effect_unknowns(effect);
    list.insert(list.end(), own.begin(), own.end());
  }
  return list;
}

Explanation Explainer::fitted(const Hypothesis& start, std::vector<PlacedEffect> effects, int most,
                              const Eigen::MatrixXd& known_slope) const {
  Explanation result;
  result.fit = fit(all_, start, unknowns(effects), most, known_slope);
  simulations += result.fit.simulations;
  result.effects = read_back(result.fit.hypothesis, std::move(effects));
  return result;
}

Explanation Explainer::settled(const Hypothesis& start, std::vector<PlacedEffect> effects, int most) const {
  Explanation result = fitted(start, std::move(effects), most);
  const std::size_t before = result.fit.simulations;
  refresh_slope(all_, result.fit);
  simulations += result.fit.simulations - before;
  return result;
}

void Explainer::settle(Explanation& e, int most) const { e = settled(e.fit.hypothesis, e.effects, most); }

std::vector<Explainer::Scanned> Explainer::scan(const Explanation& base, const Scales& scales) const {
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

void Explainer::set_clock(Explanation& e, Channel channel) const {
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

Explanation Explainer::refined(const Explanation& base, const Scanned& scanned) const {
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

std::vector<Explanation> Explainer::extended(const Explanation& base, const Scales& scales, std::size_t most,
                                             double least) const {
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

bool Explainer::is_seen(const PlacedEffect& effect) const { return is_hold(*effect.entry) && repeats(*effect.channel); }

std::optional<Explanation> Explainer::held(const Explanation& base, const Scales& scales, Channel channel) const {
  if (!repeats(channel)) return std::nullopt;
  for (Scanned& scanned : scan(base, scales)) {
    if (scanned.candidate.channel == channel && is_hold(*scanned.candidate.entry)) {
      const Explanation refined_one = refined(base, scanned);
      return settled(refined_one.fit.hypothesis, refined_one.effects, 6);
    }
  }
  return std::nullopt;
}

Explanation Explainer::without(const Explanation& whole, std::size_t leave_out) const {
  Hypothesis hypothesis = whole.fit.hypothesis;
  std::vector<PlacedEffect> effects = whole.effects;
  remove_effect(hypothesis.rig, *effects[leave_out].entry, effects[leave_out].channel);
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(leave_out));
  return settled(hypothesis, std::move(effects), 6);
}

void Explainer::regrow(Explanation& e, const Shorten& shorten) const {
  Hypothesis hypothesis = e.fit.hypothesis;
  for (const double share : {0.1, 0.16, 0.25, 0.35, 0.5, 0.7}) {
    const Fit part = fit(shorten(share), hypothesis, unknowns(e.effects), 10);
    simulations += part.simulations;
    hypothesis = part.hypothesis;
  }
  Explanation grown = settled(hypothesis, e.effects, 8);
  if (grown.fit.chi_squared < e.fit.chi_squared) e = std::move(grown);
}

bool Explainer::leaves_noise(const Explanation& e) const {
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

bool Explainer::repeats(Channel channel) const {
  const auto& renewals = all_.evidence.front().renewals[index(channel)];
  return renewals && renewals->regular;
}

}  // namespace host_sim::diagnose
