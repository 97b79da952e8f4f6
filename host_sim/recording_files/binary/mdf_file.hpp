// MDF 4 measurement files (.mf4) by the published layout of ASAM.
#pragma once

#include <string_view>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// Whether a file begins as one of MDF does, of any version.
[[nodiscard]] bool is_mdf(std::string_view head);

/// The channels of all channel groups, each group with its own master: sorted and unsorted data; data in one block or
/// in lists (DL, HL, LD), compressed or not (DZ, with and without transposition); columns (DV) with their invalidation
/// bits (DI); conversions:
///
///   1:1, linear  y = P₁ + P₂ x    rational  y = (P₁x² + P₂x + P₃) ÷ (P₄x² + P₅x + P₆)    table with and without
///   interpolation    ranges of values
///
/// A value whose invalidation bit is set is NaN. Listed as left out: texts, byte arrays, arrays, conversions to text or
/// by formulas, groups without a time. InputError: MDF 3, a file that is damaged or was not finished, no channel with
/// numbers. Source: ASAM MDF 4.2.0, "Measurement Data Format", 2019.
[[nodiscard]] RawTable table_of_mdf(std::string_view bytes, std::string_view source);

}  // namespace host_sim
