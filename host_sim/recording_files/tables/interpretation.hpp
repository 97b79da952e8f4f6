// Which column of a foreign file holds which quantity, in which unit, and why.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"
#include "model/channel.hpp"

namespace host_sim {

/// What is known of the rig when a file is read.
struct RigContext {
  const firmware::ChannelMap& channels;       ///< the rig description's [channels]
  std::optional<double> rate = std::nullopt;  ///< [Hz] of the rig
  std::optional<model::RigKind> kind = std::nullopt;
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
};

/// Finds time and channels, in this order: entries of [channels] (by heading, name or name without unit), the
/// quantities' own names, guesses (channel_guess.hpp). Units are converted; a column without one is taken as SI, except
/// displacements that move more than 2 m, which are taken as mm (no rig here has such a travel; a road may, and then
/// needs its unit). Of two columns that look alike none is used, and a note says so.
///
/// The unit of time, where it is not stated, is the one that gives the rig's rate; else s for steps below 0.5, ms below
/// 100, µs above (rigs run at 2 Hz … 2 kHz). InputError: no time, no channel, a unit of the wrong dimension.
[[nodiscard]] Interpretation interpret(const RawTable& table, const RigContext& rig);

/// The entries of [channels] that make other commands read the file the same way without guessing. Clocks and sample
/// numbers have none.
[[nodiscard]] firmware::ChannelMap channel_map_of(const RawTable& table, const Interpretation& interpretation);

}  // namespace host_sim
