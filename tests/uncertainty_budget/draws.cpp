#include "tests/uncertainty_budget/draws.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/assess/error_propagation.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"
#include "tests/support/reference_road.hpp"

namespace uncertainty_budget {
namespace {

using namespace host_sim::identification;
using model::Channel;

constexpr double period = 1e-3;

/// F = k x + b ẋ + m ẍ on a measured deflection. The damping is not fitted.
constexpr const char* bench_text = R"(kind = "component_bench"
sample_rate = 1000.0
[suspension]
stiffness = 30000.0
damping = 1000.0
[effects.moving_mass]
mass = 3.0
[tolerance]
"suspension.stiffness" = 0.05
"suspension.damping" = 0.02
[noise]
F = 10.0
x_act = 2e-6
[calibration.F]
gain = 0.002
offset = 1.0
[calibration.x_act]
gain = 0.001
)";

/// A car whose body mass is not fitted.
constexpr const char* car_text = R"(kind = "quarter_car"
sample_rate = 1000.0
[body]
mass = 290.0
[wheel]
mass = 40.0
[tyre]
stiffness = 200e3
damping = 100.0
[suspension]
stiffness = 31500.0
damping = 1500.0
[effects.body_guide_damping]
damping = 200.0
[tolerance]
"tyre.stiffness" = 0.05
"body.mass" = 0.002
[noise]
z_r = 2e-5
zdd_w = 0.3
zdd_b = 0.05
dz_b = 5e-5
F_w = 10.0
[calibration.z_r]
gain = 0.002
[calibration.zdd_w]
gain = 0.01
[calibration.zdd_b]
gain = 0.006
k = 3.0
[calibration.F_w]
gain = 0.004
)";

struct Given {
  firmware::RigDescription description;
  std::vector<std::string> fitted;  ///< tolerated parameters that are; the others are not
  std::vector<Channel> measured;    ///< the input first
  firmware::Recording truth;        ///< the input without errors
};

Given given(const Asked& asked) {
  Given rig;
  const bool bench = asked.rig == "component_bench";
  if (!bench && asked.rig != "quarter_car") throw std::invalid_argument("component_bench or quarter_car is expected");
  rig.description = firmware::parse_rig(bench ? bench_text : car_text, asked.rig + ".toml");
  if (!asked.calibration) rig.description.calibration = {};
  rig.fitted = bench ? std::vector<std::string>{"suspension.stiffness"} : std::vector<std::string>{"tyre.stiffness"};
  if (!asked.tolerances) {
    std::erase_if(rig.description.tolerance, [&](const auto& entry) { return entry.first != rig.fitted.front(); });
  }
  const auto count = static_cast<std::size_t>(asked.duration / period);
  rig.truth.sample_period = period;
  rig.truth.source = asked.rig;
  rig.truth.time = firmware::sample_times(count, 1.0 / period);
  if (bench) {
    rig.measured = {Channel::x_act, Channel::F};
    const double turn = 2.0 * std::numbers::pi;
    for (const double t : rig.truth.time) {
      const double begin = 1.0 - std::exp(-std::pow(t / 0.2, 3));  // from rest
      rig.truth[Channel::x_act].push_back(begin * (8e-3 * std::sin(turn * 0.7 * t) + 4e-3 * std::sin(turn * 2.3 * t) +
                                                   1e-3 * std::sin(turn * 11.0 * t)));
    }
  } else {
    rig.measured = {Channel::z_r, Channel::zdd_w, Channel::zdd_b, Channel::dz_b, Channel::F_w};
    const auto road = support::random_road(64e-6, period, asked.duration, 7);
    for (std::size_t k = 0; k < count; ++k) rig.truth[Channel::z_r].push_back(road[k].position);
  }
  return rig;
}

struct Fitted {
  IdentificationProblem problem;
  Fit fit;
};
Fitted fitted_to(const Given& rig, firmware::Recording recording) {
  std::vector<PreparedRecording> recordings{
      prepare_recording(rig.description, std::move(recording), Use::fitted, false)};
  const Hypothesis hypothesis = described_hypothesis(rig.description, recordings);
  std::vector<FreeParameter> parameters;
  for (const FreeParameter& parameter : tolerated_parameters(rig.description)) {
    if (std::find(rig.fitted.begin(), rig.fitted.end(), parameter.path) != rig.fitted.end()) {
      parameters.push_back(parameter);
    }
  }
  for (const firmware::PlacedEffect& effect : firmware::effects_of(hypothesis.rig)) {
    for (const FreeParameter& parameter : effect_parameters(effect)) parameters.push_back(parameter);
  }
  for (const FreeParameter& start : start_parameters(rig.description, recordings)) parameters.push_back(start);
  IdentificationProblem problem(std::move(recordings), hypothesis);
  Fit fit = host_sim::identification::fit(problem, hypothesis, parameters);
  return {std::move(problem), std::move(fit)};
}

/// What a rig was, and what its sensors read.
struct Drawn {
  firmware::Recording recording;
  host_sim::Response truth;
};
/// `errors`: (1) without its noise, and (2).
Drawn drawn(const Given& rig, std::uint64_t seed, bool errors) {
  support::NormalNoise normal(seed);
  model::RigParameters<double> parameters = rig.description.rig;
  for (const auto& [path, bound] : rig.description.tolerance) {
    const double share = bound * (2.0 * normal.uniform() - 1.0);
    if (!errors || std::find(rig.fitted.begin(), rig.fitted.end(), path) != rig.fitted.end()) continue;
    *firmware::find_parameter(parameters, path) *= 1.0 + share;
  }
  Drawn result{rig.truth, {}};
  const host_sim::SimulationInput input = host_sim::simulation_input(parameters, rig.truth);
  result.truth = host_sim::simulate(parameters, input, host_sim::resting(parameters, input));
  for (const Channel channel : rig.measured) {
    const bool is_input = channel == rig.measured.front();
    const std::vector<double>& values = is_input ? rig.truth[channel] : result.truth[index(channel)];
    const auto& calibration = rig.description.calibration[index(channel)];
    const double gain = normal(), offset = normal();
    const double delta = errors && calibration ? calibration->standard_gain() * gain : 0.0;
    const double zero = errors && calibration ? calibration->standard_offset() * offset : 0.0;
    const double noise = *rig.description.noise[index(channel)];
    std::vector<double>& read = result.recording[channel];
    read.resize(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) read[k] = (1.0 + delta) * values[k] + zero + noise * normal();
  }
  return result;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::string text_of(const UncertaintyBudget& budget) {
  std::string text;
  for (const UncertaintyBudget::Part& part : budget.parts) {
    if (budget.share(part) < 0.0005) continue;
    char share[32];
    std::snprintf(share, sizeof share, " %.1f %%", 100.0 * budget.share(part));
    text += (text.empty() ? "" : ", ") + words(part) + share;
  }
  return text;
}

}  // namespace

std::vector<Compared> compare(const Asked& asked) {
  const Given rig = given(asked);
  Fitted nominal = fitted_to(rig, drawn(rig, asked.seed, false).recording);
  refresh_jacobian(nominal.problem, nominal.fit);
  const FitErrors errors = fit_errors(rig.description, nominal.problem, nominal.fit,
                                      uncertainty(nominal.problem, suspect_parameters(rig.description), nominal.fit));
  std::vector<Compared> numbers;
  const std::vector<UncertaintyBudget> budgets = parameter_budgets(nominal.fit, errors);
  const std::vector<FreeParameter>& parameters = nominal.fit.parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].role == FreeParameter::Role::start)
      continue;  // which recording begins at rest, its noise decides
    numbers.push_back({parameters[i].path, 0.0, 0.0, budgets[i].combined, text_of(budgets[i])});
  }
  std::vector<Channel> predicted;
  for (const auto& [channel, prediction] : predicted_channels(nominal.problem, nominal.fit, errors, false)) {
    predicted.push_back(channel);
    numbers.push_back({"rms of " + std::string(model::name(channel)), 0.0, 0.0, prediction.rms.budget.combined,
                       text_of(prediction.rms.budget)});
  }

  std::vector<std::vector<double>> off(asked.draws);
  for_all(asked.draws, [&](std::size_t d) {
    const Drawn one = drawn(rig, asked.seed + 1 + d, true);
    const Fitted found = fitted_to(rig, one.recording);
    for (const FreeParameter& parameter : found.fit.parameters) {
      if (parameter.role == FreeParameter::Role::start) continue;
      const double truth = *firmware::find_parameter(rig.description.rig, parameter.path);
      off[d].push_back(parameter.value(parameter.get(found.fit.hypothesis)) - truth);
    }
    const PreparedRecording& samples = found.problem.samples().front();
    const host_sim::Response model = true_channels(found.fit.hypothesis, samples, samples.input,
                                                   found.fit.hypothesis.starts.front(), 0, {samples.substeps});
    for (const Channel channel : predicted) {
      off[d].push_back(rms(model[index(channel)]) - rms(one.truth[index(channel)]));
    }
  });
  const auto count = static_cast<double>(asked.draws);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    double sum = 0.0, squares = 0.0;
    for (const auto& each : off) sum += each.at(i);
    numbers[i].bias = sum / count;
    for (const auto& each : off) squares += std::pow(each[i] - numbers[i].bias, 2);
    numbers[i].spread = std::sqrt(squares / (count - 1.0));
  }
  return numbers;
}

}  // namespace uncertainty_budget
