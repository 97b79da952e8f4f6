#include "host_sim/identification/select/model_fitter.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/comparison/start_state.hpp"
#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/common/golden_section.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/identification/select/fault_candidates.hpp"
#include "host_sim/identification/select/fault_rewrites.hpp"
#include "host_sim/identification/select/linear_refit.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;

namespace {

/// true: `model` is the other one now.
bool take_if_better(CandidateModel other, CandidateModel& model) {
  if (!(other.fit.chi_squared < model.fit.chi_squared)) return false;
  model = std::move(other);
  return true;
}

firmware::PlacedEffect placed(const Candidate& candidate, const Start& start) {
  return {candidate.entry, candidate.channel, start.values};
}

Hypothesis with(const Hypothesis& hypothesis, const Candidate& candidate, const Start& start) {
  Hypothesis other = hypothesis;
  if (candidate.replaces != nullptr) firmware::remove_effect(other.rig, *candidate.replaces, std::nullopt);
  firmware::put_effect(other.rig, placed(candidate, start));
  if (is_hold(*candidate.entry)) other.clocks[index(*candidate.channel)] = start.clock;
  return other;
}

/// A fit that has left what the recording showed: it found something else.
bool has_left(const Start& start, const firmware::PlacedEffect& found) {
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    const double within = found.entry->parameters[i].kept_within;
    const double moved = std::abs(found.values[i] - start.values[i]);
    if (within > 0.0 && moved > (1.0 - thresholds::at_bound) * within * std::abs(start.values[i])) return true;
  }
  return false;
}

/// The effects with their parameters as they are in a hypothesis.
std::vector<firmware::PlacedEffect> read_back(const Hypothesis& hypothesis,
                                              std::vector<firmware::PlacedEffect> effects) {
  for (firmware::PlacedEffect& effect : effects) {
    for (const firmware::PlacedEffect& now : firmware::effects_of(hypothesis.rig)) {
      if (now.entry == effect.entry && now.channel == effect.channel) effect.values = now.values;
    }
  }
  return effects;
}

}  // namespace

void drop_jacobian(Fit& fit) {
  fit.prediction = {};
  fit.jacobian.resize(0, 0);
}

struct ModelFitter::Scanned {
  Candidate candidate;
  std::vector<std::pair<double, Start>> starts;  ///< gain; best first
};

struct ModelFitter::Direction {
  std::size_t start;                  ///< of the candidate
  std::optional<std::size_t> number;  ///< the one parameter that acts, of either sign; none: the start as it is
  Eigen::VectorXd change;             ///< of the residuals
};

std::vector<FreeParameter> ModelFitter::parameters(const Hypothesis& hypothesis,
                                                   const std::vector<firmware::PlacedEffect>& effects) const {
  std::vector<FreeParameter> list = common_;
  const auto of_faults = fault_parameters(hypothesis.faults);
  list.insert(list.end(), of_faults.begin(), of_faults.end());
  for (const firmware::PlacedEffect& effect : effects) {
    const auto own = effect_parameters(effect);
    list.insert(list.end(), own.begin(), own.end());
  }
  return list;
}

CandidateModel ModelFitter::fitted(const Hypothesis& start, std::vector<firmware::PlacedEffect> effects, int most,
                                   const Eigen::MatrixXd& known_jacobian) const {
  CandidateModel result;
  result.fit = fit(problem_, start, parameters(start, effects), most, known_jacobian);
  result.channels = problem_.channels().size();
  result.effects = read_back(result.fit.hypothesis, std::move(effects));
  return result;
}

CandidateModel ModelFitter::refitted(const Hypothesis& start, std::vector<firmware::PlacedEffect> effects,
                                     int most) const {
  CandidateModel result = fitted(start, std::move(effects), most);
  refresh_jacobian(problem_, result.fit);
  return result;
}

CandidateModel ModelFitter::refitted_in(IdentificationProblem& problem, const SearchSpace& space,
                                        const SelectionCriterion& criterion, const CandidateModel& model) {
  return ModelFitter(problem, space.common, criterion).refitted(model.fit.hypothesis, model.effects, 6);
}

void ModelFitter::refit(CandidateModel& model, int most) const {
  model = refitted(model.fit.hypothesis, model.effects, most);
}

bool ends_at_bound(const firmware::PlacedEffect& effect) {
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const FitRange range = fit_range(effect.entry->parameters[i]);
    const double reach = thresholds::at_bound * effect.values[i];
    if (effect.values[i] + reach >= range.upper || effect.values[i] - reach <= range.lower) return true;
  }
  return false;
}

std::vector<ModelFitter::Direction> ModelFitter::directions_of(const CandidateModel& base,
                                                               const Candidate& candidate) const {
  std::vector<Direction> tried, simulated;
  std::vector<Variation> variations;
  const auto add = [&](std::size_t start, std::optional<std::size_t> number, const Start& values) {
    Hypothesis other = with(base.fit.hypothesis, candidate, values);
    if (firmware::find_rig_fault(other.rig, problem_.sample_period())) return;
    if (candidate.channel && problem_.samples().front().explains(*candidate.channel)) {
      const auto read = predict_sensor(problem_, other, base.fit.prediction, *candidate.channel);
      tried.push_back({start, number, residuals(problem_, read) - base.fit.residual});
      return;
    }
    simulated.push_back({start, number, {}});
    variations.push_back({std::move(other), std::nullopt});
  };
  for (std::size_t s = 0; s < candidate.starts.size(); ++s) {
    const Start& start = candidate.starts[s];
    Start neutral = start;
    std::vector<std::size_t> proportional;
    for (std::size_t p = 0; p < start.values.size(); ++p) {
      const model::EffectParameter& card = candidate.entry->parameters[p];
      if (!is_proportional(card)) continue;
      neutral.values[p] = card.neutral;
      proportional.push_back(p);
    }
    if (proportional.empty()) add(s, std::nullopt, start);
    for (const std::size_t p : proportional) {
      Start one = neutral;
      one.values[p] = start.values[p];
      add(s, p, one);
    }
  }
  const auto values = residuals_of_each(problem_, variations, false, &base.fit.prediction);
  for (std::size_t s = 0; s < simulated.size(); ++s) {
    simulated[s].change = values[s] - base.fit.residual;
    tried.push_back(std::move(simulated[s]));
  }
  std::erase_if(tried, [](const Direction& d) { return !d.change.allFinite(); });
  return tried;
}

void ModelFitter::keep_best_sizes(const LinearRefit& others, std::span<const Direction> tried, const Start& start,
                                  Scanned& scanned) {
  Eigen::MatrixXd change(tried.front().change.size(), std::ssize(tried));
  for (std::size_t d = 0; d < tried.size(); ++d) change.col(static_cast<Eigen::Index>(d)) = tried[d].change;
  Eigen::VectorXd sizes = others.best_sizes(change);
  Start best = start;
  for (std::size_t d = 0; d < tried.size(); ++d) {
    const std::size_t p = *tried[d].number;
    const model::EffectParameter& card = scanned.candidate.entry->parameters[p];
    const FitRange range = fit_range(card);
    const double unit = start.values[p] - card.neutral;
    double& size = sizes[static_cast<Eigen::Index>(d)];
    best.values[p] = std::clamp(card.neutral + size * unit, range.lower, range.upper);
    size = (best.values[p] - card.neutral) / unit;
  }
  scanned.starts.emplace_back(others.gain(change * sizes), std::move(best));
  scanned.starts.emplace_back(others.gain(change.rowwise().sum()), start);  // where that size is beyond what runs
}

std::vector<ModelFitter::Scanned> ModelFitter::scan(const CandidateModel& base, const Scales& scales) const {
  auto list = candidates(problem_.samples(), base.fit.hypothesis, scales);
  if (!criterion_.imitating) std::erase_if(list, [](const Candidate& c) { return c.entry->imitates; });
  if (!criterion_.sensors) std::erase_if(list, [](const Candidate& c) { return c.channel.has_value(); });
  if (!criterion_.machine) {
    std::erase_if(list, [](const Candidate& c) { return c.entry->subsystem == model::Subsystem::machine; });
  }
  std::vector<Scanned> scanned(list.size());
  const LinearRefit others(base.fit);
  for_all(list.size(), [&](std::size_t i) {
    scanned[i].candidate = list[i];
    const std::vector<Direction> tried = directions_of(base, list[i]);
    for (std::size_t from = 0, to = 0; from < tried.size(); from = to) {
      while (to < tried.size() && tried[to].start == tried[from].start) ++to;
      const Start& start = list[i].starts[tried[from].start];
      if (!tried[from].number) {
        scanned[i].starts.emplace_back(others.gain(tried[from].change), start);
      } else {
        keep_best_sizes(others, std::span(tried).subspan(from, to - from), start, scanned[i]);
      }
    }
    std::sort(scanned[i].starts.begin(), scanned[i].starts.end(),
              [](const auto& a, const auto& b) { return a.first > b.first; });
  });
  std::erase_if(scanned, [](const Scanned& s) { return s.starts.empty(); });
  std::sort(scanned.begin(), scanned.end(),
            [](const Scanned& a, const Scanned& b) { return a.starts.front().first > b.starts.front().first; });
  return scanned;
}

void ModelFitter::set_clock(CandidateModel& model, Channel channel) const {
  const auto c = index(channel);
  const Fit& now = model.fit;
  if (!now.hypothesis.clocks[c].own) return;
  const Eigen::MatrixXd h = now.jacobian.transpose() * now.jacobian;
  const StepBox box = step_box(now.parameters, now.hypothesis, 1.0);
  const bool drives = !problem_.samples().front().explains(channel);
  Hypothesis other = now.hypothesis;
  double lowest = now.chi_squared;
  for (double HoldClock::*const part : {&HoldClock::phase, &HoldClock::stretch, &HoldClock::phase}) {
    double& value = other.clocks[c].*part;
    const double before = value;
    const auto power = [&](double tried) {
      value = tried;
      const Eigen::VectorXd r = residuals(
          problem_, drives ? predict(problem_, other) : predict_sensor(problem_, other, now.prediction, channel));
      const Eigen::VectorXd g = now.jacobian.transpose() * r;
      const Eigen::VectorXd d = bounded_step(h, g, box);
      return r.squaredNorm() + 2.0 * g.dot(d) + d.dot(h * d);
    };
    const LowestPoint best = golden_section(power, -1.0, 1.0, thresholds::clock_rounds);
    value = best.value < lowest ? best.at : before;
    lowest = std::min(lowest, best.value);
  }
  if (lowest >= now.chi_squared) return;
  model = fitted(other, model.effects, 6);
}

CandidateModel ModelFitter::fitted_beside(const CandidateModel& base, const Scanned& scanned) const {
  const Candidate& candidate = scanned.candidate;
  const Eigen::MatrixXd none;
  CandidateModel best;
  best.fit.chi_squared = INFINITY;
  for (std::size_t s = 0; s < std::min<std::size_t>(2, scanned.starts.size()); ++s) {
    const bool near_best = scanned.starts[s].first >= thresholds::second_start * scanned.starts[0].first;
    if (s > 0 && !near_best && std::isfinite(best.fit.chi_squared)) break;
    const Start& start = scanned.starts[s].second;
    std::vector<firmware::PlacedEffect> effects = base.effects;
    const auto replaced =
        std::remove_if(effects.begin(), effects.end(), [&](const auto& e) { return e.entry == candidate.replaces; });
    const bool adds = replaced == effects.end();
    effects.erase(replaced, effects.end());
    effects.push_back(placed(candidate, start));
    const Eigen::MatrixXd& known = adds ? base.fit.jacobian : none;
    CandidateModel other = fitted(with(base.fit.hypothesis, candidate, start), effects, 8, known);
    if (is_hold(*candidate.entry)) set_clock(other, *candidate.channel);
    if (has_left(start, other.effects.back()) || (!adds && ends_at_bound(other.effects.back()))) continue;
    if (other.fit.chi_squared < best.fit.chi_squared) best = std::move(other);
  }
  return best;
}

std::vector<CandidateModel> ModelFitter::extended(const CandidateModel& base, const Scales& scales, std::size_t most,
                                                  double least) const {
  auto scanned = scan(base, scales);
  problem_.work().add_candidates(scanned.size());
  if (scanned.empty()) return {};
  const double good = thresholds::promising_beside_best * scanned.front().starts.front().first;
  const auto promises = [](const Scanned& s) { return s.starts.front().first; };
  while (!scanned.empty() && (scanned.size() > most || promises(scanned.back()) < least ||
                              (scanned.size() > thresholds::always_fitted && promises(scanned.back()) < good))) {
    scanned.pop_back();
  }
  std::vector<CandidateModel> list(scanned.size());
  for_all(scanned.size(), [&](std::size_t i) {
    list[i] = fitted_beside(base, scanned[i]);
    drop_jacobian(list[i].fit);
  });
  // A candidate whose simulations diverge from all of its starts is none.
  std::erase_if(list, [](const CandidateModel& model) { return !std::isfinite(model.fit.chi_squared); });
  std::sort(list.begin(), list.end(),
            [this](const CandidateModel& a, const CandidateModel& b) { return criterion_.prefers(a, b); });
  return list;
}

bool ModelFitter::is_seen(const firmware::PlacedEffect& effect) const {
  return is_hold(*effect.entry) && repeats_regularly(*effect.channel);
}

std::optional<CandidateModel> ModelFitter::extended_by_fault(const CandidateModel& base, double least) const {
  const bool only_noise = leaves_noise(base);
  auto list = fault_candidates(problem_, base.fit, only_noise);
  if (only_noise) {
    std::erase_if(list, [&](const FaultCandidate& candidate) {
      return candidate.gain < penalty(criterion_, candidate.fault, problem_.channels().size());
    });
  }
  problem_.work().add_candidates(list.size());
  std::erase_if(list, [least](const FaultCandidate& candidate) { return candidate.gain < least; });
  if (list.size() > thresholds::fitted_faults) list.resize(thresholds::fitted_faults);
  std::vector<CandidateModel> models(list.size());
  for_all(list.size(), [&](std::size_t i) {
    Hypothesis start = base.fit.hypothesis;
    start.faults.push_back(list[i].fault);
    models[i] = fitted(start, base.effects, 6);
    drop_jacobian(models[i].fit);
  });
  std::erase_if(models, [](const CandidateModel& model) { return !std::isfinite(model.fit.chi_squared); });
  if (models.empty()) return std::nullopt;
  CandidateModel best = *std::min_element(models.begin(), models.end(),
                                          [this](const auto& a, const auto& b) { return criterion_.prefers(a, b); });
  refit(best, 4);
  join_filters(best);
  improve_group(best);
  simplify_clock(*this, best, best.faults().size() - 1);
  bend_drift(best);
  return best;
}

CandidateModel ModelFitter::filtered(const CandidateModel& base, const PlacedFault& filter) const {
  Hypothesis start = base.fit.hypothesis;
  start.faults.push_back(filter);
  CandidateModel model = refitted(start, base.effects, 8);
  if (std::isfinite(model.fit.chi_squared)) improve_group(model);
  return model;
}

void ModelFitter::join_filters(CandidateModel& model) const {
  const PlacedFault last = model.faults().back();
  if (last.kind != FaultKind::common_filter) return;
  for (std::size_t f = 0; f + 1 < model.faults().size(); ++f) {
    const PlacedFault& other = model.faults()[f];
    const bool alike = other.kind == last.kind && other.order == last.order && other.digital == last.digital &&
                       other.inverse == last.inverse &&
                       std::abs(other.values.front() / last.values.front() - 1.0) < thresholds::alike_filters;
    if (!alike) continue;
    Hypothesis start = model.fit.hypothesis;
    PlacedFault both = other;
    both.seen = false;
    for (const Channel channel : last.channels) {
      if (!both.acts_on(channel)) both.channels.push_back(channel);
    }
    start.faults.pop_back();
    start.faults.erase(start.faults.begin() + static_cast<std::ptrdiff_t>(f));
    start.faults.push_back(std::move(both));
    CandidateModel joined = refitted(start, model.effects, 8);
    if (!criterion_.prefers(joined, model)) continue;
    model = std::move(joined);
    return;
  }
}

void ModelFitter::improve_group(CandidateModel& model) const {
  for (std::size_t round = 0; round < problem_.channels().size(); ++round) {
    const auto others = neighbouring_groups(problem_, model.fit, model.faults().size() - 1,
                                            thresholds::promising * criterion_.parameter);
    if (others.empty()) return;
    Hypothesis start = model.fit.hypothesis;
    start.faults.back() = others.front().fault;
    CandidateModel other = refitted(start, model.effects, 8);
    if (!(other.fit.chi_squared < model.fit.chi_squared - thresholds::replaces)) return;
    model = std::move(other);
  }
}

void ModelFitter::bend_drift(CandidateModel& model) const {
  if (model.faults().back().kind != FaultKind::drift) return;
  Hypothesis start = model.fit.hypothesis;
  start.faults.back().fitted[1] = true;
  CandidateModel bent = refitted(start, model.effects, 8);
  if (criterion_.prefers(bent, model)) model = std::move(bent);
}

CandidateModel ModelFitter::without_fault(const CandidateModel& whole, std::size_t leave_out, int most) const {
  Hypothesis hypothesis = whole.fit.hypothesis;
  const PlacedFault fault = hypothesis.faults[leave_out];
  hypothesis.faults.erase(hypothesis.faults.begin() + static_cast<std::ptrdiff_t>(leave_out));
  CandidateModel less = refitted(hypothesis, whole.effects, most);
  for (const Channel channel : fault.channels) set_clock_anew(less, channel);
  return less;
}

std::optional<CandidateModel> ModelFitter::held(const CandidateModel& base, const Scales& scales,
                                                Channel channel) const {
  if (!repeats_regularly(channel)) return std::nullopt;
  for (Scanned& scanned : scan(base, scales)) {
    if (scanned.candidate.channel == channel && is_hold(*scanned.candidate.entry)) {
      const CandidateModel found = fitted_beside(base, scanned);
      return refitted(found.fit.hypothesis, found.effects, 6);
    }
  }
  return std::nullopt;
}

void ModelFitter::set_clock_anew(CandidateModel& model, Channel channel) const {
  const auto holds_it = [channel](const firmware::PlacedEffect& e) {
    return e.channel == channel && is_hold(*e.entry);
  };
  if (std::none_of(model.effects.begin(), model.effects.end(), holds_it)) return;
  Hypothesis own = model.fit.hypothesis;
  own.clocks[index(channel)] = {true, 0.0};
  CandidateModel clocked = refitted(own, model.effects, 2);
  set_clock(clocked, channel);
  if (take_if_better(std::move(clocked), model)) refit(model, 4);
}

CandidateModel ModelFitter::without(const CandidateModel& whole, std::size_t leave_out, int most) const {
  Hypothesis hypothesis = whole.fit.hypothesis;
  std::vector<firmware::PlacedEffect> effects = whole.effects;
  firmware::remove_effect(hypothesis.rig, *effects[leave_out].entry, effects[leave_out].channel);
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(leave_out));
  CandidateModel less = refitted(hypothesis, std::move(effects), most);
  if (const std::optional<Channel> channel = whole.effects[leave_out].channel) set_clock_anew(less, *channel);
  return less;
}

std::optional<CandidateModel> ModelFitter::simplified(const CandidateModel& whole, std::size_t effect) const {
  const firmware::PlacedEffect& own = whole.effects[effect];
  if (own.entry->contains.empty()) return std::nullopt;
  double value = 0.0;
  for (std::size_t i = 0; i < own.values.size(); ++i) {
    if (own.entry->parameters[i].from_contained) value = own.values[i];
  }
  const firmware::CatalogueEntry* const entry = firmware::find_effect(own.entry->contains);
  const model::EffectParameter& card = entry->parameters.front();
  const firmware::PlacedEffect simpler{entry, own.channel, {std::clamp(value, card.lower, card.upper)}};
  Hypothesis start = whole.fit.hypothesis;
  firmware::remove_effect(start.rig, *own.entry, own.channel);
  firmware::put_effect(start.rig, simpler);
  std::vector<firmware::PlacedEffect> effects = whole.effects;
  effects[effect] = simpler;
  return refitted(start, std::move(effects), 8);
}

void ModelFitter::refit_by_continuation(CandidateModel& model) const {
  take_if_better(grown_from(model.fit.hypothesis, model.effects), model);
  refit_from_new_start(model);
  if (!leaves_noise(model)) refit_from_other_distances(model);
}

void ModelFitter::refit_from_other_distances(CandidateModel& model) const {
  const std::vector<firmware::PlacedEffect> effects = model.effects;
  for (const firmware::PlacedEffect& effect : effects) {
    const model::Corner corner = effect.entry->corner;
    if (corner != model::Corner::free_play && corner != model::Corner::stop) continue;
    const Hypothesis from = model.fit.hypothesis;
    for (const double factor : {thresholds::distance_shift, 1.0 / thresholds::distance_shift}) {
      firmware::PlacedEffect moved = effect;
      moved.values.front() *= factor;
      Hypothesis start = from;
      firmware::put_effect(start.rig, moved);
      if (take_if_better(grown_from(start, effects), model) && leaves_noise(model)) return;
    }
  }
}

CandidateModel ModelFitter::grown_from(Hypothesis start, const std::vector<firmware::PlacedEffect>& effects) const {
  for (const double share : thresholds::continuation_shares) {
    Fit part = fit(problem_.truncated(share), start, parameters(start, effects), 10);
    start = std::move(part.hypothesis);
  }
  return refitted(start, effects, 8);
}

void ModelFitter::refit_from_new_start(CandidateModel& model) const {
  const auto begins_moving = [](const ProblemRecording& r) { return r.is_fitted() && !r.samples->at_rest; };
  const auto& recordings = problem_.recordings();
  if (std::none_of(recordings.begin(), recordings.end(), begins_moving)) return;
  auto sliding = model.fit.hypothesis.rig;
  for (const firmware::PlacedEffect& effect : firmware::effects_of(sliding)) {
    if (effect.entry->corner == model::Corner::sticking)
      firmware::remove_effect(sliding, *effect.entry, effect.channel);
  }
  for (const auto& rig : {model.fit.hypothesis.rig, sliding}) {
    Hypothesis start = model.fit.hypothesis;
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      const PreparedRecording& samples = *recordings[i].samples;
      if (!begins_moving(recordings[i])) continue;
      start.starts[i] = estimated_start(rig, samples.input, samples.recording, samples.range);
    }
    take_if_better(refitted(start, model.effects, 8), model);
  }
}

bool ModelFitter::leaves_noise(const CandidateModel& model) const {
  const std::size_t channels = problem_.channels().size();
  Eigen::Index at = 0;
  for (const ProblemRecording& r : problem_.recordings()) {
    if (!r.is_fitted()) continue;
    std::vector<std::array<Power, noise_bands + 1>> powers(channels);
    for (std::size_t k = 0; k < r.fit_whitening->bins(); ++k) {
      const std::size_t b = noise_band_of(r.fit_whitening->frequency(k));
      for (std::size_t c = 0; c < channels; ++c) {
        powers[c][b].squares += model.fit.residual.segment<2>(at).squaredNorm();
        powers[c][b].count += 2.0;
        at += 2;
      }
    }
    for (const auto& of_channel : powers) {
      for (const Power& power : of_channel) {
        if (power.significance() > thresholds::leaves_noise) return false;
      }
    }
  }
  const Power whole{model.fit.chi_squared, static_cast<double>(model.fit.residual.size())};
  return whole.significance() < thresholds::leaves_noise;
}

bool ModelFitter::repeats_regularly(Channel channel) const {
  const auto& renewals = problem_.samples().front().renewals[index(channel)];
  return renewals && renewals->regular;
}

}  // namespace host_sim::identification
