// The recording of a run, written while it lasts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/journal.hpp"
#include "hal/sensor_source.hpp"
#include "host_sim/rig_description.hpp"

namespace firmware::controller {

/// When the oldest of a record's samples was taken; its own instant where none is older.
[[nodiscard]] hal::Time oldest_sample(const Record& record);

/// A CSV recording as `rigtwin compare` and `diagnose` read it, row by row. Whole rows only: a disk that is full ends
/// the recording with the last row that fits. The file lies under its own name from the start, for whoever pulls the
/// plug.
///
/// Columns: t – the loop's own grid since the run began: a step of one period, and after a late period, which moves the
/// grid, longer by what `late` says –, what is measured or computed, ducts, for a quarter_car the estimates, and for
/// every rig
///   late [s]   how long after its instant the period began; the readers explain longer steps by it
///   age [s]    of its oldest sample
///   age_F [s]  of that of each channel that is measured, nan where none came: a replay finds them as old again
class Recorder {
 public:
  /// Opens the file and writes comments and header. `trouble`: why not.
  Recorder(const std::string& file, const host_sim::RigDescription& rig, const hal::SensorSetup& sensors,
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

  [[nodiscard]] std::uint64_t rows() const { return rows_; }  ///< written
  [[nodiscard]] std::uint64_t lost() const { return lost_; }  ///< not written
  [[nodiscard]] int error() const { return error_; }          ///< errno of the first failure, 0 for none

 private:
  void number(double value);

  int file_ = -1;
  std::string buffer_;
  std::uint64_t collected_ = 0;  ///< rows in the buffer
  std::uint64_t rows_ = 0;
  std::uint64_t lost_ = 0;
  std::int64_t length_ = 0;  ///< of the file
  int error_ = 0;
  bool estimates_ = false;
  std::size_t ducts_ = 0;
  std::array<bool, model::channel_count> kept_{};
  std::array<bool, model::channel_count> fitted_{};
  hal::Time begin_ = hal::never;
};

}  // namespace firmware::controller
