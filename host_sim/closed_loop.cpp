#include "host_sim/closed_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "hal/simulated/rig.hpp"
#include "host_sim/input_error.hpp"

namespace host_sim {
namespace {

using model::Channel;
using model::RigKind;

/// Collects what the firmware wrote into its journal.
class Recorder {
 public:
  Recorder(const RigDescription& description, std::size_t samples) : kind_(description.rig.kind) {
    recording_.sample_period = description.period();
    if (description.rig.has_fdva) ducts_ = static_cast<std::size_t>(description.rig.fdva.ducts);
    for (auto& column : columns_) column.reserve(samples);
    if (kind_ == RigKind::quarter_car) {
      recording_.extra = {{"F_w_c", "N", {}}, {"v_r", "m/s", {}}, {"v_w", "m/s", {}}, {"v_b", "m/s", {}}};
    }
  }

  void take(const firmware::Record& record) {
    if (record.mode != firmware::Mode::running) return;
    for (std::size_t i = 0; i < model::channel_count; ++i) columns_[i].push_back(record.values[i]);
    for (std::size_t j = 0; j < ducts_; ++j) recording_.ducts[j].push_back(record.openings.is_open(j) ? 1.0 : 0.0);
    if (kind_ == RigKind::quarter_car) {
      const auto& v = record.velocities;
      const std::array<double, 4> values{record.wheel_load, v.foot_point, v.wheel, v.body};
      for (std::size_t i = 0; i < values.size(); ++i) recording_.extra[i].values.push_back(values[i]);
    }
    ++rows_;
  }

  /// Columns that were never measured nor computed are left out.
  Recording finish(double sample_rate) {
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      const bool known = std::any_of(columns_[i].begin(), columns_[i].end(), [](double v) { return !std::isnan(v); });
      if (known) recording_.channels[i] = std::move(columns_[i]);
    }
    recording_.time = sample_times(rows_, sample_rate);
    return std::move(recording_);
  }

 private:
  RigKind kind_;
  std::size_t ducts_ = 0;
  std::size_t rows_ = 0;
  std::array<std::vector<double>, model::channel_count> columns_;
  Recording recording_;
};

}  // namespace

hal::SensorSetup simulated_sensors(const RigDescription& description) {
  hal::SensorSetup setup{};
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    const bool relative_only = channel == Channel::z_w || channel == Channel::z_b || channel == Channel::F_act;
    setup[i].fitted = is_hardware_channel(description.rig.kind, channel) && !relative_only;
    if (description.range[i]) {
      setup[i].lowest = description.range[i]->lower;
      setup[i].highest = description.range[i]->upper;
    }
  }
  return setup;
}

firmware::Settings firmware_settings(const RigDescription& description) {
  const ControllerDescription& c = description.controller;
  firmware::Settings settings;
  settings.period = hal::seconds(description.period());
  if (std::abs(settings.period.seconds() * description.sample_rate - 1.0) > 1e-12) {
    throw InputError(description.source, 0, "sample_rate has a period that is no whole number of nanoseconds",
                     "a rate such as 1000.0, 500.0 or 2000.0 Hz");
  }
  settings.limits.stroke = c.stroke;
  settings.limits.speed = c.speed;
  settings.limits.force = c.force;
  settings.limits.energy_gain = c.energy_gain;
  settings.ramps.rate = c.ramp;
  if (c.cross_over > 0.0) settings.observers.cross_over = c.cross_over;
  if (const auto wrong = settings.check(); !wrong.empty()) {
    throw InputError(description.source, 0, "the firmware cannot be set up like this", wrong);
  }
  return settings;
}

firmware::ValvePlan valve_plan(const RigDescription& description) {
  const auto& fdva = description.rig.fdva;
  const auto first = hal::Openings::first(description.rig.has_fdva ? static_cast<std::size_t>(fdva.open_ducts) : 0);
  std::vector<firmware::ValvePlan::Change> changes;
  for (const auto& s : description.controller.valve_plan) {
    changes.push_back({hal::seconds(s.time), hal::Openings::from_bits(s.open)});
  }
  if (const auto wrong = firmware::ValvePlan::check(changes); !wrong.empty()) {
    throw InputError(description.source, 0, "valves.plan does not fit", wrong);
  }
  return {first, changes};
}

Run run_closed_loop(const RigDescription& description, const FootPointMotion& excitation, const RunOptions& options) {
  const firmware::Settings settings = firmware_settings(description);
  SimulatedRig plant(description, options.seed, options.noise);
  hal::simulated::Construction construction;
  construction.period = settings.period;
  construction.sensors = simulated_sensors(description);
  construction.ducts = description.rig.has_fdva ? static_cast<std::size_t>(description.rig.fdva.ducts) : 0;
  construction.safe_position = hal::Openings::from_bits(description.controller.safe_ducts);
  hal::simulated::Rig rig(plant, construction, options.faults);

  std::vector<firmware::Record> storage(8);
  firmware::Journal journal(storage);
  firmware::TableReference reference(excitation);
  firmware::ControlLoop loop(settings, description.rig, rig.roles(), reference, valve_plan(description), journal);

  Recorder recorder(description, excitation.size());
  loop.start();
  std::size_t periods = 0;
  loop.run([&] {
    while (const auto record = journal.pop()) recorder.take(*record);
    if (options.progress && (periods & 0x3fffU) == 0) {
      options.progress(std::min(1.0, static_cast<double>(periods) / static_cast<double>(excitation.size() + 1)));
    }
    return ++periods == 1 || loop.mode() != firmware::Mode::safe;
  });
  return {recorder.finish(description.sample_rate), loop.trip(), loop.counters(), journal.lost()};
}

}  // namespace host_sim
