// A test programme: roads one after the other, each so often, at a level, with pauses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace firmware {

/// [[blocks]] of a programme.
struct ProgrammeBlock {
  std::string road = "iso8608:B";  ///< iso8608:A … H, or a CSV file beside the programme
  double speed = 27.78;            ///< [m/s]
  double duration = 60.0;          ///< of one repetition [s]; a file may be shorter
  std::uint64_t seed = 1;          ///< of an ISO 8608 road
  double level = 1.0;              ///< scales the road about its beginning, 0 … 1.5
  int repetitions = 1;
  double pause = 0.0;  ///< the reference stands still for so long after the last repetition [s]
  std::size_t line = 0;
};

struct Programme {
  std::string source;
  std::vector<ProgrammeBlock> blocks;  ///< at least one
};

/// Reads and checks a programme. InputError with the line for every error.
[[nodiscard]] Programme read_programme(const std::filesystem::path& file);

/// The same from text; `source` stands for the file in messages.
[[nodiscard]] Programme parse_programme(std::string_view text, std::string_view source);

}  // namespace firmware
