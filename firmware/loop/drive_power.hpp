// Whether the drive has power, shall have it, and really has it.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "hal/drive_enable.hpp"
#include "hal/time.hpp"
#include "model/components/channel.hpp"

namespace firmware {

/// The drive's enable, and what shows that it does what it is told.
///
/// Power that is wanted stays wanted until it is taken; nothing but give() asks for it. "Off" is not believed unread:
///
///   (1)  feedback ≠ wanted, or unreadable, for longer than enable_time      hazard: enable_feedback
///   (2)  x̄ ← x̄ + (x − x̄) h/T,  T = 1 s                                      mean of the measured position
///   (3)  |x − x̄| > unpowered_way, no power for longer than enable_time       hazard: motion_without_power
///
/// (1) where a contact is fitted that moves with the power; (3) where the rig has an enable and the position is
/// measured. A step of unpowered_way trips, and so does a lasting speed of unpowered_way/T; what sinks more slowly does
/// not. Within enable_time a contactor drops out and the drive coasts to a stop; x̄ is x until then.
/// The second stage of a power unit, where there is one, follows power that has been proven and goes before it.
class DrivePower {
 public:
  DrivePower(hal::DriveEnable& enable, const Supervision& supervision, double period, model::Channel position,
             hal::DriveEnable* high_pressure = nullptr);

  void give() { wanted_ = true; }
  void take() { wanted_ = false; }

  [[nodiscard]] bool wanted() const { return wanted_; }
  [[nodiscard]] bool on() const { return on_; }  ///< as last written with success
  /// Enable and second stage are as wanted.
  [[nodiscard]] bool written() const { return written_ && (high_pressure_ == nullptr || high_.has_value()); }
  [[nodiscard]] bool to_be_taken() const { return !wanted_; }      ///< off first, on last
  [[nodiscard]] bool still() const { return !on_ && !moves_; }     ///< no power, and nothing is seen to move
  [[nodiscard]] bool always() const { return !enable_.fitted(); }  ///< no enable: the drive has power at all times
  [[nodiscard]] std::uint64_t failures() const { return failures_; }

  /// Writes at a change, and again after a fault. False: not taken, whether the drive has power is unknown.
  [[nodiscard]] bool write(hal::Time now);

  /// The same for the second stage: on where `wanted`, and the drive has power. Off before the power is taken, on after.
  [[nodiscard]] bool write_high_pressure(bool wanted);

  /// Once a period; `position` where it is measured by a good sample. (1), then (3).
  [[nodiscard]] std::optional<Trip> watch(std::optional<double> position, hal::Time now);

  /// Where the drive stands without power, smoothed over 20 ms [m]; nothing where it is not measured.
  [[nodiscard]] std::optional<double> place() const { return place_; }

 private:
  static constexpr double mean_time = 1.0;    ///< T [s]
  static constexpr double place_time = 0.02;  ///< noise of a sensor, less than 1 s of anything that sinks [s]

  [[nodiscard]] std::optional<Trip> watch_feedback(hal::Time now);
  [[nodiscard]] std::optional<Trip> watch_motion(std::optional<double> position, hal::Time now);

  hal::DriveEnable& enable_;
  hal::DriveEnable* high_pressure_;
  hal::Time enable_time_;
  double way_;         ///< unpowered_way [m]
  double mean_share_;  ///< h/T
  double place_share_;
  model::Channel channel_;
  bool wanted_ = false;
  bool on_ = false;
  bool written_ = true;
  bool moves_ = false;
  std::optional<bool> high_{};  ///< the second stage as last written with success
  std::uint64_t failures_ = 0;
  hal::Time agreed_ = hal::never;  ///< feedback and wanted, last
  hal::Time taken_ = hal::never;   ///< the power went, or the program began
  std::optional<double> place_{};  ///< [m]
  double mean_ = 0.0;              ///< x̄ [m]
};

}  // namespace firmware
