// What the simulated rig itself shows, whatever the program says of it: power, motion, force, and trips that are missed.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/faults/scenario.hpp"
#include "tests/faults/watch.hpp"
#include "tests/firmware/loop/rig_under_test.hpp"

namespace faults {

/// Looks at a rig after each period. The first thing that is violated stays; empty: nothing.
///
///   power     comes only within 1.2 s of somebody's arm or rest, of a drive whose converter shows what it was told; it
///             is gone 80 ms after a press of any contact, and stays so until somebody asks
///   motion    none 80 ms after a press
///             a rest gives it only if an arming has passed since the rig was idle and since what takes one; of a drive
///             that stands off the middle only with words; not after a second stop
///   braking   a drive that moved by 0.06 m/s and more is slowed down by 35 m/s² at most: it does not stop dead
///   force     what is beyond its limit for 150 ms does not grow by a twentieth while the drive has power; on the way back
///             to rest for 30 ms, half of the limit and a tenth of it; in armed and approach it is not beyond half of it
///   standing  nobody acknowledges a rig that moves or has power
///   trips     each fault of must_trip() leads to safe within its time where the program leads the drive; so do, outside
///             an arming, a drive that stays 11 mm and more away from its command for 70 ms, or whose mean error is twice
///             what is allowed for 50 ms; and a sensor that repeats itself for 220 ms while the drive moves by 2.5 mm
///
/// 80 ms: braking from 0.7 m/s at 20 m/s² takes 35, two periods that begin 20 ms late 40, 5 are left. A contact that is
/// welded without anything that shows it is nobody's fault; what shows it (enable_feedback) has 0.2 s, the watchdog 20
/// ms more.
class PlantWatch : public Watch {
 public:
  PlantWatch(const Scenario& scenario, const rig_under_test::Journey& journey)
      : Watch("plant", scenario, journey), place_(journey.rig.drive().position), musts_(must_trip(scenario)) {}

  /// Before a period.
  void asked(Request::What what) {
    const bool asks = what == Request::What::arm || what == Request::What::rest;
    if (asks) asked_at_ = now();
    if (what == Request::What::stop) {
      asked_at_ = hal::never;
      const bool second = journey_.loop.mode() == Mode::safe && journey_.rig.powered() && in_safe_ > 1;
      if (second && stopped_again_at_ == hal::never) stopped_again_at_ = now();
    }
    if (asks && !pressed()) pressed_at_ = hal::never;
    if (asks) stopped_again_at_ = hal::never;
    if (asks) rest_asked_ = what == Request::What::rest;
  }

  /// After a period.
  void look() {
    const Mode mode = journey_.loop.mode();
    in_safe_ = mode == Mode::safe ? in_safe_ + 1 : 0;
    look_at_press();
    look_at_power();
    look_at_braking();
    look_at_force();
    look_at_pushes();
    look_at_rest();
    look_for_missed_trips();
    look_at_standstill();
    const double moved = std::abs(journey_.rig.drive().position - place_);
    if (mode_ == Mode::safe && mode == Mode::idle && ((had_power_ && scenario_.scene.drive_enable) || moved > 1e-9) &&
        !scenario_.moves_by_itself()) {
      violate("acknowledged in motion or with power [m]", moved, 0.0);
    }
    had_power_ = journey_.rig.powered();
    place_ = journey_.rig.drive().position;
    mode_ = mode;
  }

 private:
  static constexpr double reaction = 0.08;        // [s]
  static constexpr double arming_patience = 1.2;  // [s]
  /// A fault that must trip: where it is there for more than `periods` periods in which the program leads the drive.
  struct Must {
    const char* what;
    hal::simulated::Window window;
    int periods;
    bool arming = false;  ///< only while the rig arms
    int seen = 0;
  };

  static std::vector<Must> must_trip(const Scenario& s) {
    using hal::simulated::ChannelFault;
    using Device = hal::simulated::DeviceFault::Device;
    std::vector<Must> all;
    for (const auto& f : s.presses) all.push_back({"press", f.window, 1});
    for (const auto& f : s.open_interlocks) {
      const bool by_hand = (s.scene.settings.arming.hold_to_run >> f.interlock & 1U) != 0;
      all.push_back({by_hand ? "open contact held by hand" : "open interlock", f.window, 1, by_hand});
    }
    for (const auto& f : s.channels) {
      const bool bad = f.kind == ChannelFault::Kind::drop || f.kind == ChannelFault::Kind::not_a_number;
      if (bad && f.probability >= 1.0) all.push_back({"bad samples", f.window, 4});
      if (f.kind == ChannelFault::Kind::freeze) all.push_back({"samples with an old stamp", f.window, 12});
      const bool late = f.kind == ChannelFault::Kind::delay && f.delay_samples > 6 && f.probability >= 1.0;
      if (late) all.push_back({"late samples", f.window, 5});
    }
    if (s.lossy) all.push_back({"two bad samples of three", *s.lossy, 15});
    if (s.often_late) all.push_back({"one late period in five", *s.often_late, 40});
    for (const auto& f : s.devices) {
      const int patience = f.fault == hal::Fault::timeout ? 4 : 1;
      if (f.device == Device::sensors) all.push_back({"sensors", f.window, patience});
      if (f.device == Device::command && s.scene.drive_enable) all.push_back({"command", f.window, patience});
      if (f.device == Device::stop_button) all.push_back({"unreadable button", f.window, 1});
      if (f.device == Device::interlocks) all.push_back({"unreadable interlocks", f.window, 1});
      if (f.device == Device::valves) all.push_back({"valves", f.window, 1});
      if (f.device == Device::heartbeat) all.push_back({"heartbeat", f.window, 1});
    }
    for (const auto& f : s.late) {
      if (f.by > hal::milliseconds(11)) all.push_back({"late period", f.window, 1});
      if (f.by > hal::microseconds(300)) all.push_back({"late periods", f.window, 12});
    }
    return all;
  }

  [[nodiscard]] hal::Time now() const { return journey_.rig.now(); }
  [[nodiscard]] double since(hal::Time time) const { return time == hal::never ? -1.0 : (now() - time).seconds(); }
  template <class Faults>
  [[nodiscard]] bool any(const Faults& faults) const {
    return std::any_of(faults.begin(), faults.end(), [&](const auto& f) { return f.window.contains(now()); });
  }
  [[nodiscard]] bool pressed() const { return any(scenario_.presses); }
  [[nodiscard]] bool welded() const {
    return std::any_of(scenario_.stuck_enables.begin(), scenario_.stuck_enables.end(),
                       [&](const auto& f) { return f.on && f.window.contains(now()); });
  }

  void look_at_press() {
    if (pressed()) {
      if (pressed_at_ == hal::never) pressed_at_ = now();
      asked_at_ = hal::never;
    }
    if (since(stopped_again_at_) > reaction && mode_ == Mode::safe && !scenario_.moves_by_itself()) {
      const double moved = std::abs(journey_.rig.drive().position - place_);
      if (moved > 1e-12) violate("motion after a second stop [m]", moved, 0.0);
    }
    if (since(pressed_at_) <= reaction) return;
    const double moved = std::abs(journey_.rig.drive().position - place_);
    if (moved > 1e-12 && !scenario_.moves_by_itself()) violate("motion after a press [m]", moved, 0.0);
    if (scenario_.scene.drive_enable && journey_.rig.powered() && !welded()) {
      violate("power after a press [s]", since(pressed_at_), reaction);
    }
  }

  void look_at_power() {
    if (!scenario_.scene.drive_enable) return;
    const bool powered = journey_.rig.powered();
    const Mode mode = journey_.loop.mode();
    if (mode == Mode::armed) armed_ = proven_ = true;
    if (mode == Mode::idle) proven_ = false;
    if (had_power_ && takes_an_arming()) proven_ = false;
    if (powered && since(stopped_again_at_) > reaction && !welded()) {
      violate("power after a second stop [s]", since(stopped_again_at_), reaction);
    }
    if (powered && !had_power_ && !welded()) {
      if (rest_asked_ && !proven_) violate("power by a rest without an arming", 1.0, 0.0);
      const auto& arming = scenario_.scene.settings.arming;
      const double off = std::abs(journey_.rig.drive().position);
      if (!armed_ && !arming.off_centre && arming.probe_amplitude > 0.0 && off > 1.1 * arming.position_tolerance &&
          !scenario_.position_lies()) {
        violate("power off the middle before a probe [m]", off, arming.position_tolerance);
      }
      const double asked = since(asked_at_);
      if (asked < 0.0 || asked > arming_patience) violate("power that nobody asked for [s]", asked, arming_patience);
      const double tolerance = scenario_.scene.settings.arming.position_tolerance;
      for (const auto& error : scenario_.read_back_errors) {
        if (error.window.contains(now()) && error.window.from + hal::milliseconds(1300) < now() &&
            journey_.loop.mode() == Mode::arming && std::abs(error.offset) > 1.2 * tolerance) {
          violate("power behind a converter that shows something else [m]", error.offset, tolerance);
        }
      }
      look_at_proofs();
    }
    // The contact is not as the enable says, and shows it.
    const bool closed = powered || (welded() && !journey_.rig.watchdog_has_acted());
    differs_ = closed && !journey_.rig.enabled() && scenario_.scene.enable_feedback ? differs_ + 1 : 0;
    if (differs_ > 320) violate("a welded contact keeps its supply [periods]", differs_, 320.0);
  }

  /// Power has come by an arming: behind a converter that answers, and a test of the stop button.
  void look_at_proofs() {
    if (journey_.loop.mode() != Mode::arming) return;
    const auto silent = [&](const auto& f) {
      return f.device == hal::simulated::DeviceFault::Device::command && f.fault == hal::Fault::timeout &&
             f.window.contains(now());
    };
    if (std::any_of(scenario_.devices.begin(), scenario_.devices.end(), silent)) {
      violate("power behind a converter that is silent", 1.0, 0.0);
    }
    if (!scenario_.wants_stop_tests()) return;
    double tested = firmware::never_reached;
    for (const auto& press : scenario_.presses) {
      const bool both = press.contacts == hal::simulated::Press::Contacts::both;
      if (both && press.window.from <= now()) tested = std::min(tested, since(press.window.from));
    }
    const double most = scenario_.scene.settings.arming.stop_test + 2.0 * h;
    if (tested > most) violate("power without a test of the stop button [s]", tested, most);
  }

  /// What is there now makes the power of a watchdog, or of a line, unknown.
  [[nodiscard]] bool takes_an_arming() const {
    using Device = hal::simulated::DeviceFault::Device;
    const auto& devices = scenario_.devices;
    const bool lines = std::any_of(devices.begin(), devices.end(), [&](const auto& f) {
      return (f.device == Device::heartbeat || f.device == Device::valves) && f.window.contains(now());
    });
    return lines || std::any_of(scenario_.late.begin(), scenario_.late.end(), [&](const auto& f) {
             return f.by > hal::milliseconds(11) && f.window.contains(now());
           });
  }

  /// In safe power lasts as long as something moves, and not behind a force that a slow motion met; no arming passes
  /// with a force that is no offset of a sensor.
  void look_at_rest() {
    using Device = hal::simulated::DeviceFault::Device;
    const Mode mode = journey_.loop.mode();
    if (in_safe_ == 1) from_ = mode_;
    const bool blind = scenario_.fails(Device::command) || scenario_.fails(Device::drive_enable) || welded() ||
                       !scenario_.stuck_drives.empty();
    const bool powered = scenario_.scene.drive_enable && journey_.rig.powered();
    const bool moves = std::abs(journey_.rig.drive().position - place_) > 1e-12;
    standing_ = in_safe_ > 0 && powered && !moves ? standing_ + 1 : 0;
    if (standing_ > 100 && !blind) violate("power at rest [periods]", standing_, 100.0);
    const bool slow = from_ == Mode::arming || from_ == Mode::armed || from_ == Mode::ready;
    const bool met = in_safe_ > 80 && slow && journey_.loop.trip().reason == Reason::force && !rest_asked_;
    if (met && powered && !blind) violate("power behind a force that a slow motion met", 1.0, 0.0);
    if (scenario_.offset && !scenario_.torn && mode == Mode::armed) violate("armed with a preload", 1.0, 0.0);
  }

  void look_at_braking() {
    const double speed = (journey_.rig.drive().position - place_) / h;
    const bool begins = (in_safe_ == 2 || in_safe_ == 3) && std::abs(speed_) > 0.06;  // a short way back is steeper
    const bool judged = begins && had_power_ && journey_.rig.powered() && scenario_.moves_as_described();
    if (judged && std::abs(speed - speed_) > 35.0 * h) violate("stops dead [m/s]", std::abs(speed - speed_), 35.0 * h);
    speed_ = speed;
  }

  /// A drive without power that is pushed for 0.4 s is noticed, and the watchdog takes its supply.
  void look_at_pushes() {
    const bool pushed =
        scenario_.scene.drive_enable && !journey_.rig.powered() && !scenario_.position_lies() &&
        !scenario_.fails(hal::simulated::DeviceFault::Device::sensors) && !any(scenario_.stuck_drives) &&
        std::any_of(scenario_.pushes.begin(), scenario_.pushes.end(),
                    [&](const auto& f) { return f.window.contains(now()) && std::abs(f.velocity) > 0.02; });
    pushed_ = pushed ? pushed_ + 1 : 0;
    if (pushed_ > 450 && !journey_.rig.watchdog_has_acted()) violate("pushed without power [periods]", pushed_, 450.0);
  }

  void look_at_force() {
    const Mode mode = journey_.loop.mode();
    const auto channel = scenario_.scene.parameters.kind == model::RigKind::quarter_car ? rig_under_test::Channel::F_w
                                                                                        : rig_under_test::Channel::F;
    const bool blind = scenario_.fails(hal::simulated::DeviceFault::Device::sensors) ||
                       std::any_of(scenario_.channels.begin(), scenario_.channels.end(),
                                   [&](const auto& f) { return f.channel == model::index(channel); });
    if (blind || !journey_.rig.powered()) {
      above_ = met_ = grown_ = 0;
      return;
    }
    const double shown = journey_.plant.force();
    const double force = std::abs(shown), tared = std::abs(shown - journey_.loop.tare());
    const double limit = scenario_.scene.settings.limits.force;
    if (in_safe_ <= 80) least_ = tared;
    least_ = std::min(least_, tared);
    const bool returns = in_safe_ > 80 && std::abs(journey_.rig.drive().position - place_) > 1e-9 &&
                         scenario_.scene.parameters.kind != model::RigKind::quarter_car;  // whose wheel moves by itself
    grown_ = returns && tared > 0.55 * limit && tared > least_ + 0.1 * limit ? grown_ + 1 : 0;
    if (grown_ > 30) violate("a force grows on the way back [N]", tared, least_);
    const bool approaches = mode == Mode::armed || mode == Mode::ready;
    const bool meets = tared > 1.1 * scenario_.scene.settings.limits.highest_low_force();
    met_ = approaches && meets && !scenario_.torn && !scenario_.deviates_by_sensors() ? met_ + 1 : 0;
    if (met_ > 20) violate("a force in a slow motion [N]", tared, 0.5 * limit);
    above_ = force > limit ? above_ + 1 : 0;
    if (above_ == 150) reached_ = force;
    if (above_ > 150 && force > 1.05 * reached_) violate("a force beyond its limit grows [N]", force, reached_);
  }

  void look_for_missed_trips() {
    for (Must& must : musts_) {
      const Mode mode = journey_.loop.mode();
      const bool there = must.window.contains(now()) && (must.arming ? mode == Mode::arming : leads_drive(mode));
      must.seen = there ? must.seen + 1 : 0;
      if (must.seen > must.periods) violate(must.what, must.seen, must.periods);
    }
  }

  /// A drive that does not go where it is told, and a sensor that does not follow it.
  void look_at_standstill() {
    const auto& loop = journey_.loop;
    const bool led = leads_drive(loop.mode()) && loop.mode() != Mode::arming && journey_.rig.powered();
    const double there = journey_.rig.drive().position, error = commanded_ - there;
    const double velocity = (loop.command().position - commanded_) / h;
    commanded_ = loop.command().position;
    away_ = led && std::abs(error) > 11e-3 ? away_ + 1 : 0;
    const bool blind = scenario_.position_lies() || scenario_.fails(hal::simulated::DeviceFault::Device::sensors);
    if (away_ > 70 && !blind) violate("away from its command [periods]", away_, 70.0);

    look_at_repeated(led, there);
    const double share = h / scenario_.scene.settings.supervision.following_memory;
    const double allowed = 1e-3 + 14e-3 * std::abs(velocity) + 0.05 * std::abs(commanded_);
    if (!led) offset_ = error;  // at rest, of a sensor
    const double moved = error - offset_;
    errors_ = led ? errors_ + share * (moved * moved - errors_) : 0.0;
    allowed_ = led ? allowed_ + share * (allowed * allowed - allowed_) : 1e-6;
    beyond_ = errors_ > 4.0 * allowed_ ? beyond_ + 1 : 0;
    if (beyond_ > 50 && !blind) violate("a stuck drive [m²]", errors_, 4.0 * allowed_);
  }

  void look_at_repeated(bool led, double there) {
    for (const auto& fault : scenario_.channels) {
      const auto channel = model::channel_at(fault.channel);
      using rig_under_test::Channel;
      const bool positional = channel == Channel::x_act || channel == Channel::z_r || channel == Channel::F;
      const auto also = [&](const auto& f) { return f.channel == fault.channel; };
      const bool alone = std::count_if(scenario_.channels.begin(), scenario_.channels.end(), also) == 1;
      if (fault.kind != hal::simulated::ChannelFault::Kind::repeat || !positional || !alone) continue;
      const bool repeats = led && fault.window.contains(now());
      if (!repeats) repeated_ = 0;
      if (!repeats) continue;
      if (repeated_ == 0) lowest_ = highest_ = there;
      ++repeated_;
      lowest_ = std::min(lowest_, there);
      highest_ = std::max(highest_, there);
      if (repeated_ > 220 && highest_ - lowest_ > 2.5e-3)
        violate("a sensor repeats itself [periods]", repeated_, 220.0);
    }
  }

  hal::Time asked_at_ = hal::never;
  hal::Time pressed_at_ = hal::never;
  double place_;  ///< of the drive, after the period before [m]
  bool had_power_ = false;
  hal::Time stopped_again_at_ = hal::never;
  bool rest_asked_ = false;  ///< and not an arming
  bool armed_ = false;       ///< an arming has passed, ever
  bool proven_ = false;      ///< and nothing since that takes one
  Mode mode_ = Mode::idle;   ///< after the period before
  int in_safe_ = 0;          ///< periods
  double speed_ = 0.0;       ///< of the drive [m/s]
  double least_ = 0.0;       ///< force on the way back [N]
  Mode from_ = Mode::idle;   ///< what led to safe
  int standing_ = 0;         ///< periods in safe with power and without motion
  int pushed_ = 0;
  int differs_ = 0;
  int away_ = 0;                          ///< periods away from the command
  double commanded_ = 0.0;                ///< for this instant [m]
  double errors_ = 0.0, allowed_ = 1e-6;  ///< of a stuck drive, mean squares [m²]
  double offset_ = 0.0;                   ///< error before that [m]
  int beyond_ = 0;                        ///< periods
  int repeated_ = 0;                      ///< periods
  double lowest_ = 0.0, highest_ = 0.0;   ///< of the drive meanwhile [m]
  int above_ = 0;                         ///< periods beyond the limit of force
  int met_ = 0;                           ///< … beyond that of a slow motion
  int grown_ = 0;                         ///< … and growing on the way back
  double reached_ = 0.0;                  ///< [N]
  std::vector<Must> musts_;
};

}  // namespace faults
