#include "host_sim/recording_files/tables/time_entry.hpp"

#include <charconv>
#include <string_view>
#include <system_error>

#include "firmware/description/text/number_text.hpp"

namespace host_sim {
namespace {

constexpr std::string_view row_number = "row number at ";
constexpr std::string_view hertz = " Hz";
constexpr std::string_view skipped = " lines skipped";

template <typename Number>
std::optional<Number> whole_number_text(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

TimeEntry take_time_entry(firmware::ChannelMap& channels) {
  TimeEntry entry;
  const auto t = channels.find("t");
  if (t == channels.end()) return entry;
  std::string& column = t->second.column;
  if (column.ends_with(skipped)) {
    const std::size_t comma = column.rfind(", ");
    const std::size_t begin = comma == std::string::npos ? 0 : comma + 2;
    const std::string_view number = std::string_view(column).substr(begin, column.size() - skipped.size() - begin);
    if (const auto skip = whole_number_text<std::size_t>(number)) {
      entry.skip = *skip;
      column.resize(comma == std::string::npos ? 0 : comma);
    }
  }
  if (column.starts_with(row_number) && column.ends_with(hertz)) {
    const std::string_view number = std::string_view(column).substr(row_number.size());
    const auto rate = whole_number_text<double>(number.substr(0, number.size() - hertz.size()));
    if (rate && *rate > 0.0 && *rate < 1e9) entry.rate = rate;
  }
  if (entry.rate || column.empty()) channels.erase(t);
  return entry;
}

void put_time_entry(const TimeEntry& entry, firmware::ChannelMap& channels) {
  if (!entry.rate && entry.skip == 0) return;
  firmware::ColumnSource& t = channels["t"];
  if (entry.rate)
    t = {std::string(row_number) + firmware::shortest(*entry.rate) + std::string(hertz), std::nullopt, 0.0};
  if (entry.skip == 0) return;
  if (!t.column.empty()) t.column += ", ";
  t.column += std::to_string(entry.skip) + std::string(skipped);
}

}  // namespace host_sim
