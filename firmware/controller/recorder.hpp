// The recording of a run, written while it lasts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/recording/run_columns.hpp"
#include "hal/sensor_source.hpp"

namespace firmware::controller {

/// A CSV recording as `rigtwin compare` and `diagnose` read it, row by row. Whole rows only: a disk that is full ends
/// the recording with the last row that fits. The file lies under its own name from the start, for whoever pulls the
/// plug.
///
/// Columns: t, then those of RunColumns. t is the loop's own grid since the run began: a step is one period, and after
/// a late period, which moves the grid, longer by `late`; the readers explain longer steps by that column.
class Recorder {
 public:
  /// Opens the file and writes comments and header. `trouble`: why not.
  Recorder(const std::string& file, const RigDescription& rig, const hal::SensorSetup& sensors,
           const std::vector<std::string>& comments, std::string& trouble);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A row, if the record is one of the run.
  void take(const Record& record);

  /// Hands over what was collected. False once rows could not be written.
  bool flush();
  /// And onto the disk.
  bool sync();

  // From any thread.
  [[nodiscard]] std::uint64_t rows() const { return rows_.load(); }  ///< written
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(); }  ///< not written
  [[nodiscard]] int error() const { return error_.load(); }          ///< errno of the first failure, 0 for none

 private:
  void number(double value);

  int file_ = -1;
  std::string buffer_;
  std::uint64_t collected_ = 0;  ///< rows in the buffer
  std::atomic<std::uint64_t> rows_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::int64_t length_ = 0;  ///< of the file
  std::atomic<int> error_{0};
  RunColumns columns_;
  hal::Time begin_ = hal::never;
};

}  // namespace firmware::controller
