#include "host_sim/identification/select/fault_rewrites.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/identification/common/butterworth.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;

namespace {

/// All channels of a problem but these.
std::vector<Channel> all_but(const IdentificationProblem& problem, const std::vector<Channel>& channels) {
  std::vector<Channel> others;
  for (const Channel channel : problem.channels()) {
    if (std::find(channels.begin(), channels.end(), channel) == channels.end()) others.push_back(channel);
  }
  return others;
}

/// One channel more behind a clock or filter. With the input itself, all that are not behind it seem to be early.
void put_behind(PlacedFault& fault, Channel channel, const IdentificationProblem& problem) {
  if (fault.is_of(channel)) return;
  fault.seen = false;
  if (fault.inverse) {
    std::erase(fault.channels, channel);
  } else if (channel != problem.samples().front().input.channel) {
    fault.channels.push_back(channel);
  } else {
    fault.channels = all_but(problem, fault.channels);
    fault.inverse = fault.kind == FaultKind::common_filter;
    if (fault.kind == FaultKind::clock) {
      for (double& value : fault.values) value = -value;
    }
  }
}

bool same_channels(const PlacedFault& a, const PlacedFault& b) {
  return a.channels.size() == b.channels.size() &&
         std::all_of(a.channels.begin(), a.channels.end(), [&](Channel channel) { return b.acts_on(channel); });
}

}  // namespace

bool improve_order(const ModelFitter& fitter, CandidateModel& model, std::size_t fault) {
  if (model.faults()[fault].kind != FaultKind::common_filter) return false;
  bool improved = false;
  for (const int step : {-1, 1}) {
    while (true) {
      const int order = model.faults()[fault].order;
      if (order + step < 1 || order + step > thresholds::highest_filter_order) break;
      Hypothesis start = model.fit.hypothesis;
      start.faults[fault].order += step;
      start.faults[fault].values[0] *= butterworth_delay(order + step) / butterworth_delay(order);
      CandidateModel other = fitter.refitted(start, model.effects, 8);
      const double to_beat = model.penalised_chi_squared(fitter.criterion()) - thresholds::replaces;
      if (!(other.penalised_chi_squared(fitter.criterion()) < to_beat) || !fitter.leaves_noise(other)) break;
      model = std::move(other);
      improved = true;
    }
  }
  return improved;
}

bool simplify_clock(const ModelFitter& fitter, CandidateModel& model, std::size_t fault) {
  const CandidateModel whole = model;
  const PlacedFault& own = whole.faults()[fault];
  if (own.kind != FaultKind::clock || !own.fitted[0] || !own.fitted[1]) return false;
  bool simplified = false;
  for (const std::size_t value : {std::size_t{0}, std::size_t{1}}) {
    // One channel that is late is its sensor's delay.
    if (value == 1 && own.channels.size() == 1) continue;
    Hypothesis start = whole.fit.hypothesis;
    start.faults[fault].values[value] = 0.0;
    start.faults[fault].fitted[value] = false;
    CandidateModel simpler = fitter.refitted(start, whole.effects, 8);
    if (!fitter.criterion().prefers(simpler, model)) continue;
    model = std::move(simpler);
    simplified = true;
  }
  return simplified;
}

std::optional<CandidateModel> in_filter(const ModelFitter& fitter, const CandidateModel& whole, std::size_t clock) {
  const PlacedFault& late = whole.faults()[clock];
  if (late.kind != FaultKind::clock) return std::nullopt;
  std::optional<CandidateModel> best;
  for (std::size_t f = 0; f < whole.faults().size(); ++f) {
    if (whole.faults()[f].kind != FaultKind::common_filter) continue;
    Hypothesis start = whole.fit.hypothesis;
    PlacedFault& filter = start.faults[f];
    if (same_channels(filter, late)) {
      const double own = butterworth_delay(filter.order) / (2.0 * std::numbers::pi);  // [s] times the corner
      const double delay = own / filter.values[0] + (filter.inverse ? -late.values[0] : late.values[0]);
      if (!(delay > 0.0)) continue;
      filter.values[0] = own / delay;
    } else {
      for (const Channel channel : late.channels) put_behind(filter, channel, fitter.problem());
      if (filter.channels.empty() || filter.channels.size() == whole.faults()[f].channels.size()) continue;
    }
    start.faults.erase(start.faults.begin() + static_cast<std::ptrdiff_t>(clock));
    CandidateModel other = fitter.refitted(start, whole.effects, 8);
    if (fitter.criterion().prefers(other, best ? *best : whole)) best = std::move(other);
  }
  return best;
}

std::optional<CandidateModel> in_group(const ModelFitter& fitter, const CandidateModel& whole, std::size_t effect) {
  const std::optional<Channel> channel = whole.effects[effect].channel;
  const PreparedRecording& first = fitter.problem().samples().front();
  if (!channel || (!first.explains(*channel) && channel != first.input_sensor())) return std::nullopt;
  std::optional<CandidateModel> best;
  for (std::size_t f = 0; f < whole.faults().size(); ++f) {
    const PlacedFault& fault = whole.faults()[f];
    const bool of_group = fault.kind == FaultKind::clock || fault.kind == FaultKind::common_filter;
    // A clock of this channel that runs differently may be late as well.
    const bool is_late = fault.kind == FaultKind::clock && fault.acts_on(*channel) && fault.channels.size() == 1 &&
                         whole.effects[effect].entry->lateness == model::Lateness::delay;
    if (!of_group || (fault.is_of(*channel) && !is_late) || (fault.inverse && fault.channels.size() == 1)) continue;
    Hypothesis start = whole.fit.hypothesis;
    std::vector<firmware::PlacedEffect> effects = whole.effects;
    firmware::remove_effect(start.rig, *effects[effect].entry, channel);
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(effect));
    put_behind(start.faults[f], *channel, fitter.problem());
    if (start.faults[f].channels.empty()) continue;
    if (is_late) {
      start.faults[f].values[0] += whole.effects[effect].values[0];
      start.faults[f].fitted[0] = true;
    }
    CandidateModel other = fitter.refitted(start, std::move(effects), 8);
    if (fitter.criterion().prefers(other, best ? *best : whole)) best = std::move(other);
  }
  return best;
}

std::optional<CandidateModel> in_one_fault(const ModelFitter& fitter, const CandidateModel& whole, std::size_t effect) {
  const firmware::PlacedEffect& own = whole.effects[effect];
  const bool lags = own.entry->lateness == model::Lateness::lag;
  if (!own.channel || (!lags && own.entry->lateness != model::Lateness::delay)) return std::nullopt;
  Hypothesis start = whole.fit.hypothesis;
  std::vector<firmware::PlacedEffect> effects;
  std::vector<Channel> late;
  double sum = 0.0;
  for (std::size_t i = 0; i < whole.effects.size(); ++i) {
    const firmware::PlacedEffect& other = whole.effects[i];
    const double ratio = other.entry == own.entry ? other.values.front() / own.values.front() : 0.0;
    if (!(std::abs(ratio - 1.0) < thresholds::alike_filters)) {
      effects.push_back(other);
      continue;
    }
    if (i < effect) return std::nullopt;
    late.push_back(*other.channel);
    sum += other.values.front();
    firmware::remove_effect(start.rig, *other.entry, other.channel);
  }
  if (late.size() < 2 || start.faults.size() >= thresholds::most_faults) return std::nullopt;
  const double mean = sum / static_cast<double>(late.size());
  PlacedFault fault = lags ? filter_fault({}, 1.0 / (2.0 * std::numbers::pi * mean), 1) : clock_fault({}, mean, 0.0);
  if (!lags) fault.fitted[1] = false;
  // The input last: it turns the group into that of all others.
  const Channel input = fitter.problem().samples().front().input.channel;
  std::stable_partition(late.begin(), late.end(), [input](Channel channel) { return channel != input; });
  for (const Channel channel : late) put_behind(fault, channel, fitter.problem());
  if (fault.channels.empty()) return std::nullopt;
  start.faults.push_back(std::move(fault));
  CandidateModel one = fitter.refitted(start, std::move(effects), 8);
  return fitter.criterion().prefers(one, whole) ? std::optional(std::move(one)) : std::nullopt;
}

std::optional<CandidateModel> by_sensors(const ModelFitter& fitter, const CandidateModel& whole, std::size_t fault) {
  const PlacedFault& own = whole.faults()[fault];
  const bool clock = own.kind == FaultKind::clock, filter = own.kind == FaultKind::common_filter;
  if (!clock && !(filter && own.order == 1 && !own.digital)) return std::nullopt;
  // The clock of all others is that of the input; an inverse filter says so itself.
  const bool of_input = filter ? own.inverse : own.channels.size() == fitter.problem().channels().size();
  if (of_input ? own.channels.size() < fitter.problem().channels().size() : clock && own.channels.size() > 1) {
    return std::nullopt;
  }
  std::vector<Channel> channels = own.channels;
  if (of_input) {
    const std::optional<Channel> input = fitter.problem().samples().front().input_sensor();
    if (!input) return std::nullopt;
    channels = {*input};
  }
  const model::Lateness as = clock ? model::Lateness::delay : model::Lateness::lag;
  const firmware::CatalogueEntry* const entry =
      firmware::find_effect_that([as](const auto& e) { return e.of_channel && e.lateness == as; });
  const auto& card = entry->parameters.front();
  const double value =
      clock ? (of_input ? -own.values[0] : own.values[0]) : 1.0 / (2.0 * std::numbers::pi * own.values[0]);
  if (!(value > card.lower)) return std::nullopt;
  Hypothesis start = whole.fit.hypothesis;
  std::vector<firmware::PlacedEffect> effects = whole.effects;
  for (const Channel channel : channels) {
    const auto is_there = [&](const firmware::PlacedEffect& e) { return e.entry == entry && e.channel == channel; };
    if (!firmware::has_place(start.rig, *entry, channel) || std::any_of(effects.begin(), effects.end(), is_there)) {
      return std::nullopt;
    }
    effects.push_back({entry, channel, {std::min(value, card.upper)}});
    firmware::put_effect(start.rig, effects.back());
  }
  const auto is_among = [&](Channel channel) {
    return std::find(channels.begin(), channels.end(), channel) != channels.end();
  };
  start.faults.erase(start.faults.begin() + static_cast<std::ptrdiff_t>(fault));
  std::erase_if(start.faults, [&](const PlacedFault& other) {
    return channels.size() > 1 && other.kind == FaultKind::clock &&
           std::all_of(other.channels.begin(), other.channels.end(), is_among);
  });
  return fitter.refitted(start, std::move(effects), 8);
}

}  // namespace host_sim::identification
