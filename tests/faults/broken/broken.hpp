// Which safety function is broken: for a copy of the loop made by instrument.pl.
#pragma once

#include <type_traits>

extern int rigtwin_break;  ///< number of a line of functions.txt; 0: none

[[nodiscard]] constexpr int which_is_broken() { return std::is_constant_evaluated() ? 0 : rigtwin_break; }

#define rigtwin_broken which_is_broken()
