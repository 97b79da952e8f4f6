#include "host_sim/identification/select/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/identification/estimate/free_parameter.hpp"
#include "host_sim/identification/predict/true_input.hpp"
#include "host_sim/identification/prepare/sample_faults.hpp"
#include "host_sim/identification/select/ripple_period.hpp"
#include "host_sim/identification/select/thresholds.hpp"
#include "host_sim/signal/summary.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using Starts = std::vector<Start>;

struct Size {
  double rms = 0.0, peak = 0.0;
};

Size size_of(const std::vector<double>& values) {
  Size size;
  double mean = 0.0;
  for (const double v : values) mean += v;
  mean /= static_cast<double>(std::max<std::size_t>(values.size(), 1));
  for (const double v : values) {
    size.rms += (v - mean) * (v - mean);
    size.peak = std::max(size.peak, std::abs(v));
  }
  size.rms = std::sqrt(size.rms / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
  return size;
}

/// The |value| beyond half of the largest that comes most often: where a channel is cut off before a low-pass, which
/// rounds the tops and overshoots by up to 11 %, and where a sine turns.
struct Top {
  double value;
  bool prominent;  ///< it comes thresholds::top_prominence times as often as the others, in the median
};
Top most_frequent_top(const std::vector<double>& values) {
  const double largest = largest_magnitude(values);
  std::array<std::size_t, thresholds::top_bins> counts{};
  for (const double v : values) {
    const double height = 2.0 * std::abs(v) / largest - 1.0;
    if (height >= 0.0) ++counts[std::min(static_cast<std::size_t>(height * thresholds::top_bins), counts.size() - 1)];
  }
  const auto most = static_cast<double>(std::max_element(counts.begin(), counts.end()) - counts.begin());
  std::sort(counts.begin(), counts.end());
  return {0.5 * largest * (1.0 + (most + 0.5) / thresholds::top_bins),
          counts.back() > thresholds::top_prominence * std::max<std::size_t>(counts[counts.size() / 2], 1)};
}

/// True if more than half of the samples near `top` differ from the sample before by much less than the noise. Only a
/// sensor at its limit does that.
bool is_still_at(double top, const std::vector<double>& values, double noise) {
  const double width = 0.5 * largest_magnitude(values) / thresholds::top_bins;
  std::size_t still = 0, there = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (std::abs(std::abs(values[k]) - top) > 0.5 * width) continue;
    ++there;
    if (std::abs(values[k] - values[k - 1]) < thresholds::still * noise) ++still;
  }
  return 2 * still > there;
}

/// The |value| at which a channel is cut off, of each recording in which it is, or may be behind a filter. Forces have
/// flat tops of their own there, with noise: a component that yields, a tyre that lifts off.
Starts repeated_extremes(const std::vector<PreparedRecording>& recordings, Channel channel) {
  Starts starts;
  for (const PreparedRecording& e : recordings) {
    if (!e.recording.has(channel)) continue;
    // Between the samples that were recorded an interpolation overshoots the limit.
    std::vector<double> recorded;
    for (std::size_t k = 0; k < e.size(); k += e.step) recorded.push_back(e.recording[channel][k]);
    if (const auto limit = cut_off_at(recorded)) {
      starts.push_back({{*limit}});
    } else if (largest_magnitude(recorded) > 0.0) {
      const auto c = index(channel);
      const Top top = most_frequent_top(recorded);
      const bool repeats = e.rounding[c] > 0.0 || e.renewals[c];
      const bool is_still = !repeats && is_still_at(top.value, recorded, e.noise[c]);
      const bool may_be_round = model::unit(channel) != "N" && (top.prominent || e.channel_noise[c].shows_a_filter());
      if (is_still || may_be_round) starts.push_back({{top.value}});
    }
  }
  return starts;
}

/// The period of a channel that holds its values; where its renewals are regular, also renewed by a clock of its own:
/// where between two samples its values are taken the search finds.
Starts renewal_periods(const std::vector<PreparedRecording>& recordings, Channel channel) {
  Starts starts;
  if (const auto held = hold_period(recordings, channel)) {
    starts.push_back({{held->value}});
    const bool regular = std::all_of(recordings.begin(), recordings.end(), [channel](const PreparedRecording& e) {
      const auto& renewals = e.renewals[index(channel)];
      return !renewals || renewals->regular;
    });
    if (regular) starts.push_back({{held->value}, {true, 0.0}});
  }
  return starts;
}

using Present = std::vector<firmware::PlacedEffect>;

/// The effect of a rig that another one contains; nullptr: none.
const firmware::PlacedEffect* contained(const Present& present, const firmware::CatalogueEntry& entry) {
  const auto it = std::find_if(present.begin(), present.end(), [&](const auto& p) {
    return !entry.contains.empty() && p.entry->name == entry.contains;
  });
  return it == present.end() ? nullptr : &*it;
}

/// As the card of the effect says. None: the recordings do not show the parameter.
Starts starts_of(const model::EffectParameter& parameter, const std::vector<PreparedRecording>& recordings,
                 std::optional<Channel> channel, const model::MotionScales& scales) {
  Starts starts;
  switch (parameter.starts.read) {
    case model::Reading::nothing: {
      const double unit = parameter.starts.scale(scales);
      if (unit == 0.0) break;
      for (const double factor : parameter.starts.factors) {
        starts.push_back({{factor * unit}});
        if (is_proportional(parameter)) break;  // one start shows every size
      }
      break;
    }
    case model::Reading::repeated_extreme:
      if (channel) starts = repeated_extremes(recordings, *channel);
      break;
    case model::Reading::renewal_period:
      if (channel) starts = renewal_periods(recordings, *channel);
      break;
  }
  return starts;
}

/// Of an effect: every combination of the starts of its parameters.
Starts starts_of(const firmware::CatalogueEntry& entry, const std::vector<PreparedRecording>& recordings,
                 std::optional<Channel> channel, const Scales& scales,
                 const firmware::PlacedEffect* replaced = nullptr) {
  model::MotionScales sizes = scales.motion;
  if (channel) sizes.channel = scales.rms[index(*channel)];
  Starts starts(1);  // of no parameter: one, without values
  for (const model::EffectParameter& parameter : entry.parameters) {
    Starts longer;
    Starts own = starts_of(parameter, recordings, channel, sizes);
    if (replaced != nullptr && parameter.from_contained) own = {{{replaced->values.front()}}};
    for (const Start& first : starts) {
      for (const Start& next : own) {
        Start both{first.values, next.clock};
        both.values.insert(both.values.end(), next.values.begin(), next.values.end());
        longer.push_back(std::move(both));
      }
    }
    starts = std::move(longer);
  }
  return starts;
}

/// What the model leaves of the force of the component, as far as a channel shows it; empty: none does.
std::vector<double> force_left(const PreparedRecording& recording, const Response& response,
                               const model::RigParameters<double>& rig) {
  const bool driven = rig.kind == model::RigKind::driven_mass;
  const bool machine = rig.kind != model::RigKind::quarter_car && !driven;
  const Channel channel = machine ? Channel::F : Channel::zdd_b;
  const double factor = machine ? 1.0 : driven ? -rig.body.mass : rig.body.mass;
  const auto& shown = recording.channels;
  if (std::find(shown.begin(), shown.end(), channel) == shown.end()) return {};
  std::vector<double> force = recording.recording[channel];
  for (std::size_t k = 0; k < force.size(); ++k) {
    force[k] = factor * (force[k] - response[index(channel)][k]);
  }
  return force;
}

}  // namespace

Scales scales_of(const std::vector<PreparedRecording>& recordings, const Hypothesis& hypothesis,
                 const std::vector<Response>& responses) {
  Scales s;
  const auto enlarge = [](double& to, double value) { to = std::max(to, value); };
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const PreparedRecording& e = recordings[r];
    for (const Channel channel : e.channels) {
      const Size size = size_of(e.recording[channel]);
      enlarge(s.rms[index(channel)], size.rms);
      enlarge(s.peak[index(channel)], size.peak);
    }
    const bool bench = hypothesis.rig.kind == model::RigKind::component_bench;
    std::vector<double> deflection;
    if (bench) {
      for (const auto& m : e.input.motion) deflection.push_back(m.position);
    } else if (e.input.is_force()) {
      deflection = responses[r][index(Channel::x_act)];
      for (const auto& m : e.input.motion) enlarge(s.motion.force, std::abs(m.position) / 3.0);  // peak of a noise
    } else {
      deflection = responses[r][index(Channel::dz_b)];
      enlarge(s.motion.tyre_force, size_of(responses[r][index(Channel::F_w)]).rms);
      enlarge(s.motion.tyre_deflection, size_of(responses[r][index(Channel::dz_w)]).rms);
      double squares = 0.0;
      for (const auto& m : e.input.motion) squares += m.acceleration * m.acceleration;
      enlarge(s.motion.foot_acceleration, std::sqrt(squares / static_cast<double>(e.input.size())));
    }
    const auto rate = [&](const std::vector<double>& values) {
      std::vector<double> rates(values.size());
      for (std::size_t k = 1; k < values.size(); ++k) rates[k] = (values[k] - values[k - 1]) / e.input.period;
      return rates;
    };
    const std::vector<double> velocity = rate(deflection);
    const Size d = size_of(deflection), v = size_of(velocity);
    enlarge(s.motion.acceleration, size_of(rate(velocity)).rms);
    enlarge(s.motion.deflection, d.rms);
    enlarge(s.motion.deflection_peak, d.peak);
    enlarge(s.motion.velocity, v.rms);
    enlarge(s.motion.velocity_peak, v.peak);
    if (s.motion.ripple_period == 0.0) {
      s.motion.ripple_period = ripple_period(deflection, force_left(e, responses[r], hypothesis.rig));
    }
    if (bench) {
      enlarge(s.motion.force, size_of(responses[r][index(Channel::F)]).rms);
      // A description without a stiffness moves no force, and every start would be a share of nothing.
      if (std::find(e.channels.begin(), e.channels.end(), Channel::F) != e.channels.end()) {
        enlarge(s.motion.force, 0.5 * size_of(e.recording[Channel::F]).rms);
      }
    } else if (!e.input.is_force()) {
      enlarge(s.motion.force, hypothesis.rig.body.mass * size_of(responses[r][index(Channel::zdd_b)]).rms);
    }
  }
  return s;
}

std::vector<Candidate> candidates(const std::vector<PreparedRecording>& recordings, const Hypothesis& hypothesis,
                                  const Scales& scales) {
  const auto present = firmware::effects_of(hypothesis.rig);
  const auto is_present = [&](const firmware::CatalogueEntry& entry, std::optional<Channel> channel) {
    return std::any_of(present.begin(), present.end(),
                       [&](const firmware::PlacedEffect& p) { return p.entry == &entry && p.channel == channel; });
  };
  const PreparedRecording& first = recordings.front();
  std::vector<Channel> sensors = first.channels;
  if (const auto input = first.input_sensor()) sensors.push_back(*input);
  std::vector<Candidate> list;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    if (!first.shows(entry)) continue;
    if (entry.of_channel) {
      for (const Channel channel : sensors) {
        if (!firmware::has_place(hypothesis.rig, entry, channel) || is_present(entry, channel)) continue;
        if (!first.explains(channel) && !can_be_undone(entry, first, channel)) continue;
        Starts starts = starts_of(entry, recordings, channel, scales);
        if (!starts.empty()) list.push_back({&entry, channel, std::move(starts)});
      }
      continue;
    }
    if (!firmware::has_place(hypothesis.rig, entry, std::nullopt) || is_present(entry, std::nullopt)) continue;
    if (entry.subsystem == model::Subsystem::machine && first.input.deflection_reached) continue;
    if (std::any_of(present.begin(), present.end(), [&](const auto& p) { return p.entry->contains == entry.name; })) {
      continue;
    }
    const firmware::PlacedEffect* const replaced = contained(present, entry);
    Starts starts = starts_of(entry, recordings, std::nullopt, scales, replaced);
    if (starts.empty()) continue;
    list.push_back({&entry, std::nullopt, std::move(starts), replaced != nullptr ? replaced->entry : nullptr});
  }
  return list;
}

}  // namespace host_sim::identification
