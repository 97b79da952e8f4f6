#include "host_sim/plan/advice.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/common/multisine.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/plan/thresholds.hpp"

namespace host_sim::plan {

using model::Channel;

namespace {

/// A way in which the experiment could be changed.
struct Variant {
  std::string words;
  firmware::RigDescription description;
  Setting setting;
  std::optional<Channel> sensor{};
  bool is_band = false;
};

/// Result of the rehearsal of a variant.
struct Outcome {
  std::vector<double> left;  ///< of each rival beside its nearest other
  Information information;
  std::string refused;
};

/// Text of a refusal, without the file and without the expected value.
std::string reason_of(std::string refusal, const std::string& source) {
  if (refusal.starts_with(source + ": ")) refusal.erase(0, source.size() + 2);
  return refusal.substr(0, refusal.find(", expected"));
}

/// Sines over an octave with the velocity of the road.
firmware::FootPointMotion octave(identification::Band band, const firmware::FootPointMotion& road, double rate) {
  firmware::FootPointMotion motion = identification::multisine(band, 1.0 / rate, road.size());
  const identification::MotionSize before = identification::size_of(road), after = identification::size_of(motion);
  if (!(after.velocity > 0.0) || !(after.travel > 0.0)) return motion;
  identification::scale(motion, std::min(before.velocity / after.velocity,
                                         identification::thresholds::most_travel * before.travel / after.travel));
  return motion;
}

std::vector<Variant> variants(const firmware::RigDescription& description, const Setting& setting,
                              const Rehearsal& now) {
  std::vector<Variant> list;
  const auto add = [&](std::string words) -> Variant& {
    list.push_back({std::move(words), description, setting});
    return list.back();
  };
  for (const Channel channel : setting.without) {
    Variant& variant = add("a sensor of " + std::string(model::name(channel)));
    std::erase(variant.setting.without, channel);
    variant.sensor = channel;
  }
  for (const Channel channel : unrecorded_channels(now)) {
    Variant& variant = add("a sensor of " + std::string(model::name(channel)));
    variant.setting.added = channel;
    variant.sensor = channel;
  }
  identification::scale(add("twice the level of excitation").setting.motion, 2.0);
  for (double from = 0.5; from < 60.0; from *= 2.0) {
    if (2.0 * from > 0.25 * description.sample_rate) break;
    char words[64];
    std::snprintf(words, sizeof words, "excitation from %g to %g Hz", from, 2.0 * from);
    Variant& variant = add(words);
    variant.is_band = true;
    variant.setting.motion = octave({from, 2.0 * from}, setting.motion, description.sample_rate);
  }
  if (description.rig.has_fdva && description.controller.valve_plan.empty()) {
    for (int open = 0; open <= description.rig.fdva.ducts; ++open) {
      if (open == description.rig.fdva.open_ducts) continue;
      add(std::to_string(open) + (open == 1 ? " duct open" : " ducts open")).description.rig.fdva.open_ducts = open;
    }
  }
  return list;
}

/// A channel that was not recorded before is believed: its own sensor has no effects.
Outcome outcome_of(const Rehearsal& rehearsal, const std::vector<Rival>& rivals) {
  Outcome outcome;
  std::vector<std::vector<Direction>> directions(rivals.size());
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    const auto& strong = rivals[i].strong;
    if (!strong || (strong->channel && !rehearsal.problem().samples().front().explains(*strong->channel))) continue;
    if (auto change = strong_change(rehearsal, rivals[i])) {
      const bool signs = std::all_of(strong->entry->parameters.begin(), strong->entry->parameters.end(),
                                     [](const auto& p) { return p.lower < 0.0; });
      const double square = rehearsal.product(*change, *change);
      directions[i].push_back({std::move(*change), signs, square});
    }
  }
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    const double whole = directions[i].empty() ? 0.0 : directions[i].front().square;
    double least = std::sqrt(std::max(whole, 0.0));
    for (std::size_t j = 0; j < rivals.size() && !directions[i].empty(); ++j) {
      if (j != i) least = std::min(least, left_of(rehearsal, directions[i].front().change, whole, directions[j]));
    }
    outcome.left.push_back(std::isfinite(least) ? least : 0.0);
  }
  outcome.information = information_of(rehearsal);
  return outcome;
}

/// A band that the rig cannot follow is tried with half of the amplitude, and a quarter.
Outcome rehearsed(Variant& variant, const std::vector<Rival>& rivals) {
  Outcome outcome;
  const std::string words = variant.words;
  for (const char* const level : {"", " at half the road's velocity", " at a quarter of the road's velocity"}) {
    try {
      const Rehearsal rehearsal(variant.description, variant.setting);
      outcome = outcome_of(rehearsal, rivals);
      variant.words = words + level;
      return outcome;
    } catch (const firmware::InputError& error) {
      outcome.refused = reason_of(error.what(), variant.description.source);
    }
    if (!variant.is_band) break;
    identification::scale(variant.setting.motion, 0.5);
  }
  return outcome;
}

double known_alone(const Information& information, std::size_t parameter) {
  OpenCombination alone;
  alone.parts.push_back({information.parameters[parameter].path, 1.0});
  return known_to(information, alone);
}

Advice compared(const Variant& variant, const Outcome& with, const Outcome& without, const std::vector<Rival>& rivals) {
  Advice advice{variant.words, 1.0, {}, 1.0};
  double sum = 0.0, count = 0.0;
  // Below a tenth of a standard deviation nothing is told apart, here or there.
  constexpr double nothing = 0.1;
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    if (!rivals[i].strong) continue;
    const double ratio = std::max(with.left[i], nothing) / std::max(without.left[i], nothing);
    sum += std::log(std::clamp(ratio, 1.0 / thresholds::most_gain, thresholds::most_gain));
    count += 1.0;
    if (ratio > advice.most) {
      advice.most = std::min(ratio, thresholds::most_gain);
      advice.helps = identification::words(*rivals[i].strong);
    }
  }
  if (count > 0.0) advice.gain = std::exp(sum / count);
  for (std::size_t i = 0; i < without.information.parameters.size(); ++i) {
    const std::string& path = without.information.parameters[i].path;
    for (std::size_t k = 0; k < with.information.parameters.size(); ++k) {
      if (with.information.parameters[k].path != path) continue;
      if (known_alone(without.information, i) > thresholds::open &&
          known_alone(with.information, k) < thresholds::open) {
        advice.determines.push_back(path);
      }
    }
  }
  return advice;
}

/// The sensor, or else the excitation, that would determine an open combination.
void explain(std::vector<OpenCombination>& open, const std::vector<Variant>& variants,
             const std::vector<Outcome>& outcomes, const Rehearsal& now) {
  const auto& channels = now.problem().channels();
  const bool force = std::any_of(channels.begin(), channels.end(), [](Channel c) { return model::unit(c) == "N"; });
  for (OpenCombination& combination : open) {
    std::vector<std::string> sensors, others;
    bool force_helps = false;
    for (std::size_t v = 0; v < variants.size(); ++v) {
      if (!outcomes[v].refused.empty() || known_to(outcomes[v].information, combination) > thresholds::open) continue;
      if (variants[v].sensor) {
        sensors.emplace_back(model::name(*variants[v].sensor));
        force_helps = force_helps || model::unit(*variants[v].sensor) == "N";
      } else {
        others.push_back(variants[v].words);
      }
    }
    if (force_helps && !force) {
      combination.why = "no force is measured";
    } else if (!sensors.empty()) {
      combination.why = identification::joined(sensors) + (sensors.size() == 1 ? " is" : " are") + " not measured";
    } else if (!others.empty()) {
      combination.why = "this excitation does not show it; " + others.front() + " would";
    } else {
      combination.why = "neither these channels nor this excitation show it";
    }
  }
}

}  // namespace

AdviceResult advice_for(const firmware::RigDescription& description, const Setting& setting,
                        const std::vector<Rival>& rivals, std::vector<OpenCombination>& open,
                        const std::function<void(double)>& progress) {
  Setting shorter = setting;
  shorter.motion.resize(
      std::min(shorter.motion.size(), static_cast<std::size_t>(thresholds::advice_duration * description.sample_rate)));
  const Rehearsal now(description, shorter);
  const Outcome without = outcome_of(now, rivals);
  std::vector<Variant> tried = variants(description, shorter, now);
  std::vector<Outcome> outcomes(tried.size());
  std::atomic<std::size_t> done{0};
  identification::for_all(tried.size(), [&](std::size_t v) {
    outcomes[v] = rehearsed(tried[v], rivals);
    progress(static_cast<double>(++done) / static_cast<double>(tried.size()));
  });
  AdviceResult result;
  for (std::size_t v = 0; v < tried.size(); ++v) {
    if (outcomes[v].refused.empty()) {
      result.advice.push_back(compared(tried[v], outcomes[v], without, rivals));
    } else {
      result.remarks.push_back(tried[v].words + " could not be tried: " + outcomes[v].refused);
    }
  }
  std::stable_sort(result.advice.begin(), result.advice.end(),
                   [](const Advice& a, const Advice& b) { return a.gain > b.gain; });
  explain(open, tried, outcomes, now);
  return result;
}

}  // namespace host_sim::plan
