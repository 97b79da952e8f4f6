// The controller's Kalman filter over a recording.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace host_sim::estimation {

/// By channel and row the age of the sample [s]; an empty column: 0.
using Ages = std::array<std::vector<double>, model::channel_count>;

/// What the filter says of one channel.
struct ChannelInnovations {
  model::Channel channel;
  std::size_t count = 0;
  double rms = 0.0;       ///< of the normalised innovations: 1 for a right model
  double one_late = 0.0;  ///< correlation of neighbours: 0 for a right model
};

/// An alarm of the innovation monitor in words: "zdd_b, colour, 25.3 standard deviations (limit 5.04)".
struct Estimate {
  std::vector<double> time;
  /// Columns by name, as `columns()` lists them.
  std::vector<firmware::ExtraColumn> columns;
  std::vector<ChannelInnovations> channels;
  double nis = 0.0;               ///< mean of Σ ν² ÷ number of innovations: 1 for a right model
  double sigma_wheel_load = 0.0;  ///< that the filter expects of its F_w [N]
  double sigma_velocity = 0.0;    ///< of its velocity of the deflection [m/s]
  std::size_t alarms = 0, blocks = 0;
  std::string last_alarm;  ///< empty: none
  std::size_t too_old = 0;
  std::size_t wide_rows = 0;  ///< in which the road moved otherwise than described (KalmanFilter (5))
  [[nodiscard]] double wide_share() const {
    return time.empty() ? 0.0 : static_cast<double>(wide_rows) / static_cast<double>(time.size());
  }

  /// Whether the innovations contradict the model; nullopt: not judged, no block of innovations was full.
  [[nodiscard]] std::optional<bool> model_wrong() const {
    if (blocks == 0) return std::nullopt;
    return alarms > 0;
  }
  [[nodiscard]] const std::vector<double>& column(std::string_view name) const;
};

/// Runs firmware::KalmanFilter, the controller's code, over a recording (its parts, each from a new start). Channels:
/// those of [estimator] sensors, else all with a [noise] that the recording has. Ducts and F_act as recorded. Samples
/// out of their range and rows that were filled are not used. InputError when a wanted channel is missing or the filter
/// does not fit.
///
/// Columns: x_est for each channel x that a quarter car has, v_r_est, v_w_est, v_b_est, v_rel_est [m/s], y_est [m],
/// vy_est [m/s] and F_c_est [N] with an FDVA, bias_x for each bias state, nis (Σ ν² of the period), innovations (their
/// number), model_wrong (1: the monitor has found a contradiction since the start). The names are not those of
/// channels: an estimate is no recording and no command takes it for one.
[[nodiscard]] Estimate run_filter(const firmware::RigDescription& description,
                                  const std::vector<firmware::Recording>& parts, const std::vector<Ages>& ages);

/// Ages of samples that a controller recorded (columns age_x), for the rows of the parts; nothing recorded: zeros.
[[nodiscard]] std::vector<Ages> recorded_ages(const std::filesystem::path& file,
                                              const firmware::RigDescription& description,
                                              const std::vector<firmware::Recording>& parts);

}  // namespace host_sim::estimation
