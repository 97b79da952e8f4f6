// No heap in the loop: counted where it is taken.
#pragma once

#include <cstdint>

namespace firmware::controller {

/// From now on, or no longer, every allocation of this thread breaks the seal.
void seal_heap(bool sealed);

/// How often this thread took or gave heap while it was sealed.
[[nodiscard]] std::uint64_t broken_seals();

}  // namespace firmware::controller
