#include "host_sim/identification/learn/excited_range.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/identification/learn/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;

std::vector<double> motion_at(const PreparedRecording& recording, const Response& channels, CurvePlace place,
                              CurveOver over) {
  const bool bench = channels[index(Channel::dz_b)].empty();
  std::vector<double> x = channels[index(place == CurvePlace::tyre          ? Channel::dz_w
                                         : place == CurvePlace::body_guide  ? Channel::z_b
                                         : place == CurvePlace::wheel_guide ? Channel::z_w
                                         : bench                            ? Channel::x_act
                                                                            : Channel::dz_b)];
  if (x.empty() && place == CurvePlace::suspension) {
    for (const auto& motion : recording.input.motion) x.push_back(motion.position);
  }
  if (over != CurveOver::velocity || x.size() < 3) return x;
  std::vector<double> velocity(x.size(), 0.0);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) velocity[k] = (x[k + 1] - x[k - 1]) / (2.0 * recording.input.period);
  return velocity;
}

std::optional<ExcitedRange> excited_range(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                          CurvePlace place, CurveOver over) {
  std::vector<double> seen;
  double farthest = 0.0;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    const std::size_t end = std::max(r.samples->fitted.to, r.samples->held_out.to);
    const Response channels =
        true_channels(hypothesis, *r.samples, r.samples->input, hypothesis.starts[i], end, r.resolution());
    const std::vector<double> x = motion_at(*r.samples, channels, place, over);
    for (const double value : x) farthest = std::fmax(farthest, std::abs(value));
    for (std::size_t k = r.fitted.from; k < std::min(r.fitted.to, x.size()); ++k) seen.push_back(x[k]);
  }
  std::sort(seen.begin(), seen.end());
  double squares = 0.0;
  for (const double x : seen) squares += x * x;
  if (seen.size() < thresholds::fewest_samples || !(squares > 0.0) || !std::isfinite(squares)) return std::nullopt;
  const auto cut = static_cast<std::size_t>(thresholds::rarely_reached * static_cast<double>(seen.size()));
  const ExcitedRange range{std::min(seen[cut], 0.0), std::max(seen[seen.size() - 1 - cut], 0.0),
                           std::sqrt(squares / static_cast<double>(seen.size())), farthest};
  if (!(range.largest() > 0.0) || !std::isfinite(farthest)) return std::nullopt;
  return range;
}

}  // namespace host_sim::identification
