#include "firmware/controller/run.hpp"

#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "firmware/controller/cache_warmup.hpp"
#include "firmware/controller/devices.hpp"
#include "firmware/controller/emergency.hpp"
#include "firmware/controller/heap_seal.hpp"
#include "firmware/controller/real_time.hpp"
#include "firmware/controller/recorder.hpp"
#include "firmware/controller/spans.hpp"
#include "firmware/controller/wake_lead.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/input_error.hpp"
#include "firmware/description/version.hpp"
#include "firmware/loop/control_loop.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/recording/run_columns.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "hal/linux/clock.hpp"
#include "hal/linux/gpio.hpp"
#include "hal/linux/iio.hpp"

namespace firmware::controller {
namespace {

constexpr std::size_t journal_records = 8192;  // eight seconds at 1 kHz: a disk may be slow for that long
constexpr std::size_t write_records = 512;     // at most so many between two writes, however fast they come

/// Why the program itself, not the firmware, ends a run.
enum class Cause : int { none, signal, disk, heap };

void print(const Spans& spans, double allowed_delay) {
  const std::string lines =
      line("wake-up latency", spans.wake_up) + line("step time", spans.step) + line("sample age", spans.age);
  std::fputs(lines.c_str(), stdout);
  const double delay = static_cast<double>(spans.age.quantile(0.999) + spans.step.quantile(0.999)) * 1e-9;
  if (allowed_delay > 0.0 && delay > allowed_delay) {
    std::printf("NOTE: samples and computation take %.3f ms (P99.9), stability leaves %.3f ms: this loop may grow\n",
                delay * 1e3, allowed_delay * 1e3);
  }
  std::fflush(stdout);
}

/// Signs of life to systemd, if it asked for them.
void notify(const char* state) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (path == nullptr || std::strlen(path) >= sizeof address.sun_path) return;
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return;
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, path);
  if (path[0] == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  static_cast<void>(::sendto(socket, state, std::strlen(state), 0, reinterpret_cast<const sockaddr*>(&address), size) <
                    0);
  ::close(socket);
}

/// Reads the journal in a thread of its own: recording, signals, watchdog.
class Scribe {
 public:
  Scribe(ControlLoop& loop, Journal& journal, Recorder& recorder, Spans& spans, double allowed_delay)
      : loop_(loop), journal_(journal), recorder_(recorder), spans_(spans), allowed_delay_(allowed_delay) {
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, 512 * 1024);  // locked, hence small
    const int error = ::pthread_create(
        &thread_, &attributes,
        [](void* self) -> void* {
          static_cast<Scribe*>(self)->write();
          return nullptr;
        },
        this);
    model::require(error == 0, "a thread for the recording");
    ::pthread_attr_destroy(&attributes);
  }
  Scribe(const Scribe&) = delete;
  Scribe& operator=(const Scribe&) = delete;
  ~Scribe() { finish(); }

  void finish() {
    if (finished_) return;
    finished_ = true;
    end_.store(true);
    ::pthread_join(thread_, nullptr);
  }

  [[nodiscard]] Cause cause() const { return cause_.load(); }
  [[nodiscard]] std::uint64_t taken() const { return taken_.load(std::memory_order_relaxed); }  ///< records so far
  void blame(Cause cause) {
    Cause none = Cause::none;
    cause_.compare_exchange_strong(none, cause);
    loop_.stop();
  }

 private:
  void write() {
    hal::linux::MonotonicClock clock;
    hal::Time synced = clock.now();
    for (bool last = false; !last;) {
      const bool end = end_.load();
      std::size_t taken = 0;
      for (; taken < write_records; ++taken) {
        const auto record = journal_.pop();
        if (!record) break;
        taken_.fetch_add(1, std::memory_order_relaxed);
        spans_.age.add((record->time - oldest_sample(*record)).ns);
        recorder_.take(*record);
      }
      if (taken > 0) notify("WATCHDOG=1");
      const bool more = taken == write_records;
      last = end && !more;
      bool written = recorder_.flush();
      if (written && (last || clock.now() - synced >= hal::milliseconds(500))) {
        written = recorder_.sync();
        synced = clock.now();
      }
      if (!written) blame(Cause::disk);
      if (!last) await_signal(more ? 0 : 10'000'000);
    }
  }

  void await_signal(long nanoseconds) {
    sigset_t awaited;
    ::sigemptyset(&awaited);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) ::sigaddset(&awaited, signal);
    const timespec pause{0, nanoseconds};
    const int signal = ::sigtimedwait(&awaited, nullptr, &pause);
    if (signal == SIGUSR1) print(spans_, allowed_delay_);
    if (signal == SIGTERM || signal == SIGINT || signal == SIGHUP) blame(Cause::signal);
  }

  ControlLoop& loop_;
  Journal& journal_;
  Recorder& recorder_;
  Spans& spans_;
  double allowed_delay_;
  std::atomic<bool> end_{false};
  std::atomic<std::uint64_t> taken_{0};
  std::atomic<Cause> cause_{Cause::none};
  bool finished_ = false;
  pthread_t thread_{};
};

std::string words(const Trip& trip) {
  std::string text(name(trip.reason));
  if (trip.channel) text += " of " + std::string(model::name(*trip.channel));
  if (!is_fault(trip.reason)) return text;
  char numbers[96];
  std::snprintf(numbers, sizeof numbers, " (%.4g, limit %.4g)", trip.value, trip.limit);
  return text + numbers;
}

/// Converters have been filling their queues since they were opened: the old samples out, new ones under way.
void drain(const hal::Rig& roles, hal::Time period) {
  for (int i = 0; i < 8; ++i) {
    static_cast<void>(roles.sensors.read());
    roles.clock.sleep_until(roles.clock.now() + period);
  }
}

/// Sleeps until a moment before a period is due, warms the caches over and over while there is time, and waits for
/// its instant without sleeping. How late the sleep ended.
hal::Time wake_before(hal::Time due, WakeLead& wake, hal::Clock& machine, CacheWarmup& warmup) {
  const hal::Time wanted = due - wake.early();
  machine.sleep_until(wanted);
  const hal::Time woken = machine.now();
  wake.use([&] { return due - machine.now(); }, [&] { warmup.step(); });
  while (machine.now() < due) {
  }
  return woken - wanted;
}

FootPointMotion motion_of(const Options& options, const RigDescription& rig, std::size_t rows) {
  const std::size_t samples = samples_of(options.duration, rig.sample_rate);
  const RoadChoice road{options.road, options.speed, options.seed, options.bandwidth, options.cut_off};
  auto motion =
      excitation(rig.rig, motion_over(road, rig, rows > 0 ? rows : samples, read_csv_recording), rig.sample_rate);
  if (rows > 0 && rig.rig.kind != model::RigKind::hil && !motion.empty() && motion.front().position != 0.0) {
    throw UsageError("--replay of a road that begins elsewhere than at 0: its recording lacks the way there");
  }
  return motion;
}

Status drive(const Options& options, const RigDescription& rig, Devices& devices, Verdict& verdict) {
  const Settings settings = control_settings(rig);
  const hal::Rig opened = devices.roles();
  RememberedCommand command(opened.command);
  const hal::Rig roles{opened.clock,       opened.sensors,   opened.valves,       command,
                       opened.stop_button, opened.heartbeat, opened.drive_enable, opened.interlocks};
  const ValvePlan valves = valve_plan(rig);
  if (const auto wrong = ControlLoop::check(settings, rig.rig, roles, valves); !wrong.empty()) {
    std::fprintf(stderr, "rig_controller: %s: %s\n", rig.source.c_str(), std::string(wrong).c_str());
    return Status::unfit_input;
  }
  const FootPointMotion motion = motion_of(options, rig, devices.rows());
  TableReference reference(motion);
  std::vector<Record> storage(journal_records);
  Journal journal(storage);
  const auto loop = std::make_unique<ControlLoop>(settings, rig.rig, roles, reference, valves, journal);
  const auto spans = std::make_unique<Spans>();
  const bool asked = options.realtime && !options.virtual_time;
  WakeLead wake(hal::seconds(std::min(rig.hardware.schedule.wake_early, 0.25 * rig.period())));
  const auto warmup = asked && wake.early() > hal::Time{}
                          ? std::make_unique<CacheWarmup>(*loop, journal, settings, rig.rig, roles.sensors.setup())
                          : nullptr;

  hal::linux::MonotonicClock machine;
  EmergencyReturn emergency_return(roles, command, machine, settings.ramps, 0.5 * settings.limits.stroke, rig.period());
  std::atomic<bool> at_rest{false};
  const auto stop = [](void* running) { static_cast<ControlLoop*>(running)->stop(); };
  ::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is a disk that is full
  catch_traps({&emergency_return, &command, &at_rest, stop, loop.get(), rig.period()});
  const ForgetTraps until_the_end;

  // Rights before anything moves. The recording's thread is made in between: it shall have the locked memory, not the
  // priority.
  sigset_t ours;
  ::sigemptyset(&ours);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) ::sigaddset(&ours, signal);
  ::pthread_sigmask(SIG_BLOCK, &ours, nullptr);
  if (asked) lock_memory(verdict);
  look_at_machine(verdict, rig.hardware.schedule.cpu);
  Verdict rights = verdict;
  if (asked) schedule_loop(rights, rig.hardware.schedule.priority, rig.hardware.schedule.cpu);
  std::fputs(asked ? rights.text().c_str() : "real time: NOT ASKED FOR (--no-realtime, --virtual-time, --replay)\n",
             stdout);
  std::fputs(devices.text().c_str(), stdout);
  std::fflush(stdout);
  if (asked && !rights.granted()) {
    std::fputs("rig_controller: refused: no real-time rights; grant what is MISSING above, or say --no-realtime\n",
               stderr);
    return Status::refused;
  }

  std::string trouble;
  Recorder recorder(
      options.out, rig, roles.sensors.setup(),
      {"rig_controller " + std::string(version) + ": " + std::string(model::name(rig.rig.kind)) + ", " + options.road +
           ", seed " + std::to_string(options.seed) + (options.simulated ? ", SIMULATED RIG" : "") +
           (options.replay.empty() ? "" : ", REPLAY of " + one_line(options.replay)),
       asked ? "real time: " + rights.summary() : "NOT REAL TIME: run without real-time scheduling"},
      trouble);
  if (!trouble.empty()) {
    std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
    return Status::cannot_write;
  }
  // Threads inherit their maker's scheduling: the recording's gets the ordinary one.
  const sched_param ordinary{};
  if (asked) ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  Scribe scribe(*loop, journal, recorder, *spans, rig.hardware.schedule.allowed_delay);
  if (asked) {
    sched_param parameters{};
    parameters.sched_priority = rig.hardware.schedule.priority;
    ::sched_setscheduler(0, SCHED_FIFO, &parameters);
  }
  notify("READY=1");
  std::printf("running: %s\n", options.out.c_str());
  std::fflush(stdout);

  const double longest_return = 3.0 * rig.controller.stroke / rig.controller.ramp + 2.0;
  hal::Time safe_since = hal::never;
  std::uint64_t periods = 0;
  if (!options.simulated && options.replay.empty()) drain(roles, settings.period);
  seal_heap(true);
  loop->arm();
  loop->start();
  for (;;) {
    const hal::Time due = loop->due();
    hal::Time woken{}, seen{};
    if (warmup && periods > 0) {
      spans->wake_up.add(wake_before(due, wake, machine, *warmup).ns);
      seen = roles.clock.now();
      woken = machine.now();
    } else {
      roles.clock.sleep_until(due);
      woken = machine.now();
      seen = roles.clock.now();
      spans->wake_up.add((seen - due).ns);
    }
    loop->step();
    if (broken_seals() > 0 && scribe.cause() == Cause::none) scribe.blame(Cause::heap);
    const hal::Time done = machine.now();
    spans->step.add((done - woken).ns);
    ++periods;
    while (options.virtual_time && !trapped() && periods - scribe.taken() > journal_records / 2)
      ::usleep(1000);  // nobody is in a hurry
    if (loop->mode() != Mode::safe) continue;
    if (safe_since == hal::never) safe_since = seen;
    if (loop->at_rest() || (seen - safe_since).seconds() > longest_return) break;
  }
  at_rest.store(loop->at_rest());
  seal_heap(false);
  if (asked) ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  notify("STOPPING=1");
  scribe.finish();

  print(*spans, rig.hardware.schedule.allowed_delay);
  const Counters& c = loop->counters();
  unsigned long long lost = recorder.lost();
  lost += journal.lost();
  std::printf(
      "  late periods %llu, bridged samples %llu, missed frames %llu, limited commands %llu, rows %llu, lost %llu\n",
      static_cast<unsigned long long>(c.late_periods), static_cast<unsigned long long>(c.bridged_samples),
      static_cast<unsigned long long>(c.missed_frames), static_cast<unsigned long long>(c.limited_commands),
      static_cast<unsigned long long>(recorder.rows()), lost);
  std::fputs(devices.warnings().c_str(), stdout);
  std::fflush(stdout);

  std::string why = words(loop->trip());
  Status status = is_fault(loop->trip().reason) ? Status::safe_stop : Status::done;
  if (loop->trip().reason == Reason::stop_requested) {
    if (scribe.cause() == Cause::signal) why = "a signal to stop";
    if (scribe.cause() == Cause::heap) {
      why = "heap taken in the loop, " + std::to_string(broken_seals()) + " times";
      status = Status::internal;
    }
  }
  if (recorder.error() != 0 && status == Status::done) {  // the last rows may fail when the loop has ended
    why = "the recording cannot be written: " + std::string(std::strerror(recorder.error()));
    status = Status::cannot_write;
  }
  if (!options.histogram.empty()) {
    try {
      write_file(options.histogram, as_cyclictest(*spans));
    } catch (const OutputError& error) {
      std::fprintf(stderr, "rig_controller: %s\n", error.what());
      if (status == Status::done) status = Status::cannot_write;
    }
  }
  std::printf("rig_controller: ended by %s; valves safe, command %s, %llu rows in %s\n", why.c_str(),
              loop->at_rest() ? "at rest" : "NOT AT REST", static_cast<unsigned long long>(recorder.rows()),
              options.out.c_str());
  return status;
}

Status check(const RigDescription& rig, Devices& devices, Verdict& verdict) {
  const hal::Rig roles = devices.roles();
  const ValvePlan valves = valve_plan(rig);
  const auto wrong = ControlLoop::check(control_settings(rig), rig.rig, roles, valves);
  lock_memory(verdict);
  look_at_machine(verdict, rig.hardware.schedule.cpu);
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
  const bool ready = sensors && verdict.granted();
  std::printf("rig_controller: %s\n", ready ? "everything but motion is in order" : "NOT READY: see above");
  return ready ? Status::done : Status::refused;
}

}  // namespace

Status run(const Options& options) {
  if (options.task == Options::Task::list) {
    std::printf("%s, %s\n%s%s", hal::linux::gpio_library().c_str(), hal::linux::iio_library().c_str(),
                hal::linux::list_gpio().c_str(), hal::linux::list_iio().c_str());
    return Status::done;
  }
  const RigDescription rig = read_rig(options.rig);
  std::string trouble;
  if (!options.histogram.empty()) {  // that it cannot be written is to be known before anything moves
    static_cast<void>(OutputFile(options.histogram));
  }
  const std::unique_ptr<Devices> devices = open_devices(rig, options, trouble);
  if (!devices) {
    std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
    return Status::refused;
  }
  Verdict verdict;
  return options.task == Options::Task::check ? check(rig, *devices, verdict) : drive(options, rig, *devices, verdict);
}

}  // namespace firmware::controller
