// Reads and checks the [laws] of a rig description.
#pragma once

#include <vector>

#include "firmware/description/laws/law_description.hpp"
#include "firmware/description/table/rig_description_table.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// Reads and checks [laws]. Files are relative to the folder of the description.
///
/// InputError, with the line: a place that this kind of rig lacks, numbers that are not finite or not ascending, fewer
/// than 2 or more than 33 points (17 a direction for a surface), no room for more laws, values that no rig reaches in
/// the given unit (the likely unit is named), a law that feeds energy although nothing says that it should; `behind` of
/// anything but a curve that nowhere falls.
[[nodiscard]] std::vector<LawDescription> read_laws(DescriptionTable& top, model::RigParameters<double>& rig);

}  // namespace firmware
