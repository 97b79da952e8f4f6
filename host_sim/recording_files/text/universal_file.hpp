// Time histories of universal files (SDRC I-DEAS).
#pragma once

#include <string_view>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// Whether a file begins as a universal file does: a line −1, then the number of a dataset.
[[nodiscard]] bool is_universal_file(std::string_view head);

/// The functions of all datasets 58 and 58b (ASCII and binary) whose abscissa is the time, as columns. Real values,
/// single or double precision, evenly or unevenly spaced (records: export/universal_records.hpp). Other datasets and
/// functions are passed over and noted.
///
///   name   ID line 1 where it begins with record 6's response; else that response with node and direction; else ID
///          line 1; several equal names are numbered
///   unit   the ordinate's unit; where it is NONE, by its specific data type and the lengths and forces of dataset 164
///   time   [s] even spacing: the whole rate in Hz that the six digits of the increment stand for, if there is one
///
/// InputError: a dataset that is cut off or not as described, no time history.
/// Source: SDRC I-DEAS universal dataset 58, revision of 30 June 1999, 58b and 164.
[[nodiscard]] RawTable table_of_universal_file(std::string_view bytes, std::string_view source);

}  // namespace host_sim
