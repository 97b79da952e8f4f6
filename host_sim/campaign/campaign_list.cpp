#include "host_sim/campaign/campaign_list.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string_view>
#include <system_error>

#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/small_text.hpp"

namespace host_sim::campaign {
namespace {

namespace fs = std::filesystem;
using firmware::InputError;

constexpr std::array<std::string_view, 13> endings{".csv", ".mat", ".tdms", ".h5",  ".hdf5", ".rsp", ".tim",
                                                   ".mf4", ".mdf", ".uff",  ".unv", ".mcap", ".xlsx"};

bool is_recording(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// run_9 before run_10: digits as the number that they are.
bool in_order(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      while (i + 1 < a.size() && a[i] == '0' && digit(a[i + 1])) ++i;
      while (j + 1 < b.size() && b[j] == '0' && digit(b[j + 1])) ++j;
      const std::size_t from_a = i, from_b = j;
      while (i < a.size() && digit(a[i])) ++i;
      while (j < b.size() && digit(b[j])) ++j;
      if (i - from_a != j - from_b) return i - from_a < j - from_b;
      const int sign = a.compare(from_a, i - from_a, b, from_b, j - from_b);
      if (sign != 0) return sign < 0;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

std::vector<CampaignRecord> of_folder(const fs::path& folder, const std::optional<fs::path>& rig) {
  if (!rig) throw InputError(folder.string(), 0, "is a folder of recordings without a rig", "--rig RIG.toml");
  std::vector<std::string> names;
  std::error_code error;
  const fs::directory_iterator entries(folder, error);
  if (error) throw InputError(folder.string(), 0, "cannot be read: " + error.message(), "a folder that may be read");
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(error) && is_recording(entry.path()) && !name.starts_with('.')) names.push_back(name);
  }
  std::sort(names.begin(), names.end(), in_order);
  std::vector<CampaignRecord> records;
  records.reserve(names.size());
  for (const std::string& name : names) records.push_back({name, folder / name, *rig});
  return records;
}

std::vector<CampaignRecord> of_list(const fs::path& list, const std::optional<fs::path>& rig) {
  const std::string source = list.string();
  const std::string text = firmware::read_small_text(list, "a list of [[record]] in TOML, or a folder of recordings");
  toml::table table;
  try {
    table = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(source, error.source().begin.line, "TOML syntax: " + std::string(error.description()),
                     "a list of [[record]] in TOML");
  }
  firmware::DescriptionTable top(table, "", source);
  std::optional<fs::path> common = rig;
  if (top.has("rig")) {
    const fs::path named = list.parent_path() / top.text("rig");
    if (!common) common = named;
  }
  const toml::node& blocks = top.need("record", "a list of [[record]], each with data");
  top.finish();
  if (!blocks.is_array()) top.fail(blocks, "record is not a list", "[[record]], each with data");
  std::vector<CampaignRecord> records;
  for (const toml::node& node : *blocks.as_array()) {
    if (!node.is_table()) top.fail(node, "record holds something else than tables", "[[record]], each with data");
    firmware::DescriptionTable one(*node.as_table(), "record", source);
    CampaignRecord record;
    record.data = list.parent_path() / one.text("data");
    record.name = one.has("name") ? one.text("name") : record.data.filename().string();
    if (one.has("rig")) record.rig = list.parent_path() / one.text("rig");
    one.finish();
    if (record.rig.empty() && !common) top.fail(node, "the record has no rig", "rig here, above the list or as --rig");
    if (record.rig.empty()) record.rig = *common;
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace

std::vector<CampaignRecord> campaign_records(const fs::path& campaign, const std::optional<fs::path>& rig) {
  std::error_code error;
  const bool folder = fs::is_directory(campaign, error);
  std::vector<CampaignRecord> records = folder ? of_folder(campaign, rig) : of_list(campaign, rig);
  if (records.empty())
    throw InputError(campaign.string(), 0, "holds no recording", "recordings, or a list of [[record]]");
  std::set<std::string> names;
  for (CampaignRecord& record : records) {
    std::replace(record.name.begin(), record.name.end(), '/', '_');
    if (record.name.empty() || record.name.starts_with('.') || !names.insert(record.name).second) {
      throw InputError(campaign.string(), 0,
                       "two records have the name " + firmware::in_quotes(record.name) + ", or it is none",
                       "a name for each");
    }
    for (const fs::path& file : {record.data, record.rig}) {
      if (!fs::is_regular_file(file, error))
        throw InputError(file.string(), 0, "is not there", "a file of the campaign");
    }
  }
  return records;
}

}  // namespace host_sim::campaign
