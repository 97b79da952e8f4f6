#include "host_sim/diagnose/where.hpp"

#include <algorithm>
#include <utility>

#include "host_sim/catalogue.hpp"
#include "host_sim/diagnose/rest.hpp"

namespace host_sim::diagnose {

using model::Channel;

namespace {

std::string subsystem_of(const PlacedEffect& effect) {
  std::string place(model::name(effect.entry->place));
  if (effect.channel) place.append(" ").append(model::name(*effect.channel));
  return place;
}

/// Where a channel's disagreement sits when nothing is named for it.
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

std::vector<Place> places(const std::vector<BandPower>& left, const Findings& findings, const std::string& likely) {
  std::vector<Place> result;
  const auto excesses = channel_excesses(left);
  double total = 0.0;
  for (const ChannelExcess& e : excesses) total += e.excess;
  for (const ChannelExcess& e : excesses) {
    if (!(e.significance > significant) || !(e.excess > 0.005 * total)) continue;
    std::string subsystem = subsystem_of(e.channel, findings.best.fit.hypothesis.rig.kind);
    const PlacedEffect* named = nullptr;
    for (const PlacedEffect& effect : findings.best.effects) {
      if (effect.channel == e.channel) named = &effect;
      if (!effect.channel && named == nullptr) named = &effect;
    }
    if (named != nullptr) {
      subsystem = subsystem_of(*named);
    } else if (!likely.empty()) {
      subsystem = likely;
    }
    result.push_back({e.channel, e.lowest, e.highest, std::move(subsystem), e.excess / total});
  }
  std::sort(result.begin(), result.end(), [](const Place& a, const Place& b) { return a.share > b.share; });
  return result;
}

}  // namespace host_sim::diagnose
