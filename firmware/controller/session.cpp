#include "firmware/controller/session.hpp"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "firmware/controller/instance.hpp"
#include "firmware/controller/real_time/delay_check.hpp"
#include "firmware/controller/real_time/heap_seal.hpp"
#include "firmware/controller/recording/output_claim.hpp"
#include "firmware/controller/recording/trip_text.hpp"
#include "firmware/controller/safety/systemd_notify.hpp"
#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/loop_proof.hpp"
#include "firmware/description/semi_active_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/internet_address.hpp"
#include "firmware/description/version.hpp"
#include "firmware/recording/output_file.hpp"

namespace firmware::controller {
namespace {

constexpr std::size_t journal_records = 8192;  // eight seconds at 1 kHz: a disk may be slow for that long

// After the run the disk gets this long for the last rows. systemd waits 60 s (TimeoutStopSec).
constexpr hal::Time disk_patience = hal::milliseconds(5000);

/// The roles with a command output that remembers.
hal::Rig remembering(const hal::Rig& opened, RememberedCommand& command) {
  return {opened.clock,     opened.sensors,      opened.valves,     command,     opened.stop_button,
          opened.heartbeat, opened.drive_enable, opened.interlocks, opened.area, opened.high_pressure};
}

Settings fitting_settings(const RigDescription& rig, const hal::Rig& roles, bool looks) {
  Settings settings = control_settings(rig);
  if (looks) settings.arming = arming_settings(rig);
  if (const auto wrong = ControlLoop::check(settings, rig.rig, roles, valve_plan(rig)); !wrong.empty()) {
    throw InputError(rig.source, 0, "the description does not fit the devices", wrong);
  }
  return settings;
}

}  // namespace

void drain(const hal::Rig& roles, hal::Time period) {
  for (int i = 0; i < 8; ++i) {
    static_cast<void>(roles.sensors.read());
    roles.clock.sleep_until(roles.clock.now() + period);
  }
}

std::uint64_t rows_per_part(double minutes, double sample_rate) {
  const double rows = minutes * 60.0 * sample_rate;
  constexpr double endless = 1e15;  // thirty thousand years at 1 kHz
  return rows < endless ? static_cast<std::uint64_t>(rows) : 0;
}

double longest_return(const RigDescription& rig) { return 3.0 * rig.controller.stroke / rig.controller.ramp + 2.0; }

double longest_stop(const RigDescription& rig) { return longest_return(rig) + 2.0 * disk_patience.seconds(); }

Session::Session(const Options& options, const RigDescription& rig, Devices& devices, Verdict& verdict)
    : Session(options, rig, devices, verdict, lead_of(options, devices.replayed()),
              !options.simulated && options.replay.empty()) {}

Session::Session(const Options& options, const RigDescription& rig, Devices& devices, Verdict& verdict,
                 std::unique_ptr<Lead> lead, bool looks)
    : options_(options),
      rig_(rig),
      devices_(devices),
      verdict_(verdict),
      realtime_(options.realtime && !options.virtual_time),
      operated_(is_operated(options)),
      lead_(std::move(lead)),
      settings_(fitting_settings(rig, devices.roles(), looks)),
      instance_(new_instance(rig)),
      opened_(devices.roles()),
      command_(opened_.command),
      roles_(remembering(opened_, command_)),
      valves_(valve_plan(rig)),
      road_(options, rig, devices.replayed(), operated_ || !options.socket.empty()),
      storage_(journal_records),
      journal_(storage_),
      companion_(companion(rig)),
      compensation_(compensation_of(rig)),
      compensation_of_warmup_(compensation_of(rig)),
      loop_(settings_, rig.rig, roles_, road_.reference(), valves_, journal_),
      spans_(std::make_unique<Spans>()),
      wake_(hal::seconds(std::min(rig.hardware.schedule.wake_early, 0.25 * rig.period()))),
      emergency_return_(roles_, command_, machine_, settings_.ramps, 0.5 * settings_.limits.stroke, rig.period(),
                        settings_.arming.hold_to_run),
      longest_return_(longest_return(rig)) {
  if (companion_) loop_.attach(*companion_);
  if (compensation_) loop_.attach(*compensation_);
  if (realtime_ && wake_.early() > hal::Time{}) {
    warmup_ = std::make_unique<CacheWarmup>(loop_, journal_, settings_, rig.rig, roles_.sensors.setup());
    if (compensation_of_warmup_) warmup_->attach(*compensation_of_warmup_);
  }
}

Status Session::run() {
  const auto stop = [](void* loop) { static_cast<ControlLoop*>(loop)->end(); };
  open_notify_socket();
  block_signals();
  catch_traps({&emergency_return_, &command_, &at_rest_, stop, &loop_, rig_.period()});
  const ForgetTraps until_the_end;
  const cpu_set_t others = cpus_without(rig_.hardware.schedule.cpu);
  if (!acquire_rights()) return Status::refused;
  if (!options_.simulated && options_.replay.empty()) {
    find_phase();
    if (!keeps_allowed_delay()) return Status::unfit_input;
  }
  // What may be refused comes before the recording: a run that is refused empties no earlier one.
  if (!open_socket() || !open_datagrams()) return Status::refused;
  if (!open_recording()) return Status::cannot_write;
  if (datagrams_) publish_to(others);
  recording_ =
      std::make_unique<RecordingThread>(others, journal_, *recorder_, *spans_, rig_.hardware.schedule.allowed_delay,
                                        tap_.get(), [this] { return refusals_text(loop_.refusals(), rig_); });
  socket_ = std::make_unique<ControlSocket>(
      ControlSocket::Parts{loop_, *recording_, progress_, road_.highest_level(), publisher_.get(), instance_,
                           [this] { return refusals_text(loop_.refusals(), rig_); },
                           [this] { return refusals_text(loop_.rest_refusals(), rig_); }},
      listening_);
  supervisor_ = std::make_unique<Supervisor>(
      others, Supervisor::Parts{loop_, journal_, *recording_, progress_, *socket_, longest_return_});
  if (road_.highest_level() < ReferencePlayer::highest_level) {
    std::printf("level: at most %.4g, beyond it the run does not fit the limits\n", road_.highest_level());
  }
  notify("READY=1");
  std::printf(operated_ ? "waiting for the operator; recording: %s\n" : "running: %s\n", options_.out.c_str());
  std::fflush(stdout);
  drive();
  return finish();
}

/// Before anything moves.
bool Session::acquire_rights() {
  const ScheduleDescription& schedule = rig_.hardware.schedule;
  if (realtime_) lock_memory(verdict_);
  look_at_machine(verdict_, schedule.cpu);
  look_at_settings(verdict_, schedule.cpu, schedule.priority);
  if (realtime_) schedule_loop(verdict_, schedule.priority, schedule.cpu);
  std::fputs(
      realtime_ ? verdict_.text().c_str() : "real time: NOT ASKED FOR (--no-realtime, --virtual-time, --replay)\n",
      stdout);
  std::fputs(devices_.text().c_str(), stdout);
  std::fflush(stdout);
  rights_ = realtime_ ? "real time: " + verdict_.summary() : "NOT REAL TIME: run without real-time scheduling";
  if (!realtime_ || verdict_.granted()) return true;
  std::fputs("rig_controller: refused: no real-time rights; grant what is MISSING above, or say --no-realtime\n",
             stderr);
  return false;
}

/// On devices: when periods begin, against the trigger of the converters.
void Session::find_phase() {
  const auto& converters = rig_.hardware.converters;
  if (!converters || converters->inputs.empty()) return;
  std::vector<std::size_t> channels;
  for (const auto& input : converters->inputs) channels.push_back(input.channel);
  const double age = converters->sample_age > 0.0 ? converters->sample_age : usual_share_of_period * rig_.period();
  phase_ = measured_phase(roles_.clock, roles_.sensors, channels, settings_.period, hal::seconds(age));
  if (phase_) {
    std::printf("phase: a period begins %.3f ms after its samples\n", age * 1e3);
  } else {
    std::fputs(
        "phase: NOT KEPT: the converters do not sample at the rate of the loop, samples are up to a period old\n",
        stdout);
  }
}

/// hil on devices: sample age and computation as they are now, against what stability leaves.
bool Session::keeps_allowed_delay() {
  if (rig_.rig.kind != model::RigKind::hil) return true;
  const hal::Time now = roles_.clock.now();
  hal::Time delay = measured_sample_age(roles_, phase_ ? phase_->next(now) : now, settings_.period);
  if (warmup_) delay = delay + measured_computation([this] { warmup_->step(); }, machine_);
  const MotionObjection objection = delay_objection(rig_, delay.seconds());
  if (objection.empty()) return true;
  std::fprintf(stderr, "rig_controller: %s: %s\n", place(rig_, objection).c_str(), objection.text.c_str());
  return false;
}

bool Session::open_recording() {
  std::string trouble;
  Recorder::Setup setup;
  setup.file = options_.out;
  setup.comments = {"rig_controller " + std::string(version) + ": " + std::string(model::name(rig_.rig.kind)) + ", " +
                        road_.text() + (options_.simulated ? ", SIMULATED RIG" : "") +
                        (options_.replay.empty() ? "" : ", REPLAY of " + one_line(options_.replay)),
                    rights_, "instance " + instance_};
  for (const auto& [name, sentence] : rig_.waivers) setup.comments.push_back("WAIVER " + name + ": " + sentence);
  setup.overwrite = options_.overwrite;
  setup.inputs = inputs_ = files_read(options_, rig_);
  setup.several_runs = lead_->goes_on(0);
  setup.rows_per_part = rows_per_part(options_.part_minutes, rig_.sample_rate);
  setup.cycle_samples = road_.cycle_samples();
  setup.programme = options_.programme;
  if (const ProgrammeReference* programme = road_.programme(); programme != nullptr) {
    setup.place = [programme](std::uint64_t sample) { return programme->place(sample); };
  }
  recorder_ = std::make_unique<Recorder>(setup, rig_, roles_.sensors.setup(), trouble);
  if (trouble.empty()) return true;
  std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
  return false;
}

bool Session::open_datagrams() {
  if (options_.publish.empty()) return true;
  std::string trouble;
  datagrams_ = std::make_unique<DatagramSocket>(parse_host_port("--publish", options_.publish), trouble);
  if (trouble.empty()) return true;
  std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
  return false;
}

void Session::publish_to(const cpu_set_t& cpus) {
  tap_ = std::make_unique<LiveTap>(options_.publish_every);
  writer_ = std::make_unique<DatagramWriter>(rig_, roles_.sensors.setup(), options_.simulated, tap_->every(), *spans_,
                                             instance_);
  writer_->describe_run(std::filesystem::path(options_.out).filename().string(),
                        options_.duration * static_cast<double>(options_.cycles));
  writer_->describe_refusals([this] { return refusals_text(loop_.refusals(), rig_); });
  publisher_ = std::make_unique<Publisher>(cpus, *tap_, *writer_, *datagrams_, rig_.sample_rate);
  std::printf("publishing to %s, one period of %llu, as %s\n", options_.publish.c_str(),
              static_cast<unsigned long long>(tap_->every()), instance_.c_str());
}

bool Session::open_socket() {
  if (!operated_ && options_.socket.empty()) return true;
  const std::string trouble = listening_.listen(socket_path(options_.socket, rig_.hardware.schedule.socket));
  if (trouble.empty()) return true;
  std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
  return false;
}

void Session::drive() {
  if (!options_.simulated && options_.replay.empty()) drain(roles_, settings_.period);
  // Two periods ahead, for what comes before the first.
  if (phase_) loop_.begin_at(phase_->next(roles_.clock.now() + settings_.period * 2));
  seal_heap(true);
  for (;;) {
    const hal::Time seen = await_period();
    lead_->ask(loop_, progress_.periods.load(std::memory_order_relaxed));
    loop_.step();
    if (broken_seals() > 0) supervisor_->end_run(Cause::heap);
    spans_->step.add((machine_.now() - woken_).ns);
    publish();
    if (options_.virtual_time) wait_for_recording();
    if (is_over(seen)) break;
  }
  at_rest_.store(loop_.at_rest());
  seal_heap(false);
}

void Session::publish() {
  if (!first_fault_ && is_fault(loop_.trip().reason)) first_fault_ = loop_.trip();
  progress_.mode.store(loop_.mode(), std::memory_order_relaxed);
  progress_.reason.store(loop_.trip().reason, std::memory_order_relaxed);
  progress_.second.store(loop_.second().reason, std::memory_order_relaxed);
  progress_.enabled.store(loop_.enabled(), std::memory_order_relaxed);
  progress_.at_rest.store(loop_.at_rest(), std::memory_order_relaxed);
  progress_.held.store(loop_.held(), std::memory_order_relaxed);
  progress_.proven.store(loop_.proven(), std::memory_order_relaxed);
  progress_.position.store(loop_.command().position, std::memory_order_relaxed);
  progress_.periods.fetch_add(1, std::memory_order_release);
}

/// The rig is safe and at rest, or has had its time; with an operator: and somebody or something ends the program.
bool Session::is_over(hal::Time seen) {
  if (loop_.mode() != Mode::safe) {
    safe_since_ = hal::never;
    return false;
  }
  const ReplayedRun* replayed = devices_.replayed();
  const std::uint64_t periods = progress_.periods.load(std::memory_order_relaxed);
  if (replayed != nullptr) return periods >= replayed->rows;  // what was recorded, and no more
  if (safe_since_ == hal::never) safe_since_ = seen;
  if (lead_->goes_on(periods) && supervisor_->cause() == Cause::none && !trapped()) return false;
  return loop_.at_rest() || (seen - safe_since_).seconds() > longest_return_;
}

/// Sleeps until the period is due. With warm-up: sleeps until a moment before, warms the caches over and over while
/// there is time, and waits for the instant without sleeping. The rig's time then.
hal::Time Session::await_period() {
  const hal::Time due = loop_.due();
  hal::Time seen{};
  if (warmup_ && progress_.periods.load(std::memory_order_relaxed) > 0) {
    const hal::Time wanted = due - wake_.early();
    machine_.sleep_until(wanted);
    spans_->wake_up.add((machine_.now() - wanted).ns);
    wake_.use([&] { return due - machine_.now(); }, [&] { warmup_->step(); });
    while (machine_.now() < due) {
    }
    seen = roles_.clock.now();
    woken_ = machine_.now();
  } else {
    roles_.clock.sleep_until(due);
    woken_ = machine_.now();
    seen = roles_.clock.now();
    spans_->wake_up.add((seen - due).ns);
  }
  return seen;
}

/// In virtual time nobody is in a hurry: the loop waits for the disk, unless the run is to end.
void Session::wait_for_recording() const {
  while (!trapped() && supervisor_->cause() == Cause::none &&
         progress_.periods.load(std::memory_order_relaxed) - recording_->taken() > journal_records / 2) {
    ::usleep(1000);
  }
}

Status Session::finish() {
  const sched_param ordinary{};
  if (realtime_) ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  notify("STOPPING=1");
  extend_timeout(disk_patience.seconds() + 2.0);
  const bool written = recording_->finish(disk_patience);
  supervisor_->finish();
  if (publisher_) publisher_->finish();
  print(*spans_, rig_.hardware.schedule.allowed_delay);
  print_counters();

  std::string why;
  Status status = verdict_of_run(why);
  if (!written && status == Status::done) {
    why = "the disk stalls: the end of the recording is not written";
    status = Status::cannot_write;
  }
  if (!write_histogram() && status == Status::done) status = Status::cannot_write;
  if (written) recorder_->end(why);
  if (publisher_) publisher_->say_end(why);
  std::printf("rig_controller: ended by %s; valves safe, command %s, %llu rows in %s\n", why.c_str(),
              devices_.replayed() != nullptr ? "as recorded"
              : !loop_.at_rest()             ? "NOT AT REST"
              : loop_.held()                 ? "held where it stopped"
                                             : "at rest",
              static_cast<unsigned long long>(recorder_->rows()), options_.out.c_str());
  if (!written) {  // the recording's thread cannot be joined
    std::fflush(stdout);
    ::_exit(static_cast<int>(status));
  }
  return status;
}

/// A file that has come under this name since the start stays.
bool Session::write_histogram() const {
  if (options_.histogram.empty()) return true;
  std::string trouble = output_objection(options_.histogram, options_.overwrite, inputs_);
  try {
    if (trouble.empty()) write_file(options_.histogram, as_cyclictest(*spans_));
  } catch (const OutputError& error) {
    trouble = error.what();
  }
  if (!trouble.empty()) std::fprintf(stderr, "rig_controller: %s\n", trouble.c_str());
  return trouble.empty();
}

void Session::print_counters() const {
  const Counters& c = loop_.counters();
  std::printf(
      "  late periods %llu, bridged samples %llu, missed frames %llu, limited commands %llu, rows %llu, lost %llu\n",
      static_cast<unsigned long long>(c.late_periods), static_cast<unsigned long long>(c.bridged_samples),
      static_cast<unsigned long long>(c.missed_frames), static_cast<unsigned long long>(c.limited_commands),
      static_cast<unsigned long long>(recorder_->rows()), static_cast<unsigned long long>(lost()));
  if (publisher_) {
    std::printf("  published %llu, lost to publishing %llu\n", static_cast<unsigned long long>(publisher_->sent()),
                static_cast<unsigned long long>(publisher_->lost()));
  }
  std::fputs(devices_.warnings().c_str(), stdout);
  std::fflush(stdout);
}

Status Session::verdict_of_run(std::string& why) const {
  why = trip_text(loop_.trip(), rig_);
  if (is_fault(loop_.trip().reason)) return Status::safe_stop;
  if (loop_.trip().reason == Reason::stop_requested && supervisor_->cause() == Cause::heap) {
    why = "heap taken in the loop, " + std::to_string(broken_seals()) + " times";
    return Status::internal;
  }
  if (recorder_->error() != 0) {
    why = "the recording cannot be written: " + std::string(std::strerror(recorder_->error()));
    return Status::cannot_write;
  }
  if (lost() > 0) {
    why = std::to_string(lost()) + " lost records: the disk is too slow";
    return Status::cannot_write;
  }
  if (supervisor_->cause() == Cause::signal) why = "a signal to stop";
  if (!first_fault_) return Status::done;
  std::printf("rig_controller: an earlier run of this session ended by %s\n", trip_text(*first_fault_, rig_).c_str());
  return Status::safe_stop;
}

}  // namespace firmware::controller
