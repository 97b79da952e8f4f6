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
/// lateness. 20 ms are the longest gap that a straight line may bridge: a quarter of a period at a wheel resonance of
/// 12 Hz. `Missing` says what becomes of longer ones.
///
/// `stamp_error`: rounding of the times as printed [s].
///
/// InputErrors: a step that neither whole periods nor `late` explain; with Missing::refuse a gap beyond 20 ms, or more
/// rows missing than recorded; with Missing::mark more than 5 % of the rows missing or incomplete, or more than 10 %
/// together with those in gaps beyond 20 ms. Times that do not rise are left to check_time().
enum class Missing : unsigned char {
  refuse,  ///< a gap beyond 20 ms is an error
  mark,    ///< it is filled and marked too, for pieces_of()
};
void fill_gaps(Recording& recording, const std::vector<double>& late, const RecordingLocation& location,
               std::optional<double> expected_rate, Missing missing = Missing::refuse, double stamp_error = 0.0);

/// The parts of a recording between its gaps of more than 20 ms, each a recording that begins in motion; a recording
/// without such gaps is the only part. Parts shorter than 4 s (six periods of a body mode of 1.5 Hz, which a state at
/// the start and a spectrum need) are left out, unless none is longer. The remark of the first part says what was left
/// out.
[[nodiscard]] std::vector<Recording> pieces_of(Recording recording);

}  // namespace firmware
