// A measurement file as a recording: one time axis, SI units, channels by name.
#pragma once

#include <optional>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "host_sim/recording_files/tables/interpretation.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// The table's rows in SI units, as recorded: values that the file lacks are NaN, missing rows stay missing. Changes of
/// the time axis, each with a note:
///
///   several rates   the rig's rate if a column has it, else the fastest. Slower columns are interpolated linearly;
///                   faster ones are averaged over one period (weights of a trapezium of ± half a period).
///   uneven steps    of 0.4 … 1.6 of their mean that are no rounding of an even grid (firmware::recover_grid): the
///                   rows are interpolated linearly onto the even grid of the mean step; a longer step is a gap
///
/// `keep_others`: columns that are no channel become Recording::extra, in SI units where their unit is known.
/// InputError: time that does not rise, fewer than two rows, ducts other than 0 and 1.
///   slow channels   most cells of a column empty: interpolated linearly between the filled ones
///   coarse stamps   repeated stamps that are the rounding of an even grid: the grid
struct TableRecording {
  firmware::Recording recording;
  std::vector<std::string> notes;
  std::vector<LeftOut> left_out;  ///< columns of the table that are not in the recording
};
/// The table keeps its names and units; values are moved out of it where they stay as they are.
[[nodiscard]] TableRecording to_recording(RawTable& table, const Interpretation& meaning, const RigContext& rig,
                                          bool keep_others = false);

/// The recording of a table for an analysis, with the checks of read_recording(); the notes become its remark.
[[nodiscard]] firmware::Recording read_table_recording(RawTable table, const RigContext& rig,
                                                       firmware::Missing missing);

}  // namespace host_sim
