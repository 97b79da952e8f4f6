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
  if (motion.ripple_period == 0.0) motion.ripple_period = motion.deflection_peak;  // any that the travel shows
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
      // Diagnose compares zdd_r only where it contradicts z_r, which small effects do not make it do.
      if (channel != Channel::zdd_r && fits(entry, channel)) list.push_back(subject_of(rehearsal, entry, channel));
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
  if (!of_either_sign) direction_ = direction_at(middle);
  lowest_ = direction_ * middle - std::log(thresholds::range);
  highest_ = direction_ * middle + std::log(thresholds::range);
  if (subject.entry->corner != model::Corner::none) take_absent(direction_ * middle + std::log(thresholds::absent));
  if (const auto first = trial(direction_ * middle)) default_.significance = first->significance;
}

/// Twice the value and half of it: the effect is more where the same factor changes more.
double SizeSearch::direction_at(double middle) const {
  const auto at = [&](double factor) { return change(value_at(middle + std::log(factor))); };
  const auto half = at(0.5), whole = at(1.0), twice = at(2.0);
  if (!whole) return 1.0;
  const auto between = [&](const Change& a, const Change& b) { return rehearsal_.significance(difference(a, b)); };
  if (half && twice) return between(*twice, *whole) >= between(*whole, *half) ? 1.0 : -1.0;
  // Next to a rig that the model refuses: the described rig has none of the effect.
  if (twice) return rehearsal_.significance(*twice) >= rehearsal_.significance(*whole) ? 1.0 : -1.0;
  if (half) return rehearsal_.significance(*whole) >= rehearsal_.significance(*half) ? 1.0 : -1.0;
  return 1.0;
}

void SizeSearch::take_absent(double place) {
  firmware::PlacedEffect none = subject_.placed();
  none.values[parameter_] = value_at(place);
  absent_ = rehearsal_.residuals_with(none);
  if (absent_) absent_effect_ = std::move(none);
  trials_.clear();
  strongest_ = {};
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

/// The trials on both sides of a significance.
SizeSearch::Bracket SizeSearch::bracket(double wanted) const {
  Bracket found;
  for (const Trial& t : trials_) {
    if (t.significance < wanted && (!found.below || t.place > found.below->place)) found.below = t;
    if (t.significance >= wanted && (!found.above || t.place < found.above->place)) found.above = t;
  }
  return found;
}

std::optional<Size> SizeSearch::with(double wanted) {
  // Places beyond which the model refuses the rig, or does not know it.
  double lowest = lowest_, highest = highest_;
  bool least_taken = absent_.has_value();
  for (int i = 0; i < thresholds::most_trials; ++i) {
    const auto [below, above] = bracket(wanted);
    for (const auto& t : {below, above}) {
      if (t && std::abs(std::log(std::max(t->significance, 1e-9) / wanted)) < thresholds::size_error) {
        return Size{value_at(t->place), t->significance};
      }
    }
    double place = 0.0;
    if (below && above) {
      // Where the significance jumps, the effect shows from there on.
      if (above->place - below->place < 0.2 * thresholds::size_error) break;
      const double from = std::log(std::max(below->significance, 1e-3 * wanted)), to = std::log(above->significance);
      const double share = std::clamp((std::log(wanted) - from) / (to - from), 0.1, 0.9);
      place = below->place + share * (above->place - below->place);
    } else if (above) {
      place = above->place - std::max(std::log(above->significance / wanted), 0.1);
      if (place <= lowest) place = 0.5 * (above->place + lowest);
      if (above->place - lowest < thresholds::size_error) {
        // As small as it can be simulated it still shows, by what its equations do to the step: counted from there.
        if (least_taken || above->significance > thresholds::vanishes * default_.significance) return std::nullopt;
        least_taken = true;
        take_absent(above->place);
        place = std::log(std::abs(default_.value - neutral_)) * direction_;
      }
    } else if (below) {
      place = below->place + std::clamp(std::log(wanted / std::max(below->significance, 1e-3)), 0.1, std::log(30.0));
      if (place >= highest) place = 0.5 * (below->place + highest);
      if (highest - below->place < thresholds::size_error || value_at(below->place) == value_at(highest)) {
        return std::nullopt;
      }
    } else {
      return std::nullopt;
    }
    if (trial(place)) continue;
    (above ? lowest : highest) = place;
    if (below && above) return std::nullopt;
  }
  const auto [below, above] = bracket(wanted);
  if (!below || !above) return std::nullopt;
  return Size{value_at(above->place), above->significance};
}

}  // namespace host_sim::plan
