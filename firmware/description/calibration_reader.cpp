#include "firmware/description/calibration_reader.hpp"

#include <array>
#include <string_view>

#include "firmware/description/text/spelling.hpp"
#include "firmware/description/text/toml_text.hpp"
#include "model/rig/rig_check.hpp"

namespace firmware {
namespace {

constexpr std::string_view day_expected = "a day such as \"2026-03-01\"";

/// A text in quotes, or a date as TOML has them without quotes.
std::optional<CalendarDate> read_day(DescriptionTable& table, std::string_view key) {
  if (!table.has(key)) return std::nullopt;
  const toml::node& node = table.need(key, day_expected);
  std::string text;
  if (const auto* const plain = node.as_date()) {
    text = date_text({plain->get().year, plain->get().month, plain->get().day});
  } else {
    text = node.value_or(std::string());
  }
  const std::optional<CalendarDate> day = find_date(text);
  if (!day) table.fail(node, table.path(key) + " is no day of the calendar", day_expected);
  return day;
}

/// Text that says something: an empty certificate is none.
std::string read_words(DescriptionTable& table, std::string_view key) {
  if (!table.has(key)) return {};
  std::string words = table.text(key);
  if (words.find_first_not_of(" \t\r\n") == std::string::npos) {
    table.fail(key, table.path(key) + " is empty", "a number or name as the certificate has it");
  }
  return words;
}

CalibrationDescription read_calibration(DescriptionTable& table) {
  CalibrationDescription calibration;
  table.number_in("gain", calibration.gain, 0.0, 1.0, "the relative uncertainty of the sensor's factor");
  table.number_in("offset", calibration.offset, 0.0, 1e6, "the uncertainty of the sensor's zero in the channel's unit");
  if (calibration.gain == 0.0 && calibration.offset == 0.0) {
    table.fail(table.has("gain") ? "gain" : "offset",
               "[" + table.path("gain").substr(0, table.path("gain").rfind('.')) + "] states no uncertainty",
               "gain = 0.002 (relative, with k = 2), or offset in the channel's unit");
  }
  table.number_in("k", calibration.k, 0.5, 10.0, "the coverage factor of the certificate");
  calibration.date = read_day(table, "date");
  calibration.valid_until = read_day(table, "valid_until");
  if (calibration.date && calibration.valid_until && *calibration.valid_until < *calibration.date) {
    table.fail("valid_until", table.path("valid_until") + " is before " + table.path("date"),
               "a day on or after " + date_text(*calibration.date));
  }
  calibration.certificate = read_words(table, "certificate");
  calibration.serial = read_words(table, "serial");
  calibration.certificate_serial = read_words(table, "certificate_serial");
  if (!calibration.certificate_serial.empty() && calibration.serial.empty()) {
    table.fail("certificate_serial", table.path("certificate_serial") + " stands without " + table.path("serial"),
               "the serial number of the sensor that is fitted beside that of the certificate");
  }
  if (table.has("certificate_channel")) {
    std::array<std::string_view, model::channel_count> names;
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = model::channel_names[i].name;
    const std::string word = table.text("certificate_channel");
    calibration.certificate_channel = model::find_channel(word);
    if (!calibration.certificate_channel) {
      table.fail("certificate_channel", with_suggestion("unknown channel", word, names), "one of " + listed(names));
    }
  }
  table.finish();
  return calibration;
}

}  // namespace

Calibrations read_calibrations(DescriptionTable& top, const model::RigParameters<double>& rig) {
  Calibrations calibrations;
  auto table = top.table("calibration");
  if (!table) return calibrations;
  table->for_each_channel([&](model::Channel channel, const std::string& key, const toml::node& node) {
    const bool extra_force = rig.kind == model::RigKind::quarter_car && channel == model::Channel::F_act;
    if (!model::has_sensor(rig.kind, channel) && !extra_force) {
      table->fail(node, table->path(key) + ": this kind of rig computes or commands " + key + " itself",
                  "a channel that a sensor measures");
    }
    auto one = table->table(key);
    calibrations[model::index(channel)] = read_calibration(*one);
  });
  return calibrations;
}

std::vector<std::pair<std::string, std::string>> calibration_lines(const CalibrationDescription& calibration) {
  std::vector<std::pair<std::string, std::string>> lines;
  if (calibration.gain > 0.0) lines.emplace_back("gain", toml_float(calibration.gain));
  if (calibration.offset > 0.0) lines.emplace_back("offset", toml_float(calibration.offset));
  lines.emplace_back("k", toml_float(calibration.k));
  if (calibration.date) lines.emplace_back("date", toml_string(date_text(*calibration.date)));
  if (calibration.valid_until) lines.emplace_back("valid_until", toml_string(date_text(*calibration.valid_until)));
  if (!calibration.certificate.empty()) lines.emplace_back("certificate", toml_string(calibration.certificate));
  if (!calibration.serial.empty()) lines.emplace_back("serial", toml_string(calibration.serial));
  if (!calibration.certificate_serial.empty()) {
    lines.emplace_back("certificate_serial", toml_string(calibration.certificate_serial));
  }
  if (calibration.certificate_channel) {
    lines.emplace_back("certificate_channel", toml_string(model::name(*calibration.certificate_channel)));
  }
  return lines;
}

}  // namespace firmware
