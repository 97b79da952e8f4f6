// Scenarios in which one thing goes wrong while an operator wants runs. Included by scenario.hpp.
#pragma once

#include <cmath>

#include "tests/faults/scenario.hpp"

namespace faults {

/// Everything that the others have drawn, but the rig.
inline void Scenario::forget_faults() {
  channels.clear();
  devices.clear();
  presses.clear();
  late.clear();
  open_interlocks.clear();
  read_back_errors.clear();
  stuck_enables.clear();
  stuck_feedbacks.clear();
  pushes.clear();
  stuck_drives.clear();
  requests.clear();
  low_limit = torn = offset = wild = false;
  scene.deviations = {};
  scene.drive_at.reset();
  scene.settings.limits.force = firmware::Limits{}.force;
  scene.settings.arming.off_centre = false;
  scene.settings.arming.probe_amplitude = scene.settings.arming.sway = 0.0;
}

/// Arms, starts, lets it run; stops, once or twice, acknowledges, and again.
inline void Scenario::draw_wanted_runs() {
  using What = Request::What;
  scene.reference = rig_under_test::road(static_cast<std::size_t>(1500 + whole(3000)), real(0.5, 2.0));
  scene.settings.ramps.rate = whole(2) == 0 ? 0.2 : 0.05;
  if (whole(4) == 0) {
    scene.settings.arming.probe_amplitude = 2e-3;
    scene.settings.arming.sway = 250.0;
  }
  const int approach = scene.settings.arming.probe_amplitude > 0.0 ? 2000 : 60;
  int period = 50 + whole(150);
  while (period < periods) {
    requests.push_back({What::acknowledge, period});
    requests.push_back({What::arm, period + 1});
    requests.push_back({What::start, period + approach});
    const int stops = period + approach + 300 + whole(3500);
    requests.push_back({What::stop, stops});
    if (whole(2) == 0) requests.push_back({What::stop, stops + 10 + whole(40)});
    period = stops + 1500;
  }
}

inline void Scenario::draw_one_fault() {
  forget_faults();
  draw_wanted_runs();
  const int where = whole(8);
  if (where < 2) draw_of_arming();
  if (where == 2 || where == 3) draw_of_power();
  if (where == 4 || where == 5) draw_of_a_run();
  if (where == 6) draw_of_the_reference();
  if (where == 7) draw_of_time();
  std::stable_sort(requests.begin(), requests.end(),
                   [](const Request& a, const Request& b) { return a.period < b.period; });
}

/// What an arming should refuse.
inline void Scenario::draw_of_arming() {
  auto& arming = scene.settings.arming;
  const bool hil = scene.parameters.kind == model::RigKind::hil;
  const auto probes = [&] {
    if (arming.probe_amplitude > 0.0) return;
    arming.probe_amplitude = 2e-3;
    for (Request& request : requests) {
      if (request.what == Request::What::start) request.period += 1940;
    }
  };
  deviates = true;
  const int what = hil ? 1 + whole(5) : whole(3);
  if (what == 0) {
    one = "the drive wanders";
    scene.drive_enable = true;
    arming.wander = 0.5e-3;
    stuck_drives.push_back({{hal::milliseconds(whole(100)), hal::milliseconds(1'000'000)}, real(0.04, 0.1)});
  } else if (what == 1) {
    one = "the force sways";
    arming.sway = 250.0;
    scene.deviations.force_noise = real(300.0, 900.0);
  } else if (what == 2) {
    one = "sign or gain of the position";
    probes();
    scene.deviations.position_sign = std::array{-1.0, 0.3, 2.0}[static_cast<std::size_t>(whole(3))];
  } else if (what == 3) {
    one = "sign of the force";
    probes();
    scene.deviations.force_sign = std::array{-1.0, 0.0, 30.0}[static_cast<std::size_t>(whole(3))];
  } else if (what == 4) {
    one = "noise in the probe";
    probes();
    arming.sway = 0.0;
    scene.deviations.force_noise = real(400.0, 900.0);
  } else {
    one = "gain of the force";
    probes();
    arming.allowed_gain = 1.2;
    arming.probe_stiffness = scene.parameters.suspension.stiffness + scene.parameters.fdva.coupling_stiffness;
    scene.deviations.force_sign = 4.0;  // of at least the spring alone: 1.46 times that, and within a factor of 3
  }
}

/// Lines, contacts, a converter, the stop button.
inline void Scenario::draw_of_power() {
  using Device = hal::simulated::DeviceFault::Device;
  using Contacts = hal::simulated::Press::Contacts;
  constexpr hal::Time for_good = hal::milliseconds(1'000'000);
  const int what = whole(7);
  scene.drive_enable = true;
  if (what == 0) {
    one = "enable";
    devices.push_back({Device::drive_enable, hal::Fault::refused, {hal::milliseconds(whole(800)), for_good}});
  } else if (what == 1) {
    one = "second stage";
    scene.high_pressure = true;
    if (whole(2) == 0) devices.push_back({Device::high_pressure, hal::Fault::refused, {{}, for_good}});
  } else if (what == 2) {
    one = "a converter that is silent";
    devices.push_back({Device::command, hal::Fault::timeout, {{}, for_good}});
  } else if (what == 3) {
    one = "test of the stop button";
    scene.settings.arming.stop_test = real(0.5, 3.0);
    const int tested = whole(3);
    const hal::Time from = hal::milliseconds(whole(40));
    if (tested > 0)
      presses.push_back({{from, from + rig_under_test::ms * 3}, tested == 1 ? Contacts::both : Contacts::first});
  } else if (what == 4) {
    one = "hold to run";
    scene.settings.arming.hold_to_run = 1U;
    open_interlocks.push_back({0, {hal::milliseconds(whole(2500)), for_good}});
  } else if (what == 5) {
    one = "pushed behind a press";
    const hal::Time pressed = hal::milliseconds(500 + whole(1500));
    presses.push_back({{pressed, pressed + rig_under_test::ms * 3}});
    pushes.push_back({whole(2) == 0 ? -0.05 : 0.05, {pressed + hal::milliseconds(600), for_good}});
    requests.assign(1, {Request::What::stop, 10});
  } else {
    one = "two stops of a drive without an enable";
    scene.drive_enable = false;
  }
}

/// What the guards of a run look for.
inline void Scenario::draw_of_a_run() {
  constexpr hal::Time for_good = hal::milliseconds(1'000'000);
  const hal::simulated::Window window{hal::milliseconds(300 + whole(2500)), for_good};
  const bool bench = scene.parameters.kind == model::RigKind::component_bench;
  const bool hil = scene.parameters.kind == model::RigKind::hil;
  const int drawn = whole(6);  // the last one is the kind's own
  const int what = drawn < 5 || hil ? drawn : bench ? 6 : 3;
  filtered = what == 3 && !hil && !bench;
  scene.settings.supervision.following_memory = whole(2) == 0 ? 5.0 : 0.5;
  if (what == 0) {
    one = "a stuck drive";
    stuck_drives.push_back({window});
  } else if (what == 1) {
    one = "a drive that runs away";
    scene.drive_enable = true;
    stuck_drives.push_back({window, (whole(2) == 0 ? -1.0 : 1.0) * (whole(2) == 0 ? real(0.35, 0.6) : real(1.1, 1.2))});
    for (Request& request : requests) {  // half of them in a slow motion
      if (request.what == Request::What::start && whole(2) == 0) request.period = periods;
    }
  } else if (what == 2) {
    one = "a sensor that repeats itself";
    hal::simulated::ChannelFault fault;
    fault.kind = hal::simulated::ChannelFault::Kind::repeat;
    fault.channel = draw_fitted();
    fault.window = window;
    channels.push_back(fault);
  } else if (what == 3) {
    torn = true;
    const double least = filtered ? 2.0 : 1.0;
    scene.reference = rig_under_test::road(4500, real(least, least + 1.0));
    scene.deviations.force_noise = 3.0;
    scene.deviations.force_torn_after = static_cast<std::uint64_t>(300 + whole(800));
    std::erase_if(requests, [](const Request& r) { return r.what == Request::What::stop; });
  } else if (what == 4) {
    one = "a sensor that misses two samples of three";
    constexpr int often = 60;
    hal::simulated::ChannelFault fault;
    fault.kind = hal::simulated::ChannelFault::Kind::drop;
    fault.channel = draw_fitted();
    for (int i = 0; i < often; ++i) {
      const hal::Time from = window.from + hal::milliseconds(3 * i);
      fault.window = {from, from + hal::milliseconds(2)};
      channels.push_back(fault);
    }
    lossy = {window.from, window.from + hal::milliseconds(3 * often)};
  } else if (what == 5) {
    deviates = true;
    one = "a loop that drives the car";
    scene.deviations.force_sign = -1.0;
    scene.settings.arming.probe_amplitude = 0.0;
  } else {
    deviates = low_limit = true;
    one = "something in the way";
    const double side = whole(2) == 0 ? -1.0 : 1.0;
    scene.settings.ramps.rest = side * real(0.01, 0.02);
    scene.reference = rig_under_test::road(scene.reference.size(), real(0.2, 0.5));
    scene.obstacle = {side * 3e-3, 200e3, static_cast<std::uint64_t>(whole(2) == 0 ? 0 : 700)};
    scene.settings.limits.force = real(2000.0, 3000.0);
  }
}

/// What no drive can follow.
inline void Scenario::draw_of_the_reference() {
  auto& reference = scene.reference;
  const int what = whole(3);
  wild = true;
  const double speed = real(0.9, 1.4), way = real(0.06, 0.11), slope = real(0.25, 0.6), corner = real(0.3e-3, 0.6e-3);
  const auto begin = static_cast<std::size_t>(200 + whole(500));
  for (std::size_t k = 0; k < reference.size(); ++k) {
    const double t = h * static_cast<double>(k), w = 2.0 * speed / way;
    rig_under_test::Motion& m = reference[k];
    if (what == 0) {  // a sine that is too fast
      one = "a fast reference";
      m = {0.5 * way * (1.0 - std::cos(w * t)), speed * std::sin(w * t), speed * w * std::cos(w * t)};
    } else if (k >= begin && what == 1) {  // a velocity that jumps
      one = "a reference with corners";
      const bool up = (k - begin) / 150 % 2 == 0;
      const double ramp = slope * h * static_cast<double>((k - begin) % 150);
      m = {reference[begin - 1].position + (up ? ramp : slope * h * 150.0 - ramp), up ? slope : -slope, 0.0};
    } else if (k >= begin) {
      one = "a reference that rattles";
      m.position += k % 2 == 0 ? corner : 0.0;
    }
  }
}

/// Nobody watched for a while.
inline void Scenario::draw_of_time() {
  const hal::Time at = hal::milliseconds(300 + whole(2500));
  const int what = whole(3);
  if (what == 2) {
    one = "one period in five is late";
    constexpr int often = 40, apart = 13;  // [ms] 9 of a late one, and four that are punctual
    for (int i = 0; i < often; ++i) {
      const hal::Time from = at + hal::milliseconds(apart * i);
      late.push_back({{from, from + rig_under_test::ms}, hal::milliseconds(9)});
    }
    often_late = {at, at + hal::milliseconds(apart * often)};
  } else if (what == 0) {
    one = "a period that is late";
    late.push_back({{at, at + rig_under_test::ms}, hal::microseconds(13'000 + whole(7000))});
  } else {
    one = "a machine that was suspended";
    suspensions.push_back({at, hal::microseconds(13'000 + whole(1'000'000))});
  }
}

}  // namespace faults
