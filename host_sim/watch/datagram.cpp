#include "host_sim/watch/datagram.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace host_sim::watch {
namespace {

using nlohmann::json;

constexpr std::size_t most_values = 96;
constexpr std::size_t longest_key = 40;
constexpr std::size_t longest_text = 300;
constexpr std::size_t longest_setup = 32'768;  // [bytes]

struct TextField {
  std::string_view key;
  std::string Datagram::*field;
};
constexpr std::array text_fields{
    TextField{"instance", &Datagram::instance},  TextField{"state", &Datagram::state},
    TextField{"reason_name", &Datagram::reason}, TextField{"second_reason", &Datagram::second_reason},
    TextField{"trip", &Datagram::trip},          TextField{"failed_checks", &Datagram::failed_checks}};

/// One word of printable ASCII: it goes into requests.
bool is_instance(std::string_view text) {
  constexpr std::size_t longest_instance = 128;
  return text.size() <= longest_instance &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

bool take_text(const std::string& key, const std::string& text, Datagram& datagram) {
  if (text.size() > longest_text) return false;
  if (key == "ended") datagram.ended = text;
  if (key == "instance" && !is_instance(text)) return false;
  for (const TextField& known : text_fields) {
    if (known.key == key) datagram.*known.field = text;
  }
  return true;
}

bool take_number(const std::string& key, double value, Datagram& datagram) {
  if (!std::isfinite(value) || datagram.values.size() == most_values) return false;
  datagram.values.emplace_back(key, value);
  return true;
}

bool take(const std::string& key, const json& value, Datagram& datagram) {
  if (key.size() > longest_key) return false;
  if (key == "sequence" || key == "lost") {
    if (!value.is_number_unsigned()) return false;
    (key == "lost" ? datagram.lost : datagram.sequence) = value.get<std::uint64_t>();
    return true;
  }
  if (key == "setup") {
    if (!value.is_object() || value.dump().size() > longest_setup) return false;
    datagram.setup = value;
    return true;
  }
  if (key == "timestamp") {
    if (!value.is_number()) return false;
    datagram.timestamp = value.get<double>();
    return std::isfinite(datagram.timestamp);
  }
  if (value.is_string()) return take_text(key, value.get_ref<const std::string&>(), datagram);
  return value.is_number() && take_number(key, value.get<double>(), datagram);
}

/// Deeply nested input would take the parser's stack.
bool is_shallow(std::string_view text) {
  constexpr int deepest = 8;
  int depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > deepest) return false;
  }
  return true;
}

}  // namespace

double Datagram::value(std::string_view name) const {
  for (const auto& [key, value] : values) {
    if (key == name) return value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::optional<Datagram> parse_datagram(std::string_view text) {
  if (!is_shallow(text)) return std::nullopt;
  const json object = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!object.is_object() || !object.contains("timestamp") || !object.contains("sequence")) return std::nullopt;
  Datagram datagram;
  for (const auto& [key, value] : object.items()) {
    if (!take(key, value, datagram)) return std::nullopt;
  }
  if (datagram.state.empty() && !datagram.ended) return std::nullopt;
  return datagram;
}

}  // namespace host_sim::watch
