#include "firmware/description/recorder_reader.hpp"

#include <array>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/spelling.hpp"
#include "firmware/description/text/toml_text.hpp"
#include "firmware/description/values/effects_by_name.hpp"

namespace firmware {
namespace {

constexpr std::string_view recorder_entries = "a list of tables, such as [{ channels = [\"F\"], … }]";

/// read(entry) of each table of a list.
template <class Read>
void for_each_entry(DescriptionTable& recording, std::string_view key, const Read& read) {
  if (!recording.has(key)) return;
  const toml::node& node = recording.need(key, recorder_entries);
  const auto* list = node.as_array();
  if (list == nullptr) recording.fail(node, recording.path(key) + " is not a list", recorder_entries);
  for (const toml::node& one : *list) {
    const auto* inner = one.as_table();
    if (inner == nullptr)
      recording.fail(one, "an entry of " + recording.path(key) + " is not a table", recorder_entries);
    DescriptionTable entry(*inner, recording.path(key), recording.source());
    read(entry);
    entry.finish();
  }
}

std::vector<model::Channel> recorded_channels(DescriptionTable& entry) {
  std::array<std::string_view, model::channel_count> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = model::channel_names[i].name;
  const toml::node& node = entry.need("channels", "a list of channels, such as [\"F\"]");
  const auto* list = node.as_array();
  if (list == nullptr || list->empty()) {
    entry.fail(node, entry.path("channels") + " is not a list of channels", "a list such as [\"F\"]");
  }
  std::vector<model::Channel> channels;
  for (const toml::node& one : *list) {
    const std::string word = one.value_or(std::string());
    const auto channel = model::find_channel(word);
    if (!channel) entry.fail(one, with_suggestion("unknown channel", word, names), "one of " + listed(names));
    channels.push_back(*channel);
  }
  return channels;
}

std::string channel_array(const std::vector<model::Channel>& channels) {
  std::string text;
  for (const model::Channel channel : channels) {
    text += (text.empty() ? "\"" : ", \"") + std::string(model::name(channel)) + "\"";
  }
  return "[" + text + "]";
}

void read_hold(DescriptionTable& entry, model::RigParameters<double>& rig) {
  double period = 0.0;
  const std::vector<model::Channel> channels = recorded_channels(entry);
  static_cast<void>(entry.need("period", "the time for which a value is held [s]"));
  entry.number_in("period", period, 0.0, 1.0, "the time for which a value is held [s]");
  const CatalogueEntry* const hold = find_effect_that([](const CatalogueEntry& effect) {
    return effect.of_channel && effect.parameters.front().starts.read == model::Reading::renewal_period;
  });
  for (const model::Channel channel : channels) put_effect(rig, {hold, channel, {period}});
}

}  // namespace

RecorderDescription read_recorder(DescriptionTable& top, model::RigParameters<double>& rig) {
  RecorderDescription recorder;
  auto table = top.table("recording");
  if (!table) return recorder;
  for_each_entry(*table, "common_filter", [&](DescriptionTable& entry) {
    RecorderDescription::Filter filter{recorded_channels(entry)};
    static_cast<void>(entry.need("corner_hz", "the corner of a low-pass [Hz]"));
    entry.number_in("corner_hz", filter.corner, 1e-3, 1e6, "the corner of a low-pass [Hz]");
    if (entry.has("order")) filter.order = entry.whole_in("order", 1, 4);
    if (entry.has("digital")) filter.digital = entry.truth("digital");
    recorder.common_filter.push_back(std::move(filter));
  });
  for_each_entry(*table, "clock", [&](DescriptionTable& entry) {
    RecorderDescription::Clock clock{recorded_channels(entry)};
    entry.number_in("offset", clock.offset, -10.0, 10.0, "how late the channels are [s]");
    entry.number_in("ppm", clock.ppm, -1e5, 1e5, "how slow the clock is [ppm]");
    recorder.clock.push_back(std::move(clock));
  });
  for_each_entry(*table, "hum", [&](DescriptionTable& entry) {
    RecorderDescription::Hum hum;
    hum.channels = recorded_channels(entry);
    static_cast<void>(entry.need("hz", "the frequency of the mains [Hz]"));
    entry.number_in("hz", hum.frequency, 1e-3, 1e6, "the frequency of the mains [Hz]");
    constexpr std::string_view expected = "a number >= 0 for each channel";
    const toml::node& node = entry.need("amplitude", expected);
    const auto* list = node.as_array();
    const bool fits = list != nullptr && list->size() == hum.channels.size();
    for (std::size_t i = 0; fits && i < list->size(); ++i) {
      const auto value = as_number((*list)[i]);
      if (value && *value >= 0.0 && *value < 1e300) hum.amplitude.push_back(*value);
    }
    if (hum.amplitude.size() != hum.channels.size()) {
      entry.fail(node, entry.path("amplitude") + " does not fit", expected);
    }
    recorder.hum.push_back(std::move(hum));
  });
  for_each_entry(*table, "drift", [&](DescriptionTable& entry) {
    RecorderDescription::Drift drift{entry.text("path")};
    if (find_parameter(rig, drift.path) == nullptr) {
      entry.fail("path", "drift of the unknown parameter " + drift.path,
                 "a parameter of this rig, such as \"suspension.damping\"");
    }
    static_cast<void>(entry.need("per_cent", "the change over a recording [%]"));
    entry.number_in("per_cent", drift.per_cent, -100.0, 1e4, "the change over a recording [%]");
    entry.number_in("bend", drift.bend, -50.0, 50.0, "the bend of the change");
    recorder.drift.push_back(std::move(drift));
  });
  for_each_entry(*table, "hold", [&](DescriptionTable& entry) { read_hold(entry, rig); });
  table->finish();
  return recorder;
}

std::vector<std::pair<std::string, std::string>> recorder_lines(const RecorderDescription& recorder) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto add = [&](std::string_view key, const auto& list, const auto& text_of) {
    std::string text;
    for (const auto& one : list) text += (text.empty() ? "{ " : ", { ") + text_of(one) + " }";
    if (!text.empty()) lines.emplace_back(key, "[" + text + "]");
  };
  add("common_filter", recorder.common_filter, [](const RecorderDescription::Filter& filter) {
    return "channels = " + channel_array(filter.channels) + ", corner_hz = " + toml_float(filter.corner) +
           ", order = " + std::to_string(filter.order) + (filter.digital ? ", digital = true" : "");
  });
  add("clock", recorder.clock, [](const RecorderDescription::Clock& clock) {
    return "channels = " + channel_array(clock.channels) + ", offset = " + toml_float(clock.offset) +
           ", ppm = " + toml_float(clock.ppm);
  });
  add("hum", recorder.hum, [](const RecorderDescription::Hum& hum) {
    std::string amplitudes;
    for (const double value : hum.amplitude) amplitudes += (amplitudes.empty() ? "" : ", ") + toml_float(value);
    return "channels = " + channel_array(hum.channels) + ", hz = " + toml_float(hum.frequency) + ", amplitude = [" +
           amplitudes + "]";
  });
  add("drift", recorder.drift, [](const RecorderDescription::Drift& drift) {
    return "path = \"" + drift.path + "\", per_cent = " + toml_float(drift.per_cent) +
           (drift.bend != 0.0 ? ", bend = " + toml_float(drift.bend) : "");
  });
  return lines;
}

}  // namespace firmware
