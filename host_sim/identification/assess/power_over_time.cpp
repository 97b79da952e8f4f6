#include "host_sim/identification/assess/power_over_time.hpp"

#include <algorithm>

namespace host_sim::identification {

double PowerOverTime::excess() const {
  double sum = 0.0;
  for (const double ratio : refit) sum += std::max(ratio - 1.0, 0.0);
  return sum;
}

std::pair<double, double> PowerOverTime::middle() const {
  if (from.empty()) return {0.0, 0.0};
  std::pair<double, double> result{from.front(), to.back()};
  const double whole = excess();
  if (!(whole > 0.0)) return result;
  constexpr double outside = 0.1;  // before and behind the middle
  double sum = 0.0;
  bool begun = false;
  for (std::size_t k = 0; k < refit.size(); ++k) {
    sum += std::max(refit[k] - 1.0, 0.0);
    if (!begun && sum >= outside * whole) {
      result.first = from[k];
      begun = true;
    }
    if (sum >= (1.0 - outside) * whole) {
      result.second = to[k];
      break;
    }
  }
  return result;
}

std::vector<PowerOverTime> power_over_time(const IdentificationProblem& problem, const Hypothesis& refit,
                                           const Hypothesis& after) {
  const double seconds = shown_stretch(problem);
  const auto of_refit = stretch_powers(problem, read_all(problem, refit), seconds),
             of_after = stretch_powers(problem, read_all(problem, after), seconds);
  const std::vector<model::Channel>& channels = problem.channels();
  std::vector<PowerOverTime> result;
  std::size_t first = 0;  // of the recording in `result`
  for (std::size_t k = 0; k < of_refit.size(); ++k) {
    if (k == 0 || of_refit[k].recording != of_refit[k - 1].recording) {
      first = result.size();
      for (const model::Channel channel : channels) result.push_back({channel, of_refit[k].recording, {}, {}, {}, {}});
    }
    for (std::size_t c = 0; c < channels.size(); ++c) {
      PowerOverTime& power = result[first + c];
      power.from.push_back(of_refit[k].from);
      power.to.push_back(of_refit[k].to);
      power.refit.push_back(of_refit[k].of_channel(c).ratio());
      power.after.push_back(of_after[k].of_channel(c).ratio());
    }
  }
  return result;
}

}  // namespace host_sim::identification
