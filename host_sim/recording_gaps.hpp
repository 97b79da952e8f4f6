// Late periods and lost samples of a recording that rig_controller wrote.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/recording_columns.hpp"

namespace host_sim {

/// Puts the rows of a controller's recording onto the even grid that everybody else reads.
///
/// The controller never makes up for a late period: it moves its grid, and the column `late` says by how much. So a
/// step in time is n T, or n T + late of the row that ends it, n ≥ 1 (n − 1 rows were lost on their way to the disk).
///
///   a step of s   becomes round(s/T) steps of T; the rows in between that nobody recorded are straight lines between
///                 their neighbours, ducts as they stood before. What remains, below T/2 a step, moves all that follows
///                 alike: equations without a clock do not see it.
///   NaN           a sample that did not come: a straight line as well
///
/// Such rows are marked in Recording::filled and count for nothing; Recording::remark says how many there are and by
/// how much the rig was late. Nothing is filled over more than 20 ms: a quarter of a period at a wheel's resonance of
/// 12 Hz, beyond which a straight line says nothing.
///
/// InputErrors: a step that `late` does not explain, a gap beyond 20 ms, more rows missing than recorded. Times that do
/// not rise are left to check_time().
void fill_gaps(Recording& recording, const std::vector<double>& late, const Place& place,
               std::optional<double> expected_rate);

}  // namespace host_sim
