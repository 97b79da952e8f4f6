// Random faults in random states, and what must hold whatever they are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace faults {

using firmware::Mode;
using firmware::Reason;
using rig_under_test::h;
using rig_under_test::Journey;
using rig_under_test::Scene;

/// What an operator asks for at a period.
struct Request {
  enum class What : unsigned char { arm, disarm, start, hold, resume, level, stop, rest, acknowledge };
  What what = What::arm;
  int period = 0;
  double level = 1.0;
};

/// A rig, what goes wrong with it, and what its operator does; all of it follows from a seed.
struct Scenario {
  explicit Scenario(std::uint64_t seed) : generator(seed), scene(draw_scene()) {
    scene.settings.ramps.rate = 0.2;  // a return takes 1 s, not 4
    const double rest = real(-0.02, 0.02);
    // hil: the force is tared at rest, where the component carries nothing.
    if (scene.parameters.kind != model::RigKind::hil) scene.settings.ramps.rest = rest;
    scene.settings.arming.tare_time = 0.02;
    scene.settings.arming.preload = 2000.0;
    scene.settings.arming.position_tolerance = 0.005;
    scene.settings.arming.force_ramp = 0.0;
    scene.reference = rig_under_test::road(scene.reference.size(), real(0.2, 2.0));
    scene.drive_enable = whole(4) != 0;
    const int count = whole(10) == 0 ? 0 : 1 + whole(3);
    for (int i = 0; i < count; ++i) draw_fault();
    draw_requests();
    if (whole(2) == 0) scene.settings.arming.force_ramp = 0.1;
    scene.faults = {channels, devices, presses, {}, {}, late, seed};
  }
  Scenario(const Scenario&) = delete;
  Scenario& operator=(const Scenario&) = delete;

  [[nodiscard]] bool faultless() const {
    return channels.empty() && devices.empty() && presses.empty() && late.empty();
  }
  /// Nothing that is injected reaches the motion: neither samples, nor commands, nor time.
  [[nodiscard]] bool moves_as_described() const {
    using Device = hal::simulated::DeviceFault::Device;
    return channels.empty() && late.empty() && !fails(Device::sensors) && !fails(Device::command);
  }
  /// What goes wrong, in one line.
  [[nodiscard]] std::string text() const {
    std::string line = std::string(name(scene.parameters.kind)) + (scene.drive_enable ? "" : ", no enable");
    char words[160];
    for (const auto& f : channels) {
      std::snprintf(words, sizeof words, "; %s fault %d %.3f-%.3f s",
                    std::string(model::name(model::channel_at(f.channel))).c_str(), static_cast<int>(f.kind),
                    f.window.from.seconds(), f.window.until.seconds());
      line += words;
    }
    for (const auto& f : devices) {
      std::snprintf(words, sizeof words, "; device %d fault %d %.3f-%.3f s", static_cast<int>(f.device),
                    static_cast<int>(f.fault), f.window.from.seconds(), f.window.until.seconds());
      line += words;
    }
    for (const auto& p : presses) {
      std::snprintf(words, sizeof words, "; press %.3f-%.3f s", p.window.from.seconds(), p.window.until.seconds());
      line += words;
    }
    for (const auto& l : late) {
      std::snprintf(words, sizeof words, "; late by %.4f %.3f-%.3f s", l.by.seconds(), l.window.from.seconds(),
                    l.window.until.seconds());
      line += words;
    }
    return line;
  }
  /// The only sensor of the position says something wrong that looks right. Where the drive then stands when power
  /// comes nobody can know.
  [[nodiscard]] bool position_lies() const {
    const auto position =
        model::index(scene.parameters.kind == model::RigKind::quarter_car ? rig_under_test::Channel::z_r
                                                                          : rig_under_test::Channel::x_act);
    return std::any_of(channels.begin(), channels.end(), [&](const auto& fault) { return fault.channel == position; });
  }
  [[nodiscard]] bool fails(hal::simulated::DeviceFault::Device device) const {
    return std::any_of(devices.begin(), devices.end(), [&](const auto& fault) { return fault.device == device; });
  }

  std::mt19937_64 generator;
  Scene scene;
  std::vector<hal::simulated::ChannelFault> channels;
  std::vector<hal::simulated::DeviceFault> devices;
  std::vector<hal::simulated::Press> presses;
  std::vector<hal::simulated::LateWake> late;
  std::vector<Request> requests;

  static constexpr int periods = 6000;

 private:
  // The distributions of the standard library differ between libraries; these do not.
  int whole(int below) { return static_cast<int>(generator() % static_cast<std::uint64_t>(below)); }
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(generator() >> 11U) / 9007199254740992.0;
  }
  // One draw a statement: compilers evaluate the arguments of a call in orders of their own.
  Scene draw_scene() {
    const auto periods_of_road = static_cast<std::size_t>(800 + whole(1200));
    const auto kind = std::array{model::RigKind::hil, model::RigKind::quarter_car,
                                 model::RigKind::component_bench}[static_cast<std::size_t>(whole(3))];
    return Scene(kind, periods_of_road);
  }
  hal::simulated::Window draw_window() {
    const hal::Time from = hal::milliseconds(whole(3500));
    const int length = std::array{1, 2, 5, 50, 500, 100'000}[static_cast<std::size_t>(whole(6))];
    return {from, from + hal::milliseconds(length)};
  }
  void draw_fault() {
    using hal::simulated::ChannelFault;
    using Device = hal::simulated::DeviceFault::Device;
    const int kind = whole(8);
    if (kind < 3) {
      std::vector<std::size_t> fitted;
      for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
        if (scene.sensors[i].fitted) fitted.push_back(i);
      }
      ChannelFault fault;
      fault.kind = static_cast<ChannelFault::Kind>(whole(6));
      fault.channel = fitted[static_cast<std::size_t>(whole(static_cast<int>(fitted.size())))];
      fault.window = draw_window();
      fault.delay_samples = static_cast<unsigned>(1 + whole(20));
      fault.spike = real(-1.0, 1.0) * scene.sensors[fault.channel].highest;
      fault.probability = real(0.1, 1.0);
      channels.push_back(fault);
    } else if (kind < 5) {
      devices.push_back({static_cast<Device>(whole(6)),
                         std::array{hal::Fault::timeout, hal::Fault::disconnected,
                                    hal::Fault::refused}[static_cast<std::size_t>(whole(3))],
                         draw_window()});
    } else if (kind < 7) {
      presses.push_back({draw_window()});
    } else {
      late.push_back({draw_window(), hal::microseconds(100 + whole(20'000))});
    }
  }
  void draw_requests() {
    using What = Request::What;
    for (int period = whole(200); period < periods; period += 100 + whole(1500)) {
      const int what = whole(10);
      requests.push_back({what < 9 ? static_cast<What>(what) : What::acknowledge, period, real(0.0, 1.5)});
      // Somebody who wants a run arms and starts.
      if (what > 4) continue;
      requests.push_back({What::arm, period + 1});
      requests.push_back({What::start, period + 60});
    }
    std::stable_sort(requests.begin(), requests.end(),
                     [](const Request& a, const Request& b) { return a.period < b.period; });
  }
};

/// A scenario, played in virtual time with the invariants checked in every period. What was violated first; empty:
/// none.
class Trial {
 public:
  explicit Trial(std::uint64_t seed) : scenario_(seed), journey_(scenario_.scene), loop_(journey_.loop) {}

  [[nodiscard]] std::string play() {
    std::size_t next = 0;
    before_ = journey_.rig.drive().position;
    for (int k = 0; k < Scenario::periods && violated_.empty(); ++k) {
      for (; next < scenario_.requests.size() && scenario_.requests[next].period <= k; ++next) {
        ask(scenario_.requests[next]);
      }
      const Mode mode = loop_.mode();
      const Reason reason = loop_.trip().reason;
      journey_.rig.roles().clock.sleep_until(loop_.due());
      look_at_motion();
      loop_.step();
      now_ = journey_.rig.now();
      look_at_state(mode, reason);
      look_at_recording();
    }
    return violated_.empty() ? violated_ : violated_ + " [" + scenario_.text() + "]";
  }

  [[nodiscard]] Reason reason() const { return loop_.trip().reason; }
  [[nodiscard]] bool has_run() const { return has_run_; }

 private:
  // A drive at the speed limit of 0.7 m/s stops within 35 ms at 20 m/s², and the longest time without a period is 20
  // ms.
  static constexpr double braking_time = 0.035 + 2.0 * 0.020 + 0.005;                            // [s]
  static constexpr double reach = rig_under_test::half_stroke + 0.7 * 0.7 / 40.0 + 0.7 * 0.020;  // [m]

  void ask(const Request& request) {
    using What = Request::What;
    asked_ = request.what == What::acknowledge || request.what == What::rest || request.what == What::arm;
    if (request.what == What::arm) loop_.arm();
    if (request.what == What::disarm) loop_.disarm();
    if (request.what == What::start) loop_.start();
    if (request.what == What::hold) loop_.hold();
    if (request.what == What::resume) loop_.resume();
    if (request.what == What::level) static_cast<void>(loop_.level(request.level));
    if (request.what == What::stop) loop_.stop();
    if (request.what == What::rest) {
      loop_.go_to_rest();
      after_press_ = 0.0;
    }
    if (request.what == What::acknowledge) loop_.acknowledge();
  }

  void violate(const char* what, double value, double limit) {
    if (!violated_.empty()) return;
    char text[200];
    std::snprintf(text, sizeof text, "%s: %.6g, limit %.6g, at %.3f s in %s after %s", what, value, limit,
                  journey_.rig.now().seconds(), std::string(name(loop_.mode())).c_str(),
                  std::string(name(loop_.trip().reason)).c_str());
    violated_ = text;
  }

  /// As the program wants it, unless the watchdog has taken it.
  [[nodiscard]] bool power() const { return journey_.rig.enabled() && !journey_.rig.watchdog_has_acted(); }

  /// The drive itself, whatever the program says.
  void look_at_motion() {
    const double position = journey_.rig.drive().position;
    const double moved = std::abs(position - before_);
    const double time = (journey_.rig.now() - now_).seconds();
    before_ = position;
    if (std::abs(position) > reach) violate("beyond stroke and braking distance [m]", std::abs(position), reach);
    const double most = 1.02 * 0.7 * (time + h);
    if (moved > most && !(power() && !had_power_ && scenario_.position_lies())) violate("a jump [m]", moved, most);
    had_power_ = power();
    // A beat since the last look gave power meanwhile, if the program wants it.
    const bool powered = journey_.rig.enabled() && journey_.rig.beats() != beats_;
    beats_ = journey_.rig.beats();
    if (scenario_.scene.drive_enable && !had_power_ && !powered) {
      without_power_ = moved > 1e-12 ? without_power_ + time : 0.0;
      if (without_power_ > braking_time) violate("motion without power [s]", without_power_, braking_time);
    } else {
      without_power_ = 0.0;
    }
    const bool pressed = loop_.mode() == Mode::safe && is_stop(loop_.trip().reason) && loop_.held();
    after_press_ = pressed ? after_press_ + time : 0.0;
    if (after_press_ > braking_time && moved > 1e-12) violate("motion after a press [s]", after_press_, braking_time);
    if (after_press_ > braking_time && scenario_.scene.drive_enable && had_power_) {
      violate("power after a press [s]", after_press_, braking_time);
    }
  }

  void look_at_state(Mode before, Reason reason) {
    has_run_ = has_run_ || loop_.mode() == Mode::running;
    const bool safe = loop_.mode() == Mode::safe;
    if (safe && loop_.trip().reason == Reason::none) violate("safe without a reason", 0.0, 0.0);
    if (safe && before == Mode::safe && loop_.trip().reason != reason) violate("the first reason is lost", 0.0, 0.0);
    const Reason now = loop_.trip().reason;
    if (scenario_.faultless() && is_fault(now)) violate("a fault where there is none", 0.0, 0.0);
    const bool by_motion = now == Reason::speed || now == Reason::acceleration || now == Reason::stroke ||
                           now == Reason::energy || now == Reason::growth || now == Reason::following_error ||
                           now == Reason::measured_speed || now == Reason::measured_stroke || now == Reason::force;
    if (scenario_.moves_as_described() && by_motion) violate("motion is blamed without a fault", 0.0, 0.0);
    // Braking, and twice the whole stroke at 0.2 m/s.
    constexpr double longest = 0.1 + 2.0 * 0.25 / 0.2;
    const double moved = std::abs(journey_.rig.drive().position - stood_);
    stood_ = journey_.rig.drive().position;
    if (!safe || before != Mode::safe || asked_) safe_time_ = 0.0;
    asked_ = false;
    safe_time_ += h;
    if (safe && safe_time_ > longest && moved > 1e-9) violate("not at rest in its time [s]", safe_time_, longest);
    using Device = hal::simulated::DeviceFault::Device;
    if (safe && !scenario_.fails(Device::valves) && journey_.rig.openings() != scenario_.scene.safe_position) {
      violate("valves not safe", 0.0, 0.0);
    }
  }

  void look_at_recording() {
    while (const auto record = journey_.journal.pop()) {
      if (record->period != recorded_) violate("a period is not on record", static_cast<double>(record->period), 0.0);
      recorded_ = record->period + 1;
      last_ = record->trip.reason;
    }
    if (journey_.journal.lost() > 0) violate("records are lost", 1.0, 0.0);
    if (last_ != loop_.trip().reason) violate("the reason is not on record", 0.0, 0.0);
  }

  Scenario scenario_;
  Journey journey_;
  firmware::ControlLoop& loop_;
  std::string violated_;
  hal::Time now_{};
  double before_ = 0.0;  ///< position of the drive [m]
  double stood_ = 0.0;   ///< the same after the period before [m]
  std::uint64_t beats_ = 0;
  bool had_power_ = false;
  bool has_run_ = false;
  bool asked_ = false;
  double without_power_ = 0.0;  ///< moving for so long [s]
  double after_press_ = 0.0;    ///< [s]
  double safe_time_ = 0.0;      ///< [s]
  std::uint64_t recorded_ = 0;
  Reason last_ = Reason::none;
};

}  // namespace faults
