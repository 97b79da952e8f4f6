#include "host_sim/recording_files/text/universal_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;
using firmware::InputError;
using firmware::trimmed;

constexpr int time_type = 17;  // specific data type of an abscissa

std::optional<int> read_integer(std::string_view field) {
  field = trimmed(field);
  if (field.starts_with('+')) field.remove_prefix(1);
  int value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size()) return std::nullopt;
  return value;
}

// A field of a Fortran record; beyond the line's end it is blank.
std::string_view field_of(std::string_view line, std::size_t begin, std::size_t width) {
  return begin < line.size() ? line.substr(begin, width) : std::string_view();
}

// The next number of a Fortran list: "1.0E+00", "1.0D+00", "1.0+100", and fields that touch ("1.0E+00-2.0E+00").
// nullopt: what stands there is no number. `rest` becomes what follows it.
std::optional<double> next_number(std::string_view& rest) {
  rest = trimmed(rest);
  std::size_t length = 0;
  bool exponent = false;
  for (; length < rest.size(); ++length) {
    const char c = rest[length];
    if (c == ' ' || c == '\t' || c == ',') break;
    if (c == 'e' || c == 'E' || c == 'd' || c == 'D') {
      exponent = true;
    } else if ((c == '+' || c == '-') && length > 0) {
      const char before = rest[length - 1];
      const bool after_letter = before == 'e' || before == 'E' || before == 'd' || before == 'D';
      if (exponent && !after_letter) break;  // the next field begins
      if (!after_letter) {
        const std::string_view digits = rest.substr(length + 1, 3);  // an exponent of three digits has no letter
        const bool three = digits.size() == 3 &&
                           std::all_of(digits.begin(), digits.end(), [](char d) { return d >= '0' && d <= '9'; });
        if (!three) break;
        exponent = true;
      }
    }
  }
  std::string text(rest.substr(0, length));
  rest.remove_prefix(length);
  if (rest.starts_with(',')) rest.remove_prefix(1);
  if (is_missing_value(text)) return text.empty() ? std::nullopt : std::optional(std::nan(""));
  std::replace(text.begin(), text.end(), 'D', 'E');
  std::replace(text.begin(), text.end(), 'd', 'e');
  const std::size_t sign = text.find_first_of("+-", 1);
  if (sign != std::string::npos && text.find_first_of("eE") == std::string::npos) text.insert(sign, "E");
  const char* const first = text.data() + (text.starts_with('+') ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) return std::nan("");
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return std::isfinite(value) ? value : std::nan("");
}

// An abscissa with six digits: the whole rate that they stand for.
double whole_rate(double increment) {
  const double rate = 1.0 / increment;
  const double digit = std::pow(10.0, std::floor(std::log10(increment)) - 5.0);
  const double whole = std::round(rate);
  return whole > 0.0 && std::abs(1.0 / whole - increment) <= 0.5000001 * digit ? whole : rate;
}

struct Function {
  std::string id, response;
  int type = 0, node = 0, direction = 0;
  int data_type = 0;
  std::size_t points = 0;
  bool even = true;
  double first = 0.0, increment = 0.0;
  int abscissa_type = 0, ordinate_type = 0;
  std::string abscissa_unit, ordinate_unit;

  [[nodiscard]] bool complex() const { return data_type == 5 || data_type == 6; }
  [[nodiscard]] bool single() const { return data_type == 2 || data_type == 5; }
  [[nodiscard]] bool is_time_history() const { return abscissa_type == time_type && !complex(); }
  [[nodiscard]] std::size_t numbers() const { return points * (complex() ? 2U : 1U) + (even ? 0U : points); }
};

// "58b x y 11 n": byte order, format of the numbers, header lines, bytes of data.
struct BinaryHeader {
  bool little = true;
  std::size_t bytes = 0;
};

class UniversalReader {
 public:
  UniversalReader(std::string_view bytes, std::string_view source) : rest_(bytes) {
    table_.source = source;
    table_.format = "universal file";
  }

  RawTable run() {
    while (next_dataset()) {
    }
    if (kept_.empty()) {
      throw InputError(table_.source, 0, "no time history is found" + (passed_.empty() ? "" : "; it holds " + passed()),
                       "a dataset 58 with the time as abscissa");
    }
    if (!passed_.empty()) table_.notes.push_back("passed over: " + passed());
    fill_table();
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail(std::string_view wrong, std::string_view expected) const {
    throw InputError(table_.source, line_, wrong, expected);
  }

  std::optional<std::string_view> next_line() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    while (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  std::string_view need_line(std::string_view what) {
    const auto line = next_line();
    if (!line) fail("the file ends within a dataset", what);
    return *line;
  }

  static bool is_delimiter(std::string_view line) { return trimmed(line) == "-1"; }

  bool next_dataset() {
    std::optional<std::string_view> line;
    do {
      line = next_line();
      if (!line) return false;
    } while (!is_delimiter(*line));
    const auto number = next_line();
    if (!number) return false;
    const std::string_view name = trimmed(field_of(*number, 0, 7));
    if (name == "58") {
      read_function(std::nullopt);
    } else if (name == "58b" || name == "58B") {
      read_function(binary_header(*number));
    } else {
      if (name == "164")
        read_units();
      else
        ++passed_["dataset " + (read_integer(name) ? std::string(name) : "?")];
      skip_dataset();
    }
    return true;
  }

  void skip_dataset() {
    for (auto line = next_line(); line && !is_delimiter(*line);) line = next_line();
  }

  BinaryHeader binary_header(std::string_view line) const {
    const auto order = read_integer(field_of(line, 7, 6)), format = read_integer(field_of(line, 13, 6));
    const auto bytes = read_integer(field_of(line, 31, 12));
    if (!order || (*order != 1 && *order != 2) || !format || *format != 2 || !bytes || *bytes < 0) {
      fail("the header of dataset 58b is " + in_quotes(line), "byte order 1 or 2, format 2 (IEEE 754), 11, bytes");
    }
    return {*order == 1, static_cast<std::size_t>(*bytes)};
  }

  // Dataset 164: its unit of length, say, in metres is 1 ÷ factor.
  void read_units() {
    static_cast<void>(need_line("the code of the units"));
    std::string_view factors = need_line("factors of length, force and temperature");
    const auto length = next_number(factors), force = next_number(factors);
    if (length && *length > 0.0) length_ = 1.0 / *length;
    if (force && *force > 0.0) force_ = 1.0 / *force;
  }

  int need_integer(std::string_view line, std::size_t begin, std::size_t width, std::string_view what) const {
    const auto value = read_integer(field_of(line, begin, width));
    if (!value) fail(in_quotes(trimmed(field_of(line, begin, width))) + " is no integer", what);
    return *value;
  }

  Function read_header() {
    Function f;
    f.id = trimmed(need_line("ID line 1"));
    for (int i = 0; i < 4; ++i) static_cast<void>(need_line("an ID line"));
    const std::string_view six = need_line("record 6 of dataset 58");
    f.type = need_integer(six, 0, 5, "the type of the function");
    f.response = trimmed(field_of(six, 31, 10));
    f.node = read_integer(field_of(six, 41, 10)).value_or(0);
    f.direction = read_integer(field_of(six, 51, 4)).value_or(0);
    const std::string_view seven = need_line("record 7 of dataset 58");
    f.data_type = need_integer(seven, 0, 10, "the type of the numbers: 2, 4, 5 or 6");
    if (f.data_type != 2 && f.data_type != 4 && !f.complex()) {
      fail("the type of the numbers is " + std::to_string(f.data_type), "2, 4, 5 or 6");
    }
    const int points = need_integer(seven, 10, 10, "the number of points");
    if (points < 0) fail("there are " + std::to_string(points) + " points", "0 or more");
    f.points = static_cast<std::size_t>(points);
    f.even = need_integer(seven, 20, 10, "1 for even spacing, 0 for uneven") == 1;
    std::string_view spacing = field_of(seven, 30, 50);
    f.first = next_number(spacing).value_or(0.0);
    f.increment = next_number(spacing).value_or(0.0);
    const std::string_view abscissa = need_line("record 8 of dataset 58");
    f.abscissa_type = need_integer(abscissa, 0, 10, "the kind of the abscissa");
    f.abscissa_unit = unit_in(abscissa);
    const std::string_view ordinate = need_line("record 9 of dataset 58");
    f.ordinate_type = need_integer(ordinate, 0, 10, "the kind of the ordinate");
    f.ordinate_unit = unit_in(ordinate);
    static_cast<void>(need_line("record 10 of dataset 58"));
    static_cast<void>(need_line("record 11 of dataset 58"));
    return f;
  }

  static std::string unit_in(std::string_view axis) {
    const std::string_view unit = trimmed(field_of(axis, 47, 20));
    return unit == "NONE" || unit == "none" ? "" : std::string(unit);
  }

  void read_function(std::optional<BinaryHeader> binary) {
    const std::size_t begun = line_;
    const Function f = read_header();
    if (!f.is_time_history()) {
      ++passed_["function of type " + std::to_string(f.type)];
      if (binary) skip_bytes(binary->bytes);
      return skip_dataset();
    }
    if (f.even && f.points > 1 && !(f.increment > 0.0 && std::isfinite(1.0 / f.increment))) {
      fail("the increment of the time is " + firmware::shortest(f.increment), "seconds above 0");
    }
    std::vector<double> numbers = binary ? binary_numbers(f, *binary) : ascii_numbers(f);
    const auto end = next_line();
    if (end && !is_delimiter(*end)) fail_behind(f);
    if (!end) table_.notes.emplace_back("the last dataset has no end");
    keep(f, std::move(numbers), begun);
  }

  [[noreturn]] void fail_behind(const Function& f) const {
    fail("more follows the " + std::to_string(f.points) + " points of a dataset", "a line with -1");
  }

  std::vector<double> ascii_numbers(const Function& f) {
    std::vector<double> numbers;
    while (numbers.size() < f.numbers()) {
      std::string_view line =
          need_line(std::to_string(f.numbers()) + " numbers; there are " + std::to_string(numbers.size()));
      if (is_delimiter(line)) {
        fail("a dataset ends after " + std::to_string(numbers.size()) + " numbers", std::to_string(f.numbers()));
      }
      while (!trimmed(line).empty() && numbers.size() < f.numbers()) {
        const std::string_view before = trimmed(line);
        const auto number = next_number(line);
        if (!number) fail(in_quotes(before.substr(0, 20)) + " is no number", "a number of dataset 58");
        numbers.push_back(*number);
      }
      // Some programs fill the last line with zeros.
      while (!trimmed(line).empty()) {
        const auto number = next_number(line);
        if (!number || *number != 0.0) fail_behind(f);
        if (padding_note_) continue;
        table_.notes.emplace_back("the last line of a dataset is filled with zeros, which are left out");
        padding_note_ = true;
      }
    }
    return numbers;
  }

  void skip_bytes(std::size_t count) {
    if (count > rest_.size()) fail("the file ends within binary numbers", std::to_string(count) + " bytes");
    rest_.remove_prefix(count);
  }

  // The abscissa of unevenly spaced points is single, as are the values of types 2 and 5; the others are double.
  std::vector<double> binary_numbers(const Function& f, const BinaryHeader& binary) {
    const std::size_t value_size = f.single() ? 4 : 8;
    const std::size_t row_size = value_size + (f.even ? 0U : 4U);
    if (binary.bytes / row_size < f.points || binary.bytes > rest_.size()) {
      fail("there are " + std::to_string(std::min(binary.bytes, rest_.size())) + " bytes for " +
               std::to_string(f.points) + " points",
           std::to_string(row_size) + " bytes a point");
    }
    const char* at = rest_.data();
    std::vector<double> numbers;
    const auto put = [&](std::size_t size) {
      std::array<char, 8> raw{};
      std::memcpy(raw.data(), at, size);
      at += size;
      if (binary.little != (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.begin() + size);
      float single = 0.0F;
      double value = 0.0;
      std::memcpy(&single, raw.data(), sizeof single);
      std::memcpy(&value, raw.data(), sizeof value);
      if (size == 4) value = static_cast<double>(single);
      numbers.push_back(std::isfinite(value) ? value : std::nan(""));
    };
    for (std::size_t k = 0; k < f.points; ++k) {
      if (!f.even) put(4);
      put(value_size);
    }
    rest_.remove_prefix(binary.bytes);
    if (!is_delimiter(rest_.substr(0, rest_.find('\n')))) static_cast<void>(next_line());  // some end the data's line
    return numbers;
  }

  struct Kept {
    Function function;
    std::vector<double> values, time;
    std::size_t line;
  };

  void keep(const Function& f, std::vector<double> numbers, std::size_t line) {
    Kept kept{f, {}, {}, line};
    const std::optional<firmware::Unit> unit = firmware::find_unit(f.abscissa_unit);
    const double scale = unit && unit->dimension == firmware::Dimension::time ? unit->scale : 1.0;
    const double rate = f.even && f.increment > 0.0 ? whole_rate(f.increment) : 1.0;
    for (std::size_t k = 0; k < f.points; ++k) {
      const double time = f.even ? f.first + static_cast<double>(k) / rate : numbers[2 * k];
      if (!std::isfinite(time)) fail("the time of point " + std::to_string(k + 1) + " is missing", "a number");
      kept.time.push_back(firmware::Target::in_seconds(time, scale));
      kept.values.push_back(f.even ? numbers[k] : numbers[2 * k + 1]);
    }
    kept_.push_back(std::move(kept));
  }

  std::string passed() const {
    std::string text;
    for (const auto& [what, count] : passed_) {
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " × " + what;
    }
    return text;
  }

  static std::string name_of(const Function& f) {
    const bool named = !f.response.empty() && f.response != "NONE";
    if (named && f.id.starts_with(f.response)) return f.id;
    if (!named) return f.id.empty() || f.id == "NONE" ? "node " + std::to_string(f.node) : f.id;
    constexpr std::array<std::string_view, 7> directions{"", "X", "Y", "Z", "RX", "RY", "RZ"};
    const auto axis = static_cast<std::size_t>(std::abs(static_cast<long>(f.direction)));
    if (f.node == 0 || axis == 0 || axis >= directions.size()) return f.response;
    return f.response + " " + std::to_string(f.node) + (f.direction < 0 ? "-" : "+") + std::string(directions[axis]);
  }

  // Of a function that states no unit: by its kind and the units of the file, where it states them.
  std::string unit_of(const Function& f) const {
    if (!f.ordinate_unit.empty()) return f.ordinate_unit;
    const auto scaled = [](double scale, std::string_view unit) {
      return scale == 1.0 ? std::string(unit) : firmware::shortest(scale) + " " + std::string(unit);
    };
    if (f.ordinate_type == 8 && length_) return scaled(*length_, "m");
    if (f.ordinate_type == 11 && length_) return scaled(*length_, "m/s");
    if (f.ordinate_type == 12 && length_) return scaled(*length_, "m/s²");
    if ((f.ordinate_type == 9 || f.ordinate_type == 13) && force_) return scaled(*force_, "N");
    return "";
  }

  void fill_table() {
    const bool one_axis =
        std::all_of(kept_.begin(), kept_.end(), [&](const Kept& one) { return one.time == kept_.front().time; });
    if (one_axis) {
      RawColumn time{"t"};
      time.text = "t";
      time.unit = "s";
      time.values = kept_.front().time;
      table_.rows = time.values.size();
      table_.columns.push_back(std::move(time));
    }
    table_.header_line = kept_.front().line;
    std::map<std::string, int> names;
    for (Kept& one : kept_) {
      RawColumn column{to_utf8(name_of(one.function))};
      if (const int times = ++names[column.name]; times > 1) column.name += " (" + std::to_string(times) + ")";
      column.text = column.name;
      column.unit = to_utf8(unit_of(one.function));
      column.values = std::move(one.values);
      if (!one_axis) column.own_time = std::move(one.time);
      table_.columns.push_back(std::move(column));
    }
  }

  std::string_view rest_;
  std::size_t line_ = 0;
  RawTable table_;
  bool padding_note_ = false;
  std::vector<Kept> kept_;
  std::map<std::string, int> passed_;
  std::optional<double> length_, force_;  // [m], [N] of the file's units
};

}  // namespace

bool is_universal_file(std::string_view head) {
  const auto line = [&head] {
    const std::size_t end = std::min(head.find('\n'), head.size());
    const std::string_view text = trimmed(head.substr(0, end));
    head.remove_prefix(std::min(end + 1, head.size()));
    return text.ends_with('\r') ? trimmed(text.substr(0, text.size() - 1)) : text;
  };
  std::string_view first = line();
  while (first.empty() && !head.empty()) first = line();
  if (first != "-1") return false;
  const std::string_view second = trimmed(field_of(line(), 0, 7));
  const auto number = read_integer(second.ends_with('b') ? second.substr(0, second.size() - 1) : second);
  return number && *number > 0;
}

RawTable table_of_universal_file(std::string_view bytes, std::string_view source) {
  return UniversalReader(bytes, source).run();
}

}  // namespace host_sim
