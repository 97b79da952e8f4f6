#include "firmware/controller/simulated_devices.hpp"

#include "hal/linux/clock.hpp"
#include "hal/simulated/rig.hpp"
#include "host_sim/closed_loop.hpp"
#include "host_sim/simulated_rig.hpp"

namespace firmware::controller {
namespace {

/// The time of the simulated rig follows the machine's.
class PacedClock final : public hal::Clock {
 public:
  explicit PacedClock(hal::Clock& simulated) : simulated_(simulated) {}

 private:
  hal::Time do_now() override {
    follow();
    return simulated_.now();
  }
  void do_sleep_until(hal::Time deadline) override {
    machine_.sleep_until(deadline);
    follow();
  }
  void follow() {
    const hal::Time now = machine_.now();
    if (now > simulated_.now()) simulated_.sleep_until(now);
  }

  hal::linux::MonotonicClock machine_;
  hal::Clock& simulated_;
};

class SimulatedDevices final : public Devices {
 public:
  SimulatedDevices(const host_sim::RigDescription& rig, const Options& options)
      : plant_(rig, options.seed, host_sim::SimulatedRig::Noise::as_described),
        rig_(plant_, construction(rig, options)),
        paced_(rig_.roles().clock),
        virtual_time_(options.virtual_time) {}

  [[nodiscard]] hal::Rig roles() override {
    const hal::Rig roles = rig_.roles();
    if (virtual_time_) return roles;
    return {paced_, roles.sensors, roles.valves, roles.command, roles.stop_button, roles.heartbeat};
  }
  [[nodiscard]] std::string text() const override {
    return std::string("SIMULATED RIG, no devices") + (virtual_time_ ? ", virtual time\n" : "\n");
  }

 private:
  static hal::simulated::Construction construction(const host_sim::RigDescription& rig, const Options& options) {
    hal::simulated::Construction c;
    c.period = hal::seconds(rig.period());
    if (!options.virtual_time) c.start = hal::linux::MonotonicClock().now();
    c.sensors = host_sim::simulated_sensors(rig);
    c.ducts = rig.rig.has_fdva ? static_cast<std::size_t>(rig.rig.fdva.ducts) : 0;
    c.safe_position = hal::Openings::from_bits(rig.controller.safe_ducts);
    return c;
  }

  host_sim::SimulatedRig plant_;
  hal::simulated::Rig rig_;
  PacedClock paced_;
  bool virtual_time_;
};

}  // namespace

std::unique_ptr<Devices> simulate_devices(const host_sim::RigDescription& rig, const Options& options) {
  return std::make_unique<SimulatedDevices>(rig, options);
}

}  // namespace firmware::controller
