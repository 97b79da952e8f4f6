// A rig description with other values, in the words of the user's own file.
#pragma once

#include <string>

#include "firmware/description/rig_description.hpp"

namespace host_sim::identification {

/// The text of `given` with the values of `found`: comments, order and spelling stay; numbers that changed are replaced
/// where they stand, tables that are new (effects, laws) follow at the end, a law's file becomes the
/// points in it. Reads back as `found`, bit for bit. Where
/// that is not possible – an inline table, a value that stood in no line – the complete description takes its place
/// (firmware::format_rig), which holds every table with its defaults and no comments.
[[nodiscard]] std::string edited_rig(const firmware::RigDescription& given, const firmware::RigDescription& found);

}  // namespace host_sim::identification
