#include "host_sim/identification/assess/localisation.hpp"

#include <algorithm>
#include <utility>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;

namespace {

std::string subsystem_of(const firmware::PlacedEffect& effect) {
  std::string place(model::name(effect.entry->subsystem));
  if (effect.channel) place.append(" ").append(model::name(*effect.channel));
  return place;
}

/// The subsystem of a channel for which nothing is named.
std::string subsystem_of(Channel channel, model::RigKind kind) {
  if (kind == model::RigKind::component_bench) return channel == Channel::x_act ? "machine" : "suspension";
  switch (channel) {
    case Channel::F_w:
    case Channel::dz_w:
      return "tyre";
    case Channel::zdd_w:
    case Channel::z_w:
      return "wheel";
    default:
      return "suspension";
  }
}

}  // namespace

std::vector<RecordingLocation> localise(const std::vector<BandPower>& left, const SearchResult& found,
                                        const std::string& likely) {
  std::vector<RecordingLocation> result;
  const auto excesses = channel_excesses(left);
  double total = 0.0;
  for (const ChannelExcess& e : excesses) total += e.excess;
  for (const ChannelExcess& e : excesses) {
    if (!(e.significance > thresholds::significant_deviations) || !(e.excess > thresholds::least_located_share * total))
      continue;
    std::string subsystem = subsystem_of(e.channel, found.best.fit.hypothesis.rig.kind);
    const firmware::PlacedEffect* named = nullptr;
    for (const firmware::PlacedEffect& effect : found.best.effects) {
      if (effect.channel == e.channel) named = &effect;
      if (!effect.channel && named == nullptr) named = &effect;
    }
    if (named != nullptr) {
      subsystem = subsystem_of(*named);
    } else if (!found.freed.empty()) {  // "wheel" of wheel.mass
      subsystem = found.freed.front().path.substr(0, found.freed.front().path.find('.'));
    } else if (!likely.empty()) {
      subsystem = likely;
    }
    result.push_back({e.channel, e.lowest, e.highest, std::move(subsystem), e.excess / total});
  }
  std::sort(result.begin(), result.end(),
            [](const RecordingLocation& a, const RecordingLocation& b) { return a.share > b.share; });
  return result;
}

}  // namespace host_sim::identification
