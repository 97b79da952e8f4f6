// A period as one JSON object, for PlotJuggler and `rigtwin watch`.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "firmware/controller/recording/spans.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/recording/run_columns.hpp"
#include "hal/sensor_source.hpp"

namespace firmware::controller {

/// Writes the datagrams of a session. Keys:
///
///   timestamp      of the period on the loop's clock [s], nanoseconds resolved
///   instance       which program sends it (new_instance): two that send to one port are told apart
///   sequence       of the datagram, from 0: a gap is what the way to the reader lost
///   period         of the loop: a gap wider than the decimation is what was lost before
///   lost           periods so far that were to be published and were not
///   z_r, F, …      every column of the recording (RunColumns), under its name there; a value that is no number is left
///                  out, because JSON has none
///   state, reason_name, second_reason   names of `mode` and `reason`, and of what happened after that
///   trip           once the rig is in safe: why, in words
///   failed_checks  in safe after an arming that was refused: everything that was wrong, at most 300 bytes
///   energy_fed, energy_taken            hil: W and D of the EnergyGuard [J]
///   command, tare, bridged, late_periods, limited_commands
///   setup          with the first datagram and every second: rig, recording, duration, limits, units, spans
///                  of the loop
///   ended          in the last one, which has nothing but timestamp, instance, sequence and lost beside it
class DatagramWriter {
 public:
  struct Numbers {
    std::uint64_t sequence = 0;
    std::uint64_t lost = 0;
  };

  /// `every`: of so many periods one is published; `instance`: of this program. References must outlive the writer.
  DatagramWriter(const RigDescription& rig, const hal::SensorSetup& sensors, bool simulated, std::uint64_t every,
                 const Spans& spans, std::string instance);

  /// What is recorded: the file's name, and how long the run takes [s]; 0: until it is stopped.
  void describe_run(std::string recording, double duration) {
    recording_ = std::move(recording);
    duration_ = duration;
  }

  /// All checks that the last arming has failed, in words, or nothing.
  void describe_refusals(std::function<std::string()> refusals) { refusals_ = std::move(refusals); }

  [[nodiscard]] std::string period(const Record& record, const Numbers& numbers, bool with_setup) const;
  [[nodiscard]] std::string end(hal::Time time, const Numbers& numbers, const std::string& why) const;

 private:
  [[nodiscard]] std::string setup() const;

  const RigDescription& rig_;
  RunColumns columns_;
  bool simulated_;
  std::uint64_t every_;
  const Spans& spans_;
  std::string instance_;
  std::string recording_;
  double duration_ = 0.0;  ///< [s]
  std::function<std::string()> refusals_;
};

}  // namespace firmware::controller
