#include "host_sim/identification/assess/prediction_error.hpp"

#include <cmath>

#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;

namespace {

double error_of(const IdentificationProblem& problem, const std::vector<Response>& responses, Channel channel) {
  const SquaredError squares = held_out_squares(problem, responses, channel);
  return squares.data > 0.0 ? std::sqrt(squares.error / squares.data) : 0.0;
}

double noise_floor(const IdentificationProblem& problem, Channel channel) {
  const auto c = index(channel);
  double noise = 0.0, data = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (!r.is_held_out()) continue;
    const PreparedRecording& samples = *r.samples;
    const auto& measured = samples.recording[channel];
    const Window window = samples.comparable(channel, r.held_out);
    double count = 0.0;
    for (std::size_t k = samples.compared_from(window.from); k < window.to; k += samples.step) {
      data += std::pow(measured[k], 2);
      count += 1.0;
    }
    double variance = r.noise_variance(channel);
    if (channel == Channel::zdd_r) {  // z_r alone says nothing of faster motion
      const double rms = r.noise[c].rms(samples.compared_period());
      variance += variance_above(samples.input_edge, measured, window, rms, samples.input.period);
    }
    noise += variance * count;
  }
  return data > 0.0 ? std::sqrt(noise / data) : 0.0;
}

}  // namespace

std::map<Channel, PredictionError> prediction_errors(const IdentificationProblem& problem, const Hypothesis& given,
                                                     const Hypothesis& refit, const Hypothesis& after,
                                                     const Hypothesis* catalogue) {
  std::map<Channel, PredictionError> result;
  if (!problem.has_held_out()) return result;
  const auto of_given = read_all(problem, given), of_refit = read_all(problem, refit),
             of_after = read_all(problem, after);
  const auto of_catalogue = catalogue != nullptr ? read_all(problem, *catalogue) : std::vector<Response>();
  for (const Channel channel : problem.channels()) {
    result[channel] = {error_of(problem, of_given, channel), error_of(problem, of_refit, channel),
                       error_of(problem, of_after, channel), noise_floor(problem, channel)};
    if (catalogue != nullptr) result[channel].catalogue = error_of(problem, of_catalogue, channel);
  }
  return result;
}

}  // namespace host_sim::identification
