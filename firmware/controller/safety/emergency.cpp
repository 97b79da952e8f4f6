#include "firmware/controller/safety/emergency.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "firmware/controller/safety/systemd_notify.hpp"
#include "firmware/loop/reference/ramp.hpp"
#include "hal/linux/clock.hpp"

namespace firmware::controller {
namespace {
constexpr double keep_alive_every = 0.2;  // [s] between two messages to systemd, whose watchdog has 2 s or more
}

hal::Result<void> RememberedCommand::do_write(const hal::Command& command) {
  const hal::Result<void> written = output_.write(command);
  if (written) {
    position_.store(command.position);
    velocity_.store(command.velocity);
    moved_.store(true);
  }
  return written;
}

EmergencyReturn::EmergencyReturn(const hal::Rig& rig, RememberedCommand& command, hal::Clock& clock, const Ramps& ramps,
                                 double half_stroke, double period, std::uint32_t hold_to_run)
    : rig_(rig),
      command_(command),
      clock_(clock),
      ramps_(ramps),
      half_stroke_(half_stroke),
      period_(period),
      hold_to_run_(hold_to_run) {}

void EmergencyReturn::make_valves_safe() {
  if (rig_.high_pressure != nullptr) static_cast<void>(!rig_.high_pressure->write(false));
  static_cast<void>(!rig_.valves.write(rig_.valves.safe_position()));
}

void EmergencyReturn::take_power() { static_cast<void>(!rig_.drive_enable.write(false)); }

bool EmergencyReturn::stopped_by_hand() {
  const hal::Result<bool> pressed = rig_.stop_button.pressed();
  const hal::Result<std::uint32_t> open = rig_.interlocks.open();
  return !pressed || *pressed || !open || (*open & ~hold_to_run_) != 0;
}

int EmergencyReturn::periods_at_most() const {
  return static_cast<int>(std::ceil((2.0 * 1.5 * half_stroke_ / ramps_.rate + 1.0) / period_));
}

EmergencyReturn::End EmergencyReturn::go() {
  make_valves_safe();
  if (!command_.moved()) {
    take_power();
    return End::at_rest;
  }
  ReturnToRest way(command_.position(), command_.velocity(), ramps_, half_stroke_, period_);
  const hal::Time period = hal::seconds(period_);
  hal::Time due = clock_.now();
  int failed = 0;
  const int keep_alive = static_cast<int>(std::ceil(keep_alive_every / period_));
  End end = End::at_rest;
  for (int left = periods_at_most(); !way.arrived(); --left) {
    if (left == 0) {
      end = End::not_in_time;
      break;
    }
    due += period;
    clock_.sleep_until(due);
    if (left % keep_alive == 0) notify("WATCHDOG=1");
    if (end != End::held && stopped_by_hand()) {
      take_power();
      way = ReturnToRest::brake_and_hold(command_.position(), command_.velocity(), ramps_, half_stroke_, period_);
      end = End::held;
    }
    const hal::Result<void> written = command_.write(way.next());
    failed = written ? 0 : failed + 1;
    if (failed > 0 && (written.fault() != hal::Fault::timeout || failed == 3)) {
      end = End::command_lost;
      break;
    }
  }
  take_power();
  make_valves_safe();  // another thread may have been in the middle of a write
  return end;
}

namespace {

Emergency emergency;
pthread_t loop_thread;
pthread_t returning_thread;  // valid while returning
std::atomic<bool> armed{false};
std::atomic<bool> returning{false};
std::atomic<bool> trapped_elsewhere{false};

void say(const char* words) { static_cast<void>(!::write(STDERR_FILENO, words, std::strlen(words))); }

/// A length in µm, without the C library's printing.
void say_micrometres(double metres) {
  char digits[24];
  char* at = digits + sizeof digits;
  *--at = '\0';
  auto left = static_cast<unsigned long>(std::lround(std::abs(metres) * 1e6));
  const bool minus = metres < 0.0 && left > 0;
  do {
    *--at = static_cast<char>('0' + left % 10);
    left /= 10;
  } while (left > 0);
  if (minus) *--at = '-';
  say(at);
  say(" um");
}

/// The loop goes on in its own thread: it is asked to stop, and has the time that an emergency return may take.
EmergencyReturn::End wait_for_the_loop() {
  trapped_elsewhere.store(true);
  emergency.stop(emergency.loop);
  hal::linux::MonotonicClock clock;
  const hal::Time period = hal::seconds(emergency.period);
  const auto keep_alive = static_cast<int>(std::ceil(keep_alive_every / emergency.period));
  for (int left = emergency.emergency_return->periods_at_most(); !emergency.at_rest->load(); --left) {
    if (left == 0) return EmergencyReturn::End::not_in_time;
    if (left % keep_alive == 0) notify("WATCHDOG=1");
    clock.sleep_until(clock.now() + period);
  }
  return EmergencyReturn::End::at_rest;
}

/// The recording's thread gets a moment for its last rows; what hangs is ended.
void bound(double seconds) {
  sigset_t alarm;
  ::sigemptyset(&alarm);
  ::sigaddset(&alarm, SIGALRM);
  ::signal(SIGALRM, SIG_DFL);
  ::pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
  ::alarm(static_cast<unsigned>(seconds) + 2U);
}

void tell_end(EmergencyReturn::End end, double from) {
  say("rig_controller: ended by a trap of the program; valves safe, command ");
  if (end == EmergencyReturn::End::at_rest) {
    say("at rest, from ");
    say_micrometres(from);
  } else if (end == EmergencyReturn::End::held) {
    say("held where it was stopped, at ");
    say_micrometres(emergency.command->position());
  } else {
    say("NOT AT REST");
  }
  say(", no heartbeat\n");
}

void return_to_rest(bool in_the_loop) {
  returning_thread = ::pthread_self();
  returning.store(true);
  const double from = emergency.command->position();
  emergency.emergency_return->make_valves_safe();
  const double longest = emergency.period * emergency.emergency_return->periods_at_most();
  extend_timeout(longest + 2.0);
  bound(longest);
  const EmergencyReturn::End end = in_the_loop ? emergency.emergency_return->go() : wait_for_the_loop();
  hal::linux::MonotonicClock clock;
  clock.sleep_until(clock.now() + hal::milliseconds(100));
  tell_end(end, from);
}

void die_of(int signal) {
  sigset_t own;
  ::sigemptyset(&own);
  ::sigaddset(&own, signal);
  ::signal(signal, SIG_DFL);
  ::pthread_sigmask(SIG_UNBLOCK, &own, nullptr);
  ::raise(signal);
}

/// Sent by another process, e.g. by systemd's watchdog; not a fault of the thread that it interrupts.
bool sent_from_outside(const siginfo_t& info) { return info.si_code <= 0 && info.si_pid != ::getpid(); }

void on_trap(int signal, siginfo_t* info, void*) {
  const bool in_the_loop = ::pthread_equal(::pthread_self(), loop_thread) != 0;
  if (armed.exchange(false)) {
    return_to_rest(in_the_loop);
  } else if (returning.load()) {
    if (sent_from_outside(*info)) return;  // an abort waits until the command is at rest
    if (::pthread_equal(::pthread_self(), returning_thread) == 0) {
      // The thread that returns the command to rest ends the program. If it waits for the loop and the loop has trapped
      // as well, the loop's thread returns the command itself.
      if (in_the_loop) {
        const EmergencyReturn::End end = emergency.emergency_return->go();
        if (end == EmergencyReturn::End::at_rest) emergency.at_rest->store(true);
      }
      for (;;) ::pause();
    }
  } else {
    say("rig_controller: ended by a trap of the program outside a run\n");
  }
  die_of(signal);
}

}  // namespace

void catch_traps(const Emergency& given) {
  emergency = given;
  loop_thread = ::pthread_self();
  armed.store(true);
  struct sigaction action {};
  action.sa_sigaction = on_trap;
  action.sa_flags = SA_ONSTACK | SA_SIGINFO;
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGSYS, SIGTRAP}) {
    ::sigaction(signal, &action, nullptr);
  }
}

bool emergency_under_way() { return returning.load(); }

void forget_traps() { armed.store(false); }

bool trapped() { return trapped_elsewhere.load(); }

}  // namespace firmware::controller
