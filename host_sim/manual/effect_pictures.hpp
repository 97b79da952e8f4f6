// What each effect of the catalogue does to each channel: simulated with and without it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"

namespace host_sim::manual {

/// One channel of a rig without and with an effect.
struct ChannelPicture {
  model::Channel channel{};
  double change = 0.0;                    ///< rms(with − without) ÷ rms(without), of the whole run [1]
  std::vector<double> without{}, with{};  ///< a window of both
};

/// An effect on a rig.
struct EffectPicture {
  const firmware::CatalogueEntry* entry = nullptr;
  std::string rig;                         ///< file name of the description
  std::string values;                      ///< "coulomb_friction: force = 44.3 N"
  double window = 0.0;                     ///< length of the curves [s]
  std::vector<ChannelPicture> channels{};  ///< that the rig records, in the order of model::channel_names
  /// The force on the shipped bench with the same values, where the effect has a place there: the law itself.
  std::optional<ChannelPicture> on_bench{};
};

/// One picture for each effect of the catalogue, on the first of the shipped rigs where it has a place: quarter car,
/// hardware in the loop, bench, hardware in the loop with an air spring. `rigs`: folder of their descriptions, which
/// are taken without their own effects, limits and noise. Sizes are those that `rigtwin plan` calls typical. Road:
/// ISO 8608 B at 27.78 m/s, 8 s, seed 1; four times as high for an effect that changes nothing there. InputError if a
/// description is missing; std::logic_error if an effect has no place.
[[nodiscard]] std::vector<EffectPicture> effect_pictures(const std::filesystem::path& rigs);

}  // namespace host_sim::manual
