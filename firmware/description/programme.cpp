#include "firmware/description/programme.hpp"

#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/small_text.hpp"

namespace firmware {
namespace {

constexpr int most_repetitions = 100'000;

ProgrammeBlock read_block(DescriptionTable table, const std::filesystem::path& folder) {
  ProgrammeBlock block;
  block.line = table.line();
  block.road = table.text("road");
  const bool standard = block.road.starts_with("iso8608:");
  if (!standard && std::filesystem::path(block.road).is_relative()) block.road = (folder / block.road).string();
  table.number_in("speed", block.speed, 0.01, 1000.0, "a speed in m/s");
  table.number_in("duration", block.duration, 0.01, 1e6, "the length of one repetition in s");
  table.number_in("level", block.level, 0.0, 1.5, "a factor of the road");
  table.number_in("pause", block.pause, 0.0, 1e5, "a time in s");
  if (table.has("seed")) block.seed = static_cast<std::uint64_t>(table.whole_in("seed", 0, 1'000'000'000));
  if (table.has("repetitions")) block.repetitions = table.whole_in("repetitions", 1, most_repetitions);
  table.finish();
  return block;
}

}  // namespace

Programme parse_programme(std::string_view text, std::string_view source) {
  toml::table top_table;
  try {
    top_table = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(source, error.source().begin.line, "TOML syntax: " + std::string(error.description()),
                     "a programme of [[blocks]] in TOML");
  }
  Programme programme;
  programme.source = source;
  DescriptionTable top(top_table, "", source);
  const toml::node& blocks = top.need("blocks", "a list of [[blocks]], each with a road");
  top.finish();
  if (!blocks.is_array()) top.fail(blocks, "blocks is not a list", "[[blocks]], each with a road");
  for (const toml::node& block : *blocks.as_array()) {
    if (!block.is_table()) top.fail(block, "blocks holds something else than tables", "[[blocks]], each with a road");
    programme.blocks.push_back(
        read_block(DescriptionTable(*block.as_table(), "blocks", source), std::filesystem::path(source).parent_path()));
  }
  if (programme.blocks.empty()) top.fail(blocks, "blocks is empty", "at least one of [[blocks]]");
  return programme;
}

Programme read_programme(const std::filesystem::path& file) {
  return parse_programme(read_small_text(file, "a programme of [[blocks]] in TOML"), file.string());
}

}  // namespace firmware
