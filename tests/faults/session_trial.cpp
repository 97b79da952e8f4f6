#include "tests/faults/session_trial.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/lead.hpp"
#include "firmware/controller/real_time/heap_seal.hpp"
#include "firmware/controller/recording/recorder.hpp"
#include "firmware/controller/session.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/simulated/rig.hpp"

namespace firmware::controller {

// The heap is watched in the program itself, where malloc is replaced.
void seal_heap(bool /*sealed*/) {}
std::uint64_t broken_seals() { return 0; }

}  // namespace firmware::controller

namespace faults {
namespace {

using firmware::Reason;
using firmware::controller::Status;
using hal::simulated::ChannelFault;
using hal::simulated::DeviceFault;

constexpr std::size_t interlocks = 2;

/// The faults of a session, drawn from a seed.
class Faults {
 public:
  /// `begins_within`: all of them [ms].
  Faults(std::uint64_t seed, const hal::SensorSetup& sensors, std::uint64_t begins_within)
      : generator_(seed), sensors_(sensors), begins_within_(begins_within) {
    const int count = static_cast<int>(whole(4));
    for (int i = 0; i < count; ++i) draw();
  }
  [[nodiscard]] hal::simulated::FaultPlan plan(std::uint64_t seed) const {
    return {.channels = channels_,
            .devices = devices_,
            .presses = presses_,
            .open_interlocks = open_interlocks_,
            .read_back_errors = read_back_errors_,
            .late_wakes = late_,
            .seed = seed,
            .stuck_enables = stuck_enables_};
  }
  [[nodiscard]] bool none() const {
    return channels_.empty() && devices_.empty() && presses_.empty() && late_.empty() && open_interlocks_.empty() &&
           read_back_errors_.empty() && stuck_enables_.empty();
  }

 private:
  std::uint64_t whole(std::uint64_t below) { return generator_() % below; }
  hal::simulated::Window window() {
    const hal::Time from = hal::milliseconds(static_cast<std::int64_t>(whole(begins_within_)));
    return {from, from + hal::milliseconds(std::array{1, 5, 50, 500, 100'000}[whole(5)])};
  }
  void draw() {
    const std::uint64_t kind = whole(8);
    if (kind < 2) {
      std::vector<std::size_t> fitted;
      for (std::size_t i = 0; i < sensors_.size(); ++i) {
        if (sensors_[i].fitted) fitted.push_back(i);
      }
      ChannelFault fault;
      fault.kind = static_cast<ChannelFault::Kind>(whole(4));
      fault.channel = fitted[whole(fitted.size())];
      fault.window = window();
      fault.delay_samples = static_cast<unsigned>(1 + whole(20));
      channels_.push_back(fault);
    } else if (kind < 4) {
      devices_.push_back({static_cast<DeviceFault::Device>(whole(6)),
                          std::array{hal::Fault::timeout, hal::Fault::disconnected, hal::Fault::refused}[whole(3)],
                          window()});
    } else if (kind < 5) {
      const hal::simulated::Window pressed = window();
      presses_.push_back({pressed, static_cast<hal::simulated::Press::Contacts>(whole(3))});
    } else if (kind == 6) {
      open_interlocks_.push_back({whole(interlocks), window()});
    } else if (kind == 7) {
      const double offset = 1e-3 * static_cast<double>(whole(61)) - 0.03;
      whole(2) == 0 ? read_back_errors_.push_back({offset, window()})
                    : stuck_enables_.push_back({whole(2) == 0, window()});
    } else {
      late_.push_back({window(), hal::microseconds(static_cast<std::int64_t>(100 + whole(20'000)))});
    }
  }

  std::mt19937_64 generator_;
  hal::SensorSetup sensors_;
  std::uint64_t begins_within_;
  std::vector<ChannelFault> channels_;
  std::vector<DeviceFault> devices_;
  std::vector<hal::simulated::Press> presses_;
  std::vector<hal::simulated::LateWake> late_;
  std::vector<hal::simulated::OpenInterlock> open_interlocks_;
  std::vector<hal::simulated::ReadBackError> read_back_errors_;
  std::vector<hal::simulated::StuckEnable> stuck_enables_;
};

class FaultyDevices final : public firmware::controller::Devices {
 public:
  FaultyDevices(const firmware::RigDescription& rig, const hal::simulated::FaultPlan& plan, std::uint64_t seed)
      : plant_(rig, seed, firmware::SimulatedRig::Noise::as_described), rig_(plant_, construction(rig), plan) {}

  [[nodiscard]] hal::Rig roles() override { return rig_.roles(); }
  [[nodiscard]] std::string text() const override { return "SIMULATED RIG with faults\n"; }

 private:
  static hal::simulated::Construction construction(const firmware::RigDescription& rig) {
    hal::simulated::Construction c = firmware::simulated_construction(rig);
    c.watchdog = hal::milliseconds(20);
    c.interlocks = interlocks;
    c.enable_feedback = true;
    return c;
  }
  firmware::SimulatedRig plant_;
  hal::simulated::Rig rig_;
};

/// Somebody who wants runs: arms, starts, holds, scales, stops, leads back and acknowledges as it comes, drawn from a
/// seed, and ends the session in the end.
class DrawnOperator final : public firmware::controller::Lead {
 public:
  explicit DrawnOperator(std::uint64_t seed) : generator_(seed) {}

  void ask(firmware::ControlLoop& loop, std::uint64_t periods) override {
    using firmware::Mode;
    const Mode mode = loop.mode();
    if (!goes_on(periods) && mode != Mode::safe) loop.end();
    if (!goes_on(periods) || generator_() % 100 != 0) return;
    const std::uint64_t drawn = generator_() % 100;
    if (mode == Mode::idle) loop.arm();
    if (mode == Mode::armed) drawn < 95 ? loop.start() : loop.disarm();
    if (mode == Mode::arming && drawn < 2) loop.stop();
    if (mode == Mode::running && drawn < 30) loop.hold();
    if (mode == Mode::running && drawn >= 90) static_cast<void>(loop.level(0.01 * static_cast<double>(drawn)));
    if (mode == Mode::holding) drawn < 60 ? loop.resume() : loop.stop();
    if (mode == Mode::safe) drawn < 50 ? loop.acknowledge() : drawn < 55 ? loop.stop() : loop.go_to_rest();
  }
  [[nodiscard]] bool goes_on(std::uint64_t periods) const override { return periods < 15'000; }

 private:
  std::mt19937_64 generator_;
};

/// A stream of the program goes nowhere for as long as this lives.
class Silence {
 public:
  Silence(std::FILE* stream, int descriptor) : stream_(stream), descriptor_(descriptor) {
    std::fflush(stream_);
    before_ = ::dup(descriptor_);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (before_ < 0 || nowhere < 0 || ::dup2(nowhere, descriptor_) < 0) throw std::runtime_error("no /dev/null");
    ::close(nowhere);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() {
    std::fflush(stream_);
    ::dup2(before_, descriptor_);
    ::close(before_);
  }

 private:
  std::FILE* stream_;
  int descriptor_;
  int before_ = -1;
};

std::string last_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line, last;
  while (std::getline(stream, line)) last = line;
  return last;
}

/// What a recording's part says of its runs.
struct Part {
  std::string defect;          ///< the first; empty: none
  Reason last = Reason::none;  ///< of the last row
  bool tripped = false;        ///< a row has a fault's reason
  bool failed = false;         ///< … but that of an arming while the rig still swings from the run before
};

Part look_at(const std::filesystem::path& file, double period) {
  Part part;
  const firmware::AsRecorded recorded = firmware::read_csv_as_recorded(file, {});
  const std::vector<double>& time = recorded.recording.time;
  if (time.empty() || recorded.reason.size() != time.size()) {
    part.defect = "no rows";
    return part;
  }
  const auto mode_of = [&](std::size_t k) { return static_cast<firmware::Mode>(static_cast<int>(recorded.mode[k])); };
  for (std::size_t k = 0; k < time.size(); ++k) {
    const auto now = static_cast<Reason>(static_cast<int>(recorded.reason[k]));
    using firmware::Mode;
    const double step = k > 0 ? time[k] - time[k - 1] : period;
    const bool even = std::abs(step - period) < 1e-9, late = std::abs(step - period - recorded.late[k]) < 1e-9;
    // Behind idle, and behind a second of standing in safe, which have no rows; an arming that was stopped and acknowledged
    // in the next period has idle alone between it and the one that follows.
    const bool again = part.last != Reason::none && k > 0 && mode_of(k - 1) == Mode::arming;
    const bool begins = k > 0 && ((mode_of(k) == Mode::arming && (mode_of(k - 1) != Mode::arming || again)) ||
                                  (mode_of(k - 1) == Mode::safe && mode_of(k) != Mode::safe));
    const bool waited = k > 0 && (mode_of(k - 1) == Mode::safe || mode_of(k - 1) == Mode::armed) && !even && !late;
    const bool anew = begins || waited;
    if (part.last != Reason::none && now != part.last && !anew) part.defect = "the first reason is not kept on record";
    part.last = now;
    part.tripped = part.tripped || is_fault(now);
    part.failed = part.failed || (is_fault(now) && now != Reason::arming_not_at_rest);
    if (anew) continue;
    if (!even && !late) part.defect = "rows are missing at " + std::to_string(time[k]) + " s";
    if (!part.defect.empty()) return part;
  }
  return part;
}

/// The first defect of what a session left, and its parts' words together.
/// `asked`: the session was ended by its operator, who may have done so in idle, which has no rows.
Part look_at_all(const std::filesystem::path& file, double period, bool asked) {
  Part whole;
  std::filesystem::path last = file;
  for (std::uint64_t number = 1;; ++number) {
    const std::filesystem::path name = firmware::controller::part_name(file.string(), number);
    if (!std::filesystem::exists(name)) break;
    const Part part = look_at(name, period);
    if (whole.defect.empty() && !part.defect.empty()) whole.defect = part.defect + ", " + name.filename().string();
    whole.last = part.last;
    whole.tripped = whole.tripped || part.tripped;
    whole.failed = whole.failed || part.failed;
    last = name;
  }
  if (whole.defect.empty() && whole.last == Reason::none && !asked) whole.defect = "the last row has no reason";
  const std::string expected = "# ended by " + std::string(name(whole.last));
  const std::string line = last_line(last);
  const bool said = line.starts_with(expected) || (asked && line.starts_with("# ended by stop_requested"));
  if (whole.defect.empty() && !said) {
    whole.defect = "the last line is '" + line + "', the last row says " + std::string(name(whole.last));
  }
  return whole;
}

void remove_parts(const std::filesystem::path& file) {
  for (std::uint64_t number = 1; std::filesystem::remove(firmware::controller::part_name(file.string(), number));)
    ++number;
}

firmware::controller::Options options_of_session(std::uint64_t seed, const std::filesystem::path& file) {
  firmware::controller::Options options;
  options.simulated = options.virtual_time = options.overwrite = true;
  options.realtime = false;
  options.road = session_road;
  options.duration = session_length;
  options.seed = seed;
  options.out = file.string();
  return options;
}

/// The same with an operator and all checks of arming.
Status record_operated_session(const firmware::RigDescription& rig, const hal::simulated::FaultPlan& plan,
                               std::uint64_t seed, const std::filesystem::path& file) {
  const firmware::controller::Options options = options_of_session(seed, file);
  FaultyDevices devices(rig, plan, seed);
  const Silence output(stdout, STDOUT_FILENO), errors(stderr, STDERR_FILENO);
  firmware::controller::Verdict verdict;
  firmware::controller::Session session(options, rig, devices, verdict, std::make_unique<DrawnOperator>(seed), true);
  return session.run();
}

}  // namespace

Status record_session(const firmware::RigDescription& rig, const hal::simulated::FaultPlan& plan, std::uint64_t seed,
                      const std::filesystem::path& file) {
  const firmware::controller::Options options = options_of_session(seed, file);
  FaultyDevices devices(rig, plan, seed);
  const Silence output(stdout, STDOUT_FILENO);
  firmware::controller::Verdict verdict;
  firmware::controller::Session session(options, rig, devices, verdict);
  return session.run();
}

SessionEnd play_session(std::uint64_t seed, bool operated) {
  static const std::array rigs{firmware::read_rig("host_sim/rigs/paper_hil_fdva.toml"),
                               firmware::read_rig("host_sim/rigs/paper_rig_fdva.toml"),
                               firmware::read_rig("host_sim/rigs/paper_bench_fdva.toml")};
  const firmware::RigDescription& rig = rigs[seed % rigs.size()];
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("rigtwin_faults_" + std::to_string(::getpid()) + ".csv");
  const Faults faults(seed, firmware::simulated_sensors(rig), operated ? 14'000 : 2500);
  const Status status = operated ? record_operated_session(rig, faults.plan(seed), seed, file)
                                 : record_session(rig, faults.plan(seed), seed, file);
  const Part left = look_at_all(file, rig.period(), operated);
  remove_parts(file);
  SessionEnd end{left.last, left.defect};
  const Status expected = left.tripped ? Status::safe_stop : Status::done;
  if (end.violated.empty() && status != expected) {
    end.violated = "status " + std::to_string(static_cast<int>(status)) + " after " + std::string(name(end.reason));
  }
  const bool orderly = operated ? !left.failed : end.reason == Reason::reference_ended;
  if (end.violated.empty() && faults.none() && !orderly) {
    end.violated = "ended by " + std::string(name(end.reason)) + " without a fault";
  }
  return end;
}

}  // namespace faults
