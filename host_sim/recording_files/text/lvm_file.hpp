// LabVIEW measurement files (.lvm).
#pragma once

#include <string_view>
#include <vector>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// Whether the first line is that of a LabVIEW measurement file.
[[nodiscard]] bool is_lvm(const std::vector<std::string_view>& lines);

/// The channels of all segments. The head of the file names separator and decimal sign; every segment has a head of its
/// own (Channels, Samples, Date, Time, Y_Unit_Label, X0, Delta_X) with one value above each channel.
///
///   time   the X_Value column before a channel (X_Columns One: one for all; Multi: one each); with X_Columns No
///          X0 + k Delta_X
///   later segments whose time begins anew are shifted by their Date and Time against those of the first segment
///
/// Special blocks and comments are passed over. InputError: no segment, no numbers.
/// Source: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)", 2023.
[[nodiscard]] RawTable read_lvm(const std::vector<std::string_view>& lines, std::string_view source);

}  // namespace host_sim
