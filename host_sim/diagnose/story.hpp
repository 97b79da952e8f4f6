// A diagnosis told to a person.
#pragma once

#include <string>

#include "host_sim/diagnose/diagnosis.hpp"

namespace host_sim::diagnose {

/// The verdict in one sentence.
[[nodiscard]] std::string sentence(const Diagnosis& diagnosis);

/// "sensor_lag of F", "coulomb_friction"
[[nodiscard]] std::string words(const PlacedEffect& effect);

/// "34.5 to 1", "over a million to 1": more nobody can know, since it takes the noise to be what it was estimated to
/// be.
[[nodiscard]] std::string odds_text(double odds);

/// "a, b and c"
[[nodiscard]] std::string joined(const std::vector<std::string>& list);

/// The unit of an effect's parameter, that of its channel filled in; nothing for a pure number.
[[nodiscard]] std::string unit_of(const PlacedEffect& effect, std::size_t parameter);

/// report.html: the story, gaps, overlays in time and frequency, where, rivals, parameters, the rig description.
[[nodiscard]] std::string report_html(const Diagnosis& diagnosis, const RigDescription& given);

/// What an effect is, its equation, how it shows: for --explain.
[[nodiscard]] std::string explanation(const CatalogueEntry& entry);

}  // namespace host_sim::diagnose
