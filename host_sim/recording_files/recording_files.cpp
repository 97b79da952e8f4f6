#include <algorithm>
#include <cctype>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/recording/recording_file.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "host_sim/recording_files/recording_mat.hpp"

namespace host_sim {
namespace {

bool is_called_mat(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".mat";
}

// What a caller hands to be written must be whole: columns of one length, as a reader will expect them.
void check_columns(const std::filesystem::path& file, const firmware::Recording& recording) {
  const auto check = [&](std::string_view column, std::size_t size) {
    if (size == recording.size()) return;
    throw std::logic_error(file.string() + ": column " + std::string(column) + " has " + std::to_string(size) +
                           " samples, t has " + std::to_string(recording.size()));
  };
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    if (!values(recording, q).empty()) check(firmware::quantity_name(q), values(recording, q).size());
  }
  for (const firmware::ExtraColumn& extra : recording.extra) check(extra.name, extra.values.size());
}

firmware::Recording read(const std::filesystem::path& file, const firmware::ChannelMap& map,
                         std::optional<double> expected_rate, firmware::Missing missing) {
  const std::string source = file.string();
  const firmware::RecordingFile opened(file);
  if (opened.is_matlab()) return read_recording_mat(file, map, expected_rate, missing);
  if (is_called_mat(file) && !opened.head().empty()) {
    throw firmware::InputError(source, 0, "is not a MATLAB 5 or 7.3 file", "one saved with -v6, -v7 or -v7.3");
  }
  return firmware::read_recording_csv(opened.descriptor(), opened.head(), source, map, expected_rate, missing);
}

}  // namespace

firmware::Recording read_recording(const std::filesystem::path& file, const firmware::ChannelMap& map,
                                   std::optional<double> expected_rate) {
  return read(file, map, expected_rate, firmware::Missing::refuse);
}

std::vector<firmware::Recording> read_parts(const std::filesystem::path& file, const firmware::ChannelMap& map,
                                            std::optional<double> usual_rate) {
  return firmware::pieces_of(read(file, map, usual_rate, firmware::Missing::mark));
}

void write_recording(const std::filesystem::path& file, const firmware::Recording& recording) {
  check_columns(file, recording);
  if (is_called_mat(file)) return write_recording_mat(file, recording);
  firmware::OutputFile output(file);
  firmware::format_recording_csv(recording, [&](std::string_view text) { output.write(text); });
  output.commit();
}

}  // namespace host_sim
