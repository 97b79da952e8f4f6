#include "firmware/controller/devices/simulated_devices.hpp"

#include "firmware/simulation/simulated_rig.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/linux/clock.hpp"
#include "hal/simulated/rig.hpp"

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
  SimulatedDevices(const RigDescription& rig, const Options& options)
      : plant_(rig, options.seed, SimulatedRig::Noise::as_described),
        rig_(plant_,
             simulated_construction(rig, options.virtual_time ? hal::Time{} : hal::linux::MonotonicClock().now())),
        paced_(rig_.roles().clock),
        virtual_time_(options.virtual_time) {}

  [[nodiscard]] hal::Rig roles() override {
    const hal::Rig roles = rig_.roles();
    if (virtual_time_) return roles;
    return {paced_,          roles.sensors,      roles.valves,     roles.command, roles.stop_button,
            roles.heartbeat, roles.drive_enable, roles.interlocks, roles.area};
  }
  [[nodiscard]] std::string text() const override {
    return std::string("SIMULATED RIG, no devices") + (virtual_time_ ? ", virtual time\n" : "\n");
  }

 private:
  SimulatedRig plant_;
  hal::simulated::Rig rig_;
  PacedClock paced_;
  bool virtual_time_;
};

}  // namespace

std::unique_ptr<Devices> simulate_devices(const RigDescription& rig, const Options& options) {
  return std::make_unique<SimulatedDevices>(rig, options);
}

}  // namespace firmware::controller
