#include "host_sim/identification/prepare/validation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/identification/prepare/unit_check.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using model::RigKind;

void check_tolerances(const firmware::RigDescription& description) {
  for (const auto& [path, bound] : description.tolerance) {
    const bool may_vanish = path.ends_with("damping");
    if (bound < 1.0 || (may_vanish && bound == 1.0)) continue;
    char wrong[128];
    std::snprintf(wrong, sizeof wrong, "a tolerance of %g lets %s be %s", bound, path.c_str(),
                  bound > 1.0 ? "negative" : "0");
    throw firmware::InputError(description.source, 0, wrong, "a relative bound below 1, such as 0.03 for ±3 %");
  }
}

/// The kind of rig that a recording's channels speak of.
RigKind kind_of(const firmware::Recording& recording) {
  const bool machine = recording.has(Channel::x_cmd) || recording.has(Channel::x_act) || recording.has(Channel::F);
  if (!recording.has(Channel::z_r)) return machine ? RigKind::component_bench : RigKind::quarter_car;
  return machine ? RigKind::hil : RigKind::quarter_car;
}

void check_kind(const firmware::RigDescription& description, const firmware::Recording& recording) {
  const RigKind kind = kind_of(recording);
  if (kind == description.rig.kind) return;
  const bool answers = recording.has(Channel::x_act) || recording.has(Channel::zdd_b);
  if (description.rig.kind == RigKind::driven_mass && recording.has(Channel::F) && answers) return;
  std::string channels;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (recording.channels[c].empty()) continue;
    channels += (channels.empty() ? "" : ", ") + std::string(model::channel_names[c].name);
  }
  throw firmware::InputError(
      recording.source, 0, "looks like a recording of a " + std::string(model::name(kind)) + " (" + channels + ")",
      "one of a " + std::string(model::name(description.rig.kind)) + ", as the rig description says" +
          (description.rig.kind == RigKind::driven_mass ? ": F, and x_act or zdd_b" : ""));
}

bool never_moves(const std::vector<double>& values) {
  return !values.empty() && std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); });
}

/// InputError where a sample is so large that sums of squares overflow: no sensor of a rig shows it.
void check_samples(const firmware::Recording& recording) {
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const auto& values = recording.channels[c];
    const auto huge = std::find_if(values.begin(), values.end(),
                                   [](double v) { return !(std::abs(v) <= thresholds::largest_sample); });
    if (huge == values.end()) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%s is %.3g %s at t = %.6g", std::string(model::channel_names[c].name).c_str(),
                  *huge, std::string(model::unit(model::channel_at(c))).c_str(),
                  recording.time[static_cast<std::size_t>(huge - values.begin())]);
    throw firmware::InputError(recording.source, 0, text, "samples that a sensor can show, or an empty cell");
  }
}

/// Channels of which one is enough for what they tell, in the order in which a remark names them.
using Alternatives = std::vector<Channel>;
std::vector<Alternatives> usual(RigKind kind) {
  if (kind == RigKind::quarter_car) {
    return {{Channel::zdd_r},
            {Channel::zdd_w},
            {Channel::zdd_b},
            {Channel::F_w},
            {Channel::dz_w, Channel::z_w},
            {Channel::dz_b, Channel::z_b}};
  }
  if (kind == RigKind::component_bench) return {{Channel::x_act}, {Channel::F}};
  if (kind == RigKind::driven_mass) return {{Channel::F}, {Channel::x_act, Channel::zdd_b}};
  return {{Channel::x_cmd}, {Channel::x_act}, {Channel::F}};
}

}  // namespace

std::vector<std::string> validate(const firmware::RigDescription& description,
                                  const std::vector<firmware::Recording*>& recordings) {
  check_tolerances(description);
  std::vector<std::string> remarks;
  std::array<bool, model::channel_count> dead{};
  for (const firmware::Recording* recording : recordings) {
    check_kind(description, *recording);
    check_samples(*recording);
    if (!recording->remark.empty()) remarks.push_back(recording->remark);
    for (std::size_t c = 0; c < dead.size(); ++c) {
      const Channel channel = model::channel_at(c);
      if (channel == Channel::F_act || !never_moves(recording->channels[c])) continue;
      if (channel == Channel::z_r || (channel == Channel::F && description.rig.kind == RigKind::driven_mass)) {
        throw firmware::InputError(
            recording->source, 0,
            std::string(model::name(channel)) + " never " + (channel == Channel::F ? "changes" : "moves"),
            "a recording in which the rig is excited");
      }
      char text[160];
      std::snprintf(text, sizeof text, "%s: %s is %.6g %s throughout, a dead sensor or an unused column: left out",
                    recording->source.c_str(), std::string(model::name(channel)).c_str(),
                    recording->channels[c].front(), std::string(model::unit(channel)).c_str());
      remarks.emplace_back(text);
      dead[c] = true;
    }
  }
  for (firmware::Recording* recording : recordings) {
    if (static_cast<double>(recording->size()) * recording->sample_period < thresholds::shortest_validated) continue;
    for (std::size_t c = 0; c < dead.size(); ++c) {
      if (dead[c]) recording->channels[c].clear();
    }
    const bool machine = description.rig.kind == RigKind::hil || description.rig.kind == RigKind::component_bench;
    if (machine && !recording->has(Channel::x_cmd) && !recording->has(Channel::x_act)) {
      throw firmware::InputError(recording->source, 0, "neither x_cmd nor x_act is there and moves",
                                 "a recording in which the machine moves the component");
    }
    std::string missing;
    for (const Alternatives& alternatives : usual(description.rig.kind)) {
      const auto there = [&](Channel channel) { return recording->has(channel) || dead[index(channel)]; };
      if (std::any_of(alternatives.begin(), alternatives.end(), there)) continue;
      missing += (missing.empty() ? "" : ", ") + std::string(model::name(alternatives.front()));
    }
    if (!missing.empty()) {
      remarks.push_back(recording->source + ": without " + missing + "; what only shows there cannot be judged");
    }
    for (std::string& remark : check_units(description, *recording)) remarks.push_back(std::move(remark));
  }
  return remarks;
}

}  // namespace host_sim::identification
