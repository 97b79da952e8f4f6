// The columns of a recorded run: one list for the file that rig_controller writes row by row and for the recording that
// a simulated run keeps in memory.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/recording/recording.hpp"
#include "hal/sensor_source.hpp"

namespace firmware {

/// Time of the oldest sample of a record; the record's own time if no sample is older.
[[nodiscard]] hal::Time oldest_sample(const Record& record);

/// The column with the ages of a channel's samples: "age_F".
[[nodiscard]] std::string age_name(model::Channel channel);

/// The columns of a run, without t, in the order in which they are written:
///
///   channels   those with a sensor and those that the program computes; z_cmd of a quarter_car whose description has
///              effects of its machine or names the column in [channels]
///   ducts      1 open, 0 closed, one column per duct of the rig
///   estimates  quarter_car only: soft sensor F_w_c of the wheel load, velocities v_r, v_w, v_b
///   compensation  hil with [compensation] only: x_added [m], x_cmd less the deflection of the car; F_added [N], force
///              that enters the car less the measured one, both as far as they are faded in
///   mode       number of the state (firmware::Mode); rows of running and holding are the run
///   reason     number of the reason for the safe state (firmware::Reason), 0 before
///   level      factor on the reference
///   enabled    1: the drive had power from this period on
///   late [s]   delay of the start of the period
///   age [s]    of the period's oldest sample
///   age_F [s]  of the sample of each channel with a sensor, nan without a sample
class RunColumns {
 public:
  enum class Source : unsigned char {
    channel,
    duct,
    wheel_load,
    velocity,
    added_command,
    added_force,
    mode,
    reason,
    level,
    enabled,
    late,
    age,
    channel_age
  };
  struct Column {
    std::string name;
    std::string unit;  ///< empty for ducts
    Source source;
    std::size_t index;  ///< of the channel, duct or velocity
  };

  RunColumns(const RigDescription& description, const hal::SensorSetup& sensors);

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] double period() const { return period_; }  ///< [s]
  [[nodiscard]] static double value(const Column& column, const Record& record);

 private:
  double period_;
  std::vector<Column> columns_;
};

/// "0 idle, 1 arming, …": the numbers of column mode.
[[nodiscard]] std::string mode_legend();
/// "0 none, 1 reference_ended, …": the numbers of column reason.
[[nodiscard]] std::string reason_legend();

/// Keeps the records of a run as a recording in memory: channels, ducts and estimates, on the even grid k/rate.
class RunRecording {
 public:
  RunRecording(const RigDescription& description, const hal::SensorSetup& sensors, std::size_t expected_rows);

  void take(const Record& record);
  [[nodiscard]] Recording finish();

 private:
  RunColumns columns_;
  std::vector<std::vector<double>*> values_;  ///< of each column, in recording_; nullptr: not kept
  double sample_rate_;
  std::size_t rows_ = 0;
  Recording recording_;
};

}  // namespace firmware
