// The contents of an HDF5 file, through the HDF5 library.
#pragma once

#include <filesystem>
#include <vector>

#include "host_sim/recording_files/binary/isolated_reader.hpp"

namespace host_sim {

/// Every data set of an HDF5 file: "/group/name" as numbers (in column order) or text, members of compound types as
/// "/group/name/member"; attributes as "/group/name@attribute", lists of texts one a line. Scaling that
/// netCDF stores beside a variable (scale_factor, add_offset, _FillValue) is applied. In a child process.
[[nodiscard]] std::vector<Leaf> read_hdf5_leaves(const std::filesystem::path& file);

}  // namespace host_sim
