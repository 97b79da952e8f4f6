#include "host_sim/sweep/rig_case.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/signal/summary.hpp"

namespace host_sim::sweep {
namespace {

using nlohmann::ordered_json;

ordered_json settings_of(const RigCase& one) {
  ordered_json line{{"id", one.id}, {"seed", one.seed}};
  for (const auto& [name, setting] : one.settings) {
    std::visit([&line, &key = name](const auto& value) { line[key] = value; }, setting);
  }
  return line;
}

Run drive(const SweepPlan& plan, const RigCase& one) {
  if (const auto fault = firmware::find_rig_fault(one.rig.rig, one.rig.period())) {
    std::string what = std::string(fault->table) + "." + std::string(fault->key);
    if (fault->table.empty()) what = "the rig as a whole";
    throw firmware::InputError(what, 0, "does not fit", fault->expected);
  }
  const firmware::RoadChoice road{one.road, one.speed, one.seed, std::nullopt, std::nullopt};
  const std::size_t samples = firmware::samples_of(plan.duration, one.rig.sample_rate);
  const firmware::FootPointMotion motion = firmware::excitation(
      one.rig.rig, firmware::motion_over(road, one.rig, samples, read_recording), one.rig.sample_rate);
  RunOptions options;
  options.seed = one.seed;
  options.noise = plan.noise ? firmware::SimulatedRig::Noise::as_described : firmware::SimulatedRig::Noise::none;
  return run_closed_loop(one.rig, motion, options);
}

void add_channels(const firmware::Recording& recording, ordered_json& line) {
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const auto& column = recording.channels[i];
    if (column.empty()) continue;
    const auto [rms, lowest, highest] = summarise(column);
    if (!std::isfinite(rms)) throw firmware::InputError("the simulation", 0, "diverges", "a rig that stays finite");
    const std::string name(model::channel_names[i].name);
    line["rms_" + name] = rms;
    line["lowest_" + name] = lowest;
    line["highest_" + name] = highest;
  }
}

}  // namespace

std::string result_line(const SweepPlan& plan, std::uint64_t id) {
  const RigCase one = case_of(plan, id);
  ordered_json line = settings_of(one);
  try {
    const Run run = drive(plan, one);
    ordered_json results = line;
    results["ended_by"] = firmware::name(run.trip.reason);
    results["samples"] = run.recording.size();
    if (run.recording.size() == 0) {
      throw firmware::InputError("the run", 0, "was stopped before its first sample", "a rig that can follow its road");
    }
    if (firmware::is_fault(run.trip.reason)) {
      throw firmware::InputError("the run", 0,
                                 "was stopped by the firmware after " + firmware::shortest(run.trip.time.seconds()) +
                                     " s: " + std::string(firmware::name(run.trip.reason)),
                                 "a rig that can follow its road to the end");
    }
    add_channels(run.recording, results);
    return results.dump();
  } catch (const firmware::InputError& error) {
    line["failed"] = error.what();
  } catch (const firmware::UsageError& error) {
    line["failed"] = error.what();
  }
  return line.dump();
}

}  // namespace host_sim::sweep
