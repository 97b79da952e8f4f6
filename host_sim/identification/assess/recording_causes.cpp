#include "host_sim/identification/assess/recording_causes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/identification/assess/humming_sensors.hpp"
#include "host_sim/identification/assess/thresholds.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

Interval times(const Interval& v, double factor) {
  Interval scaled{factor * v.value, factor * v.lower, factor * v.upper};
  if (factor < 0.0) std::swap(scaled.lower, scaled.upper);
  return scaled;
}

/// Channels that are recorded and shared the fate of the input, z_r or x_cmd, and what was fused with it: its clock or
/// its filter. `fault` acts on the others.
std::vector<Channel> with_the_input(const IdentificationProblem& problem, const PlacedFault& fault) {
  const PreparedRecording& r = problem.samples().front();
  std::vector<Channel> channels{r.input.channel};
  if (r.inputs_fused) channels.push_back(Channel::zdd_r);
  for (const Channel channel : r.channels) {
    if (!fault.acts_on(channel)) channels.push_back(channel);
  }
  return channels;
}

Interval known(double value) { return {value, value, value}; }

/// The channels' own hums, as they were fitted; or those of fewer sensors, with the input's among them. `next`: as in
/// described().
std::vector<HummingSensor> hums_of(const IdentificationProblem& problem, Hypothesis hypothesis,
                                   const PlacedFault& fault, std::vector<Interval>::const_iterator next) {
  std::erase_if(hypothesis.faults, [](const PlacedFault& other) { return other.kind == FaultKind::mains_hum; });
  std::vector<HummingSensor> hums = humming_sensors(problem, hypothesis, fault.values[0]);
  if (!hums.empty()) return hums;
  ++next;  // the frequency
  for (const Channel channel : fault.channels) {
    const Interval a = *next++, b = *next++;
    const double amplitude = std::hypot(a.value, b.value);
    const double half = 0.5 * std::max(a.upper - a.lower, b.upper - b.lower);
    hums.push_back({channel, {amplitude, std::max(amplitude - half, 0.0), amplitude + half}});
  }
  return hums;
}

/// `next`: the intervals of the fault's fitted values.
std::vector<RecordingFault> described(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                      const PlacedFault& fault, std::vector<Interval>::const_iterator next) {
  std::vector<RecordingFault> list;
  const auto add = [&list](const char* name, std::vector<Channel> channels) -> RecordingFault& {
    list.push_back({name, std::move(channels), {}, 0.0});
    list.back().is_cause = true;
    return list.back();
  };
  switch (fault.kind) {
    case FaultKind::clock: {
      const std::vector<Channel> others = with_the_input(problem, fault);
      const bool input_off = others.size() < fault.channels.size();
      const double sign = input_off ? -1.0 : 1.0;
      const std::vector<Channel>& channels = input_off ? others : fault.channels;
      if (fault.fitted[0]) add("clock_offset", channels).parameters["seconds"] = times(*next++, sign);
      if (fault.fitted[1]) add("clock_drift", channels).parameters["ppm"] = times(*next++, 1e6 * sign);
      break;
    }
    case FaultKind::common_filter: {
      RecordingFault& filter = add("common_filter", fault.inverse ? with_the_input(problem, fault) : fault.channels);
      filter.parameters["corner_hz"] = *next;
      filter.parameters["order"] = known(fault.order);
      break;
    }
    case FaultKind::mains_hum: {
      for (const HummingSensor& sensor : hums_of(problem, hypothesis, fault, next)) {
        RecordingFault& hum = add("mains_hum", {sensor.channel});
        hum.parameters["hz"] = *next;
        hum.parameters["amplitude"] = sensor.amplitude;
      }
      break;
    }
    case FaultKind::drift: {
      RecordingFault& drift = add("drift", {});
      drift.path = fault.path;
      drift.parameters["per_cent_over_record"] = times(*next, 100.0);
      break;
    }
  }
  return list;
}

}  // namespace

std::vector<RecordingFault> recording_causes(const IdentificationProblem& problem, const SearchResult& found,
                                             const SelectionCriterion& criterion,
                                             const std::vector<Interval>& parameters, const Certainty& certainty) {
  const CandidateModel& best = found.best;
  const auto first = std::find_if(best.fit.parameters.begin(), best.fit.parameters.end(),
                                  [](const FreeParameter& p) { return p.role == FreeParameter::Role::fault; });
  auto next = parameters.begin() + (first - best.fit.parameters.begin());
  std::vector<RecordingFault> list;
  for (std::size_t f = 0; f < best.faults().size(); ++f) {
    const PlacedFault& fault = best.faults()[f];
    const FoundCause support = f < found.faults.size() ? found.faults[f] : FoundCause();
    const auto no_experiment = [](const Hypothesis&) { return std::string(); };  // it would be one with the recorder
    const RatedRivals rivals =
        rated(support.rivals, best.penalised_chi_squared(criterion), 0.0, {}, certainty.temper, no_experiment);
    for (RecordingFault& cause : described(problem, best.fit.hypothesis, fault, next)) {
      cause.confidence = confidence(rivals.odds, support.gain, certainty);
      cause.alternatives = rivals.alternatives;
      list.push_back(std::move(cause));
    }
    next += std::count(fault.fitted.begin(), fault.fitted.end(), true);
  }
  for (const ExternalEvent& event : found.events) {
    // An event that costs nothing, in a part that is held out, is believed since the rest went away with it.
    const double odds = event.gain > 0.0
                            ? std::exp(std::min(0.5 * event.gain / certainty.temper, thresholds::most_logarithmic_odds))
                            : thresholds::close_odds;
    RecordingFault cause{"event", {}, {}, confidence({odds}, INFINITY, certainty)};
    cause.is_cause = true;
    const double half = thresholds::event_edge;
    cause.parameters["from_s"] = {event.from, event.from - half, event.from + half};
    cause.parameters["to_s"] = {event.to, event.to - half, event.to + half};
    list.push_back(std::move(cause));
  }
  return list;
}

}  // namespace host_sim::identification
