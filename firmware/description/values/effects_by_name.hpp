// The catalogue of effects, by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/components/channel.hpp"
#include "model/effects/effect.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// An effect of model/effects/catalogue.hpp without its C++ type.
struct CatalogueEntry {
  std::string_view name;
  model::Subsystem subsystem;
  model::RigKinds rigs;
  bool needs_fdva;
  bool needs_air_spring;
  std::span<const model::EffectParameter> parameters;
  std::string_view equation;
  std::string_view shows;
  model::Linearisation linearisation;
  model::Corner corner;
  std::string_view contains;  ///< an effect whose place this one takes
  bool imitates;              ///< named only where it leaves nothing but noise
  model::ForceForm force;     ///< the form of its force, where that is a curve
  model::Lateness lateness;   ///< how it makes late what it acts on
  model::Words words;         ///< what it does, with its numbers
  bool remembers;             ///< a force that depends on how the deflection went
  bool of_channel;            ///< a sensor effect: it needs the name of a channel
  /// For a tyre law with these values: F_w from the force of the laws before it, dz_w and the static load. nullptr if
  /// the effect is not a tyre law.
  double (*tyre_force)(std::span<const double> values, double force, double deflection, double static_load);
};

/// All effects, in the order of model/effects/catalogue.hpp.
[[nodiscard]] std::span<const CatalogueEntry> catalogue();

/// nullptr if there is no effect of that name.
[[nodiscard]] const CatalogueEntry* find_effect(std::string_view name);

/// The first effect whose card is so; nullptr if none is.
template <class Predicate>
[[nodiscard]] const CatalogueEntry* find_effect_that(const Predicate& is_so) {
  for (const CatalogueEntry& entry : catalogue()) {
    if (is_so(entry)) return &entry;
  }
  return nullptr;
}

/// An effect in a rig. `channel`: of a sensor effect. `values`: in the order of the entry's parameters [SI].
struct PlacedEffect {
  const CatalogueEntry* entry = nullptr;
  std::optional<model::Channel> channel{};
  std::vector<double> values{};
};

/// The active effects of a rig, in the order of the list.
[[nodiscard]] std::vector<PlacedEffect> effects_of(const model::RigParameters<double>& rig);

/// "effects.sensor_lag.F.time_constant"
[[nodiscard]] std::string effect_path(const PlacedEffect& effect, std::size_t parameter);

/// Activates an effect in a rig with these values.
void put_effect(model::RigParameters<double>& rig, const PlacedEffect& effect);

/// Deactivates an effect.
void remove_effect(model::RigParameters<double>& rig, const CatalogueEntry& entry,
                   std::optional<model::Channel> channel);

/// Whether an effect has a place on this rig: its kind, an FDVA where it needs one, a sensor of that channel.
[[nodiscard]] bool has_place(const model::RigParameters<double>& rig, const CatalogueEntry& entry,
                             std::optional<model::Channel> channel);

}  // namespace firmware
