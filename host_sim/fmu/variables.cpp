#include "host_sim/fmu/variables.hpp"

#include <utility>

#include "firmware/simulation/road.hpp"
#include "firmware/simulation/simulated_setup.hpp"

namespace host_sim::fmu {

Variables::Variables(const firmware::RigDescription& description) {
  using enum Causality;
  const firmware::IsoRoad usual;
  const bool bench = description.rig.kind == model::RigKind::component_bench;
  road =
      add({"road", "", "iso8608:A … iso8608:H: a road generated inside; input: the inputs excitation.… drive the rig",
           parameter, false, std::string("iso8608:B")});
  speed = add({"speed", "m/s", "Speed over the road, 0.1 … 150", parameter, false, usual.speed});
  seed = add({"seed", "", "Seed of road and sensor noise, from 0", parameter, false, 1});
  noise = add({"noise", "", "The sensors have the noise of the rig description", parameter, false, true});
  bandwidth = add({"bandwidth", "Hz", "Low-pass frequency of the road", parameter, false,
                   firmware::default_bandwidth(description.rig.kind, description.sample_rate)});
  cut_off = add({"cut_off", "Hz", "Frequency below which the spectrum of the road is flat, 0.001 … 10", parameter,
                 false, usual.cut_off});
  input_at = add({"input_at", "",
                  "start: the inputs of a step hold at its communication point, as FMI means it; end: at the next one",
                  parameter, false, std::string(input_at_start)});

  first_number = list_.size();
  model::RigParameters<double> rig = description.rig;
  for (const firmware::ParameterPath& path : firmware::parameter_paths()) {
    if (!firmware::has_part(rig, path.table)) continue;
    const std::string name = std::string(path.table) + "." + std::string(path.key);
    add({name, std::string(path.unit), "Of the rig description", parameter, false, path.value(rig)});
  }

  const std::string what = bench ? "Deflection of the component" : "Foot point";
  position = add({"excitation.position", "m", what, input, true, 0.0});
  velocity = add({"excitation.velocity", "m/s", what + ": its velocity", input, true, 0.0});
  acceleration = add({"excitation.acceleration", "m/s²", what + ": its acceleration", input, true, 0.0});

  first_column = list_.size();
  using Source = firmware::RunColumns::Source;
  const firmware::RunColumns all(description, firmware::simulated_sensors(description));
  for (const firmware::RunColumns::Column& column : all.columns()) {
    if (column.source != Source::channel && column.source != Source::duct && column.source != Source::wheel_load &&
        column.source != Source::velocity) {
      continue;
    }
    const bool duct = column.source == Source::duct;
    add({column.name, duct ? "1" : column.unit, duct ? "1 open, 0 closed" : "As rigtwin simulate records it", output,
         !duct, 0.0});
    columns_.push_back(column);
  }
  running = add({"running", "", "The firmware lets the run go on", output, false, false});
  reason = add({"reason", "", "Number of the reason why the run ended, 0 before", output, false, 0});
  reason_name = add({"reason_name", "", "Name of that reason", output, false, std::string()});
}

std::size_t Variables::add(Variable variable) {
  list_.push_back(std::move(variable));
  return list_.size() - 1;
}

}  // namespace host_sim::fmu
