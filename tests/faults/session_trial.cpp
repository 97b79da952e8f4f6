#include "tests/faults/session_trial.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <vector>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/real_time/heap_seal.hpp"
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

/// The faults of a session, drawn from a seed.
class Faults {
 public:
  Faults(std::uint64_t seed, const hal::SensorSetup& sensors) : generator_(seed), sensors_(sensors) {
    const int count = static_cast<int>(whole(4));
    for (int i = 0; i < count; ++i) draw();
  }
  [[nodiscard]] hal::simulated::FaultPlan plan(std::uint64_t seed) const {
    return {channels_, devices_, presses_, {}, {}, late_, seed};
  }
  [[nodiscard]] bool none() const { return channels_.empty() && devices_.empty() && presses_.empty() && late_.empty(); }

 private:
  std::uint64_t whole(std::uint64_t below) { return generator_() % below; }
  hal::simulated::Window window() {
    const hal::Time from = hal::milliseconds(static_cast<std::int64_t>(whole(2500)));
    return {from, from + hal::milliseconds(std::array{1, 5, 50, 500, 100'000}[whole(5)])};
  }
  void draw() {
    const std::uint64_t kind = whole(6);
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
      presses_.push_back({window()});
    } else {
      late_.push_back({window(), hal::microseconds(static_cast<std::int64_t>(100 + whole(20'000)))});
    }
  }

  std::mt19937_64 generator_;
  hal::SensorSetup sensors_;
  std::vector<ChannelFault> channels_;
  std::vector<DeviceFault> devices_;
  std::vector<hal::simulated::Press> presses_;
  std::vector<hal::simulated::LateWake> late_;
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
    return c;
  }
  firmware::SimulatedRig plant_;
  hal::simulated::Rig rig_;
};

/// Standard output goes nowhere for as long as this lives.
class Silence {
 public:
  Silence() {
    std::fflush(stdout);
    before_ = ::dup(STDOUT_FILENO);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (before_ < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0) throw std::runtime_error("no /dev/null");
    ::close(nowhere);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() {
    std::fflush(stdout);
    ::dup2(before_, STDOUT_FILENO);
    ::close(before_);
  }

 private:
  int before_ = -1;
};

std::string last_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line, last;
  while (std::getline(stream, line)) last = line;
  return last;
}

/// The first defect of the recording that a session left; `reason`: of its last row.
std::string look_at(const std::filesystem::path& file, double period, Reason& reason) {
  const firmware::AsRecorded recorded = firmware::read_csv_as_recorded(file, {});
  const std::vector<double>& time = recorded.recording.time;
  if (time.empty() || recorded.reason.size() != time.size()) return "no rows";
  Reason first = Reason::none;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const auto now = static_cast<Reason>(static_cast<int>(recorded.reason[k]));
    if (first != Reason::none && now != first) return "the first reason is not kept on record";
    first = now;
    if (k == 0) continue;
    const double step = time[k] - time[k - 1];
    const bool even = std::abs(step - period) < 1e-9, late = std::abs(step - period - recorded.late[k]) < 1e-9;
    if (!even && !late) return "rows are missing at " + std::to_string(time[k]) + " s";
  }
  reason = first;
  if (first == Reason::none) return "the last row has no reason";
  const std::string expected = "# ended by " + std::string(name(first));
  if (const std::string last = last_line(file); !last.starts_with(expected)) {
    return "the last line is '" + last + "', the last row says " + std::string(name(first));
  }
  return {};
}

}  // namespace

Status record_session(const firmware::RigDescription& rig, const hal::simulated::FaultPlan& plan, std::uint64_t seed,
                      const std::filesystem::path& file) {
  firmware::controller::Options options;
  options.simulated = options.virtual_time = options.overwrite = true;
  options.realtime = false;
  options.road = session_road;
  options.duration = session_length;
  options.seed = seed;
  options.out = file.string();
  FaultyDevices devices(rig, plan, seed);
  const Silence silence;
  firmware::controller::Verdict verdict;
  firmware::controller::Session session(options, rig, devices, verdict);
  return session.run();
}

SessionEnd play_session(std::uint64_t seed) {
  static const std::array rigs{firmware::read_rig("host_sim/rigs/paper_hil_fdva.toml"),
                               firmware::read_rig("host_sim/rigs/paper_rig_fdva.toml"),
                               firmware::read_rig("host_sim/rigs/paper_bench_fdva.toml")};
  const firmware::RigDescription& rig = rigs[seed % rigs.size()];
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("rigtwin_faults_" + std::to_string(::getpid()) + ".csv");
  const Faults faults(seed, firmware::simulated_sensors(rig));
  const Status status = record_session(rig, faults.plan(seed), seed, file);
  SessionEnd end;
  end.violated = look_at(file, rig.period(), end.reason);
  std::filesystem::remove(file);
  const Status expected = is_fault(end.reason) ? Status::safe_stop : Status::done;
  if (end.violated.empty() && status != expected) {
    end.violated = "status " + std::to_string(static_cast<int>(status)) + " after " + std::string(name(end.reason));
  }
  if (end.violated.empty() && faults.none() && end.reason != Reason::reference_ended) {
    end.violated = "ended by " + std::string(name(end.reason)) + " without a fault";
  }
  return end;
}

}  // namespace faults
