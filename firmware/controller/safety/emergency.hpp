// What a program that is beyond help still does: valves safe, command to rest.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/loop/common/settings.hpp"
#include "hal/clock.hpp"
#include "hal/command_output.hpp"
#include "hal/rig.hpp"

namespace firmware::controller {

/// A command output that remembers what it let out, for whoever has nothing else left to ask.
class RememberedCommand final : public hal::CommandOutput {
 public:
  explicit RememberedCommand(hal::CommandOutput& output) : output_(output) {}

  // From any thread, in a signal handler too.
  [[nodiscard]] bool moved() const { return moved_.load(); }  ///< anything went out
  [[nodiscard]] double position() const { return position_.load(); }
  [[nodiscard]] double velocity() const { return velocity_.load(); }

 private:
  hal::Result<void> do_write(const hal::Command& command) override;

  static_assert(std::atomic<double>::is_always_lock_free, "a signal handler must not wait for the loop");
  hal::CommandOutput& output_;
  std::atomic<double> position_{0.0};
  std::atomic<double> velocity_{0.0};
  std::atomic<bool> moved_{false};
};

/// The way to rest without the control loop: static memory, no lock, only calls that a signal handler may make as long
/// as the roles' own are such.
class EmergencyReturn {
 public:
  enum class End : unsigned char { at_rest, held, command_lost, not_in_time };

  /// Valves, drive enable, stop button and interlocks of the rig; its clock is not asked.
  EmergencyReturn(const hal::Rig& rig, RememberedCommand& command, hal::Clock& clock, const Ramps& ramps,
                  double half_stroke, double period, std::uint32_t hold_to_run = 0);

  /// High pressure off, valves to the safe position, whatever comes of it.
  void make_valves_safe();

  /// And the command to rest as after a trip: braked, then back at the given rate (firmware::ReturnToRest), one write a
  /// period, for periods_at_most(). Faults that last three periods, or that are no time-out, end it. A stop button that
  /// is pressed, an interlock that is open, or either that cannot be read turns it into braking and holding, and takes
  /// the drive's enable at once. Whatever the end, the drive has lost its enable.
  [[nodiscard]] End go();

  /// Twice the slowest way back from the end of the stroke, and a second.
  [[nodiscard]] int periods_at_most() const;

 private:
  [[nodiscard]] bool stopped_by_hand();
  void take_power();

  hal::Rig rig_;
  RememberedCommand& command_;
  hal::Clock& clock_;
  Ramps ramps_;
  double half_stroke_;
  double period_;
  std::uint32_t hold_to_run_;  ///< interlocks that matter only where a person leads
};

/// What the trap handler works with; belongs to the caller, until forget_traps().
struct Emergency {
  EmergencyReturn* emergency_return = nullptr;
  const RememberedCommand* command = nullptr;
  std::atomic<bool>* at_rest = nullptr;  ///< set by the loop's thread when it is at rest
  void (*stop)(void* loop) = nullptr;    ///< asks the loop for a stop, from a signal handler
  void* loop = nullptr;
  double period = 1e-3;  ///< [s]
};

/// From here on SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGSYS, SIGTRAP and SIGABRT end in the safe state before they end the
/// program. Each thread needs an AlternateStack for its own stack overflow.
///
/// In the loop's thread (the one that calls this) the handler itself returns the command to rest. In any other one the
/// loop goes on: it is asked to stop, which makes the valves safe and moves the command to rest, and the handler waits
/// for that. While the command returns, systemd is told
/// that the program lives and how long it takes, and an abort from outside is ignored. Either is bounded in time; a
/// trap in the handler, or an alarm, ends what hangs. The last line says what became of the command; then the program
/// dies as it would have.
void catch_traps(const Emergency& emergency);

/// The run is over: a trap only ends the program.
void forget_traps();

/// forget_traps() where it goes out of scope: before what the handler works with is gone.
struct ForgetTraps {
  ForgetTraps() = default;
  ForgetTraps(const ForgetTraps&) = delete;
  ForgetTraps& operator=(const ForgetTraps&) = delete;
  ~ForgetTraps() { forget_traps(); }
};

/// True once a trap's return to rest has begun.
[[nodiscard]] bool emergency_under_way();

/// Whether a thread other than the loop's has trapped.
[[nodiscard]] bool trapped();

}  // namespace firmware::controller
