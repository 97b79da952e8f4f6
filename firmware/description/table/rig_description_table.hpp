// Checked access to one table of a rig description.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/spelling.hpp"
#include "model/components/channel.hpp"

namespace firmware {

/// Numbers are integers and reals only; toml++ also converts `true` to 1.
[[nodiscard]] std::optional<double> as_number(const toml::node& node);
[[nodiscard]] std::optional<std::int64_t> as_whole(const toml::node& node);

/// A table with its path and the set of keys that were read. Every error is an InputError with the line of the value.
class DescriptionTable {
 public:
  DescriptionTable(const toml::table& table, std::string name, std::string_view source);

  [[nodiscard]] bool has(std::string_view key);
  const toml::node& need(std::string_view key, std::string_view expected);

  double number(std::string_view key);
  double positive(std::string_view key);
  double not_negative(std::string_view key);
  double factor(std::string_view key);  ///< a number other than 0
  /// Where the key is there: a number within bounds; `why`: what they stand for, in words.
  void number_in(std::string_view key, double& value, double lowest, double highest, std::string_view why);
  void optional_number(std::string_view key, double& value);
  int whole(std::string_view key);                              ///< a whole number that fits an int
  int whole_in(std::string_view key, int lowest, int highest);  ///< within bounds
  bool truth(std::string_view key);
  std::string text(std::string_view key);
  std::optional<DescriptionTable> table(std::string_view key);  ///< the sub-table, or nothing

  /// Every key is the name of a channel: use(channel, key, node) for each.
  template <class Use>
  void for_each_channel(const Use& use);

  /// InputError for the first key that was not read: it is unknown.
  void finish() const;
  void accept_all_keys();

  [[noreturn]] void fail(const toml::node& node, std::string_view wrong, std::string_view expected) const;
  [[noreturn]] void fail(std::string_view key, std::string_view wrong, std::string_view expected) const;

  [[nodiscard]] const std::string& source() const { return source_; }
  [[nodiscard]] std::size_t line() const { return table_->source().begin.line; }
  [[nodiscard]] const toml::table& raw() const { return *table_; }
  [[nodiscard]] std::string path(std::string_view key) const;  ///< "tyre.stiffness"

 private:
  void suspect_misspelling(std::string_view missing) const;
  [[nodiscard]] std::string suggestion(std::string_view word, const std::vector<std::string>& known) const;

  const toml::table* table_;
  std::string name_;
  std::string source_;
  std::set<std::string, std::less<>> known_;
};

template <class Use>
void DescriptionTable::for_each_channel(const Use& use) {
  std::array<std::string_view, model::channel_count> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = model::channel_names[i].name;
  for (const auto& [key, node] : raw()) {
    const auto channel = model::find_channel(key.str());
    if (!channel) {
      fail(node, with_suggestion("unknown channel", path(key.str()), names), "one of " + listed(names));
    }
    use(*channel, std::string(key.str()), node);
  }
  accept_all_keys();
}

}  // namespace firmware
