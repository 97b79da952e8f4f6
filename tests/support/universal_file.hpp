// An ASCII universal file read by the description of its format: field by field, by column. A reader of its own, so
// that the product's reader and writer are not judged by each other.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace support::universal {

/// Dataset 58, as far as the format says what a field is.
struct Function {
  std::vector<std::string> id;
  int type{}, number{}, version{}, load_case{}, response_node{}, response_direction{}, reference_node{},
      reference_direction{};
  std::string response, reference;
  int data_type{}, points{}, spacing{};
  double first{}, increment{}, z{};
  struct Axis {
    int type{}, length{}, force{}, temperature{};
    std::string label, unit;
  };
  std::vector<Axis> axes;
  std::vector<double> numbers;
};

/// A line of a file, taken apart from the left.
class Record {
 public:
  explicit Record(std::string line, std::size_t width) : rest_(std::move(line)) {
    if (rest_.size() != width)
      throw std::runtime_error("a line of " + std::to_string(rest_.size()) + " columns: " + rest_);
  }
  [[nodiscard]] int integer(std::size_t width) {
    const std::string field = right(width);
    int value = 0;
    const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
    if (read.ptr != field.data() + field.size() || field.empty()) throw std::runtime_error("no integer: " + field);
    return value;
  }
  [[nodiscard]] double real(std::size_t width) {
    const std::string field = right(width);
    double value = 0.0;
    const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
    if (read.ptr != field.data() + field.size() || field.empty()) throw std::runtime_error("no number: " + field);
    if (field.find('.') == std::string::npos) throw std::runtime_error("no decimal point: " + field);
    return value;
  }
  [[nodiscard]] std::string text(std::size_t width) {
    std::string field = take(width);
    field.erase(field.find_last_not_of(' ') + 1);
    return field;
  }
  void blank(std::size_t width) {
    if (take(width).find_first_not_of(' ') != std::string::npos) throw std::runtime_error("not blank");
  }
  void end() {
    if (rest_.find_first_not_of(' ') != std::string::npos) throw std::runtime_error("more than fields: " + rest_);
  }

 private:
  std::string take(std::size_t width) {
    const std::string field = rest_.substr(0, width);
    if (field.size() < width) throw std::runtime_error("the line is too short");
    rest_.erase(0, width);
    return field;
  }
  std::string right(std::size_t width) {
    const std::string field = take(width);
    const std::size_t first = field.find_first_not_of(' ');
    return first == std::string::npos ? "" : field.substr(first);
  }
  std::string rest_;
};

class File {
 public:
  explicit File(const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      if (end == std::string::npos) throw std::runtime_error("the last line has no end");
      for (std::size_t i = at; i < end; ++i) {
        if (text[i] < ' ' || text[i] > '~') throw std::runtime_error("not ASCII");
      }
      lines_.push_back(text.substr(at, end - at));
      at = end + 1;
    }
  }
  [[nodiscard]] bool at_end() const { return next_ == lines_.size(); }
  Record record(std::size_t width = 80) {
    if (at_end()) throw std::runtime_error("the file ends too early");
    return Record(lines_[next_++], width);
  }
  void delimiter() {
    Record line = record(6);
    EXPECT_EQ(line.integer(6), -1);
    line.end();
  }
  int dataset() {
    delimiter();
    Record line = record();
    const int number = line.integer(6);
    line.end();
    return number;
  }

  Function function() {
    Function f;
    for (int i = 0; i < 5; ++i) f.id.push_back(record().text(80));
    Record six = record();  // 2(I5,I10),2(1X,10A1,I10,I4)
    f.type = six.integer(5), f.number = six.integer(10), f.version = six.integer(5), f.load_case = six.integer(10);
    six.blank(1);
    f.response = six.text(10), f.response_node = six.integer(10), f.response_direction = six.integer(4);
    six.blank(1);
    f.reference = six.text(10), f.reference_node = six.integer(10), f.reference_direction = six.integer(4);
    six.end();
    Record seven = record();  // 3I10,3E13.5
    f.data_type = seven.integer(10), f.points = seven.integer(10), f.spacing = seven.integer(10);
    f.first = seven.real(13), f.increment = seven.real(13), f.z = seven.real(13);
    seven.end();
    for (int i = 0; i < 4; ++i) {  // I10,3I5,2(1X,20A1)
      Record line = record();
      Function::Axis axis;
      axis.type = line.integer(10), axis.length = line.integer(5), axis.force = line.integer(5),
      axis.temperature = line.integer(5);
      line.blank(1);
      axis.label = line.text(20);
      line.blank(1);
      axis.unit = line.text(20);
      line.end();
      f.axes.push_back(axis);
    }
    const auto count = static_cast<std::size_t>(f.points) * (f.data_type == 6 ? 2U : 1U);
    while (f.numbers.size() < count) {  // 4E20.12, the last line as long as it needs
      const std::size_t in_line = std::min<std::size_t>(4, count - f.numbers.size());
      Record line = record(20 * in_line);
      for (std::size_t i = 0; i < in_line; ++i) f.numbers.push_back(line.real(20));
    }
    delimiter();
    return f;
  }

 private:
  std::vector<std::string> lines_;
  std::size_t next_ = 0;
};

}  // namespace support::universal
