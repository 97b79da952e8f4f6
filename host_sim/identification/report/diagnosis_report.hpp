// A diagnosis as a page, a sentence and a rig description.
#pragma once

#include <string>
#include <string_view>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/common/wording.hpp"

namespace host_sim::identification {

/// A fault of the recording in words: "noise_level of zdd_b: factor 2.1 (2.0 … 2.2)".
[[nodiscard]] std::string words(const RecordingFault& fault);

/// The verdict in one sentence.
[[nodiscard]] std::string sentence(const Diagnosis& diagnosis);

/// "34.5 to 1", "1 to 2" where the rival fits better, "over a million to 1": larger odds are not known, since they
/// assume that the noise is exactly as estimated.
[[nodiscard]] std::string odds_text(double odds);

/// "sensor_lag of F", "suspension.stiffness of 27653"
[[nodiscard]] std::string words(const Alternative& other);

/// The unit of an effect's parameter, that of its channel filled in; nothing for a pure number.
[[nodiscard]] std::string unit_of(const firmware::PlacedEffect& effect, std::size_t parameter);

/// report.html: verdict, prediction errors, effects and rivals, locations, parameters, curves, the rig description.
[[nodiscard]] std::string report_html(const Diagnosis& diagnosis, const firmware::RigDescription& given);

/// What an effect is, its equation, how it shows: for --explain.
[[nodiscard]] std::string explanation(const firmware::CatalogueEntry& entry);

/// How the first line of rig.toml begins: a file that begins otherwise is not ours to replace.
inline constexpr std::string_view result_rig_mark = "# rigtwin diagnose";

/// rig.toml: the description with the effects that were found and the refitted parameters, for every other command, in
/// the words of the description that was given (edited_rig.hpp). `name`: its file name.
[[nodiscard]] std::string result_rig(const firmware::RigDescription& found, const firmware::RigDescription& given,
                                     std::string_view name);

}  // namespace host_sim::identification
