#include "host_sim/recording_files/binary/workbook_file.hpp"

#include <zip.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_table.hpp"

namespace host_sim {
namespace {

using firmware::InputError;

constexpr zip_uint64_t largest_part = zip_uint64_t{2} << 30U;  // [byte] of XML
constexpr std::size_t most_cells_in_a_row = 16384;             // Excel's own limit
constexpr std::size_t most_rows = 1048576;

std::string with_entities_replaced(std::string_view xml) {
  std::string text;
  for (std::size_t i = 0; i < xml.size();) {
    const std::size_t end = xml[i] == '&' ? xml.find(';', i) : std::string_view::npos;
    if (end == std::string_view::npos || end - i > 10) {
      text += xml[i++];
      continue;
    }
    const std::string_view name = xml.substr(i + 1, end - i - 1);
    constexpr std::array<std::pair<std::string_view, char>, 5> named{
        {{"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}}};
    const auto* const known =
        std::find_if(named.begin(), named.end(), [&](const auto& entity) { return entity.first == name; });
    if (known != named.end()) text += known->second;
    if (name.starts_with("#")) {
      const bool hexadecimal = name.starts_with("#x");
      unsigned code = 0;
      std::from_chars(name.data() + (hexadecimal ? 2 : 1), name.data() + name.size(), code, hexadecimal ? 16 : 10);
      append_utf8(text, code);
    }
    i = end + 1;
  }
  return text;
}

// Goes through the tags of an XML text; prefixes of name spaces are dropped.
class XmlScanner {
 public:
  explicit XmlScanner(std::string_view xml) : rest_(xml) {}

  // The next tag; false: the end. `text` has then what stood before it.
  bool next() {
    const std::size_t open = rest_.find('<');
    const std::size_t close = open == std::string_view::npos ? open : rest_.find('>', open);
    if (close == std::string_view::npos) return false;
    text = rest_.substr(0, open);
    tag_ = rest_.substr(open + 1, close - open - 1);
    rest_.remove_prefix(close + 1);
    ends = tag_.starts_with('/');
    empty = tag_.ends_with('/');
    if (ends) tag_.remove_prefix(1);
    name = tag_.substr(0, tag_.find_first_of(" \t\r\n/"));
    if (const std::size_t prefix = name.find(':'); prefix != std::string_view::npos) name.remove_prefix(prefix + 1);
    return true;
  }

  [[nodiscard]] bool begins(std::string_view wanted) const { return !ends && name == wanted; }
  [[nodiscard]] bool closes(std::string_view wanted) const { return (ends || empty) && name == wanted; }

  // The value of an attribute of the tag; empty: it has none.
  [[nodiscard]] std::string_view attribute(std::string_view wanted) const {
    for (std::size_t at = tag_.find(wanted); at != std::string_view::npos; at = tag_.find(wanted, at + 1)) {
      const std::string_view behind = tag_.substr(at + wanted.size());
      const bool whole = at > 0 && (tag_[at - 1] == ' ' || tag_[at - 1] == '\n' || tag_[at - 1] == ':');
      if (!whole || behind.size() < 2 || behind[0] != '=' || (behind[1] != '"' && behind[1] != '\'')) continue;
      return behind.substr(2, behind.find(behind[1], 2) - 2);
    }
    return {};
  }

  std::string_view text, name;
  bool ends = false, empty = false;

 private:
  std::string_view rest_, tag_;
};

std::vector<std::string> shared_strings(std::string_view xml) {
  std::vector<std::string> strings;
  bool phonetic = false;
  for (XmlScanner scanner(xml); scanner.next();) {
    if (scanner.begins("si")) strings.emplace_back();
    if (scanner.name == "rPh") phonetic = !scanner.closes("rPh");
    if (scanner.closes("t") && !strings.empty() && !phonetic) strings.back() += with_entities_replaced(scanner.text);
  }
  return strings;
}

// True: the number format shows a date or a time: it has letters of them outside quotes and brackets.
bool is_format_of_dates(std::string_view code) {
  bool quoted = false;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (code[i] == '\\' || code[i] == '_') {
      ++i;
    } else if (code[i] == '[') {  // "[h]" is a duration, "[Red]" a colour
      const std::string_view inside = code.substr(i + 1, code.find(']', i) - i - 1);
      if (inside == "h" || inside == "hh" || inside == "m" || inside == "mm" || inside == "s" || inside == "ss")
        return true;
      i += inside.size();
    } else if (std::string_view("yYdDhHsS").find(code[i]) != std::string_view::npos) {
      return true;
    }
  }
  return false;
}

// By the number of a cell's style: whether it shows a date or a time.
std::vector<bool> styles_of_dates(std::string_view xml) {
  std::vector<std::pair<int, bool>> own;  // formats of this workbook
  std::vector<bool> styles;
  bool in_cell_styles = false;
  for (XmlScanner scanner(xml); scanner.next();) {
    if (scanner.begins("numFmt")) {
      own.emplace_back(std::atoi(std::string(scanner.attribute("numFmtId")).c_str()),
                       is_format_of_dates(with_entities_replaced(scanner.attribute("formatCode"))));
    }
    if (scanner.name == "cellXfs") in_cell_styles = !scanner.ends;
    if (!in_cell_styles || !scanner.begins("xf")) continue;
    const int format = std::atoi(std::string(scanner.attribute("numFmtId")).c_str());
    const auto found = std::find_if(own.begin(), own.end(), [&](const auto& one) { return one.first == format; });
    const bool built_in = (format >= 14 && format <= 22) || (format >= 45 && format <= 47);
    styles.push_back(found != own.end() ? found->second : built_in);
  }
  return styles;
}

// Days since the workbook's day 0 as "2024-03-12 10:00:00.001000"; less than a day is a time alone.
// Source: H. Hinnant, "chrono-compatible low-level date algorithms", civil_from_days.
std::string date_text(double days, long day_zero) {
  if (!(days >= 0.0 && days < 3e6)) return "";
  auto microseconds = static_cast<std::int64_t>(std::llround(days * 86400e6));
  const std::int64_t whole = microseconds / 86400000000;
  microseconds -= whole * 86400000000;
  std::array<char, 64> text{};
  const auto time_of_day = [&] {
    std::snprintf(text.data(), text.size(), "%02d:%02d:%02d.%06d", static_cast<int>(microseconds / 3600000000),
                  static_cast<int>(microseconds / 60000000 % 60), static_cast<int>(microseconds / 1000000 % 60),
                  static_cast<int>(microseconds % 1000000));
    return std::string(text.data());
  };
  if (whole == 0) return time_of_day();
  const long z = static_cast<long>(whole) + day_zero + 719468;
  const long era = z / 146097;
  const long day_of_era = z - era * 146097;
  const long year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146096) / 365;
  const long day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const long month = (5 * day_of_year + 2) / 153;
  const std::string clock = time_of_day();
  std::snprintf(text.data(), text.size(), "%04ld-%02ld-%02ld ", year_of_era + era * 400 + (month >= 10 ? 1 : 0),
                month < 10 ? month + 3 : month - 9, day_of_year - (153 * month + 2) / 5 + 1);
  return text.data() + clock;
}

// Column and row of "BC12", both from 0.
std::pair<std::size_t, std::size_t> place_of(std::string_view reference) {
  std::size_t column = 0;
  std::size_t i = 0;
  for (; i < reference.size() && reference[i] >= 'A' && reference[i] <= 'Z' && i < 4; ++i)
    column = 26 * column + static_cast<std::size_t>(reference[i] - 'A') + 1;
  std::size_t row = 0;
  std::from_chars(reference.data() + i, reference.data() + reference.size(), row);
  return {column == 0 ? 0 : column - 1, row == 0 ? 0 : row - 1};
}

struct CloseZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, CloseZip>;

// A part of the archive; empty: it is not there.
std::string part_of(zip_t* archive, const std::string& name, const std::string& source) {
  zip_stat_t status{};
  if (zip_stat(archive, name.c_str(), 0, &status) != 0) return "";
  if ((status.valid & ZIP_STAT_SIZE) == 0 || status.size > largest_part)
    throw InputError(source, 0, "the workbook's part " + firmware::in_quotes(name) + " is larger than 2 GiB",
                     "a smaller workbook");
  zip_file_t* const opened = zip_fopen(archive, name.c_str(), 0);
  if (opened == nullptr)
    throw InputError(source, 0, "the workbook's part " + firmware::in_quotes(name) + " cannot be read", "a whole file");
  std::string bytes(status.size, '\0');
  std::size_t size = 0;
  for (zip_int64_t got = 0;
       size < bytes.size() && (got = zip_fread(opened, bytes.data() + size, bytes.size() - size)) > 0;)
    size += static_cast<std::size_t>(got);
  zip_fclose(opened);
  if (size < bytes.size())
    throw InputError(source, 0, "the workbook's part " + firmware::in_quotes(name) + " is damaged", "a whole file");
  return bytes;
}

struct Sheet {
  std::string name, part;
};

std::vector<Sheet> sheets_of(std::string_view workbook, std::string_view relations) {
  std::vector<Sheet> sheets;
  for (XmlScanner scanner(workbook); scanner.next();) {
    if (!scanner.begins("sheet")) continue;
    Sheet sheet{with_entities_replaced(scanner.attribute("name")), ""};
    const std::string_view id = scanner.attribute("id");
    for (XmlScanner relation(relations); relation.next();) {
      if (!relation.begins("Relationship") || relation.attribute("Id") != id) continue;
      const std::string_view target = relation.attribute("Target");
      sheet.part = target.starts_with('/') ? std::string(target.substr(1)) : "xl/" + std::string(target);
    }
    if (!sheet.part.empty()) sheets.push_back(std::move(sheet));
  }
  return sheets;
}

}  // namespace

std::string text_of_sheet(const std::string& sheet, const std::string& strings, const std::string& styles,
                          long day_zero) {
  const std::vector<std::string> shared = shared_strings(strings);
  const std::vector<bool> dates = styles_of_dates(styles);
  std::string text;
  std::size_t row = 0;     // of the line that is being written
  std::size_t column = 0;  // of the field that is being written
  std::string type, value;
  std::size_t style = 0;
  std::size_t own_row = 0, own_column = 0;  // of a cell that does not say its place
  bool first_row = true;
  for (XmlScanner scanner(sheet); scanner.next();) {
    if (scanner.begins("row")) {
      const int said = std::atoi(std::string(scanner.attribute("r")).c_str());
      own_row = said > 0 ? static_cast<std::size_t>(said) - 1 : first_row ? 0 : own_row + 1;
      own_column = 0;
      first_row = false;
    }
    if (scanner.begins("c")) {
      type = scanner.attribute("t");
      style = static_cast<std::size_t>(std::max(0, std::atoi(std::string(scanner.attribute("s")).c_str())));
      value.clear();
      const auto reference = scanner.attribute("r");
      const auto [to_column, to_row] = reference.empty() ? std::pair(own_column, own_row) : place_of(reference);
      own_column = to_column + 1;
      if (text.size() > largest_part) {
        throw InputError("sheet", 0, "its text is larger than 2 GiB", "a smaller sheet");
      }
      if (to_row >= most_rows || to_column >= most_cells_in_a_row) continue;
      for (; row < to_row; ++row, column = 0) text += '\n';
      for (; column < to_column; ++column) text += '\t';
    }
    if (scanner.closes("v") || scanner.closes("t")) value += with_entities_replaced(scanner.text);
    if (!scanner.closes("c")) continue;
    if (type == "s") {
      const auto index = static_cast<std::size_t>(std::max(0, std::atoi(value.c_str())));
      value = index < shared.size() ? shared[index] : "";
    } else if ((type.empty() || type == "n") && !value.empty() && style < dates.size() && dates[style]) {
      value = date_text(std::strtod(value.c_str(), nullptr), day_zero);
    }
    for (const char c : value) text += c == '\t' || c == '\n' || c == '\r' ? ' ' : c == '"' ? '\'' : c;
  }
  return text + "\n";
}

RawTable table_of_workbook(const std::filesystem::path& file) {
  const std::string source = file.string();
  int error = 0;
  const Archive archive(zip_open(file.c_str(), ZIP_RDONLY, &error));
  if (archive == nullptr)
    throw InputError(source, 0, "the Excel workbook is damaged: its archive cannot be opened", "a whole file");
  const auto part = [&](const std::string& name) { return part_of(archive.get(), name, source); };
  const std::string workbook = part("xl/workbook.xml");
  const std::vector<Sheet> sheets = sheets_of(workbook, part("xl/_rels/workbook.xml.rels"));
  const std::string strings = part("xl/sharedStrings.xml");
  const std::string styles = part("xl/styles.xml");
  const bool from_1904 =
      workbook.find("date1904=\"1\"") != std::string::npos || workbook.find("date1904=\"true\"") != std::string::npos;
  std::optional<RawTable> table;
  std::vector<LeftOut> others;
  for (const Sheet& sheet : sheets) {
    if (table) {
      others.push_back({"sheet " + sheet.name, "another sheet"});
      continue;
    }
    try {
      table = read_text_table(text_of_sheet(part(sheet.part), strings, styles, from_1904 ? -24107 : -25569), source);
      table->format = "Excel workbook, sheet " + firmware::in_quotes(sheet.name);
    } catch (const InputError&) {
      others.push_back({"sheet " + sheet.name, "no table of numbers"});
    }
  }
  if (!table) {
    throw InputError(source, 0, "no sheet of the Excel workbook holds a table of numbers",
                     "rows of numbers below the names of their columns");
  }
  table->left_out.insert(table->left_out.end(), others.begin(), others.end());
  return std::move(*table);
}

}  // namespace host_sim
