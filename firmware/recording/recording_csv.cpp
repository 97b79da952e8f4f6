// Recordings as CSV: one header line, one row a sample.
#include "firmware/recording/recording_csv.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <system_error>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/loop/common/mode.hpp"
#include "firmware/recording/column_printer.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_file.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "firmware/recording/run_columns.hpp"
#include "firmware/recording/sample_checks.hpp"

namespace firmware {
namespace {

constexpr std::size_t longest_line = std::size_t{1} << 20U;

bool is_blank(char c) { return c == ' ' || c == '\t'; }

bool is_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

// Text as a number: the end of what was read, nullptr if it is none. Too small a number is 0, too large a one infinite.
const char* read_number(const char* text, const char* end, double& value) {
  if (text != end && *text == '+' && end - text > 1 && text[1] != '-') ++text;
  const auto [next, error] = std::from_chars(text, end, value);
  if (error == std::errc::result_out_of_range) {
    value = std::strtod(std::string(text, next).c_str(), nullptr);
    return next;
  }
  return error == std::errc{} ? next : nullptr;
}

// Reads a file line by line, whatever blocks its bytes come in.
class CsvReader {
 public:
  CsvReader(std::string_view source, const ChannelMap& map, Missing missing, bool ages = false)
      : map_(map), missing_(missing), ages_(ages) {
    recording_.source = source;
  }

  void take(std::string_view block) {
    if (!rest_.empty()) {
      const std::size_t end = block.find('\n');
      rest_ += block.substr(0, end);
      if (end == std::string_view::npos) return refuse_endless_line();
      read_line(rest_);
      rest_.clear();
      block.remove_prefix(end + 1);
    }
    for (std::size_t end = block.find('\n'); end != std::string_view::npos; end = block.find('\n')) {
      read_line(block.substr(0, end));
      block.remove_prefix(end + 1);
    }
    rest_ = block;
    refuse_endless_line();
  }

  // The header has been read.
  [[nodiscard]] bool has_columns() const { return !columns_.empty(); }

  // The rows of the run so far: time of the first and of the last. nullopt: none. Rows behind a run end it.
  struct Span {
    double from, to;
    bool ended;
  };
  [[nodiscard]] std::optional<Span> span() const {
    const auto [first, after] = rows_of_the_run();
    if (first == after) return std::nullopt;
    return Span{recording_.time[first], recording_.time[after - 1], after != recording_.time.size()};
  }

  // Leaves the rows out that are not of the run, or not within these times.
  void keep(double from, double to) {
    auto [first, after] = rows_of_the_run();
    while (first != after && recording_.time[first] < from) ++first;
    while (first != after && recording_.time[after - 1] > to) --after;
    keep_rows(first, after);
  }

  // Room for a file of which `part` of `whole` bytes have been taken. Pages that stay unused cost no memory.
  void expect(std::size_t part, std::size_t whole) {
    const double rows = static_cast<double>(recording_.time.size()) + 1.0;
    const double all = 1.05 * rows * static_cast<double>(whole) / static_cast<double>(std::max<std::size_t>(part, 1));
    for (const Column& column : columns_) {
      if (column.values != nullptr) column.values->reserve(static_cast<std::size_t>(all) + 1);
    }
  }

  Recording finish(std::optional<double> expected_rate) {
    take_last_row();
    keep_the_run();
    const std::string& source = recording_.source;
    if (missing_ == Missing::mark) {
      if (recover_grid(recording_, rounding_, expected_rate)) rounding_ = {};
      expected_rate = rate_if_usual(recording_.time, rounding_, expected_rate);
    }
    if (by_controller_ || missing_ == Missing::mark) {
      const std::vector<double>& time = recording_.time;
      const bool rises = std::adjacent_find(time.begin(), time.end(), std::greater_equal<>()) == time.end();
      const double period = expected_rate || time.size() < 2 ? 1.0 / expected_rate.value_or(1.0) : median_step(time);
      fill_gaps(recording_, late_, {source, first_row_}, expected_rate, missing_,
                rises && !time.empty() ? stamp_error(time, rounding_, period) : 0.0);
    }
    check_time(recording_, rounding_, {source, first_row_}, expected_rate);
    if (!rest_.empty()) {
      recording_.remark += (recording_.remark.empty() ? one_line(source) + ": " : "; ") + "the last row is torn";
    }
    return std::move(recording_);
  }

  AsRecorded finish_as_recorded() {
    take_last_row();
    check_time_rises(recording_, {recording_.source, first_row_});
    return {std::move(recording_), std::move(late_),   std::move(age_),
            std::move(mode_),      std::move(reason_), std::move(level_)};
  }

 private:
  // A recording of rig_controller holds the way to the run and back as well; analyses get the run alone, from t = 0.
  void keep_the_run() {
    if (mode_.empty()) return;
    const auto [first, after] = rows_of_the_run();
    if (first == after) {
      throw InputError(recording_.source, first_row_, "no row belongs to a run", "a recording whose run has begun");
    }
    keep_rows(first, after);
    // Times are whole nanoseconds, printed to the last bit, so their differences are exact as well.
    constexpr double per_second = 1e9;
    const double begin = std::round(recording_.time.front() * per_second);
    for (double& time : recording_.time) time = (std::round(time * per_second) - begin) / per_second;
  }

  // From the first one to behind the last one.
  [[nodiscard]] std::pair<std::size_t, std::size_t> rows_of_the_run() const {
    if (mode_.empty()) return {0, recording_.time.size()};
    const auto in_the_run = [](double mode) {
      return mode == static_cast<double>(Mode::running) || mode == static_cast<double>(Mode::holding);
    };
    const auto first = std::find_if(mode_.begin(), mode_.end(), in_the_run);
    const auto after = std::find_if_not(first, mode_.end(), in_the_run);
    return {static_cast<std::size_t>(first - mode_.begin()), static_cast<std::size_t>(after - mode_.begin())};
  }

  void keep_rows(std::size_t first, std::size_t after) {
    for (const Column& column : columns_) {
      if (column.values == nullptr) continue;
      column.values->erase(column.values->begin() + static_cast<std::ptrdiff_t>(after), column.values->end());
      column.values->erase(column.values->begin(), column.values->begin() + static_cast<std::ptrdiff_t>(first));
    }
    first_row_ += first;
  }

  void take_last_row() {
    if (!rest_.empty() && !by_controller_) read_line(std::exchange(rest_, {}));
    const std::string& source = recording_.source;
    if (line_ == 0) throw InputError(source, 0, "the file is empty", "a header line such as t,z_r,F_w");
    if (columns_.empty()) throw InputError(source, line_, "there is no header line", "one such as t,z_r,F_w");
    if (recording_.time.empty()) throw InputError(source, line_, "no samples follow the header", "one row a sample");
    if (recording_.time.capacity() > 2 * recording_.time.size()) {
      for (const Column& column : columns_) {
        if (column.values != nullptr) column.values->shrink_to_fit();
      }
    }
  }

  struct Column {
    std::vector<double>* values = nullptr;  // nullptr: ignored
    Target target{};
  };

  [[noreturn]] void fail(std::string_view wrong, std::string_view expected) const {
    throw InputError(recording_.source, line_, wrong, expected);
  }

  void refuse_endless_line() {
    if (rest_.size() > longest_line) read_line(rest_);
  }

  void read_line(std::string_view line) {
    if (++line_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);  // UTF-8 byte order mark
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.size() > longest_line) fail("the line is longer than 1 MiB", "a text file, one row a sample");
    if (!columns_.empty()) return read_row(line);
    const std::string_view text = trimmed(line);
    if (text.empty()) return;
    if (text.front() != '#') return read_header(text);
    if (trimmed(text.substr(1)) == recording_mark) own_ = true;
  }

  void read_header(std::string_view text) {
    constexpr std::string_view header = "a header line such as t,z_r,F_w";
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) fail("the text is UTF-16", "UTF-8");
    const bool binary =
        std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
    if (binary) fail("the file is no text", "CSV, or MATLAB 5 or 7.3");
    if (text.find(',') == std::string_view::npos) {
      constexpr std::string_view commas = "commas between columns and '.' as decimal point";
      if (text.find(';') != std::string_view::npos) fail("the columns are separated by semicolons", commas);
      if (text.find('\t') != std::string_view::npos) fail("the columns are separated by tabs", commas);
    }

    std::vector<Heading> headings;
    bool numbers = true;
    for (std::string_view rest = text;;) {
      const std::size_t comma = rest.find(',');
      headings.push_back(read_heading(rest.substr(0, comma)));
      numbers = numbers && is_number(headings.back().text);
      if (comma == std::string_view::npos) break;
      rest.remove_prefix(comma + 1);
    }
    if (numbers) fail("numbers stand where names should", header);

    const std::vector<std::optional<Target>> targets =
        find_targets(headings, own_ ? ChannelMap{} : map_, recording_.source, line_);
    for (std::size_t c = 0; c < headings.size(); ++c) {
      columns_.emplace_back();
      if (targets[c]) {
        columns_.back() = {&values(recording_, targets[c]->quantity), *targets[c]};
      } else {
        recording_.ignored_columns.push_back(headings[c].text);
        if (own_ && headings[c].name == "late") {
          by_controller_ = true;
          columns_.back() = {&late_, Target{time_quantity}};
        }
        if (own_ && headings[c].name == "mode") columns_.back() = {&mode_, Target{time_quantity}};
        if (own_ && ages_ && headings[c].name == "reason") columns_.back() = {&reason_, Target{time_quantity}};
        if (own_ && ages_ && headings[c].name == "level") columns_.back() = {&level_, Target{time_quantity}};
        for (std::size_t i = 0; own_ && ages_ && i < age_.size(); ++i) {
          if (headings[c].name == age_name(model::channel_at(i))) columns_.back() = {&age_[i], Target{1 + i}};
        }
      }
    }
    rounding_ = {0, 0, 1.0};
    for (const Column& column : columns_) {
      if (column.values == &recording_.time) rounding_.scale = std::abs(column.target.scale);
    }
  }

  void read_row(std::string_view row) {
    if (own_ && row.starts_with('#')) return;  // a mark, or why the run ended
    if (trimmed(row).empty()) {
      if (empty_line_ == 0) empty_line_ = line_;
      return;
    }
    if (empty_line_ != 0) {
      line_ = empty_line_;
      fail("an empty line stands between samples", "one row a sample");
    }
    if (first_row_ == 0) first_row_ = line_;

    const char* p = row.data();
    const char* const end = p + row.size();
    for (const Column& column : columns_) {
      if (&column != columns_.data()) {
        if (p == end || *p != ',') fail_row(row);
        ++p;
      }
      if (column.values == nullptr) {
        const void* comma = p == end ? nullptr : std::memchr(p, ',', static_cast<std::size_t>(end - p));
        p = comma == nullptr ? end : static_cast<const char*>(comma);
        continue;
      }
      while (p != end && is_blank(*p)) ++p;
      double number = 0.0;
      const char* next = read_number(p, end, number);
      if (next == nullptr) fail_row(row);
      if (column.values == &recording_.time) note_rounding({p, static_cast<std::size_t>(next - p)});
      p = next;
      while (p != end && is_blank(*p)) ++p;
      if (p != end && *p != ',') fail_row(row);
      const double value = column.target.value(number);
      const bool lost =
          (by_controller_ || missing_ == Missing::mark) && std::isnan(value) && column.target.quantity != time_quantity;
      if ((!std::isfinite(value) && !lost) || column.target.quantity >= first_duct) {
        if (const Objection objection = object_to(column.target.quantity, value)) {
          check_field_count(row);
          fail(objection.wrong, objection.expected);
        }
      }
      column.values->push_back(value);
    }
    if (p != end) fail_row(row);
  }

  void check_field_count(std::string_view row) const {
    const auto fields = static_cast<std::size_t>(std::count(row.begin(), row.end(), ',')) + 1;
    const std::size_t expected = columns_.size();
    if (fields == expected) return;
    std::string wrong = "the row has " + std::to_string(fields) + (fields == 1 ? " value" : " values");
    if (fields < expected && row.find(';') != std::string_view::npos) wrong += " (separated by semicolons?)";
    if (fields + 1 >= 2 * expected && expected > 1) wrong += " (decimal commas?)";
    fail(wrong, std::to_string(expected) + " as in the header");
  }

  // Says what is wrong with a row that could not be read: its length, or else its first unreadable value.
  [[noreturn]] void fail_row(std::string_view row) const {
    check_field_count(row);
    std::string_view rest = row;
    for (const Column& column : columns_) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      const std::string_view field = trimmed(rest.substr(0, comma));
      rest.remove_prefix(std::min(comma + 1, rest.size()));
      double value = 0.0;
      if (column.values == nullptr ||
          read_number(field.data(), field.data() + field.size(), value) == field.data() + field.size()) {
        continue;
      }
      const std::string what(quantity_name(column.target.quantity));
      if (field.empty()) fail(what + " is missing", "a number");
      fail(what + " is " + in_quotes(field), "a number");
    }
    fail("the row cannot be read", std::to_string(columns_.size()) + " numbers between commas");
  }

  // Decimals and significant digits of a time stamp as printed.
  void note_rounding(std::string_view stamp) {
    int decimals = 0;
    int digits = 0;
    bool after_point = false;
    for (std::size_t i = 0; i < stamp.size(); ++i) {
      const char c = stamp[i];
      if (c >= '0' && c <= '9') {
        if (after_point) ++decimals;
        if (digits > 0 || c != '0') ++digits;
      } else if (c == '.') {
        after_point = true;
      } else if (c == 'e' || c == 'E') {
        int exponent = 0;
        const std::size_t first = i + 1 < stamp.size() && stamp[i + 1] == '+' ? i + 2 : i + 1;
        std::from_chars(stamp.data() + first, stamp.data() + stamp.size(), exponent);
        decimals -= std::clamp(exponent, -400, 400);
        break;
      }
    }
    rounding_.decimals = std::max(rounding_.decimals, decimals);
    rounding_.significant_digits = std::max(rounding_.significant_digits, digits);
  }

  Recording recording_;
  const ChannelMap& map_;
  std::vector<Column> columns_;  // empty until the header has been read
  StampRounding rounding_;
  std::string rest_;  // the beginning of a line whose end has not come yet
  std::size_t line_ = 0;
  std::size_t first_row_ = 0;
  std::size_t empty_line_ = 0;
  bool own_ = false;            // written by rigtwin
  bool by_controller_ = false;  // by rig_controller: it has a column late
  std::vector<double> late_;    // of each row [s]
  Missing missing_;             // what becomes of gaps
  std::vector<double> mode_;    // of each row; empty: all rows are the run
  std::vector<double> reason_;  // of each row
  std::vector<double> level_;   // of each row
  bool ages_;                   // are read as well
  std::array<std::vector<double>, model::channel_count> age_;
};

void read_all(CsvReader& reader, int descriptor, std::string_view head, std::string_view source, std::size_t block) {
  struct stat status {};
  const bool sized = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
  reader.take(head);
  std::size_t taken = head.size();
  std::string bytes(block, '\0');
  for (bool room_made = !sized;;) {
    const ssize_t got = ::read(descriptor, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(source, 0, std::string("cannot be read: ") + std::strerror(errno), "a readable file");
    if (got == 0) break;
    reader.take({bytes.data(), static_cast<std::size_t>(got)});
    taken += static_cast<std::size_t>(got);
    if (!std::exchange(room_made, true)) reader.expect(taken, static_cast<std::size_t>(status.st_size));
  }
}

// Reads the two ends of a file on a disk.
class EndsReader {
 public:
  EndsReader(int descriptor, std::size_t size, std::string_view source, const ChannelMap& map)
      : descriptor_(descriptor), size_(size), begin_(source, map, Missing::mark), end_(source, map, Missing::mark) {}

  std::optional<RecordingEnds> read(std::optional<double> expected_rate, double first, double last) {
    if (!read_begin(first)) return std::nullopt;
    const double from = begin_.span()->from;
    // A controller's recording goes on after the run, until its drive stands still.
    constexpr double to_stand_still = 30.0;  // [s]
    const double tail = bytes_a_second_ * (1.1 * last + to_stand_still);
    if (static_cast<double>(place_) + tail > static_cast<double>(size_)) return std::nullopt;
    if (!read_end(size_ - static_cast<std::size_t>(tail))) return std::nullopt;
    const auto span = end_.span();
    if (!span || span->to - span->from < last) return std::nullopt;
    constexpr double nearly = 1.0 - 1e-4;  // of the seconds: rounding must not make them a sample more
    begin_.keep(from, from + nearly * first);
    end_.keep(span->to - nearly * last, span->to);
    return RecordingEnds{begin_.finish(expected_rate), end_.finish(expected_rate), span->to - from};
  }

 private:
  // Up to a block from a place of the file on; empty at its end.
  std::string_view block_at(std::size_t place) {
    for (;;) {
      const ssize_t got = ::pread(descriptor_, bytes_.data(), bytes_.size(), static_cast<off_t>(place));
      if (got >= 0) return std::string_view(bytes_).substr(0, static_cast<std::size_t>(got));
      if (errno != EINTR) return {};
    }
  }

  // false: the run ends before.
  bool read_begin(double seconds) {
    for (std::size_t run_begins = 0, next_look = 0;;) {
      std::string_view block = block_at(place_);
      block = block.substr(0, block.rfind('\n') + 1);  // whole lines
      if (block.empty()) return false;
      if (place_ == 0) read_header(block);
      begin_.take(block);
      place_ += block.size();
      if (place_ < next_look) continue;
      next_look = place_ + place_ / 16;  // a look goes through all rows: a controller may have waited for hours
      const auto span = begin_.span();
      if (!span) run_begins = place_;
      if (span && span->ended) return false;
      if (!span || span->to - span->from < seconds) continue;
      bytes_a_second_ = static_cast<double>(place_ - run_begins) / (span->to - span->from);
      return true;
    }
  }

  // The end's columns are those of the same header.
  void read_header(std::string_view text) {
    while (!end_.has_columns() && !text.empty()) {
      const std::size_t line = std::min(text.find('\n'), text.size() - 1) + 1;
      end_.take(text.substr(0, line));
      text.remove_prefix(line);
    }
  }

  // From the line after this place on. false: there is none.
  bool read_end(std::size_t place) {
    const std::size_t line = block_at(place).find('\n');
    if (line == std::string_view::npos || !end_.has_columns()) return false;
    for (place += line + 1;;) {
      const std::string_view block = block_at(place);
      if (block.empty()) return place >= size_;
      end_.take(block);
      place += block.size();
    }
  }

  int descriptor_;
  std::size_t size_;
  CsvReader begin_, end_;
  std::string bytes_ = std::string(std::size_t{1} << 14U, '\0');  // a block
  std::size_t place_ = 0;                                         // behind what has been read of the beginning
  double bytes_a_second_ = 0.0;
};

void refuse_matlab(const RecordingFile& file, const std::filesystem::path& name) {
  if (file.is_matlab()) throw InputError(name.string(), 0, "is a MATLAB file", "CSV: this program reads no other");
}

}  // namespace

Recording read_recording_csv(int descriptor, std::string_view head, std::string_view source, const ChannelMap& map,
                             std::optional<double> expected_rate, Missing missing, std::size_t block) {
  CsvReader reader(source, map, missing);
  read_all(reader, descriptor, head, source, block);
  return reader.finish(expected_rate);
}

std::optional<RecordingEnds> read_recording_ends(int descriptor, std::string_view source, const ChannelMap& map,
                                                 std::optional<double> expected_rate, double first, double last,
                                                 std::size_t least_size) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size < least_size) return std::nullopt;
  try {
    return EndsReader(descriptor, size, source, map).read(expected_rate, first, last);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Recording read_csv_recording(const std::filesystem::path& file, const ChannelMap& map,
                             std::optional<double> expected_rate) {
  const RecordingFile opened(file);
  refuse_matlab(opened, file);
  return read_recording_csv(opened.descriptor(), opened.head(), file.string(), map, expected_rate);
}

AsRecorded read_csv_as_recorded(const std::filesystem::path& file, const ChannelMap& map) {
  const RecordingFile opened(file);
  refuse_matlab(opened, file);
  CsvReader reader(file.string(), map, Missing::refuse, true);
  read_all(reader, opened.descriptor(), opened.head(), file.string(), std::size_t{1} << 20U);
  return reader.finish_as_recorded();
}

Recording parse_recording_csv(std::string_view text, std::string_view source, const ChannelMap& map,
                              std::optional<double> expected_rate, Missing missing) {
  CsvReader reader(source, map, missing);
  reader.take(text);
  return reader.finish(expected_rate);
}

void format_recording_csv(const Recording& recording, const std::function<void(std::string_view)>& take,
                          const std::function<void(double)>& progress) {
  std::string text = "# " + std::string(recording_mark) + "\n";
  for (const std::string& comment : recording.comments) text += "# " + one_line(comment) + "\n";

  std::vector<const std::vector<double>*> columns;
  for (Quantity q = 0; q < quantity_count; ++q) {
    const std::vector<double>& column = values(recording, q);
    if (q != time_quantity && column.empty()) continue;
    columns.push_back(&column);
    if (q != time_quantity) text += ',';
    text += quantity_name(q);
    if (q != time_quantity && !quantity_unit(q).empty()) text += " [" + std::string(quantity_unit(q)) + "]";
  }
  for (const ExtraColumn& extra : recording.extra) {
    columns.push_back(&extra.values);
    text += "," + extra.name;
    if (!extra.unit.empty()) text += " [" + extra.unit + "]";
  }
  text += '\n';

  std::vector<ColumnPrinter> printers(columns.size());
  constexpr std::size_t block = std::size_t{1} << 17U;
  for (std::size_t k = 0; k < recording.size(); ++k) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c > 0) text += ',';
      printers[c].print((*columns[c])[k], text);
    }
    text += '\n';
    if (text.size() < block) continue;
    take(text);
    text.clear();
    if (progress) progress(static_cast<double>(k + 1) / static_cast<double>(recording.size()));
  }
  take(text);
}

std::string format_recording_csv(const Recording& recording) {
  std::string whole;
  format_recording_csv(recording, [&](std::string_view text) { whole += text; });
  return whole;
}

}  // namespace firmware
