// The real-time program: estimate → compute → supervise → act, once a period.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/loop/area_control.hpp"
#include "firmware/loop/arming_checks.hpp"
#include "firmware/loop/common/mode.hpp"
#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/companion.hpp"
#include "firmware/loop/compensation/compensation.hpp"
#include "firmware/loop/drive_power.hpp"
#include "firmware/loop/estimator/state_estimator.hpp"
#include "firmware/loop/guards/command_guard.hpp"
#include "firmware/loop/guards/force_guard.hpp"
#include "firmware/loop/guards/frozen_guard.hpp"
#include "firmware/loop/guards/lateness_guard.hpp"
#include "firmware/loop/guards/motion_guard.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "firmware/loop/hil_interface.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/loop/reference/ramp.hpp"
#include "firmware/loop/reference/reference.hpp"
#include "firmware/loop/reference/reference_player.hpp"
#include "firmware/loop/refusals.hpp"
#include "firmware/loop/valve_plan.hpp"
#include "hal/rig.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// The control program of all three kinds of rig.
///
/// Timing: at t_k the samples of t_k are read, row k of the journal is the rig at t_k, and the command put out is for
/// t_{k+1}; the drive moves to it during the period.
///
///   hil              F(t_k) enters the virtual car, which is stepped to t_{k+1} with F held; command z_w − z_b there.
///                    A Compensation stands between both: it may change F before and the command behind the car
///   quarter_car      command is the foot point of the reference at t_{k+1}; velocities and wheel load are estimated
///   component_bench  command is the deflection of the reference at t_{k+1}
///
/// While the drive has no power, the command stays; idle writes none. Power is given in two places only: by an arming,
/// which begins where the drive stands and looks at the rig (ArmingChecks) before start() leads to ready, and by a
/// person's go_to_rest(), which begins there too. mode.hpp and trip.hpp hold the states, requests and reasons as
/// tables. In ready the command moves to where the reference begins (hil: to no deflection, the car at rest above the
/// beginning of its road), the valves already stand as the run begins.
/// Static memory, no heap after construction, no exceptions, the same work every period.
class ControlLoop {
 public:
  using VirtualCar = model::VirtualCar<double>;
  static constexpr bool has_area = model::usual_laws.extensions;  ///< room for the control of an air spring

  /// What makes the parts unfit for each other (what, and what is expected), or an empty text.
  [[nodiscard]] static std::string_view check(const Settings& settings, const model::RigParameters<double>& parameters,
                                              const hal::Rig& rig, const ValvePlan& valves);

  /// Parts that pass check(), else stops. References must outlive the loop. Nothing is written yet.
  ControlLoop(const Settings& settings, const model::RigParameters<double>& parameters, const hal::Rig& rig,
              Reference& reference, const ValvePlan& valves, Journal& journal);
  ControlLoop(const ControlLoop&) = delete;
  ControlLoop& operator=(const ControlLoop&) = delete;
  ~ControlLoop() = default;

  /// Requests from any thread, taken up by the next period: request_rules says in which states.
  void request(Request wanted) { requests_.fetch_or(bit(wanted)); }
  void arm() { request(Request::arm); }        ///< idle → arming → armed
  void disarm() { request(Request::disarm); }  ///< armed → idle
  void start() { request(Request::start); }    ///< armed → ready → running
  void hold() { request(Request::hold); }      ///< running → holding
  void resume() { request(Request::resume); }  ///< holding → running
  /// Any → safe, and back to rest; a second one, or one on the way to rest, brakes and holds for good.
  void stop() { request(Request::stop); }
  /// As the first stop(), and nothing more where the way to rest is under way: for a program that ends.
  void end() { request(Request::end); }
  /// In safe, standing, without hazard, and not since a reason that takes a new arming: back to rest.
  void go_to_rest() { request(Request::rest); }
  void acknowledge() { request(Request::acknowledge); }  ///< safe → idle, once standing and without hazard
  /// Scales the reference about its beginning, 0 … ReferencePlayer::highest_level; at once before a run, within a
  /// second or so during it. False: outside, nothing is asked for.
  bool level(double wanted);

  /// Takes a companion along, which must outlive the loop. Before the first period.
#ifndef RIGTWIN_ALONE
  void attach(Companion& companion) { companion_.set(&companion); }
  /// The same for a compensation of the machine's delay; a rig that is no hil never calls it.
  void attach(Compensation& compensation) { hil_.attach(compensation); }
#endif

  /// The first period is due then, and not when step() is called first.
  void begin_at(hal::Time first) { due_ = first; }
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

  /// All checks that the last arming has failed; empty where none was refused since the last one began. Any thread.
  [[nodiscard]] const Refusals& refusals() const { return refusals_; }
  /// Why the last `rest` was not taken; empty where it was. Any thread.
  [[nodiscard]] const Refusals& rest_refusals() const { return rest_refusals_; }

  // For the thread that steps the loop; others read the journal.
  [[nodiscard]] Mode mode() const { return mode_; }
  [[nodiscard]] const Trip& trip() const { return trip_; }  ///< why the rig is or was in safe
  [[nodiscard]] const Trip& second() const {
    return second_;
  }  ///< what happened after that, first, or with power nobody gave
  /// Nothing is commanded to move any more, the drive has no power, and nothing is seen to move.
  [[nodiscard]] bool at_rest() const {
    return (mode_ == Mode::idle || (mode_ == Mode::safe && standing())) && power_.still();
  }
  /// In safe the command stays where it stopped, instead of returning to rest.
  [[nodiscard]] bool held() const { return mode_ == Mode::safe && held_; }
  /// An arming has passed, and nothing has happened since that takes one: `rest` may give power.
  [[nodiscard]] bool proven() const { return proven_; }
  [[nodiscard]] bool enabled() const { return power_.on(); }                           ///< the drive has power
  [[nodiscard]] double tare() const { return samples_.tare(force_channel()); }         ///< taken from F, or F_w [N]
  [[nodiscard]] const hal::Command& command() const { return command_guard_.last(); }  ///< for this instant
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] const ForceGuard& force_guard() const { return force_guard_; }
  [[nodiscard]] const StateEstimator& estimator() const { return estimator_; }

 private:
  static constexpr unsigned bit(Request request) { return 1U << static_cast<unsigned>(request); }
  static constexpr unsigned level_request = 1U << (static_cast<unsigned>(last_request) + 1);

  [[nodiscard]] bool hil() const { return kind_ == model::RigKind::hil; }
  [[nodiscard]] bool standing() const { return return_.arrived(); }
  [[nodiscard]] model::Channel position_channel() const {
    return kind_ == model::RigKind::quarter_car ? model::Channel::z_r : model::Channel::x_act;
  }

  [[nodiscard]] model::Channel force_channel() const {
    return kind_ == model::RigKind::quarter_car ? model::Channel::F_w : model::Channel::F;
  }
  /// In safe: on the way to rest, or braking.
  [[nodiscard]] bool moves_in_safe() const { return mode_ == Mode::safe && (!standing() || power_.wanted()); }
  /// Where the drive stands without power, if that is known and looked at.
  [[nodiscard]] std::optional<double> place() const;

  void keep_time(hal::Time now);
  void estimate(hal::Time now);
  void set_low_limits();
  void watch_motion(hal::Time now);
  [[nodiscard]] std::optional<Trip> find_hazard(hal::Time now);
  [[nodiscard]] std::optional<Trip> find_stop(hal::Time now);
  [[nodiscard]] std::optional<Trip> find_open_interlock(hal::Time now);
  [[nodiscard]] bool wants_hold_to_run(unsigned requests) const;
  [[nodiscard]] std::optional<Trip> find_untested_stop(hal::Time now) const;
  [[nodiscard]] bool matters(const Trip& hazard) const;
  [[nodiscard]] bool is_lasting(const Trip& hazard) const;
  void take_up(Request request, unsigned requests, const std::optional<Trip>& hazard, hal::Time now);
  [[nodiscard]] bool allowed(const RequestRule& rule, bool hazard) const;
  void follow(Event event);
  void begin_at_rest(double position);
  void return_to_rest(double velocity);
  [[nodiscard]] std::optional<Trip> look_at_arming(hal::Time now, std::optional<Trip> hazard);
  void list_refusals(Refusals& list, const Trip& first, hal::Time now) const;
  void begin_arming(hal::Time now);
  void get_ready();
  void trip(const Trip& trip);
  void lose_power(const Trip& cause);
  void brake_and_hold(double velocity);
  void command_area(hal::Time now);
  void compute(hal::Time now);
  [[nodiscard]] std::optional<hal::Command> wanted_command(hal::Time now);
  [[nodiscard]] std::optional<hal::Command> follow_reference(hal::Time now);
  void act(hal::Time now);
  [[nodiscard]] bool writes_command() const;
  void write_command(hal::Time now, bool& valves_stand);
  [[nodiscard]] bool write_valves();
  void write_enable(hal::Time now);
  void write_high_pressure(hal::Time now);
  void note_values(Record& record) const;

  Settings settings_;
  double period_;
  model::RigKind kind_;
  hal::Rig rig_;
  ValvePlan valves_;
  Journal& journal_;
  [[no_unique_address]] CompanionPlace companion_{};

  SampleGuard samples_;
  StateEstimator estimator_;
  CommandGuard command_guard_;
  HilInterface hil_;
  DrivePower power_;
  MotionGuard motion_guard_;
  FrozenGuard frozen_guard_;
  ForceGuard force_guard_;
  LatenessGuard lateness_guard_;
  std::optional<Trip> stop_hazard_{}, interlock_hazard_{};  ///< of this period
  std::uint32_t open_interlocks_ = 0;                       ///< of this period, bit i: interlock i
  std::optional<Trip> motion_hazard_{};                     ///< of this period, by motion, frozen and force guard
  std::optional<Trip> power_hazard_{};                      ///< of this period
  [[no_unique_address]] AreaControl<has_area> area_control_;
  ArmingChecks arming_;
  Refusals refusals_, rest_refusals_;
  ReferencePlayer player_;
  SmoothMove move_{};
  ReturnToRest return_{};

  std::atomic<unsigned> requests_{0};
  std::atomic<std::uint32_t> wanted_level_{0};  ///< in millionths: a board has no atomic double
  Mode mode_ = Mode::idle;
  Trip trip_{};
  Trip second_{};
  bool held_ = false;          ///< in safe: stays where it stopped
  bool expects_trip_ = false;  ///< in safe: the hazard of trip_ may last while the command returns to rest
  bool proven_ = false;        ///< arming has passed, and nothing has happened since that takes an arming
  bool place_shown_ = false;   ///< the last arming has found the drive where its command is
  bool sign_shown_ = false;    ///< of the measured position, by a probe of this program
  bool led_back_ = false;      ///< in safe: somebody's `rest` leads the way to rest
  bool hand_wanted_ = false;   ///< contacts that are held by hand matter in this period
  bool starved_ = false;       ///< no heartbeat until somebody has acknowledged why
  Counters counters_{};
  hal::Time due_ = hal::never;
  hal::Time lateness_{};  ///< of this period
  int failed_commands_in_a_row_ = 0;
  std::uint64_t periods_ = 0;
  std::uint64_t sample_ = 0;        ///< k, in mode running
  std::int64_t settling_left_ = 0;  ///< periods
  bool reference_begins_ = false;   ///< the reference has a first value
  hal::Command command_{};          ///< of this period
  hal::Openings openings_{};        ///< of this period
};

}  // namespace firmware
