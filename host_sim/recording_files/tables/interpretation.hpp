// Which column of a foreign file holds which quantity, in which unit, and why.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"
#include "model/components/channel.hpp"

namespace host_sim {

/// What is known of the rig when a file is read.
struct RigContext {
  const firmware::ChannelMap& channels;       ///< the rig description's [channels]
  std::optional<double> rate = std::nullopt;  ///< [Hz] of the rig
  std::optional<model::RigKind> kind = std::nullopt;
  std::optional<double> given_rate = std::nullopt;  ///< [Hz] that the user gives: rows are samples at this rate
  bool only_list = false;                           ///< no channel is needed: the file's columns are listed
};

/// One column taken as one quantity:   value in SI = scale × column + offset.
struct ColumnMeaning {
  std::size_t column;
  firmware::Quantity quantity;
  double scale = 1.0;
  double offset = 0.0;
  std::string unit;    ///< of the column; empty: SI assumed
  std::string reason;  ///< why; empty: [channels] or the quantity's own name says so
};

/// The time axis: a column, or the rate that the file states.
struct TimeMeaning {
  std::optional<std::size_t> column;  ///< nullopt: t = row / rate
  double scale = 1.0;
  double offset = 0.0;
  double rate = 0.0;    ///< [Hz] where there is no column, or it counts samples
  bool counts = false;  ///< the column counts samples
  std::string reason;
};

struct Interpretation {
  TimeMeaning time;
  std::vector<ColumnMeaning> channels;
  std::vector<std::string> notes;  ///< one line each, for the user: guesses with their reasons, what was not decided
  std::vector<std::size_t> times;  ///< columns that are a time, of all columns or of some
};

/// Finds time and channels, in this order: entries of [channels] (by heading, name or name without unit), the
/// quantities' own names, guesses (channel_guess.hpp). Units are converted; a column without one is taken as SI, except
/// displacements that move more than 2 m, which are taken as mm (no rig here has such a travel; a road may, and then
/// needs its unit). Of two columns that look alike none is used, and a note says so.
///
/// Several time columns: each governs the columns up to the next one (RawColumn::own_time of the table is filled), also
/// where one begins later than the other.
///
/// The unit of time, where it is not stated: that which gives the rig's rate or the one the file states; seconds since
/// 1970 in s, ms, µs or ns by their size; days of a spreadsheet or of MATLAB where their steps make sense as days
/// alone; else that which makes 2 Hz … 20 kHz of the steps. Where two do, it is asked for. InputError: no time, no
/// channel, a unit of the wrong dimension; the message shows `rigtwin import` with the file's own column names.
[[nodiscard]] Interpretation interpret(RawTable& table, const RigContext& rig);

/// The column that a name in [channels] or of a user means: "group/name", the heading, the name without unit, or the
/// last part of a path; nullopt: none. InputError: two are called so.
[[nodiscard]] std::optional<std::size_t> find_column(const RawTable& table, const std::string& name);

/// "'Zeit' [s], 'Weg', …": up to twelve columns, for a message.
[[nodiscard]] std::string list_of_columns(const RawTable& table);

/// The entries of [channels] that make other commands read the file the same way without guessing. Clocks and sample
/// numbers have none.
[[nodiscard]] firmware::ChannelMap channel_map_of(const RawTable& table, const Interpretation& interpretation);

}  // namespace host_sim
