#include "firmware/recording/run_columns.hpp"

#include <array>
#include <limits>
#include <type_traits>
#include <utility>

namespace firmware {

using model::Channel;
using model::RigKind;

hal::Time oldest_sample(const Record& record) {
  hal::Time oldest = record.time;
  for (const hal::Time taken : record.taken) {
    if (taken != hal::never && taken < oldest) oldest = taken;
  }
  return oldest;
}

namespace {

/// Whether the commanded foot point is recorded beside z_r: where it differs from it, and where the description asks.
bool records_foot_command(const RigDescription& description) {
  if (description.rig.kind != RigKind::quarter_car) return false;
  bool machine = description.channels.contains(std::string(model::name(Channel::z_cmd)));
  description.rig.effects.for_each([&](const auto& slot) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    machine = machine || (slot.active && Effect::card.subsystem == model::Subsystem::machine);
  });
  return machine;
}

}  // namespace

std::string age_name(Channel channel) { return "age_" + std::string(model::name(channel)); }

RunColumns::RunColumns(const RigDescription& description, const hal::SensorSetup& sensors)
    : period_(description.period()) {
  const RigKind kind = description.rig.kind;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    const bool force_or_motion_of_hardware =
        channel == Channel::F || channel == Channel::x_act || channel == Channel::F_act;
    const bool computed = (kind == RigKind::hil && !force_or_motion_of_hardware && channel != Channel::z_cmd) ||
                          (kind == RigKind::component_bench && channel == Channel::x_cmd) ||
                          (channel == Channel::z_cmd && records_foot_command(description));
    if (!sensors[i].fitted && !computed) continue;
    columns_.push_back({std::string(model::name(channel)), std::string(model::unit(channel)), Source::channel, i});
  }
  const std::size_t ducts = description.rig.has_fdva ? static_cast<std::size_t>(description.rig.fdva.ducts) : 0;
  for (std::size_t j = 0; j < ducts; ++j) {
    columns_.push_back({"duct_" + std::to_string(j + 1), "", Source::duct, j});
  }
  if (kind == RigKind::quarter_car) {
    columns_.push_back({"F_w_c", "N", Source::wheel_load, 0});
    columns_.push_back({"v_r", "m/s", Source::velocity, 0});
    columns_.push_back({"v_w", "m/s", Source::velocity, 1});
    columns_.push_back({"v_b", "m/s", Source::velocity, 2});
  }
  if (description.compensation) {
    columns_.push_back({"x_added", "m", Source::added_command, 0});
    columns_.push_back({"F_added", "N", Source::added_force, 0});
  }
  columns_.push_back({"mode", "", Source::mode, 0});
  columns_.push_back({"reason", "", Source::reason, 0});
  columns_.push_back({"level", "", Source::level, 0});
  columns_.push_back({"enabled", "", Source::enabled, 0});
  columns_.push_back({"late", "s", Source::late, 0});
  columns_.push_back({"age", "s", Source::age, 0});
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (sensors[i].fitted) columns_.push_back({age_name(model::channel_at(i)), "s", Source::channel_age, i});
  }
}

double RunColumns::value(const Column& column, const Record& record) {
  switch (column.source) {
    case Source::channel:
      return record.values[column.index];
    case Source::duct:
      return record.openings.is_open(column.index) ? 1.0 : 0.0;
    case Source::wheel_load:
      return record.wheel_load;
    case Source::velocity:
      return std::array{record.velocities.foot_point, record.velocities.wheel, record.velocities.body}[column.index];
    case Source::added_command:
      return record.added.command;
    case Source::added_force:
      return record.added.force;
    case Source::mode:
      return static_cast<double>(record.mode);
    case Source::reason:
      return static_cast<double>(record.trip.reason);
    case Source::level:
      return record.level;
    case Source::enabled:
      return record.enabled ? 1.0 : 0.0;
    case Source::late:
      return record.late.seconds();
    case Source::age:
      return (record.time - oldest_sample(record)).seconds();
    case Source::channel_age:
      return record.taken[column.index] == hal::never ? std::numeric_limits<double>::quiet_NaN()
                                                      : (record.time - record.taken[column.index]).seconds();
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string mode_legend() {
  std::string text;
  for (int i = 0; i <= static_cast<int>(Mode::safe); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(i) + " " + std::string(name(static_cast<Mode>(i)));
  }
  return text;
}

std::string reason_legend() {
  std::string text;
  for (int i = 0; i <= static_cast<int>(last_reason); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(i) + " " + std::string(name(static_cast<Reason>(i)));
  }
  return text;
}

namespace {

bool is_extra(RunColumns::Source source) {
  using Source = RunColumns::Source;
  return source == Source::wheel_load || source == Source::velocity || source == Source::added_command ||
         source == Source::added_force;
}

}  // namespace

RunRecording::RunRecording(const RigDescription& description, const hal::SensorSetup& sensors,
                           std::size_t expected_rows)
    : columns_(description, sensors), sample_rate_(description.sample_rate) {
  using Source = RunColumns::Source;
  recording_.sample_period = description.period();
  for (const RunColumns::Column& column : columns_.columns()) {
    if (is_extra(column.source)) {
      recording_.extra.push_back({column.name, column.unit, {}});
    }
  }
  std::size_t extra = 0;
  for (const RunColumns::Column& column : columns_.columns()) {
    std::vector<double>* values = nullptr;
    if (column.source == Source::channel) values = &recording_.channels[column.index];
    if (column.source == Source::duct) values = &recording_.ducts[column.index];
    if (is_extra(column.source)) {
      values = &recording_.extra[extra++].values;
    }
    if (values != nullptr) values->reserve(expected_rows);
    values_.push_back(values);
  }
}

void RunRecording::take(const Record& record) {
  if (record.mode != Mode::running) return;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (values_[i] != nullptr) values_[i]->push_back(RunColumns::value(columns_.columns()[i], record));
  }
  ++rows_;
}

Recording RunRecording::finish() {
  recording_.time = sample_times(rows_, sample_rate_);
  return std::move(recording_);
}

}  // namespace firmware
