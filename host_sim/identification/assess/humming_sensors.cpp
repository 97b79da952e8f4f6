#include "host_sim/identification/assess/humming_sensors.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"
#include "host_sim/identification/prepare/smoothed_input.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/identification/select/selection_criterion.hpp"
#include "host_sim/signal/line.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using Line = std::complex<double>;

/// A sensor, and the lines that a hum of 1 on it makes in the residuals and in δ.
struct Source {
  Channel channel{};
  bool drives = false;
  Eigen::VectorXcd lines;
};

/// Some of the sources with the hums that explain the lines best.
struct Explanation {
  std::vector<std::size_t> sources;
  Eigen::VectorXcd hums;
  Eigen::VectorXd deviations;  ///< of the real and the imaginary part of each hum
  double cost = std::numeric_limits<double>::infinity();
};

/// (1) to (4) of one recording.
class HumEquations {
 public:
  HumEquations(const IdentificationProblem& problem, std::size_t recording, const Hypothesis& hypothesis,
               double frequency);

  [[nodiscard]] const std::vector<Source>& sources() const { return sources_; }
  [[nodiscard]] Explanation cheapest() const;

 private:
  void observe(const std::vector<double>& signal, double period, double begin);
  void add_inputs(const PreparedRecording& recording, const Eigen::VectorXcd& gains);
  [[nodiscard]] Explanation explained_by(std::size_t set, const Eigen::VectorXd& deviations) const;
  [[nodiscard]] Explanation cheapest_with(const Eigen::VectorXd& deviations) const;

  double frequency_;
  std::vector<Line> lines_;         ///< ρ of each channel, then δ
  std::vector<double> deviations_;  ///< of their real and imaginary parts
  std::vector<Source> sources_;
  std::size_t channels_;
};

/// (4) but for w: g, and the position q behind an acceleration of 1.
struct SecondDifference {
  SecondDifference(double frequency, double period)
      : g(-4.0 * std::pow(std::sin(std::numbers::pi * frequency * period), 2)),
        position(period * period * (1.0 + g / 12.0) / g) {}
  double g, position;
};

/// The driving position of a hum of 1 on the input's sensor, which may be an accelerometer.
double position_behind(const PreparedRecording& recording, double frequency) {
  return recording.mean_unknown ? SecondDifference(frequency, recording.input.period).position : 1.0;
}

/// The signal behind δ: the acceleration twice integrated, as it is at this frequency, less the position.
std::vector<double> position_contradiction(const PreparedRecording& recording, Window window, double frequency) {
  const double h = recording.input.period, scale = h * h / SecondDifference(frequency, h).g;
  const std::vector<double> whole =
      contradiction(recording.recording[Channel::z_r], recording.recording[Channel::zdd_r], h);
  std::vector<double> compared;
  for (std::size_t k = window.from; k < window.to; k += recording.step) compared.push_back(scale * whole[k]);
  return compared;
}

/// The recording's input with a line of an amplitude on its position.
SimulationInput with_line(const PreparedRecording& recording, double frequency, double amplitude) {
  SimulationInput input = recording.input;
  std::vector<double> line(input.size());
  for (std::size_t k = 0; k < line.size(); ++k) {
    line[k] = std::cos(2.0 * std::numbers::pi * frequency * static_cast<double>(k) * input.period);
  }
  if (recording.input_edge > 0.0) line = smoothed(line, recording.input_edge, input.period);
  const firmware::FootPointMotion added = firmware::through_samples(line, 1.0 / input.period);
  for (std::size_t k = 0; k < line.size(); ++k) {
    input.motion[k].position += amplitude * added[k].position;
    input.motion[k].velocity += amplitude * added[k].velocity;
    input.motion[k].acceleration += amplitude * added[k].acceleration;
  }
  return input;
}

HumEquations::HumEquations(const IdentificationProblem& problem, std::size_t recording, const Hypothesis& hypothesis,
                           double frequency)
    : frequency_(frequency), channels_(problem.channels().size()) {
  const ProblemRecording& r = problem.recordings()[recording];
  const PreparedRecording& samples = *r.samples;
  const Window window = r.fit_whitening->window();
  const double period = samples.compared_period(), begin = static_cast<double>(window.from) * samples.input.period;
  const auto read = [&](const SimulationInput& input) {
    return read_channels(hypothesis, samples, input, hypothesis.starts[recording], 0, r.resolution());
  };
  const double noise = samples.noise[index(samples.input.channel)];
  const double amplitude = thresholds::hum_trial * noise * std::abs(position_behind(samples, frequency));
  const SimulationInput moved = with_line(samples, frequency, amplitude);
  const Response readings = read(samples.input), answers = read(moved);
  Eigen::VectorXcd gains(static_cast<Eigen::Index>(channels_));
  for (std::size_t c = 0; c < channels_; ++c) {
    const Channel channel = problem.channels()[c];
    const auto i = index(channel);
    const std::vector<double> left = measured_minus_read(r, channel, readings[i]);
    observe(left, period, begin);
    const Line with = line_in(measured_minus_read(r, channel, answers[i]), frequency, period, begin);
    gains(static_cast<Eigen::Index>(c)) = (lines_.back() - with) / amplitude;
  }
  if (samples.inputs_fused) observe(position_contradiction(samples, window, frequency), period, begin);
  const auto rows = static_cast<Eigen::Index>(lines_.size());
  for (std::size_t c = 0; c < channels_; ++c) {
    sources_.push_back({problem.channels()[c], false, Eigen::VectorXcd::Unit(rows, static_cast<Eigen::Index>(c))});
  }
  add_inputs(samples, gains);
}

/// The line of a signal, and its deviation: that of its neighbours, beyond the reach of the window.
void HumEquations::observe(const std::vector<double>& signal, double period, double begin) {
  constexpr int nearest = 4, furthest = 15;
  const double bin = 1.0 / (period * static_cast<double>(signal.size()));
  double power = 0.0;
  for (int i = nearest; i <= furthest; ++i) {
    for (const double side : {-1.0, 1.0})
      power += std::norm(line_in(signal, frequency_ + side * i * bin, period, begin));
  }
  lines_.push_back(line_in(signal, frequency_, period, begin));
  deviations_.push_back(std::sqrt(std::max(power / (4.0 * (furthest - nearest + 1)), 1e-300)));
}

void HumEquations::add_inputs(const PreparedRecording& recording, const Eigen::VectorXcd& gains) {
  const auto rows = static_cast<Eigen::Index>(lines_.size()), channels = static_cast<Eigen::Index>(channels_);
  const bool fused = rows > channels;
  const double h = recording.input.period;
  const auto [g, q] = SecondDifference(frequency_, h);
  const auto add = [&](Channel channel, double share, double in_delta) {
    Source source{channel, true, Eigen::VectorXcd::Zero(rows)};
    source.lines.head(channels) = -share * gains;
    if (fused) source.lines(rows - 1) = in_delta;
    sources_.push_back(std::move(source));
  };
  if (!fused) {
    add(recording.input.channel, position_behind(recording, frequency_), 0.0);
    return;
  }
  const double ratio = recording.noise[index(Channel::z_r)] / recording.noise[index(Channel::zdd_r)] / (h * h);
  const double w = 1.0 / (1.0 + ratio * ratio * g * g);
  add(Channel::z_r, w, -1.0);
  add(Channel::zdd_r, (1.0 - w) * q, q);
}

Explanation HumEquations::explained_by(std::size_t set, const Eigen::VectorXd& deviations) const {
  Explanation found;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if ((set >> i & 1U) != 0) found.sources.push_back(i);
  }
  const auto rows = static_cast<Eigen::Index>(lines_.size());
  if (static_cast<Eigen::Index>(found.sources.size()) > rows) return found;
  const Eigen::VectorXd weights = deviations.cwiseInverse();
  Eigen::MatrixXcd a(rows, static_cast<Eigen::Index>(found.sources.size()));
  for (std::size_t i = 0; i < found.sources.size(); ++i) {
    a.col(static_cast<Eigen::Index>(i)) = weights.cwiseProduct(sources_[found.sources[i]].lines);
  }
  const Eigen::VectorXcd b = weights.cwiseProduct(Eigen::Map<const Eigen::VectorXcd>(lines_.data(), rows));
  // A hum of a sensor in m/s² and one in m differ by ten powers of ten: columns of length 1.
  const Eigen::VectorXd lengths = a.colwise().norm();
  if (!(lengths.minCoeff() > 0.0)) return found;
  a *= lengths.cwiseInverse().asDiagonal();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXcd> solver(a);
  if (solver.rank() < a.cols()) return found;
  const Eigen::VectorXcd scaled = solver.solve(b);
  found.hums = scaled.cwiseQuotient(lengths);
  const Eigen::MatrixXcd covariance = (a.adjoint() * a).inverse();
  found.deviations = covariance.diagonal().real().cwiseSqrt().cwiseQuotient(lengths);
  found.cost =
      (b - a * scaled).squaredNorm() + 2.0 * SelectionCriterion().parameter * static_cast<double>(found.sources.size());
  return found;
}

Explanation HumEquations::cheapest_with(const Eigen::VectorXd& deviations) const {
  Explanation best;
  for (std::size_t set = 1; set < (std::size_t{1} << sources_.size()); ++set) {
    Explanation found = explained_by(set, deviations);
    if (found.cost < best.cost) best = std::move(found);
  }
  return best;
}

Explanation HumEquations::cheapest() const {
  Eigen::VectorXd deviations =
      Eigen::Map<const Eigen::VectorXd>(deviations_.data(), static_cast<Eigen::Index>(deviations_.size()));
  const Explanation first = cheapest_with(deviations);
  // What the model's answer is wrong by needs to know the hum.
  for (std::size_t i = 0; i < first.sources.size(); ++i) {
    const Source& source = sources_[first.sources[i]];
    if (!source.drives) continue;
    for (Eigen::Index row = 0; row < static_cast<Eigen::Index>(channels_); ++row) {
      const double error =
          thresholds::hum_model_error * std::abs(source.lines(row) * first.hums(static_cast<Eigen::Index>(i)));
      deviations(row) = std::hypot(deviations(row), error);
    }
  }
  return cheapest_with(deviations);
}

}  // namespace

std::vector<HummingSensor> humming_sensors(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                           double frequency) {
  const auto& recordings = problem.recordings();
  const auto first = std::find_if(recordings.begin(), recordings.end(), [](const auto& r) { return r.is_fitted(); });
  if (first == recordings.end() || !(first->samples->noise[index(first->samples->input.channel)] > 0.0)) return {};
  const HumEquations equations(problem, static_cast<std::size_t>(first - recordings.begin()), hypothesis, frequency);
  const Explanation found = equations.cheapest();
  std::vector<HummingSensor> sensors;
  bool drives = false;
  for (std::size_t i = 0; i < found.sources.size(); ++i) {
    const Source& source = equations.sources()[found.sources[i]];
    const auto at = static_cast<Eigen::Index>(i);
    constexpr double deviations = 1.96;  // 95 %
    const double amplitude = std::abs(found.hums(at)), half = deviations * found.deviations(at);
    sensors.push_back({source.channel, {amplitude, std::max(amplitude - half, 0.0), amplitude + half}});
    drives = drives || source.drives;
  }
  return drives ? sensors : std::vector<HummingSensor>{};
}

}  // namespace host_sim::identification
