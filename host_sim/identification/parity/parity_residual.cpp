#include "host_sim/identification/parity/parity_residual.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/parity/describe_residual.hpp"
#include "host_sim/identification/parity/relation_fit.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

using Bands = std::array<double, ParityResidual::bands>;
constexpr const auto& edges = thresholds::parity_band_edges;

/// Calls what(line, frequency) for the lines of a band.
template <class What>
void for_each_line(const RelationSpectra& spectra, std::size_t band, const What& what) {
  for (std::size_t k = 1; k < spectra.noise.size(); ++k) {
    const double f = static_cast<double>(k) * spectra.resolution;
    if (f >= edges[band] && f < edges[band + 1]) what(k, f);
  }
}

/// The band that holds the middle 80 % of what is above noise.
void set_band(const Bands& above, ParityResidual& out) {
  double total = 0.0, sum = 0.0;
  for (const double e : above) total += e;
  for (std::size_t b = 0; b < above.size() && total > 0.0; ++b) {
    if (sum < 0.1 * total) out.lowest = edges[b];
    sum += above[b];
    out.highest = edges[b + 1];
    if (sum >= 0.9 * total) return;
  }
}

/// (1) and (2)
void compare_with_noise(const RelationFit& fit, ParityResidual& out) {
  const RelationSpectra& spectra = fit.spectra();
  const double duration = 0.5 * thresholds::parity_block * (spectra.blocks + 1.0);
  Bands above{};
  double significant_power = 0.0, significant_noise = 0.0;
  for (std::size_t b = 0; b < above.size(); ++b) {
    double power = 0.0, noise = 0.0, width = 0.0;
    for_each_line(spectra, b, [&](std::size_t k, double) {
      power += fit.power(k);
      noise += spectra.noise[k];
      width += spectra.resolution;
    });
    if (!(noise > 0.0)) continue;
    out.excess[b] = power / noise - 1.0;
    const double z = out.excess[b] * std::sqrt(duration * width);
    out.significance = std::max(out.significance, z);
    if (z < thresholds::parity_significance) continue;
    above[b] = out.excess[b] * width;
    significant_power += power;
    significant_noise += noise;
  }
  if (significant_noise > 0.0) out.ratio = significant_power / significant_noise;
  set_band(above, out);
}

/// Per unit of power at an origin: the power of the relation's residual, band by band, in units of its noise.
class OriginGain {
 public:
  OriginGain(const firmware::RigDescription& description, const firmware::Recording& recording,
             const ParityRelation& relation, const RelationSpectra& spectra, const SmoothWindow& window)
      : relation_(relation), spectra_(spectra), window_(window), period_(recording.sample_period) {
    if (!relation.deflection) return;
    for (const Term& t : *relation.deflection) {
      const bool computed = t.channel == model::Channel::x_cmd;
      const double noise = computed ? 0.0 : sensor_noise(description, recording, t.channel);
      deflection_noise_ += std::pow(t.factor * noise, 2);
    }
  }

  [[nodiscard]] double in_band(const FaultOrigin& origin, std::size_t band) const {
    double power = 0.0, noise = 0.0;
    for_each_line(spectra_, band, [&](std::size_t k, double f) {
      noise += spectra_.noise[k];
      power += at_line(origin, k, f);
    });
    return noise > 0.0 ? power / noise : 0.0;
  }

 private:
  [[nodiscard]] double at_line(const FaultOrigin& origin, std::size_t line, double f) const {
    if (!origin.sensor) return std::norm(window_.gain(0, f));
    std::complex<double> gain;
    for (const Term& t : relation_.sum) {
      if (t.channel == *origin.sensor) gain += t.factor * window_.gain(t.order, f);
    }
    double power = std::norm(gain);
    if (!relation_.deflection || !(deflection_noise_ > 0.0)) return power;
    for (const Term& t : *relation_.deflection) {
      if (t.channel != *origin.sensor) continue;
      power += t.factor * t.factor * spectra_.noise_of_component[line] / (2.0 * period_ * deflection_noise_);
    }
    return power;
  }

  const ParityRelation& relation_;
  const RelationSpectra& spectra_;
  const SmoothWindow& window_;
  double period_;
  double deflection_noise_ = 0.0;  ///< variance
};

ParityResidual check(const firmware::RigDescription& description, const std::vector<firmware::Recording>& recordings,
                     const SmoothWindow& window, const ParityRelation& relation, double highest) {
  ParityResidual out;
  out.relation = relation.words;
  const RelationFit fit(description, recordings, window, relation, highest);
  if (!fit.has_data()) return out;
  compare_with_noise(fit, out);
  const OriginGain gain(description, recordings.front(), relation, fit.spectra(), window);
  for (const FaultOrigin& origin : relation.origins) {
    const bool known = std::any_of(out.locations.begin(), out.locations.end(),
                                   [&](const auto& location) { return location.place == origin.place; });
    if (known) continue;
    ParityResidual::FaultLocation location{origin.place, {}};
    for (std::size_t b = 0; b < ParityResidual::bands; ++b) location.gain[b] = gain.in_band(origin, b);
    out.locations.push_back(std::move(location));
  }
  if (out.significant()) out.description = describe_residual(relation.motion, fit.residual(), recordings, window);
  return out;
}

/// True if the parity relations are valid for a rig with these described effects and laws.
bool relations_hold_for(const model::RigParameters<double>& rig) {
  if (rig.laws.any() || rig.has_extensions()) return false;
  const auto effects = firmware::effects_of(rig);
  return std::all_of(effects.begin(), effects.end(), [](const firmware::PlacedEffect& effect) {
    const auto subsystem = effect.entry->subsystem;
    const bool has_relations = subsystem == model::Subsystem::suspension || subsystem == model::Subsystem::fdva ||
                               subsystem == model::Subsystem::machine;
    return has_relations && effect.entry->corner != model::Corner::sticking && !effect.entry->remembers;
  });
}

}  // namespace

std::vector<ParityResidual> parity_residuals(const firmware::RigDescription& description,
                                             const std::vector<PreparedRecording>& recordings) {
  if (!relations_hold_for(description.rig)) return {};
  std::vector<firmware::Recording> parts;  // copies of two minutes at most, made once, of one rate
  firmware::RigDescription known = description;
  double highest = thresholds::parity_band_edges.back();
  for (const PreparedRecording& r : recordings) {
    const double period = r.recording.sample_period;
    if (!parts.empty() && std::abs(period - parts.front().sample_period) > 1e-6 * period) continue;
    const auto most = static_cast<std::size_t>(thresholds::parity_length / r.recording.sample_period);
    const Window window{r.fitted.from, std::min(r.fitted.to, r.fitted.from + most)};
    if (r.fitted.size() == 0) continue;
    parts.push_back(cut(r.recording, window));
    // White at every sample, with the density of the noise of those that were recorded.
    for (std::size_t c = 0; c < r.noise.size() && parts.size() == 1; ++c) {
      if (r.noise[c] > 0.0) known.noise[c] = r.noise[c] * std::sqrt(static_cast<double>(r.step));
    }
    highest = std::min(highest, thresholds::recorded_share_of_rate / r.compared_period());
  }
  if (parts.empty()) return {};
  const SmoothWindow window(parts.front().sample_period);
  std::vector<ParityResidual> list;
  for (const ParityRelation& relation : parity_relations(description.rig, parts.front())) {
    list.push_back(check(known, parts, window, relation, highest));
  }
  return list;
}

}  // namespace host_sim::identification
