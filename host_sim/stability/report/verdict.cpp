#include "host_sim/stability/report/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/report/formatted.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::stability {
namespace {

std::string milliseconds(double seconds) { return formatted("%.4g ms", 1e3 * seconds); }

}  // namespace

std::string verdict(const StabilityAnalysis& a) {
  const Complex worst = a.roots.rightmost();
  if (!a.stable) {
    std::string line = formatted("unstable at %.4g Hz, doubling every %.3g s", worst.imag() / full_turn,
                                 std::numbers::ln2 / std::max(worst.real(), 1e-300));
    if (worst.real() == 0.0) line = "not stable: a root lies on the imaginary axis";
    if (a.margins.delay_margin) {
      const double change = *a.margins.delay_margin;
      line += ", stable with " + milliseconds(std::abs(change)) + (change < 0.0 ? " less delay" : " more delay");
    }
    return line;
  }
  if (a.varying && !a.varying->stable) {
    return formatted("unstable within the range of its delay, %s … %s: stable at the mean, not at %s",
                     milliseconds(a.varying->lowest).c_str(), milliseconds(a.varying->highest).c_str(),
                     milliseconds(a.varying->worst_delay).c_str());
  }
  if (!a.margins.delay_margin) return "stable at every delay from the given one up to 1 s";
  return "stable, " + milliseconds(*a.margins.delay_margin) + " of delay left";
}

std::string in_words(const LimitCycle& cycle) {
  return formatted("limit cycle of %.3g mm at %.4g Hz: ", 1e3 * cycle.at.amplitude, cycle.at.omega / full_turn) +
         (cycle.attracts ? "smaller oscillations grow to it, larger ones decay to it"
                         : "smaller oscillations decay, larger ones grow");
}

}  // namespace host_sim::stability
