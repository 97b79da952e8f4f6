#include "host_sim/recording_files/binary/tdms_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"
#include "host_sim/recording_files/binary/tdms_file.hpp"
#include "host_sim/recording_files/tables/channel_guess.hpp"
#include "host_sim/recording_files/tables/headings.hpp"

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

bool is_time_channel(const TdmsChannel& channel) {
  return channel.unreadable.empty() && (channel.is_time_stamp || is_time_name(split_heading(channel.name).name));
}

}  // namespace

RawTable table_of_tdms(std::string_view bytes, std::string_view source) {
  TdmsFile file = parse_tdms(bytes, source);
  RawTable table;
  table.source = source;
  table.format = "NI TDMS";
  if (file.cut_off)
    table.notes.emplace_back("the last segment is not complete: what stands behind its last whole chunk is lost");

  double earliest = INFINITY;
  for (const TdmsChannel& channel : file.channels)
    earliest = std::min(earliest, property_of(channel, "wf_start_time", INFINITY));

  struct Kept {
    const TdmsChannel* channel;
    std::vector<double> time;
  };
  std::vector<Kept> kept;
  std::string without_time;
  for (const TdmsChannel& channel : file.channels) {
    if (!channel.unreadable.empty()) {
      table.notes.push_back(in_quotes(channel.name) + " is left out: it holds " + channel.unreadable);
      continue;
    }
    if (channel.values.size() < 2 || is_time_channel(channel)) continue;
    const auto axis = std::find_if(file.channels.begin(), file.channels.end(), [&](const TdmsChannel& other) {
      return other.group == channel.group && is_time_channel(other) && other.values.size() == channel.values.size();
    });
    Kept one{&channel, {}};
    const double increment = property_of(channel, "wf_increment", 0.0);
    if (axis != file.channels.end()) {
      one.time = axis->values;
      const NameAndUnit heading = split_heading(axis->name);
      const std::optional<firmware::Unit> unit =
          firmware::find_unit(unit_property(*axis).empty() ? heading.unit : unit_property(*axis));
      const double scale =
          unit && unit->dimension == firmware::Dimension::time && !axis->is_time_stamp ? unit->scale : 1.0;
      if (scale != 1.0) {
        for (double& t : one.time) t *= scale;
      }
    } else if (increment > 0.0 && std::isfinite(increment)) {
      const double start = property_of(channel, "wf_start_time", earliest);
      const double offset =
          property_of(channel, "wf_start_offset", 0.0) + (std::isfinite(start) ? start - earliest : 0.0);
      const double rate = 1.0 / increment;
      const bool whole = std::abs(rate - std::round(rate)) < 1e-9 * rate;
      one.time.resize(channel.values.size());
      for (std::size_t k = 0; k < one.time.size(); ++k) {
        const double t = whole ? static_cast<double>(k) / std::round(rate) : static_cast<double>(k) * increment;
        one.time[k] = offset == 0.0 ? t : offset + t;
      }
    } else {
      without_time = channel.name;
      continue;
    }
    kept.push_back(std::move(one));
  }
  if (kept.empty()) {
    const std::string why =
        without_time.empty() ? "no channel holds numbers" : "no time belongs to " + in_quotes(without_time);
    throw firmware::InputError(source, 0, why + (table.notes.empty() ? "" : " (" + table.notes.front() + ")"),
                               "channels with a time channel in their group or the property wf_increment");
  }
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
  for (Kept& one : kept) {
    const NameAndUnit heading = split_heading(one.channel->name);
    RawColumn column{heading.name};
    column.unit = unit_property(*one.channel);
    if (column.unit.empty()) {
      column.unit = heading.unit;
    } else {
      column.name = one.channel->name;
    }
    column.text = one.channel->name;
    column.values = one.channel->values;
    if (!one_axis) column.own_time = std::move(one.time);
    table.columns.push_back(std::move(column));
  }
  return table;
}

}  // namespace host_sim
