// The catalogue of effects, by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/channel.hpp"
#include "model/effects/effect.hpp"
#include "model/rig_parameters.hpp"

namespace host_sim {

/// An effect of model/effects/catalogue.hpp with its type forgotten.
struct CatalogueEntry {
  std::string_view name;
  model::Place place;
  model::RigKinds rigs;
  bool needs_fdva;
  std::span<const model::EffectParameter> parameters;
  std::string_view equation;
  std::string_view shows;
  bool of_channel;  ///< of a channel's sensor: names its channel
};

/// All of them, in the order of the one list.
[[nodiscard]] std::span<const CatalogueEntry> catalogue();

/// nullptr: no effect of that name.
[[nodiscard]] const CatalogueEntry* find_effect(std::string_view name);

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

/// Puts an effect into a rig, or, if it is there, gives it these values.
void put_effect(model::RigParameters<double>& rig, const PlacedEffect& effect);

/// Takes an effect out of a rig.
void remove_effect(model::RigParameters<double>& rig, const CatalogueEntry& entry,
                   std::optional<model::Channel> channel);

/// Whether an effect has a place on this rig: its kind, an FDVA where it needs one, a sensor of that channel.
[[nodiscard]] bool has_place(const model::RigParameters<double>& rig, const CatalogueEntry& entry,
                             std::optional<model::Channel> channel);

}  // namespace host_sim
