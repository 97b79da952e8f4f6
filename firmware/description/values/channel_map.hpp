// The columns of recordings that use other names, units or signs than rigtwin's own recordings.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace firmware {

/// One entry of the rig description's [channels]:   value in SI = scale × column + offset.
///
/// Without a scale the column is in the unit that its heading states, and in SI units where it states none
/// (firmware/recording/column_targets.hpp, column_scale).
struct ColumnSource {
  std::string column;             ///< the column's header text ("Road [mm]"), or the part before the unit ("Road")
  std::optional<double> scale{};  ///< [SI unit / unit of the column], not 0; nullopt: by the column's unit
  double offset = 0.0;            ///< [SI unit]
};

/// Column by quantity. The keys are "t", the names of channels and "duct_1" … "duct_6" (is_recorded_quantity()).
///
/// If a recording lacks the column of an entry, its own column with the name of the quantity is used.
using ChannelMap = std::map<std::string, ColumnSource, std::less<>>;

}  // namespace firmware
