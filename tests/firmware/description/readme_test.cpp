// firmware/description/README.md lists all keys of a rig description.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <regex>
#include <string>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/description/values/loop_settings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

/// The row of a table that names the word as `word` or as `word.CHANNEL`; empty: none.
std::string row_of(const std::string& readme, std::string_view word) {
  for (const std::string_view end : {"`", ".CHANNEL`"}) {
    const std::size_t at = readme.find("`" + std::string(word) + std::string(end));
    if (at == std::string::npos) continue;
    const std::size_t begin = readme.rfind('\n', at) + 1;
    return readme.substr(begin, readme.find('\n', at) - begin);
  }
  return "";
}

/// As the tables write it: 1e5, not 100000; 0.001, not 1e-3.
std::string bound(double value) {
  if (value >= 1e5) return "1e" + std::to_string(static_cast<int>(std::lround(std::log10(value))));
  std::string text = firmware::shortest(value);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

// A user looks a key up there: a parameter or an effect that is added to the reader must be added to the tables.
TEST(ReadmeOfRigDescriptions, ListsEveryParameterAndEveryEffect) {
  const std::string readme = support::TemporaryFolder::read("firmware/description/README.md");
  for (const auto& path : firmware::parameter_paths()) {
    EXPECT_NE(readme.find("`" + std::string(path.key) + "`"), std::string::npos) << path.table << '.' << path.key;
    EXPECT_NE(readme.find("`[" + std::string(path.table) + "]`"), std::string::npos) << path.table;
  }
  for (const auto& entry : firmware::catalogue()) {
    const std::string row = row_of(readme, entry.name);
    EXPECT_NE(row, "") << entry.name;
    for (const auto& parameter : entry.parameters) {
      EXPECT_NE(row.find("`" + std::string(parameter.name) + "`"), std::string::npos)
          << entry.name << '.' << parameter.name;
    }
  }
}

// Each setting of the control loop: its row has the default and the bounds of the reader.
TEST(ReadmeOfRigDescriptions, ListsEverySettingOfTheLoop) {
  const std::string readme = support::TemporaryFolder::read("firmware/description/README.md");
  const firmware::Settings usual{};
  for (const auto& setting : firmware::loop_settings()) {
    EXPECT_NE(readme.find("`[" + std::string(setting.table) + "]`"), std::string::npos) << setting.table;
    const std::string row = row_of(readme, setting.key);
    ASSERT_NE(row, "") << setting.key;
    const double value = setting.get(usual);
    if (value != 0.0) {
      EXPECT_NE(row.find("| " + firmware::shortest(value) + " |"), std::string::npos) << row;
    }
    if (setting.table == "limits" && setting.key.starts_with("measured")) continue;  // bounds follow from other limits
    EXPECT_TRUE(row.find(bound(setting.lowest) + " … " + bound(setting.highest)) != std::string::npos)
        << row << bound(setting.lowest) << " … " << bound(setting.highest);
  }
}

// The same for every other key: the readers ask for keys by literals such as positive("stroke").
TEST(ReadmeOfRigDescriptions, ListsEveryKeyThatAReaderAsksFor) {
  const std::string readme = support::TemporaryFolder::read("firmware/description/README.md");
  const std::regex asked(
      "(?:->|\\.)(?:need|number|positive|not_negative|factor|optional_number|whole|whole_in|truth|text|table|number_in)"
      "\\(\"([a-z_]+)\"");
  int keys = 0;
  for (const auto& file : std::filesystem::directory_iterator("firmware/description")) {
    if (!file.path().filename().string().starts_with("rig_description") || file.path().extension() != ".cpp") continue;
    const std::string source = support::TemporaryFolder::read(file.path());
    for (std::sregex_iterator at(source.begin(), source.end(), asked), end; at != end; ++at, ++keys) {
      const std::string key = (*at)[1];
      EXPECT_TRUE(std::regex_search(readme, std::regex("\\b" + key + "\\b"))) << key << " in " << file.path();
    }
  }
  EXPECT_GT(keys, 40);
}

}  // namespace
