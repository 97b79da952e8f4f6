// Advice on the columns of a recording that are no channel.
#pragma once

#include <string>

#include "firmware/recording/recording.hpp"

namespace firmware {

/// "; columns that are no channel: Fz, Temp 3; under [channels] F = { column = "Fz" } takes one". Empty
/// where every column is one. At most four are named.
[[nodiscard]] std::string unread_columns(const Recording& recording, model::Channel wanted);

}  // namespace firmware
