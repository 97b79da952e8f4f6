// Prints a hash of the trace of nonlinear runs of all rig kinds: the same on every machine and with every compiler.
#include <cstdio>
#include <exception>
#include <string>

#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/closed_loop/trace.hpp"

namespace {

firmware::RigDescription shipped(const std::string& rig) {
  return firmware::read_rig("host_sim/rigs/" + rig + ".toml");
}

/// Rough enough for the nonlinear laws to matter, with ducts that open and close while the rig runs.
void drive_on_record(const std::string& name, firmware::RigDescription description) {
  if (description.rig.has_fdva)
    description.controller.valve_plan = {{2.0, 0b101101}, {3.5, 0b000001}, {5.0, 0b000000}, {5.25, 0b111111}};
  description.controller.speed = 5.0;
  description.range = {};
  if (description.rig.kind != model::RigKind::component_bench) {
    description.rig.effects.add(model::TyreLiftOff<double>{});
  }
  if (description.rig.kind == model::RigKind::quarter_car && !description.rig.lever.any()) {
    description.rig.effects.add(model::CoulombFriction<double>{40.0});
  }
  const firmware::IsoRoad road{.bandwidth = 40.0};
  const auto motion = firmware::excitation(description.rig, firmware::drive_over(road, description.sample_rate, 8000),
                                           description.sample_rate);
  const host_sim::Run run = host_sim::run_closed_loop(description, motion, {});
  std::printf("%s %zu samples, ended by %s: %s\n", name.c_str(), run.recording.size(),
              std::string(firmware::name(run.trip.reason)).c_str(),
              host_sim::hexadecimal(host_sim::trace_hash(run.recording)).c_str());
}

void add_lever(model::RigParameters<double>& rig) {
  rig.lever.count = 3;
  rig.lever.at = {-0.08, 0.0, 0.06};
  rig.lever.ratio = {0.7, 0.8, 0.85};
}

}  // namespace

int main() {
  try {
    for (const char* rig :
         {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "measured_damper", "paper_hil_aas"}) {
      drive_on_record(rig, shipped(rig));
    }
    for (const char* rig : {"paper_hil_fdva", "paper_rig_fdva"}) {
      firmware::RigDescription description = shipped(rig);
      add_lever(description.rig);
      drive_on_record(std::string(rig) + " with lever", description);
    }
    // A double bellows with a second-order actuator, levelling and a leak, whose machine's delay swings and jitters.
    firmware::RigDescription air = shipped("paper_hil_aas");
    air.rig.air_spring.counter_pressure = 3e5;
    air.rig.air_spring.counter_area = 15e-4;
    air.rig.air_spring.counter_volume = 0.3e-3;
    air.rig.air_spring.actuator_damping = 0.6;
    air.rig.air_spring.levelling_rate = 0.05;
    air.rig.effects.add(model::AirLeak<double>{0.002});
    air.rig.delay_variation = {.swing = 2e-3, .time = 0.7, .jitter = 3e-4};
    drive_on_record("paper_hil_aas with two bellows", air);
    for (std::size_t kind = 0; kind < firmware::compensation::kind_names.size(); ++kind) {
      firmware::RigDescription description = shipped("paper_hil_fdva");
      description.compensation.emplace().kind = static_cast<firmware::compensation::Kind>(kind);
      description.compensation->numbers["limit"] = 0.1;
      description.rig.effects.add(model::ActuatorLag<double>{0.003});
      drive_on_record("paper_hil_fdva with " + std::string(firmware::compensation::kind_names[kind]), description);
    }
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
  return 0;
}
