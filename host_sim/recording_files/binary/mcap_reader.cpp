#include "host_sim/recording_files/binary/mcap_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"
#include "host_sim/recording_files/tables/channel_guess.hpp"
#include "host_sim/recording_files/tables/headings.hpp"

namespace host_sim {
namespace {

using firmware::InputError;

constexpr double not_logged = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_log_columns = 4096;

// Little-endian fields of a record, in their order.
class RecordFields {
 public:
  RecordFields(std::string_view bytes, std::string_view source) : rest_(bytes), source_(source) {}

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const std::string_view part = raw(size);
    for (std::size_t i = size; i-- > 0;) value = value << 8U | static_cast<unsigned char>(part[i]);
    return value;
  }
  std::string_view text() { return raw(number(4)); }
  std::string_view raw(std::uint64_t size) {
    if (size > rest_.size()) throw InputError(source_, 0, "the MCAP log is damaged or cut off", "a whole file");
    const std::string_view part = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return part;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::string_view source_;
};

struct LoggedColumn {
  std::string name, unit;
  std::vector<double> values;
};

struct Topic {
  std::string name;
  std::string unreadable;  // empty: JSON
  std::uint64_t schema = 0;
  std::vector<std::uint64_t> log_times;  // [ns]
  std::vector<LoggedColumn> columns;
  std::map<std::string, std::size_t, std::less<>> by_name;
  std::map<std::string, std::string> left_out;  // members, with the reason
};

class McapReader {
 public:
  McapReader(std::string_view bytes, std::string_view source) : bytes_(bytes), source_(source) {}

  RawTable run() {
    RecordFields file(bytes_, source_);
    static_cast<void>(file.raw(8));
    read_records(file, true);
    RawTable table;
    table.source = source_;
    table.format = "MCAP";
    for (auto& [id, topic] : topics_) add(table, topic);
    if (table.columns.empty()) {
      std::string why = "no topic of the MCAP log holds numbers as JSON";
      if (!table.left_out.empty())
        why += ": " + firmware::in_quotes(table.left_out[0].name) + ": " + table.left_out[0].reason;
      throw InputError(source_, 0, why, "JSON messages with numbers");
    }
    if (!cut_off_.empty()) table.notes.push_back(cut_off_);
    return table;
  }

 private:
  // Operation codes of the specification; others say nothing of values.
  void read_records(RecordFields& records, bool top) {
    while (!records.rest().empty()) {
      if (top && is_mcap(records.rest())) return;
      constexpr std::size_t head = 9;  // [byte] of a record: operation code and size
      if (top && records.rest().size() < head) {
        cut_off_ = "the log is cut off: what stands in whole records is read";
        return;
      }
      const std::uint64_t opcode = records.number(1);
      const std::uint64_t size = records.number(8);
      if (top && size > records.rest().size()) {
        // A log whose writer was ended: what stands in whole records counts.
        cut_off_ = "the log is cut off: what stands in whole records is read";
        return;
      }
      RecordFields record(records.raw(size), source_);
      if (opcode == 0x03) read_schema(record);
      if (opcode == 0x04) read_channel(record);
      if (opcode == 0x05) read_message(record);
      if (opcode == 0x06 && top) read_chunk(record);
      if (opcode == 0x0f) return;  // the end of the data: a summary follows
    }
  }

  void read_chunk(RecordFields& chunk) {
    static_cast<void>(chunk.raw(8 + 8 + 8 + 4));  // first and last time, size, checksum
    const std::string compression(chunk.text());
    if (!compression.empty()) {
      throw InputError(source_, 0, "the MCAP log is compressed by " + firmware::in_quotes(compression),
                       "one without compression: mcap compress --compression none IN -o OUT");
    }
    RecordFields records(chunk.raw(chunk.number(8)), source_);
    read_records(records, false);
  }

  void read_schema(RecordFields& record) {
    const std::uint64_t id = record.number(2);
    static_cast<void>(record.text());
    if (record.text() != "jsonschema") return;
    const auto schema = nlohmann::ordered_json::parse(record.text(), nullptr, false);
    if (schema.is_object()) read_units(schema, "", units_[id], 0);
  }

  static void read_units(const nlohmann::ordered_json& schema, const std::string& path,
                         std::map<std::string, std::string>& units, int depth) {
    const auto properties = schema.find("properties");
    if (properties == schema.end() || !properties->is_object() || depth > 8) return;
    for (const auto& [name, property] : properties->items()) {
      if (!property.is_object()) continue;
      const auto description = property.find("description");
      if (description != property.end() && description->is_string())
        units[path + name] = description->get<std::string>();
      read_units(property, path + name + ".", units, depth + 1);
    }
  }

  void read_channel(RecordFields& record) {
    const std::uint64_t id = record.number(2);
    if (topics_.contains(id)) return;
    Topic topic;
    topic.schema = record.number(2);
    topic.name = record.text();
    const std::string_view encoding = record.text();
    if (encoding != "json") topic.unreadable = "messages as " + std::string(encoding) + ", not as JSON";
    topics_[id] = std::move(topic);
  }

  void read_message(RecordFields& record) {
    const auto found = topics_.find(record.number(2));
    if (found == topics_.end() || !found->second.unreadable.empty()) return;
    Topic& topic = found->second;
    static_cast<void>(record.number(4));
    const std::uint64_t log_time = record.number(8);
    static_cast<void>(record.number(8));
    const auto message = nlohmann::ordered_json::parse(record.rest(), nullptr, false);
    if (!message.is_object()) {
      topic.left_out[""] = "messages that are no JSON objects";
      return;
    }
    topic.log_times.push_back(log_time);
    take_members(topic, message, "", 0);
    for (LoggedColumn& column : topic.columns) column.values.resize(topic.log_times.size(), not_logged);
  }

  void take_members(Topic& topic, const nlohmann::ordered_json& object, const std::string& path, int depth) {
    for (const auto& [name, member] : object.items()) {
      const std::string full = path + name;
      if (member.is_object() && depth < 8) {
        take_members(topic, member, full + ".", depth + 1);
      } else if (member.is_number() || member.is_boolean() || member.is_null()) {
        LoggedColumn* const column = column_of(topic, full, member.is_null());
        if (column == nullptr) continue;
        column->values.resize(topic.log_times.size() - 1, not_logged);
        column->values.push_back(member.is_number()   ? member.get<double>()
                                 : member.is_null()   ? not_logged
                                 : member.get<bool>() ? 1.0
                                                      : 0.0);
      } else {
        topic.left_out.emplace(full, member.is_string() ? "text" : "a list");
      }
    }
  }

  LoggedColumn* column_of(Topic& topic, const std::string& name, bool only_if_known) {
    if (const auto known = topic.by_name.find(name); known != topic.by_name.end()) return &topic.columns[known->second];
    const auto& units = units_[topic.schema];
    const auto unit = units.find(name);
    // A member that is null so far is a column where the schema names it.
    if (only_if_known && unit == units.end()) return nullptr;
    if (topic.columns.size() == most_log_columns)
      throw InputError(source_, 0, "a topic of the MCAP log has more than 4096 numbers", "fewer");
    topic.by_name[name] = topic.columns.size();
    const bool is_unit =
        unit != units.end() &&
        (firmware::find_unit(unit->second) || firmware::is_unit(unit->second) || unit->second.size() <= 12) &&
        unit->second != "no unit";
    topic.columns.push_back({name, is_unit ? unit->second : "", {}});
    return &topic.columns.back();
  }

  static bool rises(const std::vector<double>& stamps) {
    for (std::size_t k = 1; k < stamps.size(); ++k) {
      if (!(stamps[k] > stamps[k - 1])) return false;
    }
    return stamps.size() > 1;
  }

  // The member that is the time, and its scale to seconds.
  static std::optional<std::size_t> time_member(const Topic& topic) {
    for (std::size_t c = 0; c < topic.columns.size(); ++c) {
      const LoggedColumn& column = topic.columns[c];
      const auto unit = firmware::find_unit(column.unit);
      const bool time = unit ? unit->dimension == firmware::Dimension::time : column.name == "t";
      if (time && is_time_name(column.name) && rises(column.values)) return c;
    }
    return std::nullopt;
  }

  void add(RawTable& table, Topic& topic) {
    const auto leave_out = [&](const std::string& name, const std::string& why) {
      table.left_out.push_back({topic.name + (name.empty() ? "" : "/" + name), why});
    };
    if (!topic.unreadable.empty()) return leave_out("", topic.unreadable);
    for (const auto& [name, why] : topic.left_out) leave_out(name, why);
    if (topic.log_times.size() < 2) return leave_out("", topic.log_times.empty() ? "no messages" : "one message");
    std::vector<double> time;
    const std::optional<std::size_t> own = time_member(topic);
    if (own) {
      time = topic.columns[*own].values;
      const auto unit = firmware::find_unit(topic.columns[*own].unit);
      if (unit && unit->scale != 1.0) {
        for (double& t : time) t *= unit->scale;
      }
    } else {
      if (!first_log_time_) first_log_time_ = earliest();
      // Differences of nanoseconds: those since 1970 are not exact as doubles.
      for (const std::uint64_t t : topic.log_times)
        time.push_back(1e-9 * static_cast<double>(static_cast<std::int64_t>(t - *first_log_time_)));
    }
    for (std::size_t c = 0; c < topic.columns.size(); ++c) {
      if (c == own) continue;
      const NameAndUnit heading = split_heading(topic.columns[c].name);
      RawColumn column{topic.columns[c].unit.empty() ? heading.name : topic.columns[c].name};
      column.text = topic.columns[c].name;
      column.unit = topic.columns[c].unit.empty() ? heading.unit : topic.columns[c].unit;
      column.group = topic.name;
      column.values = std::move(topic.columns[c].values);
      column.own_time = time;
      column.own_time_name = own ? topic.columns[*own].name : "the time of logging";
      table.columns.push_back(std::move(column));
    }
    // One topic: the table's own time, as in a text.
    const bool only = std::count_if(topics_.begin(), topics_.end(),
                                    [](const auto& one) { return one.second.log_times.size() > 1; }) == 1;
    if (!only || table.columns.empty()) return;
    for (RawColumn& column : table.columns) column.own_time.clear();
    RawColumn stamps{"t"};
    stamps.text = "t";
    stamps.unit = "s";
    stamps.values = std::move(time);
    table.rows = stamps.values.size();
    table.columns.insert(table.columns.begin(), std::move(stamps));
  }

  [[nodiscard]] std::uint64_t earliest() const {
    std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
    for (const auto& [id, topic] : topics_) {
      for (const std::uint64_t t : topic.log_times) first = std::min(first, t);
    }
    return first;
  }

  std::string_view bytes_;
  std::string_view source_;
  std::map<std::uint64_t, std::map<std::string, std::string>> units_;  // by schema and member
  std::map<std::uint64_t, Topic> topics_;
  std::optional<std::uint64_t> first_log_time_;
  std::string cut_off_;
};

}  // namespace

RawTable table_of_mcap(std::string_view bytes, std::string_view source) { return McapReader(bytes, source).run(); }

}  // namespace host_sim
