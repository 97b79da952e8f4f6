#include "firmware/controller/run.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/real_time/delay_check.hpp"
#include "firmware/controller/real_time/real_time.hpp"
#include "firmware/controller/recording/output_claim.hpp"
#include "firmware/controller/session.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/loop_proof.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/wide_limits.hpp"
#include "firmware/loop/control_loop.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/simulation/run_objection.hpp"
#include "hal/linux/clock.hpp"
#include "hal/linux/gpio.hpp"
#include "hal/linux/iio.hpp"

namespace firmware::controller {
namespace {

/// Presses that nobody has tried are not there. Waits for a press and its release, and shows when each contact opened.
bool press_stop(const hal::Rig& roles, const Devices& devices) {
  constexpr hal::Time patience = hal::milliseconds(30'000);
  if (devices.stop_contacts().empty()) return true;  // a waiver says why
  if (::isatty(STDIN_FILENO) == 0) {
    std::fputs("  stop button: NOT PRESSED, there is no terminal to ask for it\n", stdout);
    return false;
  }
  std::fputs("  stop button: press it now, and release it (30 s)\n", stdout);
  std::fflush(stdout);
  hal::linux::MonotonicClock clock;
  const hal::Time asked = clock.now();
  bool pressed = false, released = false;
  while (clock.now() - asked < patience && !released) {
    clock.sleep_until(clock.now() + hal::milliseconds(5));
    roles.stop_button.release();
    const hal::Result<bool> now = roles.stop_button.pressed();
    if (!now) {
      std::fputs("  stop button: CANNOT BE READ, or its contacts contradict each other\n", stdout);
      return false;
    }
    released = pressed && !*now;
    pressed = pressed || *now;
  }
  bool all = true;
  for (const auto& [line, opened] : devices.stop_contacts()) {
    const bool seen = opened != hal::never && opened >= asked;
    all = all && seen;
    if (seen) {
      std::printf("  stop button: contact '%s' opened after %.3f s\n", line.c_str(), (opened - asked).seconds());
    } else {
      std::printf("  stop button: contact '%s' DID NOT OPEN\n", line.c_str());
    }
  }
  if (pressed && !released) std::fputs("  stop button: NOT RELEASED\n", stdout);
  return all && released;
}

/// Every interlock closed, now.
bool interlocks_closed(const hal::Rig& roles, const RigDescription& rig) {
  static_cast<void>(!roles.interlocks.open());  // what opened before does not count
  const hal::Result<std::uint32_t> open = roles.interlocks.open();
  if (!open) std::fputs("  interlocks: CANNOT BE READ\n", stdout);
  if (!open || !rig.hardware.gpio) return static_cast<bool>(open);
  const auto& interlocks = rig.hardware.gpio->interlocks;
  for (std::size_t i = 0; i < interlocks.size(); ++i) {
    std::printf("  interlock %s: %s\n", interlocks[i].name.c_str(), (*open >> i & 1U) != 0 ? "OPEN" : "closed");
  }
  return (*open & ~arming_settings(rig).hold_to_run) == 0;
}

Status check(const RigDescription& rig, Devices& devices, Verdict& verdict) {
  const hal::Rig roles = devices.roles();
  const ValvePlan valves = valve_plan(rig);
  Settings settings = control_settings(rig);
  settings.arming = arming_settings(rig);
  const auto wrong = ControlLoop::check(settings, rig.rig, roles, valves);
  lock_memory(verdict);
  look_at_machine(verdict, rig.hardware.schedule.cpu);
  look_at_settings(verdict, rig.hardware.schedule.cpu, rig.hardware.schedule.priority);
  schedule_loop(verdict, rig.hardware.schedule.priority, rig.hardware.schedule.cpu);
  std::fputs(verdict.text().c_str(), stdout);
  std::fputs(devices.text().c_str(), stdout);
  hal::linux::MonotonicClock().sleep_until(hal::linux::MonotonicClock().now() + hal::milliseconds(200));
  drain(roles, hal::seconds(rig.period()));
  const auto frame = roles.sensors.read();
  bool sensors = static_cast<bool>(frame);
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!roles.sensors.fitted(i)) continue;
    const bool good = frame && frame->channels[i].quality == hal::Quality::good;
    sensors = sensors && good;
    std::printf("  %-6s %s", std::string(model::channel_names[i].name).c_str(), good ? "" : "NO GOOD SAMPLE\n");
    if (good) {
      std::printf("%.6g %s, %.3f ms old\n", frame->channels[i].value, std::string(model::channel_names[i].unit).c_str(),
                  (roles.clock.now() - frame->channels[i].taken).seconds() * 1e3);
    }
  }
  std::fputs(devices.warnings().c_str(), stdout);
  std::printf("limits: stroke %.4g m, speed %.4g m/s, force %.4g N, ramp %.4g m/s\n", rig.controller.stroke,
              rig.controller.speed, rig.controller.force, rig.controller.ramp);
  if (!wrong.empty()) {
    std::fprintf(stderr, "rig_controller: %s: %s\n", rig.source.c_str(), std::string(wrong).c_str());
    return Status::unfit_input;
  }
  const MotionObjection late =
      delay_objection(rig, measured_sample_age(roles, roles.clock.now(), settings.period).seconds());
  if (!late.empty()) std::printf("  delay: %s\n", late.text.c_str());
  const bool closed = interlocks_closed(roles, rig);
  const bool stops = press_stop(roles, devices);
  const bool ready = sensors && late.empty() && closed && stops && verdict.granted();
  std::printf("rig_controller: %s\n", ready ? "everything but motion is in order" : "NOT READY: see above");
  return ready ? Status::done : Status::refused;
}

/// A drop-in for rig_controller@.service. WatchdogSec is not below 2 s: the supervisor tells systemd 100 times a second
/// that the loop makes periods, so twenty periods and 2 s are a hang, no slow disk.
void print_unit_times(const RigDescription& rig) {
  const auto whole_seconds = [](double time) { return static_cast<unsigned long>(std::ceil(time)); };
  const unsigned long stop = whole_seconds(longest_stop(rig));
  std::printf(
      "# Written by rig_controller --unit-times for %s: stroke %.4g m, ramp %.4g m/s, %.4g Hz.\n[Service]\n"
      "WatchdogSec=%lu\nTimeoutStopSec=%lu\nTimeoutAbortSec=%lu\n",
      one_line(rig.source).c_str(), rig.controller.stroke, rig.controller.ramp, rig.sample_rate,
      whole_seconds(std::max(2.0, 20.0 * rig.period())), stop, stop);
}

/// The objection to motion that follows from the description alone, before any device is opened. A compensation must be
/// proven for a simulated rig too: its run would end by a trip. A description without
/// lines is no one for devices: open_devices() says so.
void refuse_unfit(const RigDescription& rig, bool devices) {
  MotionObjection objection = limits_objection(rig);
  const bool may_be_unstable = devices || rig.compensation.has_value();
  if (objection.empty() && may_be_unstable) objection = stability_objection(rig);
  if (objection.empty() && devices) objection = following_objection(rig);
  if (objection.empty() && devices) objection = wide_objection(rig);
  if (objection.empty()) return;
  throw InputError(rig.source, rig.line_of(objection.key), objection.text, "a description that a rig may run by");
}

/// That an output cannot be written, or is read by the run, is to be known before anything moves. The recorder looks at
/// the recording when it opens it.
std::string refuse_outputs(const Options& options, const RigDescription& rig) {
  if (options.part_minutes > 0.0 && options.task == Options::Task::run &&
      options.part_minutes * 60.0 * rig.sample_rate < 2.0) {
    throw UsageError("--part-minutes " + shortest(options.part_minutes) +
                     " does not fit, expected at least two periods of this rig, " + shortest(rig.period() / 30.0));
  }
  if (options.histogram.empty()) return {};
  if (std::string trouble = output_objection(options.histogram, options.overwrite, files_read(options, rig));
      !trouble.empty()) {
    return trouble;
  }
  if (leads_to_one_of(options.histogram, {options.out})) return "--histogram and --out lead to one file, expected two";
  if (is_name_of_part(options.histogram, options.out)) {
    return options.histogram + ": is the name of a part of --out " + options.out + ", expected another name";
  }
  static_cast<void>(OutputFile(options.histogram));
  return {};
}

}  // namespace

Status run(const Options& options) {
  if (options.task == Options::Task::list) {
    std::printf("%s, %s\n%s%s", hal::linux::gpio_library().c_str(), hal::linux::iio_library().c_str(),
                hal::linux::list_gpio().c_str(), hal::linux::list_iio().c_str());
    return Status::done;
  }
  const RigDescription rig = read_rig(options.rig);
  if (rig.rig.kind == model::RigKind::driven_mass) {
    throw InputError(rig.source, rig.line_of("driven_by"), "the controller commands a motion, not a force",
                     "a rig whose machine is moved: a component_bench without driven_by = \"force\"");
  }
  if (options.task == Options::Task::unit_times) {
    print_unit_times(rig);
    return Status::done;
  }
  if (options.replay.empty()) refuse_unfit(rig, !options.simulated && rig.hardware.gpio);
  std::string trouble = refuse_outputs(options, rig);
  if (!trouble.empty()) {
    std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
    return Status::cannot_write;
  }
  const std::unique_ptr<Devices> devices = open_devices(rig, options, trouble);
  if (!devices) {
    std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
    return Status::refused;
  }
  Verdict verdict;
  return options.task == Options::Task::check ? check(rig, *devices, verdict)
                                              : Session(options, rig, *devices, verdict).run();
}

}  // namespace firmware::controller
