#include "host_sim/recording_files/binary/tdms_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/units.hpp"
#include "host_sim/recording_files/binary/tdms_file.hpp"
#include "host_sim/recording_files/tables/channel_guess.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_preamble.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;

double property_of(const TdmsChannel& channel, std::string_view name, double otherwise) {
  const auto found = channel.properties.find(name);
  return found != channel.properties.end() && found->second.is_number ? found->second.number : otherwise;
}

std::string unit_property(const TdmsChannel& channel) {
  for (const std::string_view name : {"unit_string", "NI_UnitDescription", "Unit", "unit", "units"}) {
    const auto found = channel.properties.find(name);
    if (found != channel.properties.end() && !found->second.text.empty()) return found->second.text;
  }
  return "";
}

std::vector<double> waveform_times(std::size_t count, double rate, double offset) {
  const bool whole = std::abs(rate - std::round(rate)) < 1e-9 * rate;
  std::vector<double> time(count);
  for (std::size_t k = 0; k < count; ++k) time[k] = offset + static_cast<double>(k) / (whole ? std::round(rate) : rate);
  return time;
}

bool is_time_channel(const TdmsChannel& channel) {
  return channel.unreadable.empty() && (channel.is_time_stamp || is_time_name(split_heading(channel.name).name));
}

}  // namespace

namespace {

// A rate among the properties of the channel, its group or the file, by their names ("Sample Rate").
std::optional<StatedRate> stated_rate(const TdmsFile& file, const TdmsChannel& channel) {
  const auto group = file.groups.find(channel.group);
  const TdmsProperties none;
  const TdmsProperties& of_group = group == file.groups.end() ? none : group->second;
  for (const TdmsProperties* properties :
       std::array<const TdmsProperties*, 3>{&channel.properties, &of_group, &file.properties}) {
    for (const auto& [name, value] : *properties) {
      if (name.starts_with("wf_") || name.starts_with("NI_")) continue;
      const std::string line = name + ": " + (value.is_number ? firmware::shortest(value.number) : value.text);
      if (auto rate = find_rate({line})) return rate;
    }
  }
  return std::nullopt;
}

}  // namespace

RawTable table_of_tdms(std::string_view bytes, std::string_view source) {
  TdmsFile file = parse_tdms(bytes, source);
  RawTable table;
  table.source = source;
  table.format = "NI TDMS";
  if (file.cut_off)
    table.notes.emplace_back("the last segment is not complete: of its last chunk each channel has what is there");

  double earliest = INFINITY;
  for (const TdmsChannel& channel : file.channels)
    earliest = std::min(earliest, property_of(channel, "wf_start_time", INFINITY));

  struct Kept {
    TdmsChannel* channel;
    std::vector<double> time;
  };
  std::vector<Kept> kept;
  std::vector<TdmsChannel*> without_time;
  const auto leave_out = [&](const TdmsChannel& channel, std::string why) {
    table.left_out.push_back({channel.group + "/" + channel.name, std::move(why)});
  };
  for (TdmsChannel& channel : file.channels) {
    if (!channel.unreadable.empty()) {
      leave_out(channel, channel.unreadable);
      continue;
    }
    if (is_time_channel(channel)) continue;
    if (channel.values.size() < 2) {
      leave_out(channel, channel.values.empty() ? "no values" : "one value");
      continue;
    }
    // The time channel of the group with as many stamps, else with the most.
    const TdmsChannel* axis = nullptr;
    for (const TdmsChannel& other : file.channels) {
      if (other.group != channel.group || !is_time_channel(other) || other.values.size() < 2) continue;
      const bool fits = other.values.size() == channel.values.size();
      if (axis == nullptr || (fits && axis->values.size() != channel.values.size()) ||
          (axis->values.size() != channel.values.size() && other.values.size() > axis->values.size()))
        axis = &other;
    }
    Kept one{&channel, {}};
    const double increment = property_of(channel, "wf_increment", 0.0);
    const bool waveform = increment > 0.0 && std::isfinite(increment);
    if (axis != nullptr && (axis->values.size() == channel.values.size() || !waveform)) {
      one.time = axis->values;
      const NameAndUnit heading = split_heading(axis->name);
      const std::optional<firmware::Unit> unit =
          firmware::find_unit(unit_property(*axis).empty() ? heading.unit : unit_property(*axis));
      const double scale =
          unit && unit->dimension == firmware::Dimension::time && !axis->is_time_stamp ? unit->scale : 1.0;
      if (scale != 1.0) {
        for (double& t : one.time) t *= scale;
      }
      if (one.time.size() < channel.values.size()) {
        leave_out(channel,
                  std::to_string(channel.values.size() - one.time.size()) + " values behind the last time stamp");
        channel.values.resize(one.time.size());
      }
      one.time.resize(channel.values.size());
    } else if (waveform) {
      const double start = property_of(channel, "wf_start_time", earliest);
      const double offset =
          property_of(channel, "wf_start_offset", 0.0) + (std::isfinite(start) ? start - earliest : 0.0);
      one.time = waveform_times(channel.values.size(), 1.0 / increment, offset);
    } else if (const auto rate = stated_rate(file, channel)) {
      one.time = waveform_times(channel.values.size(), rate->rate, 0.0);
      const std::string note = "t from the row number and " + in_quotes(rate->text);
      if (std::find(table.notes.begin(), table.notes.end(), note) == table.notes.end()) table.notes.push_back(note);
    } else {
      without_time.push_back(&channel);
      continue;
    }
    kept.push_back(std::move(one));
  }
  if (kept.empty() && without_time.empty()) {
    std::string why = "no channel holds numbers";
    if (!table.left_out.empty()) why += ": " + in_quotes(table.left_out[0].name) + " holds " + table.left_out[0].reason;
    throw firmware::InputError(source, 0, why, "channels with numbers");
  }
  const auto add = [&](TdmsChannel& channel, std::vector<double> own_time) {
    const NameAndUnit heading = split_heading(channel.name);
    RawColumn column{heading.name};
    column.unit = unit_property(channel);
    if (column.unit.empty()) {
      column.unit = heading.unit;
    } else {
      column.name = channel.name;
    }
    column.text = channel.name;
    column.group = channel.group;
    column.values = std::move(channel.values);
    column.own_time = std::move(own_time);
    table.columns.push_back(std::move(column));
  };
  if (kept.empty()) {
    // The user may give the rate: the columns of one length.
    std::map<std::size_t, std::size_t> lengths;
    for (const TdmsChannel* channel : without_time) ++lengths[channel->values.size()];
    for (const auto& [length, count] : lengths) {
      if (table.rows == 0 || count >= lengths[table.rows]) table.rows = length;
    }
    for (TdmsChannel* channel : without_time) {
      if (channel->values.size() == table.rows) {
        add(*channel, {});
      } else {
        leave_out(*channel,
                  std::to_string(channel->values.size()) + " values, others have " + std::to_string(table.rows));
      }
    }
    return table;
  }
  for (const TdmsChannel* channel : without_time) leave_out(*channel, "no time belongs to it");
  const bool one_axis =
      std::all_of(kept.begin(), kept.end(), [&](const Kept& one) { return one.time == kept.front().time; });
  if (one_axis) {
    RawColumn time{"t"};
    time.text = "t";
    time.unit = "s";
    time.values = kept.front().time;
    table.rows = time.values.size();
    table.columns.push_back(std::move(time));
  }
  for (Kept& one : kept) add(*one.channel, one_axis ? std::vector<double>{} : std::move(one.time));
  return table;
}

}  // namespace host_sim
