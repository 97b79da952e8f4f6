// Where a recording keeps what, if not under the names and units of our own recordings.
#pragma once

#include <map>
#include <string>

namespace host_sim {

/// One entry of the rig description's [channels]:   value in SI = scale × column + offset.
struct ColumnSource {
  std::string column;   ///< the column's header text ("Road [mm]"), or the part before the unit ("Road")
  double scale = 1.0;   ///< [SI unit / unit of the column], not 0
  double offset = 0.0;  ///< [SI unit]
};

/// The columns that are not called like what they hold, by what they hold: "t", a channel's name, "duct_1" … "duct_6"
/// (is_recorded_quantity() in host_sim/recording.hpp tells these names from others).
///
/// An entry whose column a recording does not have leaves the recording's own column of that name in force.
using ChannelMap = std::map<std::string, ColumnSource, std::less<>>;

}  // namespace host_sim
