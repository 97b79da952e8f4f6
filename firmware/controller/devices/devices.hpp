// Who plays the roles of the rig.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/controller/devices/options.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/loop/common/mode.hpp"
#include "hal/rig.hpp"

namespace firmware::controller {

/// A level that was asked for, and the row in whose period it was taken up.
struct LevelChange {
  std::size_t row = 0;
  double level = 1.0;
};

/// The changes that column `level` of a recording shows, to the millionth that a request has (ControlLoop::level);
/// `period` in s.
[[nodiscard]] std::vector<LevelChange> level_changes(const std::vector<double>& level, double period);

/// Requests and states of the recorded run, for its replay.
struct ReplayedRun {
  std::size_t rows = 0;      ///< of the recording
  std::size_t samples = 0;   ///< of the run
  bool to_its_end = true;    ///< the run ended with its road
  bool with_the_way = true;  ///< the recording begins before the run
  /// Of each row; empty: the recording is the run alone.
  std::vector<Mode> modes;
  std::vector<LevelChange> levels;        ///< in order
  std::size_t stop_requested = SIZE_MAX;  ///< the row in whose period the run was asked to stop
};

/// The back-end that was chosen, opened.
class Devices {
 public:
  Devices() = default;
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;
  virtual ~Devices() = default;

  [[nodiscard]] virtual hal::Rig roles() = 0;
  /// Lines on what a user should know, once the run has lasted; empty: nothing.
  [[nodiscard]] virtual std::string warnings() const { return {}; }
  /// What was replayed; nothing for devices.
  [[nodiscard]] virtual const ReplayedRun* replayed() const { return nullptr; }
  /// The contacts of the stop button, and when each one opened last; empty: it has none.
  struct StopContact {
    std::string line;
    hal::Time opened = hal::never;
  };
  [[nodiscard]] virtual std::vector<StopContact> stop_contacts() const { return {}; }
  /// What was opened, a line each.
  [[nodiscard]] virtual std::string text() const = 0;
};

/// Opens them: the valves stand in the safe position from here on. Nothing in case of trouble, which is then one line.
[[nodiscard]] std::unique_ptr<Devices> open_devices(const RigDescription& rig, const Options& options,
                                                    std::string& trouble);

}  // namespace firmware::controller
