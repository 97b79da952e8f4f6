// Which program this is: so that nobody takes the values of one rig for those of another.
#pragma once

#include <string>

#include "firmware/description/rig_description.hpp"

namespace firmware::controller {

/// "3f2a91c05be1.9c04d1f7a0b2c3d4@host": the first 12 digits of the SHA-256 of the description's text, 64 random bits
/// of this run, and the machine. Stands in every datagram, in each answer of the control socket and in the recording's
/// comments; no blanks, no quotes. Two programs, and two runs of one, never have the same.
[[nodiscard]] std::string new_instance(const RigDescription& rig);

}  // namespace firmware::controller
