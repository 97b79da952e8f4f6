// The columns of a measurement file under the names and units of the program that wrote it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace host_sim {

/// One column; NaN where the file holds no number.
struct RawColumn {
  std::string name;              ///< as in the file, without the unit
  std::string text{};            ///< heading as in the file: what [channels] may name too
  std::string unit{};            ///< as in the file; empty: not stated
  std::vector<double> values{};  ///< in the unit of the file; time of day and dates: seconds from the first stamp's day
  bool is_clock = false;         ///< values were read from a date or a time of day
  std::vector<double> own_time{};  ///< [s] time stamps of a column with a rate of its own; empty: those of the table
  std::string own_time_name{};     ///< the column or property that own_time was read from
  std::string group{};             ///< of the file, in which the name is unique; empty: none
  bool is_slow = false;            ///< most cells are empty: a channel with fewer samples than there are rows
  int decimals = 17;               ///< most decimals printed in a text file
  int significant_digits = 17;     ///< most significant digits printed
};

/// A value that the file should hold and does not.
struct RawFault {
  std::size_t line;           ///< in the file; 0 where it has no lines
  std::string wrong;          ///< "'Weg' is 'off'"
  std::string expected;       ///< "a number"
  bool says_missing = false;  ///< a word such as NaN or n/a, which a program writes on purpose
};

/// Something of the file that is in no column.
struct LeftOut {
  std::string name;
  std::string reason;  ///< "complex numbers", "150 values, the time has 200"
};

/// A measurement file as columns.
struct RawTable {
  std::string source;                ///< file name as given by the user
  std::string format;                ///< "text, columns separated by ';', decimal ','"
  std::vector<RawColumn> columns;    ///< of one length, except those with own_time
  std::optional<double> rate{};      ///< [Hz] as the file states it beside the columns
  std::string rate_text{};           ///< where: "Sampling Interval: 0.001"
  std::string rate_conflict{};       ///< two rates that it states and that differ; empty: none
  std::vector<std::size_t> lines{};  ///< line of each row; empty: the file has no lines
  std::size_t header_line = 0;
  std::vector<std::string> notes{};  ///< what was skipped, in words
  std::vector<RawFault> faults{};    ///< in the order of the file
  std::vector<LeftOut> left_out{};   ///< in the order of the file
  std::size_t rows = 0;              ///< length of the columns without own_time
};

/// "group/name" where the name alone is not unique in the table, else the heading: what [channels] and --map name.
[[nodiscard]] std::string unique_name(const RawTable& table, std::size_t column);

}  // namespace host_sim
