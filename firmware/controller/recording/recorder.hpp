// The recording of a session, written while it lasts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/controller/reference/programme_reference.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/recording/run_columns.hpp"
#include "hal/sensor_source.hpp"

namespace firmware::controller {

/// A CSV recording, row by row, of everything but idle: arming, approach, run, stop and return. Analyses read its run
/// alone, by column `mode` (firmware/recording/README.md). Whole rows only: a disk that is full ends the recording with
/// the last row that fits. The file lies under its own name from the start, so that a loss of power leaves it there.
///
///   comments   program, road, rights, UTC of the beginning, legend of mode and reason, the rig description with its
///              SHA-256
///   rows       t, the columns of RunColumns; for a road that repeats `cycle`, for a programme `block` and `cycle`
///   (from
///              1, 0 outside of the run; a hold moves their borders by up to a second)
///   comments   marks of the operator between rows; why an arming that led to no run ended; at the end of each part
///              what it is continued in, or why its run ended (with value, limit, interlock), and when (UTC)
///
/// t is the loop's own grid since the first row: a step is one period, and after a late period, which moves the grid,
/// longer by `late`; the readers explain longer steps by that column.
///
/// A long recording has parts: run.csv, run-0002.csv, …; each has all comments and can be read alone. A run that begins
/// after an earlier one begins a part.
class Recorder {
 public:
  struct Setup {
    std::string file;
    std::vector<std::string> comments;
    bool overwrite = false;           ///< an earlier recording; else it is refused
    bool several_runs = false;        ///< an operator may begin another one, in a part of its own
    std::vector<std::string> inputs;  ///< files that the run reads: never written
    std::uint64_t rows_per_part = 0;  ///< 0: one part
    std::uint64_t cycle_samples = 0;  ///< of a road that repeats; 0: it does not
    std::string programme;            ///< its file, whose text goes into the comments; empty: none
    /// Block and cycle of a sample of the programme; empty: none.
    std::function<ProgrammeReference::Place(std::uint64_t)> place;
  };

  /// Opens the file and writes comments and header. `trouble`: why not. A recording that may get parts is refused if
  /// one of their names is taken. The description must outlive the recorder.
  Recorder(const Setup& setup, const RigDescription& rig, const hal::SensorSetup& sensors, std::string& trouble);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A row, unless the rig is idle or has stood still in safe for a second.
  void take(const Record& record);
  /// What has led to safe since the last call, in words; mostly nothing. For the console.
  [[nodiscard]] std::string news();
  /// A comment between the rows.
  void mark(const std::string& text);
  /// Hands over what was collected. False once rows could not be written.
  bool flush();
  /// And onto the disk.
  bool sync();
  /// The last comment. After it no rows.
  void end(const std::string& why);

  // From any thread.
  [[nodiscard]] std::uint64_t rows() const { return rows_.load(); }    ///< written
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(); }    ///< not written
  [[nodiscard]] int error() const { return error_.load(); }            ///< errno of the first failure, 0 for none
  [[nodiscard]] std::uint64_t parts() const { return parts_.load(); }  ///< files

 private:
  [[nodiscard]] std::string taken_part() const;
  bool open_part();
  void begin_part();
  void note_reason(const Record& record);
  void number(double value);
  void place(const Record& record);
  [[nodiscard]] bool worth_a_row(const Record& record);

  Setup setup_;
  const RigDescription& rig_;
  RunColumns columns_;
  std::string description_;  ///< as comments
  int file_ = -1;
  int first_ = -1;            ///< the first part, which stays locked: so the name of the whole recording is
  bool has_parts_ = false;    ///< a pipe or a device has one
  std::uint64_t number_ = 0;  ///< of the part that is written
  std::string buffer_;
  std::uint64_t collected_ = 0;  ///< rows in the buffer
  std::uint64_t part_rows_ = 0;  ///< taken into this part
  std::int64_t length_ = 0;      ///< of the file
  hal::Time begin_ = hal::never;
  Mode mode_ = Mode::idle;         ///< of the record before
  std::uint64_t run_samples_ = 0;  ///< rows of mode running in this run
  bool has_run_ = false;           ///< this part has rows of a run
  std::string ended_by_;           ///< why the rig is in safe, or was before it became idle
  std::string news_;
  Reason reason_ = Reason::none, second_ = Reason::none;  ///< of the record before
  hal::Time reason_time_ = hal::never;                    ///< of its trip
  hal::Command stands_{};                                 ///< in safe
  std::uint64_t standing_ = 0;                            ///< records in safe with that command
  std::atomic<std::uint64_t> rows_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<std::uint64_t> parts_{0};
  std::atomic<int> error_{0};
};

/// "2026-11-22T18:31:24Z", now.
[[nodiscard]] std::string utc_now();

/// run.csv → run-0002.csv for part 2; part 1 is the file itself.
[[nodiscard]] std::string part_name(const std::string& file, std::uint64_t part);

}  // namespace firmware::controller
