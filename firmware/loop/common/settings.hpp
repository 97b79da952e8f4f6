// What can be set about the control program.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "hal/time.hpp"

namespace firmware {

/// What a rig may do and its samples may be. README.md says why each limit acts as it does.
struct Limits {
  double stroke = 0.250;       ///< whole travel; a command stays within ± half of it [m]. Beyond: trips at once
  double speed = 0.7;          ///< of the command [m/s]. Beyond: limited and counted
  double acceleration = 0.0;   ///< of the command [m/s²]. Beyond: limited and counted. 0: highest_acceleration()
  double speed_time = 0.050;   ///< limited for longer than this without a break: trips [s]
  double force = 25e3;         ///< |measured force| [N]. Beyond: trips at once
  double low_force = 0.0;      ///< the same while the drive arms, approaches, returns [N]; 0: highest_low_force()
  double low_speed = 0.0;      ///< of the measured position meanwhile [m/s]; 0: Settings::highest_low_speed()
  int bridged_in_a_row = 3;    ///< a bad sample is bridged by the last good one; so many in a row trip (1: at once)
  double bridged_leak = 0.25;  ///< a good sample makes up for so many bad ones
  double stale_after = 5.0;    ///< a sample older (or from further in the future) than so many periods is bad
  double late_after = 0.25;    ///< a period that begins so many periods after it was due is late
  int late_in_a_row = 5;       ///< so many late periods in a row trip; LatenessGuard counts

  // Of what the rig does: MotionGuard says what they mean.
  double following = 0.010;       ///< |measured − expected position| [m]. For following_time: trips
  double following_least = 1e-3;  ///< of it, what a drive that hardly moves may be away [m]; 0: following
  double measured_stroke = 0.0;   ///< whole measured travel [m]; 0: highest_measured_stroke()
  double measured_speed = 0.0;    ///< of the measured position [m/s]; 0: highest_measured_speed()

  // Of a hil rig: EnergyGuard says what they mean.
  double energy_gain =
      1.0;  ///< energy fed by the interface, in terms of that taken by the car's dampers. Beyond: trips
  double energy_memory = 0.5;  ///< over so long [s]: 7 cycles of a wheel
  double energy_quiet = 2e-3;  ///< cycles narrower than this, peak to peak, do no harm [m]
  int energy_cycles = 3;       ///< so many cycles in a row trip

  /// [m/s²] A sine of 30 Hz, the bandwidth of the roads that a cylinder follows, has it at the speed limit.
  [[nodiscard]] double highest_acceleration() const {
    constexpr double thirty_hertz = 188.49555921538757;  // [rad/s]
    return acceleration > 0.0 ? acceleration : thirty_hertz * speed;
  }
  /// [N] Half of what a run may reach: what a slow motion meets is not described by any road.
  [[nodiscard]] double highest_low_force() const { return low_force > 0.0 ? low_force : 0.5 * force; }
  /// [m] 1 % of the stroke on each side is room for the noise of a sensor and the overshoot of a machine.
  [[nodiscard]] double highest_measured_stroke() const {
    return measured_stroke > 0.0 ? measured_stroke : 1.02 * stroke;
  }
  /// [m/s] A quarter of the speed limit is room for the noise of a differentiated sensor.
  [[nodiscard]] double highest_measured_speed() const { return measured_speed > 0.0 ? measured_speed : 1.25 * speed; }
};

/// For a limit or a time that shall never act.
inline constexpr double never_reached = std::numeric_limits<double>::infinity();

/// How the guards look. README.md of this folder says where each number comes from.
struct Supervision {
  double following_time = 0.050;     ///< a following error for longer than this trips [s]
  double following_memory = 0.5;     ///< the mean square of a following error is taken over so long [s]
  double following_share = 0.05;     ///< … and may have so much of the way from the middle
  double speed_window = 0.010;       ///< the measured speed is a difference over so long [s]
  double frozen_time = 0.2;          ///< a value that stays the same for so long may be frozen [s]; 0: none is
  double frozen_way = 2e-3;          ///< … and is, if the machine has moved so far meanwhile [m]
  double frozen_speed = 0.05;        ///< … or the foot point's speed has changed so much [m/s]
  double frozen_acceleration = 0.5;  ///< … and its acceleration so much [m/s²]
  double late_leak = 0.25;           ///< a punctual period makes up for so many late ones
  double gap = 0.010;                ///< one period that begins so late trips at once [s]
  double enable_time = 0.2;          ///< the contact that shows the power may differ, and a drive coast, so long [s]
  double unpowered_way = 2e-3;       ///< a drive without power that moves so far, or by so much a second, trips [m]
  double force_share = 0.1;          ///< F is implausible below so much of the spring's force; 0: not judged
  double force_way = 2e-3;           ///< … while the machine moves by more than this, rms [m]
  double innovation_noise = 3.0;     ///< a Kalman filter's sensor may have so many times the noise described
  double innovation_share = 0.5;     ///< … and differ by so much of what the filter expects it to show
  double growth_time = 0.1;          ///< a hil interface that pushes outwards for so long trips [s]
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
  double sway = 0.0;                ///< F may move by so much, peak to peak, at rest [N]; 0: not looked at
  double wander = 0.0;              ///< and the position by so much [m]; 0: not looked at
  double position_tolerance = 0.0;  ///< between command and measured position [m]; 0: not compared
  double probe_amplitude = 0.0;     ///< of the small move that shows the signs [m]; 0: none
  double probe_stiffness =
      0.0;                    ///< hil: force over deflection of the described component in the probe [N/m]; 0: unknown
  double allowed_gain = 0.0;  ///< hil: factor on the force that the proven loop bears; 0: unknown
  bool off_centre = false;    ///< the first arming may give power to a drive that stands off the middle
  double stop_test = 0.0;     ///< the stop button must have been pressed within so long before [s]; 0: not asked for
  std::uint32_t hold_to_run = 0;  ///< bit i: interlock i is held by hand: it matters while arming and when led to rest
  double force_ramp = 0.0;        ///< hil: F enters the car over so long from the start of a run [s]
};

/// How velocities are estimated: VelocityObserver says what the numbers do and where the defaults come from.
struct Observers {
  double cross_over = 1.0;        ///< displacement below, acceleration above [Hz]
  double differentiation = 30.0;  ///< bandwidth where there is no accelerometer [Hz]
};

struct Settings {
  hal::Time period = hal::milliseconds(1);
  Limits limits{};
  Supervision supervision{};
  Ramps ramps{};
  Arming arming{};
  Observers observers{};

  /// [m/s] Of the measured position in a slow motion: the reduced speed of ISO 10218-1, beside which people may stand. A
  /// quarter above a faster ramp.
  [[nodiscard]] double highest_low_speed() const {
    constexpr double reduced_speed = 0.25;
    if (limits.low_speed > 0.0) return limits.low_speed;
    const double slow = 1.25 * ramps.rate > reduced_speed ? 1.25 * ramps.rate : reduced_speed;
    return slow < limits.highest_measured_speed() ? slow : limits.highest_measured_speed();
  }

  /// What is wrong with the settings (key and what is expected), or an empty text.
  [[nodiscard]] std::string_view check() const;
};

}  // namespace firmware
