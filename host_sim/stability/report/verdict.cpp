#include "host_sim/stability/report/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/report/formatted.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::stability {
namespace {

std::string milliseconds(double seconds) { return formatted("%.4g ms", 1e3 * seconds); }

std::string doubling(double omega, double growth) {
  return formatted("unstable at %.4g Hz, doubling every %.3g s", omega / full_turn,
                   std::numbers::ln2 / std::max(growth, 1e-300));
}

/// Of the loop that runs; the continuous one second.
std::string unstable_in_words(const StabilityAnalysis& a) {
  const Complex worst = a.roots.rightmost();
  std::string line;
  if (a.sampled && !a.sampled->stable()) {
    const Complex z = a.sampled->eigenvalues.front();
    const double period = a.sampled->period;
    line = doubling(std::abs(std::arg(z)) / period, std::log(std::abs(z)) / period);
  } else if (a.past_border()) {
    line = "unstable with half a step of hold";
  } else if (worst.real() == 0.0) {
    line = "not stable: a root lies on the imaginary axis";
  } else {
    line = doubling(worst.imag(), worst.real());
  }
  if (a.delay_left && *a.delay_left != 0.0) {
    line +=
        ", stable with " + milliseconds(std::abs(*a.delay_left)) + (*a.delay_left < 0.0 ? " less" : " more") + " delay";
  }
  if (a.stable) {
    line += "; without sampling and hold stable";
    if (a.margins.delay_margin) line += ", " + milliseconds(*a.margins.delay_margin) + " of delay left";
  } else if (a.margins.delay_margin) {
    const double change = *a.margins.delay_margin;
    line += " (" + milliseconds(std::abs(change)) + (change < 0.0 ? " less" : " more") + " without sampling and hold)";
  }
  return line;
}

std::string smooth_verdict(const StabilityAnalysis& a) {
  if (!a.stable_as_run()) return unstable_in_words(a);
  if (!a.stable_over_delays()) {
    const bool by_sampled = a.sampled_over_delays && !a.sampled_over_delays->stable;
    const double worst = by_sampled ? a.sampled_over_delays->worst_delay + a.rig.sensor_delay : a.varying->worst_delay;
    return formatted("unstable within the range of its delay, %s … %s: stable at the mean, not at %s",
                     milliseconds(a.varying->lowest).c_str(), milliseconds(a.varying->highest).c_str(),
                     milliseconds(worst).c_str()) +
           (a.varying->stable ? "; without sampling and hold stable at every delay of the range" : "");
  }
  if (!a.delay_left) return "stable at every delay from the given one up to 1 s";
  std::string line = "stable, " + milliseconds(*a.delay_left) + " of delay left";
  if (a.margins.delay_margin) {
    line += (a.sampled ? formatted(" as sampled at %.6g Hz", 1.0 / a.sampled->period)
                       : std::string(" with half a step of hold")) +
            " (" + milliseconds(*a.margins.delay_margin) + " without sampling and hold)";
  }
  return line;
}

std::string in_words(const FoundOnSide& side) {
  std::string words = side.name + ": " + (side.stable ? "stable" : "unstable");
  if (side.delay_left) {
    words +=
        ", " + milliseconds(std::abs(*side.delay_left)) + (*side.delay_left < 0.0 ? " too much" : " of delay left");
  }
  return words;
}

}  // namespace

std::string verdict(const StabilityAnalysis& a) {
  std::string words = smooth_verdict(a);
  if (a.sides.empty()) return words;
  words += "; rest is a kink, and the worse side decides (";
  for (std::size_t i = 0; i < a.sides.size(); ++i) words += (i > 0 ? "; " : "") + in_words(a.sides[i]);
  return words + ")";
}

std::string in_words(const LimitCycle& cycle) {
  return formatted("limit cycle of %.3g mm at %.4g Hz: ", 1e3 * cycle.at.amplitude, cycle.at.omega / full_turn) +
         (cycle.attracts ? "smaller oscillations grow to it, larger ones decay to it"
                         : "smaller oscillations decay, larger ones grow");
}

}  // namespace host_sim::stability
