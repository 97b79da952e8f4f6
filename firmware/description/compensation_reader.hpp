// [compensation] of a rig description: reader and writer.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/values/compensation_description.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// One number of [compensation]: reader, writer and README take it from here.
struct CompensationKey {
  std::string_view key;
  double lowest, highest;
  std::string_view what;  ///< for messages: what it is and in which unit
  double& (*value)(compensation::Settings&);
};
[[nodiscard]] std::span<const CompensationKey> compensation_keys();

/// Reads [compensation], if it is there. InputError for a rig that is no hil, an unknown kind or key, a number outside
/// its bounds.
[[nodiscard]] std::optional<CompensationDescription> read_compensation(DescriptionTable& top,
                                                                       const model::RigParameters<double>& rig);

/// The keys and values of the table, as a description has them.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> compensation_lines(
    const CompensationDescription& compensation);

}  // namespace firmware
