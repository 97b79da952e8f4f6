#include "host_sim/recording_files/text/lvm_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_layout.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

constexpr std::string_view lvm_mark = "LabVIEW Measurement";
constexpr std::string_view end_of_header = "***End_of_Header***";

// One channel over all segments.
struct LvmChannel {
  std::string name, unit;
  std::vector<double> time, values;
};

class LvmReader {
 public:
  LvmReader(const std::vector<std::string_view>& lines, std::string_view source) : lines_(lines), source_(source) {}

  RawTable run() {
    read_head();
    while (at_ < lines_.size()) read_segment();
    if (channels_.empty())
      throw firmware::InputError(source_, 0, "the LabVIEW file holds no samples", "a segment with channels and rows");
    return make_table();
  }

 private:
  using Head = std::map<std::string, std::vector<std::string>, std::less<>>;

  [[nodiscard]] std::vector<std::string> fields_of(std::string_view line) const {
    return split_fields(line, separator_);
  }

  void read_head() {
    for (; at_ < lines_.size(); ++at_) {
      const std::string_view line = firmware::trimmed(lines_[at_]);
      if (line.starts_with("Separator")) separator_ = line.find("Comma") != std::string_view::npos ? ',' : '\t';
      if (line.starts_with(end_of_header)) break;
    }
    for (std::size_t i = 0; i < at_; ++i) {
      const std::vector<std::string> fields = fields_of(lines_[i]);
      if (fields.size() < 2) continue;
      if (fields[0] == "Decimal_Separator") decimal_ = fields[1].starts_with(',') ? ',' : '.';
      if (fields[0] == "X_Columns") x_columns_ = fields[1];
      head_[fields[0]] = fields;
    }
    if (separator_ == ',' && decimal_ == ',') decimal_ = '.';
    ++at_;
  }

  [[nodiscard]] static std::string value_at(const Head& head, std::string_view key, std::size_t field) {
    const auto found = head.find(key);
    return found != head.end() && field < found->second.size() ? found->second[field] : "";
  }
  [[nodiscard]] std::optional<double> number_of(const std::string& text) const {
    const auto number = read_text_number(text, decimal_);
    return number && std::isfinite(number->value) ? std::optional(number->value) : std::nullopt;
  }

  void read_segment() {
    Head head;
    bool special = false;
    bool has_head = false;
    for (; at_ < lines_.size(); ++at_) {
      const std::string_view line = firmware::trimmed(lines_[at_]);
      if (line.starts_with("***Start_Special***")) special = true;
      if (line.starts_with("***End_Special***")) {
        special = false;
        continue;
      }
      if (line.empty() || special) continue;
      if (line.starts_with(end_of_header)) {
        ++at_;
        has_head = true;
        break;
      }
      const std::vector<std::string> fields = fields_of(lines_[at_]);
      if (!has_head && fields.front() == "X_Value") break;  // no head of its own
      head[fields.front()] = fields;
    }
    while (at_ < lines_.size() && firmware::trimmed(lines_[at_]).empty()) ++at_;
    if (at_ >= lines_.size()) return;
    std::vector<std::string> names = fields_of(lines_[at_]);
    if (names.front() != "X_Value") {  // a file without headings
      names.assign(fields_of(lines_[at_]).size(), "");
    } else {
      ++at_;
    }
    read_rows(head, names);
  }

  struct Use {
    std::size_t field, x;
    std::size_t channel;
  };

  void read_rows(const Head& head, const std::vector<std::string>& names) {
    const bool multi = x_columns_ == "Multi";
    std::vector<Use> uses;
    std::size_t x = 0;
    for (std::size_t f = 0; f < names.size(); ++f) {
      if (names[f] == "X_Value" || (names[f].empty() && f == 0) || (multi && names[f].empty() && f % 2 == 0)) {
        x = f;
        continue;
      }
      if (names[f] == "Comment") break;
      uses.push_back({f, x, channel_at(uses.size(), names[f], value_at(head, "Y_Unit_Label", f))});
    }
    const std::size_t first_row = at_;
    std::vector<double> begins(uses.size());
    for (std::size_t u = 0; u < uses.size(); ++u)
      begins[u] = static_cast<double>(channels_[uses[u].channel].time.size());
    std::size_t row = 0;
    for (; at_ < lines_.size(); ++at_) {
      const std::string_view line = lines_[at_];
      if (firmware::trimmed(line).empty()) {
        if (row > 0) break;
        continue;
      }
      const std::vector<std::string> fields = fields_of(line);
      const bool key = !fields.front().empty() && !number_of(fields.front()) && !is_missing_value(fields.front());
      if (key) break;  // the head of the next segment
      for (const Use& use : uses) {
        if (use.field >= fields.size() || (fields[use.field].empty() && multi)) continue;
        const std::optional<double> value = number_of(fields[use.field]);
        LvmChannel& channel = channels_[use.channel];
        std::optional<double> time = number_of(use.x < fields.size() ? fields[use.x] : "");
        if (!time || x_columns_ == "No") {
          const double begin = number_of(value_at(head, "X0", use.field)).value_or(0.0);
          const std::optional<double> step = number_of(value_at(head, "Delta_X", use.field));
          if (!step || !(*step > 0.0)) {
            throw firmware::InputError(source_, at_ + 1, "the segment has neither X values nor a Delta_X",
                                       "a segment with its time");
          }
          const double rate = 1.0 / *step;
          // 1/3.906250E-5 is 25600 to six digits.
          const double whole = std::round(rate);
          time = begin + static_cast<double>(row) / (std::abs(rate - whole) < 1e-6 * rate ? whole : rate);
        }
        if (!value && !fields[use.field].empty())
          faults_.push_back({at_ + 1,
                             firmware::in_quotes(channel.name) + " is " + firmware::in_quotes(fields[use.field]),
                             "a number", is_missing_value(fields[use.field])});
        channel.time.push_back(*time);
        channel.values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
        if (use.channel == 0) row_lines_.push_back(at_ + 1);
      }
      ++row;
    }
    if (at_ == first_row) ++at_;  // never the same line twice
    for (std::size_t u = 0; u < uses.size(); ++u)
      continue_time(channels_[uses[u].channel], static_cast<std::size_t>(begins[u]), clock_of(head, uses[u].field));
    if (!first_clock_ && !uses.empty()) first_clock_ = clock_of(head, uses.front().field);
  }

  std::size_t channel_at(std::size_t position, const std::string& name, const std::string& unit) {
    const std::string shown = name.empty() ? "column " + std::to_string(position + 1) : name;
    if (position < channels_.size() && channels_[position].name == shown) return position;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      if (channels_[c].name == shown && !name.empty()) return c;
    }
    channels_.push_back({shown, unit, {}, {}});
    return channels_.size() - 1;
  }

  // Date and time of day of a segment.
  struct Clock {
    long day;
    double seconds;
  };
  [[nodiscard]] std::optional<Clock> clock_of(const Head& head, std::size_t field) const {
    std::string date = value_at(head, "Date", field);
    std::string time = value_at(head, "Time", field);
    if (date.empty()) date = value_at(head, "Date", 1);
    if (time.empty()) time = value_at(head, "Time", 1);
    if (time.size() > 15) time.resize(15);  // microseconds
    const std::optional<ClockTime> clock = read_clock_time(date.empty() ? time : date + " " + time);
    if (!clock || !clock->has_time) return std::nullopt;
    return Clock{clock->day, clock->seconds};
  }

  // A segment whose time begins anew goes on by its clock.
  void continue_time(LvmChannel& channel, std::size_t begin, std::optional<Clock> clock) const {
    if (begin == 0 || begin >= channel.time.size() || channel.time[begin] > channel.time[begin - 1]) return;
    if (!clock || !first_clock_) return;  // the recording's check says that time runs backwards
    const double shift =
        86400.0 * static_cast<double>(clock->day - first_clock_->day) + (clock->seconds - first_clock_->seconds);
    for (std::size_t k = begin; k < channel.time.size(); ++k)
      channel.time[k] = std::round(1e9 * (channel.time[k] + shift)) / 1e9;
  }

  RawTable make_table() {
    RawTable table;
    table.source = source_;
    table.format = "LabVIEW measurement file";
    std::erase_if(channels_, [&](const LvmChannel& channel) {
      if (channel.values.size() > 1) return false;
      table.left_out.push_back({channel.name, channel.values.empty() ? "no values" : "one value"});
      return true;
    });
    if (channels_.empty())
      throw firmware::InputError(source_, 0, "the LabVIEW file holds no samples", "two rows at least");
    const bool one_axis = std::all_of(channels_.begin(), channels_.end(), [&](const LvmChannel& channel) {
      return channel.time == channels_.front().time;
    });
    if (one_axis) {
      RawColumn time{"t"};
      time.text = "t";
      time.unit = "s";
      time.values = channels_.front().time;
      table.rows = time.values.size();
      table.columns.push_back(std::move(time));
      if (row_lines_.size() == table.rows) table.lines = std::move(row_lines_);
    }
    for (LvmChannel& channel : channels_) {
      const NameAndUnit heading = split_heading(channel.name);
      RawColumn column{channel.unit.empty() ? heading.name : channel.name};
      column.text = channel.name;
      column.unit = channel.unit.empty() ? heading.unit : channel.unit;
      column.values = std::move(channel.values);
      if (!one_axis) {
        column.own_time = std::move(channel.time);
        column.own_time_name = "X_Value";
      }
      table.columns.push_back(std::move(column));
    }
    table.faults = std::move(faults_);
    return table;
  }

  const std::vector<std::string_view>& lines_;
  std::string source_;
  std::size_t at_ = 0;
  char separator_ = '\t';
  char decimal_ = '.';
  std::string x_columns_ = "One";
  Head head_;
  std::vector<LvmChannel> channels_;
  std::vector<std::size_t> row_lines_;
  std::vector<RawFault> faults_;
  std::optional<Clock> first_clock_;
};

}  // namespace

bool is_lvm(const std::vector<std::string_view>& lines) {
  return !lines.empty() && firmware::trimmed(lines.front()).starts_with(lvm_mark);
}

RawTable read_lvm(const std::vector<std::string_view>& lines, std::string_view source) {
  return LvmReader(lines, source).run();
}

}  // namespace host_sim
