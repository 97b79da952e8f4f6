#include "host_sim/plan/effect_size.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/plan/thresholds.hpp"

namespace host_sim::plan {

using model::Channel;

namespace {

/// Starts of one parameter in the described motion. A limit that a recording would show by repetition starts below the
/// peak; a hold at two samples.
std::vector<double> starts_of(const model::EffectParameter& parameter, const Rehearsal& rehearsal,
                              std::optional<Channel> channel) {
  model::MotionScales motion = rehearsal.scales().motion;
  const std::size_t c = channel ? index(*channel) : 0;
  if (channel) motion.channel = rehearsal.scales().rms[c];
  std::vector<double> starts;
  switch (parameter.starts.read) {
    case model::Reading::nothing:
      for (const double factor : parameter.starts.factors) starts.push_back(factor * parameter.starts.scale(motion));
      break;
    case model::Reading::repeated_extreme:
      if (channel) starts = {0.9 * rehearsal.scales().peak[c], 0.7 * rehearsal.scales().peak[c]};
      break;
    case model::Reading::renewal_period:
      starts = {2.0 * rehearsal.problem().sample_period()};
      break;
  }
  for (double& start : starts) start = std::clamp(start, parameter.lower, parameter.upper);
  return starts;
}

Subject subject_of(const Rehearsal& rehearsal, const firmware::CatalogueEntry& entry, std::optional<Channel> channel) {
  Subject subject{&entry, channel, {}};
  subject.starts.resize(1);
  subject.seen_by_itself = identification::is_hold(entry);
  for (const model::EffectParameter& parameter : entry.parameters) {
    const std::vector<double> own = starts_of(parameter, rehearsal, channel);
    if (own.empty()) return {&entry, channel, {}};
    // Signed starts come in pairs, the positive one first.
    subject.values.push_back(parameter.lower < 0.0 ? own.front() : own[own.size() / 2]);
    std::vector<std::vector<double>> longer;
    for (const auto& first : subject.starts) {
      for (const double next : own) {
        longer.push_back(first);
        longer.back().push_back(next);
      }
    }
    subject.starts = std::move(longer);
  }
  return subject;
}

}  // namespace

std::vector<Subject> subjects(const Rehearsal& rehearsal) {
  const auto present = firmware::effects_of(rehearsal.given().rig);
  const identification::PreparedRecording& recording = rehearsal.problem().samples().front();
  const auto fits = [&](const firmware::CatalogueEntry& entry, std::optional<Channel> channel) {
    const bool there = std::any_of(present.begin(), present.end(), [&](const firmware::PlacedEffect& p) {
      return p.entry == &entry && p.channel == channel;
    });
    return !there && firmware::has_place(rehearsal.given().rig, entry, channel);
  };
  std::vector<Subject> list;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    if (!entry.of_channel) {
      if (entry.subsystem == model::Subsystem::machine && recording.input.deflection_reached) continue;
      if (fits(entry, std::nullopt)) list.push_back(subject_of(rehearsal, entry, std::nullopt));
      continue;
    }
    for (const Channel channel : recording.channels) {
      if (fits(entry, channel)) list.push_back(subject_of(rehearsal, entry, channel));
    }
  }
  return list;
}

SizeSearch::SizeSearch(const Rehearsal& rehearsal, const Subject& subject, std::size_t parameter)
    : rehearsal_(rehearsal), subject_(subject), parameter_(parameter) {
  const model::EffectParameter& card = subject.entry->parameters[parameter];
  const double start = subject.values[parameter];
  const bool of_either_sign = card.lower < 0.0;
  if (of_either_sign) {
    neutral_ = card.neutral;
    sign_ = start < neutral_ ? -1.0 : 1.0;
  }
  const double middle = place_of(start);
  default_ = {start, 0.0};
  const std::optional<Trial> first = trial(middle);
  if (!of_either_sign && first) {
    const auto more = trial(middle + std::log(2.0));
    const bool grows = more ? more->significance >= first->significance : [&] {
      const auto less = trial(middle - std::log(2.0));
      return less && less->significance < first->significance;
    }();
    direction_ = grows ? 1.0 : -1.0;
  }
  for (Trial& t : trials_) t.place *= direction_;
  lowest_ = direction_ * middle - std::log(thresholds::range);
  highest_ = direction_ * middle + std::log(thresholds::range);
  if (subject.entry->corner != model::Corner::none) {
    firmware::PlacedEffect none = subject.placed();
    none.values[parameter] = value_at(direction_ * middle + std::log(thresholds::absent));
    absent_ = rehearsal.residuals_with(none);
    if (absent_) absent_effect_ = std::move(none);
    trials_.clear();
    if (const auto again = trial(direction_ * middle)) default_.significance = again->significance;
  } else if (first) {
    default_.significance = first->significance;
  }
}

double SizeSearch::value_at(double place) const {
  const model::EffectParameter& card = subject_.entry->parameters[parameter_];
  return std::clamp(neutral_ + sign_ * std::exp(direction_ * place), card.lower, card.upper);
}

double SizeSearch::place_of(double value) const {
  return std::log(std::max(std::abs(value - neutral_), 1e-300)) * direction_;
}

std::optional<Change> SizeSearch::change(double value) const {
  firmware::PlacedEffect effect = subject_.placed();
  effect.values[parameter_] = value;
  return rehearsal_.change(effect, absent_ ? &*absent_ : nullptr);
}

std::optional<SizeSearch::Trial> SizeSearch::trial(double place) {
  const double value = value_at(place);
  const auto changed = change(value);
  if (!changed) return std::nullopt;
  const double significance = rehearsal_.significance(*changed);
  if (!std::isfinite(significance)) return std::nullopt;
  if (significance > strongest_.significance) strongest_ = {value, significance};
  trials_.push_back({place, significance});
  return trials_.back();
}

std::optional<Size> SizeSearch::with(double wanted) {
  double last_refused = INFINITY;
  for (int i = 0; i < thresholds::most_trials; ++i) {
    const Trial* below = nullptr;
    const Trial* above = nullptr;
    for (const Trial& t : trials_) {
      if (std::abs(std::log(std::max(t.significance, 1e-9) / wanted)) < thresholds::size_error) {
        return Size{value_at(t.place), t.significance};
      }
      if (t.significance < wanted && (below == nullptr || t.place > below->place)) below = &t;
      if (t.significance > wanted && (above == nullptr || t.place < above->place)) above = &t;
    }
    double place = 0.0;
    if (below != nullptr && above != nullptr) {
      if (std::abs(above->place - below->place) < 0.2 * thresholds::size_error) {  // a jump: from here on it shows
        return Size{value_at(above->place), above->significance};
      }
      const double from = std::log(std::max(below->significance, 1e-3 * wanted)), to = std::log(above->significance);
      const double share = std::clamp((std::log(wanted) - from) / (to - from), 0.1, 0.9);
      place = below->place + share * (above->place - below->place);
    } else if (above != nullptr) {
      if (above->place <= lowest_) return std::nullopt;
      place = std::max(lowest_, above->place - std::max(std::log(above->significance / wanted), 0.1));
    } else if (below != nullptr) {
      const double far = std::min(highest_, last_refused);
      if (below->place >= far - 1e-3 || value_at(below->place) == value_at(far)) return std::nullopt;
      place = std::min(highest_, below->place + std::clamp(std::log(wanted / std::max(below->significance, 1e-3)), 0.1,
                                                           std::log(30.0)));
      if (place >= last_refused) place = 0.5 * (below->place + last_refused);
    } else {
      return std::nullopt;
    }
    if (!trial(place)) {
      if (below == nullptr || above != nullptr) return std::nullopt;
      last_refused = place;  // a rig that the step cannot resolve
    }
  }
  return std::nullopt;
}

}  // namespace host_sim::plan
