// What can be set about the control program.
#pragma once

#include <string_view>

#include "hal/time.hpp"

namespace firmware {

/// What a rig may do and its samples may be. README.md says why each limit acts as it does.
struct Limits {
  double stroke = 0.250;      ///< whole travel; a command stays within ± half of it [m]. Beyond: trips at once
  double speed = 0.7;         ///< of the command [m/s]. Beyond: limited and counted
  double speed_time = 0.050;  ///< limited for longer than this without a break: trips [s]
  double force = 25e3;        ///< |measured force| [N]. Beyond: trips at once
  int bridged_in_a_row = 3;   ///< a bad sample is bridged by the last good one; so many in a row trip (1: at once)
  double stale_after = 5.0;   ///< a sample older (or from further in the future) than so many periods is bad
  double late_after = 0.25;   ///< a period that begins so many periods after it was due is late
  int late_in_a_row = 5;      ///< so many late periods in a row trip

  // Of a hil rig: EnergyGuard says what they mean.
  double energy_gain =
      1.0;  ///< energy fed by the interface, in terms of that taken by the car's dampers. Beyond: trips
  double energy_memory = 0.5;  ///< over so long [s]: 7 cycles of a wheel
  double energy_quiet = 2e-3;  ///< cycles narrower than this, peak to peak, do no harm [m]
  int energy_cycles = 3;       ///< so many cycles in a row trip
};

/// How the command gets to the reference and back.
struct Ramps {
  double rest = 0.0;      ///< command at rest [m]
  double rate = 0.05;     ///< highest speed of the moves from rest and back to it [m/s]
  double braking = 20.0;  ///< deceleration in safe, before the move back to rest; more if the stroke is short [m/s²]
  double settling = 0.0;  ///< wait at the beginning of the reference before running [s]
};

/// What is looked at before a run. The defaults look at nothing, as a simulated rig wants it; a rig description has
/// defaults of its own. ArmingChecks says what the numbers do.
struct Arming {
  double tare_time = 0.0;           ///< force and position are averaged for so long [s]; 0: no tare
  double preload = 0.0;             ///< largest |F| at rest that counts as an offset of the sensor [N]
  double position_tolerance = 0.0;  ///< between command and measured position [m]; 0: not compared
  double probe_amplitude = 0.0;     ///< of the small move that shows the signs [m]; 0: none
  double force_ramp = 0.0;          ///< hil: F enters the car over so long from the start of a run [s]
};

/// How velocities are estimated: VelocityObserver says what the numbers do and where the defaults come from.
struct Observers {
  double cross_over = 1.0;        ///< displacement below, acceleration above [Hz]
  double differentiation = 30.0;  ///< bandwidth where there is no accelerometer [Hz]
};

struct Settings {
  hal::Time period = hal::milliseconds(1);
  Limits limits{};
  Ramps ramps{};
  Arming arming{};
  Observers observers{};

  /// What is wrong with the settings (key and what is expected), or an empty text.
  [[nodiscard]] std::string_view check() const;
};

}  // namespace firmware
