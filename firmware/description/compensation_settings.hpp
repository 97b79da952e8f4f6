// [compensation] of a rig description: keys, reader, and the settings that follow from it and from the rig.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/compensation/compensator.hpp"

namespace firmware {

class DescriptionTable;

/// [compensation] as it was given.
struct CompensationDescription {
  std::string kind;
  std::map<std::string, double, std::less<>> numbers;             ///< key → value
  std::map<std::string, std::vector<double>, std::less<>> lists;  ///< coefficients, lowest, highest
};

/// Of the text of a description; nullopt: it has none.
[[nodiscard]] std::optional<CompensationDescription> compensation_of(const RigDescription& description);

/// key = value, as the description has them.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> compensation_lines(const RigDescription& description);

/// One number of [compensation]: reader, writer and README take it from here.
struct CompensationKey {
  std::string_view key;
  double lowest, highest;
  std::string_view what;  ///< for messages: what it is and in which unit
  double& (*value)(compensation::Settings&);
};
[[nodiscard]] std::span<const CompensationKey> compensation_keys();

/// Reads [compensation], if it is there. InputError for another kind of rig than hil, an unknown kind or key, a number
/// outside its bounds.
std::optional<CompensationDescription> read_compensation(DescriptionTable& top, model::RigKind kind);

/// Settings of the compensator; nullopt: the description has none. What is not given follows from the rig:
///
///   delay, lag, frequency, damping_ratio   of the machine's effects; the delay of the sensor of F and [delay_budget]
///                                          sensor_age and transport are added to the delay
///   damping                                (k/ω) sin ωτ at the wheel's mode, ω² = (k_t + k)/m_w, k of springs and FDVA
///   component                              [suspension] and [fdva]
///
/// InputError, at the line of the key, where the settings do not fit each other or the sample rate.
[[nodiscard]] std::optional<compensation::Settings> compensation_settings(const RigDescription& description);

/// The same with another method of the same defaults.
[[nodiscard]] compensation::Settings compensation_settings(const RigDescription& description, compensation::Kind kind);

/// A compensator for these settings, in place; empty: the description has none.
[[nodiscard]] std::optional<compensation::Compensator> make_compensator(const RigDescription& description);

/// InputError for a description with [compensation]: `command` computes with a loop without one.
void refuse_compensation(const RigDescription& description, std::string_view command);

}  // namespace firmware
