#include "host_sim/identification/select/held_out.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace host_sim::identification {

double held_out_chi_squared(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_held_out() || (!r.is_fitted() && !r.samples->at_rest)) continue;
    const Response response =
        read_channels(hypothesis, *r.samples, r.samples->input, hypothesis.starts[i], r.held_out.to, r.resolution());
    std::vector<double> whitened(r.held_out_whitening->count());
    r.held_out_whitening->whiten(r.held_out_whitening->spectra(*r.samples, response), whitened.data());
    for (const double v : whitened) sum += v * v;
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

}  // namespace host_sim::identification
