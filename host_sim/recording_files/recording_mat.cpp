// Recordings as MATLAB files, by matio: vectors in the names of the contract, and structures of other programs.
#include "host_sim/recording_files/recording_mat.hpp"

#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
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
  std::vector<Leaf> leaves = read_matlab_leaves(path);
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
    throw firmware::InputError(path.string(), 0, "there is no column t", "a first column t, in seconds");
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

  std::uintmax_t size = 128;
  const auto write = [&](std::string_view name, const std::vector<double>& numbers) {
    std::array<std::size_t, 2> shape{numbers.size(), 1};
    std::vector<double> data = numbers;  // matio does not promise to leave them alone
    const Variable variable(Mat_VarCreate(std::string(name).c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(),
                                          data.data(), MAT_F_DONT_COPY_DATA));
    require(variable != nullptr && Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) == 0);
    // Tags of the element and the numbers, flags, shape; the name with its tag, in one if it is short; the numbers.
    size += 8 + 8 + 16 + 16 + (name.size() <= 4 ? 8 : 8 + (name.size() + 7) / 8 * 8) + 8 * numbers.size();
  };
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    if (!values(recording, q).empty()) write(firmware::quantity_name(q), values(recording, q));
  }
  for (const firmware::ExtraColumn& extra : recording.extra) write(extra.name, extra.values);

  // matio does not report a failed write; the file size shows it.
  require(Mat_Close(file.release()) == 0);
  require(std::filesystem::file_size(output.temporary()) == size);
  output.commit();
}

}  // namespace host_sim
