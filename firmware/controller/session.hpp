// What drives a rig: control loop, recording, supervision and emergency return in one hand.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/controller/control_socket.hpp"
#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/devices/options.hpp"
#include "firmware/controller/lead.hpp"
#include "firmware/controller/publishing/publisher.hpp"
#include "firmware/controller/real_time/auxiliary_thread.hpp"
#include "firmware/controller/real_time/cache_warmup.hpp"
#include "firmware/controller/real_time/real_time.hpp"
#include "firmware/controller/real_time/sample_phase.hpp"
#include "firmware/controller/real_time/wake_lead.hpp"
#include "firmware/controller/recording/recorder.hpp"
#include "firmware/controller/recording/recording_thread.hpp"
#include "firmware/controller/recording/spans.hpp"
#include "firmware/controller/reference/run_road.hpp"
#include "firmware/controller/run.hpp"
#include "firmware/controller/safety/emergency.hpp"
#include "firmware/controller/supervisor.hpp"
#include "firmware/loop/control_loop.hpp"
#include "hal/linux/clock.hpp"

namespace firmware::controller {

/// Converters have been filling their queues since they were opened: takes the old samples out, so that the next read
/// gets new ones.
void drain(const hal::Rig& roles, hal::Time period);

/// Rows of a part of the recording; 0: one part.
[[nodiscard]] std::uint64_t rows_per_part(double minutes, double sample_rate);

/// The longest way back to rest that a session waits for [s].
[[nodiscard]] double longest_return(const RigDescription& rig);

/// From a request to stop to the end of the process at most [s]: that way, and the disk's patience, twice.
[[nodiscard]] double longest_stop(const RigDescription& rig);

/// One session with opened devices. Three or four threads:
///
///   loop          the caller's; real-time priority, the loop's CPU: steps the control loop, nothing else
///   recording     ordinary priority, other CPUs: journal → file; the only one that waits for the disk
///   publishing    if asked for. Ordinary priority, other CPUs: what the recording has taken → datagrams; never waits
///   supervision   ordinary priority, other CPUs: signals, systemd's watchdog, the operator's socket, lost records
class Session {
 public:
  Session(const Options& options, const RigDescription& rig, Devices& devices, Verdict& verdict);
  /// Led by somebody else. `looks`: arming checks the rig as the description says; else nothing is looked at.
  Session(const Options& options, const RigDescription& rig, Devices& devices, Verdict& verdict,
          std::unique_ptr<Lead> lead, bool looks);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() = default;

  /// From rights to the last line. Once.
  [[nodiscard]] Status run();

 private:
  [[nodiscard]] bool acquire_rights();
  void find_phase();
  [[nodiscard]] bool keeps_allowed_delay();
  [[nodiscard]] bool open_recording();
  [[nodiscard]] bool open_datagrams();
  void publish_to(const cpu_set_t& cpus);
  void drive();
  [[nodiscard]] bool open_socket();
  [[nodiscard]] bool is_over(hal::Time seen);
  void publish();
  [[nodiscard]] hal::Time await_period();
  void wait_for_recording() const;
  [[nodiscard]] Status finish();
  [[nodiscard]] bool write_histogram() const;
  void print_counters() const;
  [[nodiscard]] Status verdict_of_run(std::string& why) const;
  [[nodiscard]] std::uint64_t lost() const { return recorder_->lost() + journal_.lost(); }

  const Options& options_;
  const RigDescription& rig_;
  Devices& devices_;
  Verdict& verdict_;
  const bool realtime_;
  const bool operated_;  ///< somebody arms and starts by the socket
  const std::unique_ptr<Lead> lead_;
  const Settings settings_;
  const std::string instance_;
  const hal::Rig opened_;
  RememberedCommand command_;
  const hal::Rig roles_;
  const ValvePlan valves_;
  RunRoad road_;
  std::vector<Record> storage_;
  Journal journal_;
  const std::unique_ptr<Companion> companion_;                                 ///< none: observers, and ducts by plan
  const std::unique_ptr<Compensation> compensation_, compensation_of_warmup_;  ///< none: the car's deflection alone
  ControlLoop loop_;
  const std::unique_ptr<Spans> spans_;
  WakeLead wake_;
  std::unique_ptr<CacheWarmup> warmup_;  ///< none without real-time rights
  hal::linux::MonotonicClock machine_;
  EmergencyReturn emergency_return_;
  const AlternateStack alternate_stack_;
  std::atomic<bool> at_rest_{false};
  const double longest_return_;  ///< [s]
  LoopProgress progress_;
  std::string rights_;                ///< for the recording's comments
  std::optional<SamplePhase> phase_;  ///< none: simulated, replayed, or samples that come at no rate of the loop's
  hal::Time safe_since_ = hal::never;
  std::optional<Trip> first_fault_;  ///< of the session; each run has its own
  hal::Time woken_{};                ///< of this period
  std::vector<std::string> inputs_;  ///< files that the run reads
  ListeningSocket listening_;
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<LiveTap> tap_;  ///< none: nothing is published, as for the next three
  std::unique_ptr<DatagramWriter> writer_;
  std::unique_ptr<DatagramSocket> datagrams_;
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<RecordingThread> recording_;
  std::unique_ptr<ControlSocket> socket_;
  std::unique_ptr<Supervisor> supervisor_;
};

}  // namespace firmware::controller
