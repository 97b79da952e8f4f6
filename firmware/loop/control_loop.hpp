// The real-time program: estimate → compute → supervise → act, once a period.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/loop/command_guard.hpp"
#include "firmware/loop/energy_guard.hpp"
#include "firmware/loop/frozen_guard.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/loop/lateness_guard.hpp"
#include "firmware/loop/mode.hpp"
#include "firmware/loop/motion_guard.hpp"
#include "firmware/loop/ramp.hpp"
#include "firmware/loop/reference.hpp"
#include "firmware/loop/sample_guard.hpp"
#include "firmware/loop/settings.hpp"
#include "firmware/loop/state_estimator.hpp"
#include "firmware/loop/trip.hpp"
#include "firmware/loop/valve_plan.hpp"
#include "hal/rig.hpp"
#include "model/rig_model.hpp"

namespace firmware {

/// The control program of all three kinds of rig.
///
/// Timing: at t_k the samples of t_k are read, row k of the journal is the rig at t_k, and the command put out is for
/// t_{k+1}; the drive moves to it during the period.
///
///   hil              F(t_k) enters the virtual car, which is stepped to t_{k+1} with F held; command z_w − z_b there
///   quarter_car      command is the foot point of the reference at t_{k+1}; velocities and wheel load are estimated
///   component_bench  command is the deflection of the reference at t_{k+1}
///
/// In ready the command moves from rest to where the reference begins (hil: to no deflection, the car at rest above the
/// beginning of its road), the valves already stand as the run begins.
/// Static memory, no heap after construction, no exceptions, the same work every period.
class ControlLoop {
 public:
  using VirtualCar = model::VirtualCar<double>;

  /// What makes the parts unfit for each other (what, and what is expected), or an empty text.
  [[nodiscard]] static std::string_view check(const Settings& settings, const model::RigParameters<double>& parameters,
                                              const hal::Rig& rig, const ValvePlan& valves);

  /// Parts that pass check(), else stops. References must outlive the loop. Nothing is written yet.
  ControlLoop(const Settings& settings, const model::RigParameters<double>& parameters, const hal::Rig& rig,
              Reference& reference, const ValvePlan& valves, Journal& journal);
  ControlLoop(const ControlLoop&) = delete;
  ControlLoop& operator=(const ControlLoop&) = delete;
  ~ControlLoop() = default;

  /// Requests from any thread, taken up by the next period.
  void start() { requests_.fetch_or(start_request); }              ///< idle → ready
  void stop() { requests_.fetch_or(stop_request); }                ///< ready, running → safe, in good order
  void acknowledge() { requests_.fetch_or(acknowledge_request); }  ///< safe → idle, once at rest and without hazard

  /// One period, without sleeping: for whoever keeps the time himself, from due() to due().
  void step();

  /// Period after period on the rig's clock for as long as keep_running() says so. A late period is counted, never made
  /// up for.
  template <class KeepRunning>
  void run(KeepRunning&& keep_running) {
    while (keep_running()) {
      rig_.clock.sleep_until(due());
      step();
    }
  }

  /// When the next period begins.
  [[nodiscard]] hal::Time due() { return due_ == hal::never ? rig_.clock.now() : due_; }

  // For the thread that steps the loop; others read the journal.
  [[nodiscard]] Mode mode() const { return mode_; }
  [[nodiscard]] const Trip& trip() const { return trip_; }  ///< why the last run ended
  [[nodiscard]] bool at_rest() const { return mode_ == Mode::idle || (mode_ == Mode::safe && return_.arrived()); }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] const StateEstimator& estimator() const { return estimator_; }

 private:
  static constexpr unsigned start_request = 1;
  static constexpr unsigned stop_request = 2;
  static constexpr unsigned acknowledge_request = 4;

  [[nodiscard]] bool hil() const { return kind_ == model::RigKind::hil; }

  void keep_time(hal::Time now);
  void watch_motion();
  [[nodiscard]] std::optional<Trip> find_hazard(hal::Time now);
  void get_ready();
  void trip(const Trip& trip);
  void compute(hal::Time now);
  [[nodiscard]] std::optional<hal::Command> follow_reference();
  [[nodiscard]] hal::Command step_car(const Motion& foot_point);
  void act(hal::Time now);
  [[nodiscard]] bool write_valves();
  void note_values(Record& record) const;

  Settings settings_;
  double period_;
  model::RigKind kind_;
  hal::Rig rig_;
  Reference& reference_;
  ValvePlan valves_;
  Journal& journal_;
  std::optional<VirtualCar> car_{};  ///< hil only

  SampleGuard samples_;
  StateEstimator estimator_;
  CommandGuard command_guard_;
  EnergyGuard energy_guard_;
  MotionGuard motion_guard_;
  FrozenGuard frozen_guard_;
  LatenessGuard lateness_guard_;
  std::optional<Trip> motion_hazard_{};  ///< of this period, by motion and frozen guard
  std::optional<Trip> energy_hazard_{};  ///< of this period
  SmoothMove move_{};
  ReturnToRest return_{};

  std::atomic<unsigned> requests_{0};
  Mode mode_ = Mode::idle;
  Trip trip_{};
  Counters counters_{};
  hal::Time due_ = hal::never;
  hal::Time lateness_{};  ///< of this period
  int failed_commands_in_a_row_ = 0;
  std::uint64_t periods_ = 0;
  std::uint64_t sample_ = 0;        ///< k, in mode running
  std::int64_t settling_left_ = 0;  ///< periods
  bool reference_begins_ = false;   ///< the reference has a first value
  VirtualCar::State car_state_{};
  bool car_alive_ = false;    ///< the car's state is that of this instant
  hal::Command command_{};    ///< of this period
  hal::Openings openings_{};  ///< of this period
};

}  // namespace firmware
