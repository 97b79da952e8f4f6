// Recordings as MATLAB files, by matio: vectors in the names of the contract, and structures of other programs.
#include "host_sim/recording_files/recording_mat.hpp"

#include <matio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "firmware/recording/sample_checks.hpp"
#include "host_sim/recording_files/binary/hdf5_leaves.hpp"
#include "host_sim/recording_files/binary/leaf_table.hpp"
#include "host_sim/recording_files/binary/matlab_leaves.hpp"

namespace host_sim {
namespace {

struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;
struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
using MatFile = std::unique_ptr<mat_t, CloseFile>;

std::string header_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(116, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

// A name of a MATLAB variable: letters, digits and underscores, up to 48 of them, a letter first.
std::string variable_name(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0U) == 0x80U) continue;  // the rest of a letter in UTF-8
    result += std::isalnum(byte) != 0 ? c : '_';
  }
  if (result.empty() || std::isalpha(static_cast<unsigned char>(result.front())) == 0) result.insert(0, "x");
  return result.substr(0, 48);
}

// A name of up to four letters stands in its tag, a longer one behind it, filled up to eight bytes.
std::uint64_t bytes_of_name(std::string_view name) { return name.size() <= 4 ? 0 : (name.size() + 7) / 8 * 8; }

bool is_hdf5_of_matlab(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(8, '\0');
  return file.seekg(512) && file.read(bytes.data(), 8) && bytes == "\x89HDF\r\n\x1a\n";
}

// "/S/force" of HDF5 is "S.force" of MATLAB; its attributes are none of the user's.
std::vector<Leaf> matlab_paths(std::vector<Leaf> leaves) {
  std::erase_if(
      leaves, [](const Leaf& leaf) { return leaf.path.find('@') != std::string::npos || leaf.path.starts_with("/#"); });
  for (Leaf& leaf : leaves) {
    if (leaf.path.starts_with('/')) leaf.path.erase(0, 1);
    std::replace(leaf.path.begin(), leaf.path.end(), '/', '.');
  }
  return leaves;
}

std::string_view after_dot(std::string_view name) {
  const std::size_t dot = name.find('.');
  return dot == std::string_view::npos ? name : name.substr(dot + 1);
}

// Fields of a structure stand for themselves in a file whose time is in one: a structure beside a vector t is something
// else, and then only "structure.field" in the map finds its fields.
void read_names(std::vector<firmware::Heading>& headings, const firmware::ChannelMap& map) {
  const auto mapped = map.find("t");
  const std::string_view time = mapped == map.end() ? "t" : std::string_view(mapped->second.column);
  for (const firmware::Heading& heading : headings) {
    if (heading.text == time || heading.text == "t") return;
  }
  for (firmware::Heading& heading : headings) heading.name = after_dot(heading.text);
}

bool is_top_level(const Leaf& leaf) {
  return std::count(leaf.path.begin(), leaf.path.end(), '.') <= 1 && leaf.path.find_first_of("({") == std::string::npos;
}

std::vector<firmware::Heading> headings_of(const std::vector<Leaf>& leaves, const firmware::ChannelMap& map) {
  std::vector<firmware::Heading> headings;
  for (const Leaf& leaf : leaves) headings.push_back({leaf.path, leaf.path, std::nullopt});
  read_names(headings, map);
  return headings;
}

}  // namespace

std::vector<Leaf> read_mat_leaves(const std::filesystem::path& path) {
  std::vector<Leaf> leaves;
  try {
    leaves = read_matlab_leaves(path);
  } catch (const firmware::InputError&) {
    // matio refuses files of version 7.3 that other libraries than MATLAB's wrote (h5py pads texts differently).
    if (!is_hdf5_of_matlab(path)) throw;
    leaves = matlab_paths(read_hdf5_leaves(path));
    if (leaves.empty()) throw;
  }
  if (leaves.empty()) {
    throw firmware::InputError(path.string(), 0, "no variable can be read",
                               "a whole MATLAB 5 or 7.3 file with a vector t");
  }
  return leaves;
}

bool is_contract_mat(const std::filesystem::path& path, const std::vector<Leaf>& leaves,
                     const firmware::ChannelMap& map) {
  if (header_text(path).find(firmware::recording_mark) != std::string::npos) return true;
  std::vector<Leaf> top;
  for (const Leaf& leaf : leaves) {
    if (is_top_level(leaf)) top.push_back({leaf.path});
  }
  try {
    static_cast<void>(firmware::find_targets(headings_of(top, map), map, path.string(), 0));
    return true;
  } catch (const firmware::InputError&) {
    return false;
  }
}

RawTable table_of_mat(const std::filesystem::path& path, const std::vector<Leaf>& leaves) {
  std::optional<RawTable> table = table_of_leaves(leaves, '.', path.string(), "MATLAB");
  if (!table) {
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(leaves.size(), 12); ++i)
      list += (list.empty() ? "" : ", ") + leaves[i].path;
    throw firmware::InputError(path.string(), 0, "there is no column t, and no vector of numbers: " + list,
                               "a first column t, in seconds");
  }
  return std::move(*table);
}

firmware::Recording read_recording_mat(const std::filesystem::path& path, std::vector<Leaf> variables,
                                       const firmware::ChannelMap& map, std::optional<double> expected_rate,
                                       firmware::Missing missing) {
  firmware::Recording recording;
  recording.source = path.string();
  const std::string& source = recording.source;
  std::erase_if(variables, [](const Leaf& leaf) { return !is_top_level(leaf); });

  const bool own = header_text(path).find(firmware::recording_mark) != std::string::npos;
  const firmware::ChannelMap in_force = own ? firmware::ChannelMap{} : map;
  const std::vector<firmware::Heading> headings = headings_of(variables, in_force);
  const std::vector<std::optional<firmware::Target>> targets = firmware::find_targets(headings, in_force, source, 0);
  const firmware::RecordingLocation location{source};
  for (std::size_t i = 0; i < variables.size(); ++i) {
    Leaf& variable = variables[i];
    if (!targets[i]) {
      if (own && variable.kind == LeafKind::text) continue;  // the name or unit of a column
      recording.ignored_columns.push_back(variable.path);
      continue;
    }
    constexpr std::string_view numbers = "a vector of real numbers";
    if (variable.kind == LeafKind::complex)
      throw firmware::InputError(source, 0, variable.path + " is complex", numbers);
    if (variable.kind != LeafKind::numbers) {
      throw firmware::InputError(source, 0, variable.path + " is not numeric", numbers);
    }
    if (!variable.is_vector()) throw firmware::InputError(source, 0, variable.path + " is not a vector", numbers);
    std::vector<double>& column = values(recording, targets[i]->quantity);
    column = std::move(variable.numbers);
    for (std::size_t k = 0; k < column.size(); ++k) {
      column[k] = targets[i]->value(column[k]);
      const bool lost = missing == firmware::Missing::mark && std::isnan(column[k]) &&
                        targets[i]->quantity != firmware::time_quantity;
      if (lost && targets[i]->quantity < firmware::first_duct) continue;
      if (const firmware::Objection objection = firmware::object_to(targets[i]->quantity, column[k])) {
        throw location.error(k, objection.wrong, objection.expected);
      }
    }
  }
  for (firmware::Quantity q = 1; q < firmware::quantity_count; ++q) {
    const std::size_t size = values(recording, q).size();
    if (size == 0 || size == recording.size()) continue;
    throw firmware::InputError(source, 0,
                               std::string(firmware::quantity_name(q)) + " has " + std::to_string(size) + " samples",
                               std::to_string(recording.size()) + " as in t");
  }
  if (missing == firmware::Missing::mark) {
    expected_rate = firmware::rate_if_usual(recording.time, firmware::StampRounding{}, expected_rate);
    fill_gaps(recording, {}, location, expected_rate, missing);
  }
  firmware::check_time(recording, firmware::StampRounding{}, location, expected_rate);
  return recording;
}

void write_recording_mat(const std::filesystem::path& path, const firmware::Recording& recording) {
  firmware::OutputFile output(path);
  if (std::filesystem::exists(output.temporary()) && !std::filesystem::is_regular_file(output.temporary())) {
    throw firmware::OutputError(path.string(), "a MATLAB file cannot be written there", "a regular file");
  }
  const auto require = [&](bool done) {
    if (!done) throw firmware::OutputError(path.string(), "cannot be written", "room for the whole file");
  };
  const std::string header = "MATLAB 5.0 MAT-file, " + std::string(firmware::recording_mark);
  MatFile file(Mat_CreateVer(output.temporary().c_str(), header.c_str(), MAT_FT_MAT5));
  require(file != nullptr);

  std::vector<std::uint64_t> least;  // bytes of the numbers and letters of each variable
  const auto write = [&](std::string_view name, const std::vector<double>& numbers) {
    std::array<std::size_t, 2> shape{numbers.size(), 1};
    std::vector<double> data = numbers;  // matio does not promise to leave them alone
    const Variable variable(Mat_VarCreate(std::string(name).c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(),
                                          data.data(), MAT_F_DONT_COPY_DATA));
    require(variable != nullptr && Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) == 0);
    least.push_back(8 * numbers.size() + bytes_of_name(name));
  };
  const auto write_text = [&](const std::string& name, const std::string& text) {
    std::array<std::size_t, 2> shape{1, text.size()};
    std::string data = text;
    const Variable variable(
        Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, shape.data(), data.data(), MAT_F_DONT_COPY_DATA));
    require(variable != nullptr && Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) == 0);
    least.push_back((text.size() <= 4 ? 0 : text.size()) + bytes_of_name(name));
  };
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    if (!values(recording, q).empty()) write(firmware::quantity_name(q), values(recording, q));
  }
  // A variable's name has letters, digits and underscores; the name and unit that a column had stand beside it.
  std::set<std::string> used;
  for (const firmware::ExtraColumn& extra : recording.extra) {
    std::string name = variable_name(extra.name);
    while (!used.insert(name).second) name += "_";
    write(name, extra.values);
    if (name != extra.name) write_text(name + "_name", extra.name);
    if (!extra.unit.empty()) write_text(name + "_unit", extra.unit);
  }

  // matio does not report a failed write, and then notes the size that it has reached: an element is too small for its
  // numbers behind flags, shape and tags of 8 + 16 + 16 + 8 + 8 bytes.
  require(Mat_Close(file.release()) == 0);
  constexpr std::uint64_t around = 56;
  const std::vector<std::uint64_t> sizes = matlab_element_sizes(output.temporary());
  require(std::equal(sizes.begin(), sizes.end(), least.begin(), least.end(),
                     [](std::uint64_t size, std::uint64_t bytes) { return size >= bytes + around; }));
  output.commit();
}

}  // namespace host_sim
