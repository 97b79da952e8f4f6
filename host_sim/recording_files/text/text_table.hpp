// Text files of measurement programs as tables.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// Told now and then which share of a long file has been read, 0 … 1.
using ReadingProgress = std::function<void(double)>;

/// Reads text of any of the encodings (text_encoding.hpp) with the layout that most of its lines have
/// (text_layout.hpp). Between the rows these lines are passed over, counted and noted: empty ones, comments, repeated
/// headers, heads of further blocks (MTS Station Manager), statistics below the table. A header with the same names in
/// another order or in other units is read as such; another table below the first is left out and listed. The decimal
/// sign is found for each column, in the whole file where its first numbers leave it open. A row that is too short, and
/// a value that is no number, is a fault with its line; the missing values are NaN. `skip`: that many lines at the
/// begin are not looked at. InputError: no table, a line longer than 1 MiB.
[[nodiscard]] RawTable read_text_table(std::string_view bytes, std::string_view source, std::size_t skip = 0,
                                       const ReadingProgress& progress = {});

}  // namespace host_sim
