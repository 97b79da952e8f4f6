// The tables [air_spring] and [lever], and the delay that varies of [machine].
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "firmware/description/table/rig_description_table.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// A number of [air_spring] that may be left out.
struct AirSpringKey {
  std::string_view key;
  double model::AirSpringParameters<double, true>::*value;
  bool tolerable;  ///< a property of the rig; else a setting
  std::string_view unit;
};

/// All of them, in the order of the README.
[[nodiscard]] std::span<const AirSpringKey> air_spring_keys();

/// Reads [air_spring] and [lever], where they are. Values are checked later, by find_rig_fault().
void read_air_spring(DescriptionTable& top, model::RigParameters<double>& rig);
void read_lever(DescriptionTable& top, model::RigParameters<double>& rig);
/// Reads delay_swing, delay_swing_time and delay_jitter of [machine].
void read_delay_variation(DescriptionTable& machine, model::RigParameters<double>& rig);

/// InputError where the air spring carries less or more than the body weighs, and no other spring helps it.
void check_load(DescriptionTable& top, const model::RigParameters<double>& rig);

/// InputError for a tolerance of the virtual car behind a lever: `diagnose` estimates such a car from F alone, and F
/// acts on it times a ratio.
void check_lever_tolerances(DescriptionTable& top, const model::RigParameters<double>& rig,
                            const std::map<std::string, double>& tolerance);

/// A key of a table with its value as text.
struct TableLine {
  std::string table, key, value;
};

/// The lines of all three that are not parameter paths; none of what a rig does not have.
[[nodiscard]] std::vector<TableLine> extension_lines(const model::RigParameters<double>& rig);

}  // namespace firmware
