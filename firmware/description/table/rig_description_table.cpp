#include "firmware/description/table/rig_description_table.hpp"

#include <cmath>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"

namespace firmware {

std::optional<double> as_number(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
  if (const auto* real = node.as_floating_point()) return real->get();
  return std::nullopt;
}

std::optional<std::int64_t> as_whole(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return whole->get();
  return std::nullopt;
}

DescriptionTable::DescriptionTable(const toml::table& table, std::string name, std::string_view source)
    : table_(&table), name_(std::move(name)), source_(source) {}

bool DescriptionTable::has(std::string_view key) {
  known_.insert(std::string(key));
  return table_->contains(key);
}

const toml::node& DescriptionTable::need(std::string_view key, std::string_view expected) {
  if (!has(key)) {
    suspect_misspelling(key);
    throw InputError(source_, line(),
                     name_.empty() ? "no " + in_quotes(key) : "[" + name_ + "] has no " + in_quotes(key), expected);
  }
  return *table_->get(key);
}

double DescriptionTable::number(std::string_view key) {
  const toml::node& node = need(key, "a number");
  const std::optional<double> value = as_number(node);
  if (!value) fail(node, path(key) + " is not a number", "a number in SI units, such as 1140.0");
  if (!std::isfinite(*value)) fail(node, path(key) + " is not finite", "a finite number in SI units");
  return *value;
}

double DescriptionTable::positive(std::string_view key) {
  const double value = number(key);
  if (!(value > 0.0)) fail(key, path(key) + " = " + shortest(value) + " does not fit", "a number > 0 in SI units");
  return value;
}

double DescriptionTable::not_negative(std::string_view key) {
  const double value = number(key);
  if (!(value >= 0.0)) fail(key, path(key) + " = " + shortest(value) + " does not fit", "a number >= 0 in SI units");
  return value;
}

double DescriptionTable::factor(std::string_view key) {
  const double value = number(key);
  if (value == 0.0) fail(key, path(key) + " is 0", "a factor other than 0");
  return value;
}

void DescriptionTable::number_in(std::string_view key, double& value, double lowest, double highest,
                                 std::string_view why) {
  if (!has(key)) return;
  const double given = number(key);
  if (!(given >= lowest && given <= highest)) {
    fail(key, path(key) + " = " + shortest(given) + " does not fit",
         std::string(why) + ", " + shortest(lowest) + " to " + shortest(highest));
  }
  value = given;
}

void DescriptionTable::optional_number(std::string_view key, double& value) {
  if (has(key)) value = number(key);
}

int DescriptionTable::whole(std::string_view key) {
  const toml::node& node = need(key, "a whole number");
  const std::optional<std::int64_t> value = as_whole(node);
  if (!value || *value < -1000 || *value > 1000) {
    fail(node, path(key) + " is not a whole number in range", "a whole number, such as 2");
  }
  return static_cast<int>(*value);
}

int DescriptionTable::whole_in(std::string_view key, int lowest, int highest) {
  const auto value = as_whole(need(key, "a whole number"));
  if (!value || *value < lowest || *value > highest) {
    fail(key, path(key) + " is out of range", std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return static_cast<int>(*value);
}

bool DescriptionTable::truth(std::string_view key) {
  const toml::node& node = need(key, "true or false");
  if (!node.is_boolean()) fail(node, path(key) + " is neither true nor false", "true or false");
  return node.as_boolean()->get();
}

std::string DescriptionTable::text(std::string_view key) {
  const toml::node& node = need(key, "a text in quotes");
  if (!node.is_string()) fail(node, path(key) + " is not a text", "a text in quotes");
  return *node.value<std::string>();
}

std::optional<DescriptionTable> DescriptionTable::table(std::string_view key) {
  if (!has(key)) return std::nullopt;
  const toml::node& node = *table_->get(key);
  if (!node.is_table()) fail(node, path(key) + " is not a table", "a table [" + path(key) + "]");
  return DescriptionTable(*node.as_table(), path(key), source_);
}

void DescriptionTable::finish() const {
  for (const auto& [key, node] : *table_) {
    if (known_.contains(key.str())) continue;
    const std::size_t at = key.source().begin.line;
    if (known_.empty()) throw InputError(source_, at, "unknown key " + in_quotes(path(key.str())), "an empty table");
    const std::vector<std::string> known(known_.begin(), known_.end());
    const std::vector<std::string_view> words(known.begin(), known.end());
    throw InputError(source_, at, suggestion(key.str(), known), "one of " + listed(words));
  }
}

void DescriptionTable::accept_all_keys() {
  for (const auto& [key, node] : *table_) known_.insert(std::string(key.str()));
}

void DescriptionTable::fail(const toml::node& node, std::string_view wrong, std::string_view expected) const {
  throw InputError(source_, node.source().begin.line, wrong, expected);
}

void DescriptionTable::fail(std::string_view key, std::string_view wrong, std::string_view expected) const {
  const toml::node* node = table_->get(key);
  throw InputError(source_, node != nullptr ? node->source().begin.line : line(), wrong, expected);
}

std::string DescriptionTable::path(std::string_view key) const {
  return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
}

/// If a similar key exists where one is missing, reports that key with its line as the misspelling.
void DescriptionTable::suspect_misspelling(std::string_view missing) const {
  for (const auto& [key, node] : *table_) {
    if (known_.contains(key.str()) || !is_slip_of(key.str(), missing)) continue;
    throw InputError(source_, key.source().begin.line, suggestion(key.str(), {std::string(missing)}), path(missing));
  }
}

std::string DescriptionTable::suggestion(std::string_view word, const std::vector<std::string>& known) const {
  std::vector<std::string> known_paths;
  for (const std::string& key : known) known_paths.push_back(path(key));
  const std::vector<std::string_view> words(known_paths.begin(), known_paths.end());
  return with_suggestion("unknown key", path(word), words);
}

}  // namespace firmware
