#include "host_sim/closed_loop/closed_loop.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/semi_active_setup.hpp"
#include "firmware/recording/run_columns.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/simulated/rig.hpp"

namespace host_sim {

namespace {

/// Nothing closes a loop around a mass that a force drives: force → plant → sensors.
Run run_driven_mass(const firmware::RigDescription& description, const firmware::FootPointMotion& force,
                    const RunOptions& options) {
  const hal::SensorSetup sensors = firmware::simulated_sensors(description);
  const double start = force.empty() ? 0.0 : force.front().position;
  firmware::SimulatedRig plant(description, options.seed, options.noise, start);
  const auto openings = hal::Openings::from_bits(
      description.rig.has_fdva ? model::first_ducts(description.rig.fdva.open_ducts) : model::OpenDucts{0});
  Run run;
  run.recording.sample_period = description.period();
  run.recording.time = firmware::sample_times(force.size(), description.sample_rate);
  std::array<double, hal::channel_capacity> values{};
  for (std::size_t k = 0; k < force.size(); ++k) {
    if (k > 0) plant.advance({force[k].position, force[k].velocity, force[k].acceleration}, openings);
    plant.measure(values);
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      if (sensors[c].fitted) run.recording.channels[c].push_back(values[c]);
    }
    if (options.progress && (k & 0x3fffU) == 0) {
      options.progress(static_cast<double>(k) / static_cast<double>(force.size()));
    }
  }
  run.trip.reason = firmware::Reason::reference_ended;
  return run;
}

}  // namespace

Run run_closed_loop(const firmware::RigDescription& description, const firmware::FootPointMotion& excitation,
                    const RunOptions& options) {
  if (description.rig.kind == model::RigKind::driven_mass) return run_driven_mass(description, excitation, options);
  const firmware::Settings settings = firmware::control_settings(description);
  firmware::SimulatedRig plant(description, options.seed, options.noise);
  const hal::simulated::Construction construction = firmware::simulated_construction(description);
  hal::simulated::Rig rig(plant, construction, options.faults);

  std::vector<firmware::Record> storage(8);
  firmware::Journal journal(storage);
  firmware::TableReference reference(excitation);
  firmware::ControlLoop loop(settings, description.rig, rig.roles(), reference, firmware::valve_plan(description),
                             journal);
  const std::unique_ptr<firmware::Companion> companion = firmware::companion(description);
  if (companion) loop.attach(*companion);
  const std::unique_ptr<firmware::Compensation> compensation = firmware::compensation_of(description);
  if (compensation) loop.attach(*compensation);

  firmware::RunRecording recording(description, construction.sensors, excitation.size());
  loop.arm();
  loop.start();
  std::size_t periods = 0;
  loop.run([&] {
    while (const auto record = journal.pop()) recording.take(*record);
    if (options.progress && (periods & 0x3fffU) == 0) {
      options.progress(std::min(1.0, static_cast<double>(periods) / static_cast<double>(excitation.size() + 1)));
    }
    return ++periods == 1 || loop.mode() != firmware::Mode::safe;
  });
  return {recording.finish(), loop.trip(), loop.counters(), journal.lost()};
}

}  // namespace host_sim
