// The arrays of a MATLAB or HDF5 file as a table: finds the time axes and the signals that belong to them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/recording_files/binary/isolated_reader.hpp"
#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// A table from the leaves of a file, by the first of these structures that it holds:
///
///   dSPACE ControlDesk   S.X(i).Data, S.Y(j).Name, .Data, .Unit; the axis of Y(j) is X(Y(j).XIndex), else the one of
///                        its raster, else the one of its length
///   Simulink             S.time, S.signals(j).values, .label
///   time series          S.Time, S.Data, S.Name, S.DataInfo.Units, for each signal S
///   timetable, vectors   a time vector (Time, t, Zeit, tout …) and vectors or matrices of its length in the same
///                        structure or group; units from Properties.VariableUnits, an attribute unit or units, or the
///                        name
///   rate                 vectors of one length and a rate (fs, Ts, SampleRate, wf_increment …) as number or attribute
///
/// Signals with different time axes keep their own (RawColumn::own_time). nullopt: none of these.
/// `separator`: '.' in MATLAB paths, '/' in HDF5 paths.
[[nodiscard]] std::optional<RawTable> table_of_leaves(const std::vector<Leaf>& leaves, char separator,
                                                      std::string_view source, std::string_view format);

}  // namespace host_sim
