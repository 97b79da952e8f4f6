// Rigs, what goes wrong with them, and what their operators do: all of it drawn from a seed.
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

/// A rig, what goes wrong with it, and what its operator does; all of it follows from a seed. In half of the scenarios
/// several things go wrong at any time while the operator asks for anything; in the others one thing goes wrong where a
/// guard of its own should see it, and the operator wants runs (one_fault.hpp).
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
    draw_ways_to_power();
    draw_what_stands_still();
    if (whole(2) == 0) draw_one_fault();
    scene.faults.channels = channels;
    scene.faults.devices = devices;
    scene.faults.presses = presses;
    scene.faults.open_interlocks = open_interlocks;
    scene.faults.read_back_errors = read_back_errors;
    scene.faults.late_wakes = late;
    scene.faults.seed = seed;
    scene.faults.stuck_enables = stuck_enables;
    scene.faults.stuck_feedbacks = stuck_feedbacks;
    scene.faults.pushes = pushes;
    scene.faults.stuck_drives = stuck_drives;
    scene.faults.suspensions = suspensions;
  }
  Scenario(const Scenario&) = delete;
  Scenario& operator=(const Scenario&) = delete;

  [[nodiscard]] bool faultless() const {
    return channels.empty() && devices.empty() && presses.empty() && late.empty() && open_interlocks.empty() &&
           read_back_errors.empty() && stuck_drives.empty() && suspensions.empty() && !moves_by_itself() &&
           !low_limit && !torn && !wild && !offset && !deviates && !wants_stop_tests() && !off_centre();
  }
  /// Nothing that is injected reaches the motion: neither samples, nor commands, nor time.
  [[nodiscard]] bool moves_as_described() const {
    using Device = hal::simulated::DeviceFault::Device;
    return channels.empty() && late.empty() && stuck_drives.empty() && !fails(Device::sensors) &&
           !fails(Device::command) && !moves_by_itself() && !low_limit && !torn && !wild && !offset && !deviates;
  }
  /// Where an arming refuses it for its place.
  [[nodiscard]] bool off_centre() const { return scene.drive_at && !scene.settings.arming.off_centre; }
  /// The load cell does not show what it carries.
  [[nodiscard]] bool deviates_by_sensors() const {
    const auto& d = scene.deviations;
    return d.force_sign != 1.0 || d.force_offset != 0.0 || d.force_noise != 0.0;
  }
  /// Where an arming asks for a press that nobody may have made.
  [[nodiscard]] bool wants_stop_tests() const { return scene.settings.arming.stop_test > 0.0; }
  /// The drive is pushed, or its power is not what the program says.
  [[nodiscard]] bool moves_by_itself() const {
    return !pushes.empty() || !stuck_enables.empty() || !stuck_feedbacks.empty();
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
    const auto add = [&](const char* what, const auto& faults) {
      for (const auto& f : faults) {
        std::snprintf(words, sizeof words, "; %s %.3f-%.3f s", what, f.window.from.seconds(), f.window.until.seconds());
        line += words;
      }
    };
    add("interlock", open_interlocks);
    add("read-back", read_back_errors);
    add("stuck enable", stuck_enables);
    add("stuck feedback", stuck_feedbacks);
    add("push", pushes);
    add("stuck drive", stuck_drives);
    if (low_limit) line += "; low limit of force";
    if (offset) line += "; offset of the force";
    if (wild) line += "; beyond the limits";
    if (torn) line += "; F torn off";
    for (const auto& s : suspensions) {
      std::snprintf(words, sizeof words, "; suspended at %.3f s for %.3f s", s.at.seconds(), s.length.seconds());
      line += words;
    }
    if (!one.empty()) line += "; alone: " + one;
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
    return scene.deviations.position_sign != 1.0 ||
           std::any_of(channels.begin(), channels.end(), [&](const auto& fault) { return fault.channel == position; });
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
  std::vector<hal::simulated::OpenInterlock> open_interlocks;
  std::vector<hal::simulated::ReadBackError> read_back_errors;
  std::vector<hal::simulated::StuckEnable> stuck_enables;
  std::vector<hal::simulated::StuckFeedback> stuck_feedbacks;
  std::vector<hal::simulated::Push> pushes;
  std::vector<hal::simulated::StuckDrive> stuck_drives;  ///< for good: a drive that lets go would jump
  std::vector<hal::simulated::Suspension> suspensions;
  bool low_limit = false;  ///< of the force: a run may reach it
  bool offset = false;     ///< the force at rest is beyond `preload`
  bool wild = false;       ///< the reference goes beyond the limits
  bool torn = false;       ///< the load cell, at some sample
  bool filtered = false;   ///< a quarter car with a Kalman filter
  bool deviates = false;   ///< the rig is not as described: signs, gains, noise, delay, something in its way
  std::optional<hal::simulated::Window> lossy;       ///< two samples of three are missing
  std::optional<hal::simulated::Window> often_late;  ///< one period in five begins 9 ms late
  std::string one;  ///< the one thing that goes wrong, in words; empty: drawn by the others
  std::vector<Request> requests;

  static constexpr int periods = 6000;

 private:
  void draw_one_fault();  // one_fault.hpp
  void forget_faults();
  void draw_wanted_runs();
  void draw_of_arming();
  void draw_of_power();
  void draw_of_a_run();
  void draw_of_the_reference();
  void draw_of_time();

  /// A sensor that repeats itself, a drive that does not move; drawn last of all.
  void draw_what_stands_still() {
    constexpr hal::Time for_good = hal::milliseconds(1'000'000);
    if (whole(8) == 0) {
      hal::simulated::ChannelFault fault;
      fault.kind = hal::simulated::ChannelFault::Kind::repeat;
      fault.channel = draw_fitted();
      fault.window = draw_window();
      channels.push_back(fault);
    }
    if (whole(8) != 0) return;
    const hal::Time from = hal::milliseconds(whole(4500));
    stuck_drives.push_back({{from, for_good}});
  }
  std::size_t draw_fitted() {
    std::vector<std::size_t> fitted;
    for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
      if (scene.sensors[i].fitted) fitted.push_back(i);
    }
    return fitted[static_cast<std::size_t>(whole(static_cast<int>(fitted.size())))];
  }
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
      ChannelFault fault;
      fault.kind = static_cast<ChannelFault::Kind>(whole(6));
      fault.channel = draw_fitted();
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
  /// Contacts, lines and places around the drive's power; drawn last, so that what was drawn before stays.
  void draw_ways_to_power() {
    scene.enable_feedback = scene.drive_enable && whole(2) == 0;
    for (auto& press : presses) press.contacts = static_cast<hal::simulated::Press::Contacts>(whole(3));
    if (whole(5) == 0) {
      const auto interlock = static_cast<std::size_t>(whole(2));
      open_interlocks.push_back({interlock, draw_window()});
    }
    if (whole(10) == 0) {
      devices.push_back({hal::simulated::DeviceFault::Device::interlocks, hal::Fault::timeout, draw_window()});
    }
    if (whole(8) == 0) read_back_errors.push_back({real(-0.03, 0.03), {hal::milliseconds(whole(50))}});
    if (scene.drive_enable && whole(8) == 0) stuck_enables.push_back({whole(2) == 0, draw_window()});
    if (scene.enable_feedback && whole(10) == 0) stuck_feedbacks.push_back({whole(2) == 0, draw_window()});
    if (scene.drive_enable && whole(8) == 0) pushes.push_back({real(-0.1, 0.1), draw_window()});
    if (whole(3) == 0) {
      scene.drive_at = real(-0.05, 0.05);
      scene.settings.arming.off_centre = whole(3) != 0;
    }
    low_limit = whole(4) == 0;
    if (low_limit) scene.settings.limits.force = real(100.0, 1500.0);
    torn = whole(12) == 0;
    if (torn) scene.deviations.force_torn_after = static_cast<std::uint64_t>(whole(4000));
    for (auto& fault : channels) {
      if (whole(2) == 0) fault.probability = 1.0;
    }
    if (scene.drive_enable && whole(8) == 0) {
      const auto device =
          std::array{hal::simulated::DeviceFault::Device::drive_enable, hal::simulated::DeviceFault::Device::heartbeat,
                     hal::simulated::DeviceFault::Device::valves}[static_cast<std::size_t>(whole(3))];
      devices.push_back({device, hal::Fault::refused, draw_window()});
    }
    if (whole(8) == 0) late.push_back({draw_window(), hal::microseconds(300 + whole(6000))});
    if (whole(2) == 0) scene.settings.ramps.rate = 0.05;
    if (whole(3) == 0) {  // somebody asks twice
      const int period = 300 + whole(periods - 1000);
      requests.push_back({Request::What::stop, period});
      requests.push_back({whole(2) == 0 ? Request::What::stop : Request::What::acknowledge, period + 5 + whole(60)});
    }
    offset = whole(12) == 0;
    if (offset) scene.deviations.force_offset = (whole(2) == 0 ? 1.0 : -1.0) * real(3000.0, 5000.0);
    wild = whole(12) == 0;
    if (wild) scene.reference = rig_under_test::road(scene.reference.size(), real(15.0, 60.0));
    std::stable_sort(requests.begin(), requests.end(),
                     [](const Request& a, const Request& b) { return a.period < b.period; });
    if (whole(4) != 0) return;
    // With a probe: an arming takes 1.1 s and the way to rest.
    scene.settings.arming.probe_amplitude = 2e-3;
    scene.settings.arming.sway = 250.0;
    for (Request& request : requests) {
      if (request.what == Request::What::start) request.period += 1800;
    }
    std::stable_sort(requests.begin(), requests.end(),
                     [](const Request& a, const Request& b) { return a.period < b.period; });
  }
};

}  // namespace faults

#include "tests/faults/one_fault.hpp"
