// Late periods and lost samples of a recording that rig_controller wrote.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "firmware/recording/sample_checks.hpp"

namespace firmware {

/// Moves the rows of a controller's recording onto the equally spaced grid that all analyses use.
///
/// After a late period the controller shifts its grid; the column `late` holds the shift. A step in time is therefore
/// n T, or n T + late of the row that ends it, with n ≥ 1 (n − 1 rows were lost before they reached the disk).
///
///   a step of s   becomes round(s/T) steps of T. Missing rows are interpolated linearly, ducts keep their position.
///                 The remaining shift, below T/2 per step, moves all later samples together; it does not matter to
///                 time-invariant equations.
///   NaN           a missing sample: interpolated linearly as well
///
/// Such rows are marked in Recording::filled and no analysis uses them. Recording::remark holds their number and the
/// lateness. Gaps above 20 ms are refused: 20 ms is a quarter of a period at a wheel resonance of 12 Hz, the limit of
/// linear interpolation there.
///
/// InputErrors: a step that `late` does not explain, a gap beyond 20 ms, more rows missing than recorded. Times that do
/// not rise are left to check_time().
void fill_gaps(Recording& recording, const std::vector<double>& late, const RecordingLocation& location,
               std::optional<double> expected_rate);

}  // namespace firmware
