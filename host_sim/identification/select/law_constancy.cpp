#include "host_sim/identification/select/law_constancy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/select/linear_refit.hpp"
#include "host_sim/identification/select/model_evidence.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

using Weights = std::vector<std::vector<double>>;  // by recording, by sample

/// Readings of the fitted recordings as far as they are fitted.
std::vector<Response> readings_of(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  std::vector<Response> responses(problem.recordings().size());
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    responses[i] =
        read_channels(hypothesis, *r.samples, r.samples->input, hypothesis.starts[i], r.fitted.to, r.resolution());
  }
  return responses;
}

/// Mean 0 and mean square 1 over all fitted samples.
void standardise(const IdentificationProblem& problem, Weights& weights) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Window window = problem.recordings()[i].fitted;
    for (std::size_t k = window.from; k < std::min(window.to, weights[i].size()); ++k) {
      sum += weights[i][k];
      squares += weights[i][k] * weights[i][k];
      count += 1.0;
    }
  }
  const double mean = sum / std::max(count, 1.0);
  const double deviation = std::sqrt(std::max(squares / std::max(count, 1.0) - mean * mean, 1e-30));
  for (std::vector<double>& of_recording : weights)
    for (double& weight : of_recording) weight = (weight - mean) / deviation;
}

/// (1) of the change from one response to another, all channels in units of their noise.
Weights by_amplitude(const IdentificationProblem& problem, const std::vector<Response>& base,
                     const std::vector<Response>& moved) {
  Weights weights(base.size());
  for (std::size_t i = 0; i < base.size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    const PreparedRecording& samples = *r.samples;
    std::vector<double> power(r.fitted.to, 0.0);
    for (const model::Channel channel : samples.channels) {
      const auto c = index(channel);
      const double noise = std::max(samples.noise[c], 1e-300);
      for (std::size_t k = 0; k < power.size(); ++k) power[k] += std::pow((moved[i][c][k] - base[i][c][k]) / noise, 2);
    }
    const auto half = static_cast<std::size_t>(0.5 * thresholds::constancy_window / samples.input.period) + 1;
    std::vector<double> sums(power.size() + 1, 0.0);
    double whole = 0.0;
    for (std::size_t k = 0; k < power.size(); ++k) whole += power[k], sums[k + 1] = sums[k] + power[k];
    const double least = 1e-4 * whole / static_cast<double>(power.size());
    for (std::size_t k = 0; k < power.size(); ++k) {
      const std::size_t from = k > half ? k - half : 0, to = std::min(k + half, power.size());
      weights[i].push_back(0.5 * std::log((sums[to] - sums[from]) / static_cast<double>(to - from) + least + 1e-300));
    }
  }
  standardise(problem, weights);
  return weights;
}

/// (2)
Weights by_time(const IdentificationProblem& problem) {
  Weights weights(problem.recordings().size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Window window = problem.recordings()[i].fitted;
    for (std::size_t k = 0; k < window.to; ++k) {
      const double at = static_cast<double>(k) - static_cast<double>(window.from);
      weights[i].push_back(at / std::max(1.0, static_cast<double>(window.size())));
    }
  }
  standardise(problem, weights);
  return weights;
}

/// Whitened residuals where the change from `base` to `moved` acts with a weight; those of `base` without weights.
Eigen::VectorXd weighted_residuals(const IdentificationProblem& problem, const std::vector<Response>& base,
                                   const std::vector<Response>& moved, const Weights& weights) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(problem.residual_count()));
  double* out = values.data();
  for (std::size_t i = 0; i < base.size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    Response response = base[i];
    for (const model::Channel channel : r.samples->channels) {
      const auto c = index(channel);
      for (std::size_t k = 0; k < std::min(response[c].size(), weights[i].size()); ++k)
        response[c][k] += weights[i][k] * (moved[i][c][k] - base[i][c][k]);
    }
    r.fit_whitening->whiten(r.fit_whitening->spectra(*r.samples, response), out);
    out += r.fit_whitening->count();
  }
  return values;
}

/// The hypothesis with the parameter a step away, to the side on which it still is a rig.
std::optional<Hypothesis> moved_a_little(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                         const FreeParameter& parameter) {
  for (const double step : {parameter.difference, -parameter.difference}) {
    Hypothesis moved = hypothesis;
    parameter.put(moved, parameter.get(moved) + step);
    if (!firmware::find_rig_fault(moved.rig, problem.sample_period())) return moved;
  }
  return std::nullopt;
}

}  // namespace

bool LawConstancy::fails() const { return gain > thresholds::inconstant_gain && share > thresholds::inconstant_share; }

void find_constancy(const IdentificationProblem& problem, SearchResult& found) {
  const Fit& fit = found.best.fit;
  found.causes.resize(found.best.effects.size());
  for (FoundCause& cause : found.causes) cause.constancy = {};
  if (found.causes.empty() || fit.jacobian.cols() == 0) return;
  const LinearRefit others(fit);
  const Eigen::VectorXd roots = roots_of_weights(problem, fit.residual);
  const Fit believed = weighted(fit, roots);
  const LinearRefit beside_discrepancy(believed);
  const std::vector<Response> base = readings_of(problem, fit.hypothesis);
  const Weights time = by_time(problem);
  const Eigen::VectorXd unchanged = weighted_residuals(problem, base, base, time);
  for_all(found.causes.size(), [&](std::size_t e) {
    const double explained = found.causes[e].gain;
    double gain_of_all = 0.0;  // were all that is left noise
    LawConstancy& constancy = found.causes[e].constancy;
    for (const FreeParameter& parameter : effect_parameters(found.best.effects[e])) {
      const std::optional<Hypothesis> other_size = moved_a_little(problem, fit.hypothesis, parameter);
      if (!other_size) continue;
      const Hypothesis& moved = *other_size;
      const std::vector<Response> other = readings_of(problem, moved);
      const std::array<Weights, 2> gates{by_amplitude(problem, base, other), time};
      for (const Weights& weights : gates) {
        const Eigen::VectorXd change = weighted_residuals(problem, base, other, weights) - unchanged;
        if (!change.allFinite()) continue;
        const double gain = others.free_gain(change);
        if (gain <= gain_of_all) continue;
        gain_of_all = gain;
        constancy.gain = beside_discrepancy.free_gain(roots.cwiseProduct(change));
        constancy.with_time = &weights == &gates[1];
      }
    }
    if (explained > 0.0) constancy.share = std::sqrt(gain_of_all / explained);
  });
}

bool law_in_doubt(const SearchResult& found, std::size_t effect) {
  const firmware::PlacedEffect& own = found.best.effects[effect];
  for (std::size_t i = 0; i < std::min(found.causes.size(), found.best.effects.size()); ++i) {
    const firmware::PlacedEffect& other = found.best.effects[i];
    const LawConstancy& constancy = found.causes[i].constancy;
    if (!constancy.fails()) continue;
    if (i == effect) return true;
    const bool same_place = !own.channel && !other.channel && own.entry->subsystem == other.entry->subsystem;
    const double imitated = thresholds::imitated_share * thresholds::imitated_share * found.causes[effect].gain;
    if (same_place && constancy.share * constancy.share * found.causes[i].gain > imitated) return true;
  }
  return false;
}

}  // namespace host_sim::identification
