// Prints a hash of the trace of nonlinear runs of all rig kinds: the same on every machine and with every compiler.
#include <cstdio>
#include <exception>

#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/closed_loop/trace.hpp"

int main() {
  try {
    for (const char* rig : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "measured_damper"}) {
      firmware::RigDescription description = firmware::read_rig(std::string("host_sim/rigs/") + rig + ".toml");
      // Rough enough for the nonlinear laws to matter, with ducts that open and close while the rig runs.
      if (description.rig.has_fdva)
        description.controller.valve_plan = {{2.0, 0b101101}, {3.5, 0b000001}, {5.0, 0b000000}, {5.25, 0b111111}};
      description.controller.speed = 5.0;
      description.range = {};
      if (description.rig.kind != model::RigKind::component_bench) {
        description.rig.effects.add(model::TyreLiftOff<double>{});
      }
      if (description.rig.kind == model::RigKind::quarter_car) {
        description.rig.effects.add(model::CoulombFriction<double>{40.0});
      }
      const firmware::IsoRoad road{.bandwidth = 40.0};
      const auto motion = firmware::excitation(
          description.rig, firmware::drive_over(road, description.sample_rate, 8000), description.sample_rate);
      const host_sim::Run run = host_sim::run_closed_loop(description, motion, {});
      std::printf("%s %zu samples, ended by %s: %s\n", rig, run.recording.size(),
                  std::string(firmware::name(run.trip.reason)).c_str(),
                  host_sim::hexadecimal(host_sim::trace_hash(run.recording)).c_str());
    }
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
  return 0;
}
