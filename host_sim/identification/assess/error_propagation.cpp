#include "host_sim/identification/assess/error_propagation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/prediction.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using Index = Eigen::Index;
using BudgetPart = UncertaintyBudget::Part;
using BudgetSource = UncertaintyBudget::Source;

constexpr double of_normal = 1.96;                // 95 % of a normal distribution
constexpr double of_bound = std::numbers::sqrt3;  // a bound ÷ the deviation of a uniform distribution

/// Variances by source; those of one source and sensor or parameter are added.
class Variances {
 public:
  void add(BudgetSource source, const std::string& of, double variance) {
    if (!(variance > 0.0) || !std::isfinite(variance)) return;
    for (auto& [part, sum] : parts_) {
      if (part.source == source && part.of == of) {
        sum += variance;
        return;
      }
    }
    parts_.push_back({{source, of}, variance});
  }

  /// `unit`: of the value, for one of what the variances are of; `half_width`: U, in the latter.
  [[nodiscard]] UncertaintyBudget budget(double unit, double half_width) const {
    constexpr double nothing = 1e-6;  // of the variance: together far below the 2 % that a budget may be off
    UncertaintyBudget budget;
    double sum = 0.0;
    for (const auto& [part, variance] : parts_) sum += variance;
    if (!(sum > 0.0)) return budget;
    budget.combined = unit * std::sqrt(sum);
    budget.coverage = half_width / std::sqrt(sum);
    for (const auto& [part, variance] : parts_) {
      if (variance > nothing * sum) budget.parts.push_back({part.source, part.of, unit * std::sqrt(variance)});
    }
    std::stable_sort(budget.parts.begin(), budget.parts.end(),
                     [](const BudgetPart& a, const BudgetPart& b) { return a.standard > b.standard; });
    return budget;
  }

 private:
  std::vector<std::pair<BudgetPart, double>> parts_;
};

/// The budget of gᵀu without the sources and the steps.
void add_fitted(const Fit& fit, const Uncertainty& known, const Eigen::VectorXd& g, Variances& variances) {
  const Uncertainty::VarianceParts parts = known.variance_parts(g);
  variances.add(BudgetSource::noise, "", parts.noise);
  for (Index j = 0; j < parts.tolerances.size(); ++j) {
    variances.add(BudgetSource::tolerance, fit.parameters[static_cast<std::size_t>(j)].path, parts.tolerances(j));
  }
  variances.add(BudgetSource::model, "", parts.model);
}

BudgetSource source_of(UncertaintySource::Kind kind) {
  return kind == UncertaintySource::Kind::tolerance ? BudgetSource::tolerance : BudgetSource::calibration;
}

struct PredictedNumbers {
  double rms = 0.0, peak = 0.0;
};
using NumbersByChannel = std::array<PredictedNumbers, model::channel_count>;

/// Of one recording: sums of squares and peaks by channel.
struct OfRecording {
  std::array<double, model::channel_count> squares{}, peak{}, count{};
};

/// How a hypothesis is simulated.
struct Driven {
  const Hypothesis* hypothesis;
  const std::vector<SimulationInput>* inputs = nullptr;  ///< by recording, where they are not those of the recordings
  bool other_steps = false;                              ///< twice the steps, or with corners half of them
};

OfRecording of_recording(const ProblemRecording& r, std::size_t recording, const Driven& driven) {
  OfRecording result;
  const Hypothesis& hypothesis = *driven.hypothesis;
  const bool own_input = driven.inputs != nullptr && !driven.inputs->empty();
  Resolution resolution = r.resolution();
  (has_corners(hypothesis.rig) ? resolution.half : resolution.doubled) = driven.other_steps;
  const Response truth =
      true_channels(hypothesis, *r.samples, own_input ? (*driven.inputs)[recording] : r.samples->input,
                    hypothesis.starts[recording], r.fitted.to, resolution);
  for (const Channel channel : r.samples->channels) {
    const auto c = index(channel);
    for (std::size_t k = r.fitted.from; k < r.fitted.to; ++k) {
      result.squares[c] += truth[c][k] * truth[c][k];
      result.peak[c] = std::max(result.peak[c], std::abs(truth[c][k]));
    }
    result.count[c] = static_cast<double>(r.fitted.size());
  }
  return result;
}

std::vector<OfRecording> of_recordings(const IdentificationProblem& problem, const Driven& driven) {
  std::vector<OfRecording> list(problem.recordings().size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (problem.recordings()[i].is_fitted()) list[i] = of_recording(problem.recordings()[i], i, driven);
  }
  return list;
}

NumbersByChannel together(const std::vector<OfRecording>& list) {
  NumbersByChannel numbers{};
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    double squares = 0.0, count = 0.0;
    for (const OfRecording& one : list) {
      squares += one.squares[c];
      count += one.count[c];
      numbers[c].peak = std::max(numbers[c].peak, one.peak[c]);
    }
    numbers[c].rms = std::sqrt(squares / std::max(count, 1.0));
  }
  return numbers;
}

/// D² of (4) [SI²].
double power_beyond_noise(const IdentificationProblem& problem, const std::vector<Response>& readings,
                          Channel channel) {
  double sum = 0.0, noise = 0.0, count = 0.0;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted() || !r.samples->explains(channel)) continue;
    const double variance = r.noise_variance(channel);
    for (const double left : measured_minus_read(r, channel, readings[i][index(channel)])) {
      sum += left * left;
      noise += variance;
      count += 1.0;
    }
  }
  return std::max(sum - noise, 0.0) / std::max(count, 1.0);
}

/// ∂q/∂u, a row for each coordinate. A state at the start moves its own recording.
std::vector<NumbersByChannel> gradients(const IdentificationProblem& problem, const Fit& fit, const Uncertainty& known,
                                        const std::vector<OfRecording>& here) {
  std::vector<NumbersByChannel> slopes(fit.parameters.size());
  for_all(fit.parameters.size(), [&](std::size_t p) {
    const FreeParameter& parameter = fit.parameters[p];
    const bool start = parameter.role == FreeParameter::Role::start;
    if (!parameter.simulates()) return;
    const double half = known.half_widths(static_cast<Index>(p));
    const double step = std::isfinite(half) && half > 0.0 ? 0.5 * half : parameter.difference;
    std::array<NumbersByChannel, 2> ends;
    double apart = 0.0;
    for (std::size_t end = 0; end < 2; ++end) {
      Hypothesis moved = fit.hypothesis;
      parameter.put(moved, parameter.get(fit.hypothesis) + (end == 0 ? step : -step));
      const bool possible = !firmware::find_rig_fault(moved.rig, problem.sample_period());
      if (possible) apart += step;
      std::vector<OfRecording> there = here;
      if (possible && start) {
        there[parameter.recording] =
            of_recording(problem.recordings()[parameter.recording], parameter.recording, {&moved});
      } else if (possible) {
        there = of_recordings(problem, {&moved});
      }
      ends[end] = together(there);
    }
    if (!(apart > 0.0)) return;
    for (std::size_t c = 0; c < slopes[p].size(); ++c) {
      slopes[p][c] = {(ends[0][c].rms - ends[1][c].rms) / apart, (ends[0][c].peak - ends[1][c].peak) / apart};
    }
  });
  return slopes;
}

/// (2): the hypothesis that is corrected for one standard deviation of a source.
Hypothesis corrected(const Fit& fit, const UncertaintySource& source) {
  Hypothesis hypothesis = fit.hypothesis;
  if (!source.input_starts.empty()) hypothesis.starts = source.input_starts;
  for (std::size_t p = 0; p < fit.parameters.size(); ++p) {
    const FreeParameter& parameter = fit.parameters[p];
    parameter.put(hypothesis, parameter.get(hypothesis) + source.shift(static_cast<Index>(p)));
  }
  if (source.kind == UncertaintySource::Kind::tolerance) {
    if (double* const off = firmware::find_parameter(hypothesis.rig, source.of)) *off += source.parameter_step;
  }
  return hypothesis;
}

}  // namespace

FitErrors fit_errors(const firmware::RigDescription& description, const IdentificationProblem& problem, const Fit& fit,
                     Uncertainty known) {
  FitErrors errors{std::move(known), uncertainty_sources(description, problem, fit), {}};
  std::erase_if(errors.sources, [](const UncertaintySource& source) { return !source.shift.allFinite(); });
  errors.known.add_shifts(shifts_of(errors.sources));
  errors.discretisation = has_corners(fit.hypothesis.rig) ? Eigen::VectorXd(errors.known.step_shift.cwiseAbs())
                                                          : discretisation_shift(problem, fit);
  return errors;
}

std::vector<UncertaintyBudget> parameter_budgets(const Fit& fit, const FitErrors& errors) {
  std::vector<UncertaintyBudget> budgets;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FreeParameter& parameter = fit.parameters[i];
    const auto k = static_cast<Index>(i);
    const double unit =
        parameter.logarithmic ? std::abs(parameter.value(parameter.get(fit.hypothesis))) : std::abs(parameter.scale);
    double half = errors.known.half_widths(k);
    Variances variances;
    if (!std::isfinite(half)) {
      half = 0.5 * (parameter.upper - parameter.lower);
      const bool tolerated = parameter.role == FreeParameter::Role::tolerated;
      variances.add(tolerated ? BudgetSource::tolerance : BudgetSource::noise, tolerated ? parameter.path : "",
                    half * half / (of_bound * of_bound));
    } else {
      add_fitted(fit, errors.known, Eigen::VectorXd::Unit(errors.known.half_widths.size(), k), variances);
      for (const UncertaintySource& source : errors.sources) {
        variances.add(source_of(source.kind), source.of, source.shift(k) * source.shift(k));
      }
      const double steps = errors.discretisation(k) / of_bound;
      variances.add(BudgetSource::discretisation, "", steps * steps);
    }
    budgets.push_back(variances.budget(unit, half));
  }
  return budgets;
}

std::map<Channel, PredictedChannel> predicted_channels(const IdentificationProblem& problem, const Fit& fit,
                                                       const FitErrors& errors, bool rest) {
  const std::vector<OfRecording> recordings = of_recordings(problem, {&fit.hypothesis});
  const NumbersByChannel here = together(recordings);
  const NumbersByChannel other = together(of_recordings(problem, {&fit.hypothesis, nullptr, true}));
  const std::vector<NumbersByChannel> slopes = gradients(problem, fit, errors.known, recordings);
  std::vector<NumbersByChannel> moved(errors.sources.size(), here);
  for_all(moved.size(), [&](std::size_t s) {
    const Hypothesis hypothesis = corrected(fit, errors.sources[s]);
    if (firmware::find_rig_fault(hypothesis.rig, problem.sample_period())) return;
    moved[s] = together(of_recordings(problem, {&hypothesis, &errors.sources[s].input}));
  });
  const std::vector<Response> readings = rest ? read_all(problem, fit.hypothesis) : std::vector<Response>();
  const auto fitted = static_cast<Index>(fit.parameters.size());
  std::map<Channel, PredictedChannel> predictions;
  for (const Channel channel : problem.channels()) {
    const double beyond = rest ? power_beyond_noise(problem, readings, channel) : 0.0;
    const auto number = [&](double PredictedNumbers::*of) {
      const auto c = index(channel);
      const double value = here[c].*of;
      Eigen::VectorXd g(fitted);
      for (Index p = 0; p < fitted; ++p) g(p) = slopes[static_cast<std::size_t>(p)][c].*of;
      Variances variances;
      double steps = std::abs(other[c].*of - value);
      if (fitted > 0) {
        add_fitted(fit, errors.known, g, variances);
        steps = (has_corners(fit.hypothesis.rig) ? steps : 2.0 * steps) + g.cwiseAbs().dot(errors.discretisation);
      }
      for (std::size_t s = 0; s < moved.size(); ++s) {
        const double shift = moved[s][c].*of - value;
        variances.add(source_of(errors.sources[s].kind), errors.sources[s].of, shift * shift);
      }
      variances.add(BudgetSource::discretisation, "", steps * steps / (of_bound * of_bound));
      variances.add(BudgetSource::model, "", beyond / (of_bound * of_bound));
      PredictedNumber predicted{{value, value, value}, variances.budget(1.0, 0.0)};
      predicted.budget.coverage = predicted.budget.combined > 0.0 ? of_normal : 0.0;
      const double half = of_normal * predicted.budget.combined;
      predicted.interval = {value, value - half, value + half};
      return predicted;
    };
    if (std::isfinite(here[index(channel)].rms)) {
      predictions[channel] = {number(&PredictedNumbers::rms), number(&PredictedNumbers::peak)};
    }
  }
  return predictions;
}

}  // namespace host_sim::identification
