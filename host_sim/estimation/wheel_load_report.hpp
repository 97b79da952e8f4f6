// The wheel load from three sources against the truth, as a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/estimation/run_filter.hpp"

namespace host_sim::estimation {

/// One way to the wheel load.
struct WheelLoad {
  std::string name;                              ///< "k_t dz_w", "sensor F_w", "filter"
  std::vector<double> values;                    ///< [N], by row
  std::optional<double> error_rms, error_share;  ///< against the truth [N], [1]; from 1 s after the start
};

/// Those that the recording allows: k_t dz_w (dz_w or z_r − z_w), the sensor, the filter; with errors if `truth`, the
/// noiseless F_w of the same run, is given (InputError when it is of another length).
[[nodiscard]] std::vector<WheelLoad> wheel_loads(const firmware::RigDescription& description,
                                                 const firmware::Recording& recording, const Estimate& estimate,
                                                 const firmware::Recording* truth);

/// What the innovations say of the model, in a sentence: that they contradict it, that they do not, or that nothing was
/// judged and why.
[[nodiscard]] std::string sentence(const Estimate& estimate);

/// The page: figure of the loads and of their errors, table of errors, innovations of each channel, the monitor's word.
[[nodiscard]] std::string report_page(const firmware::RigDescription& description, const firmware::Recording& recording,
                                      const Estimate& estimate, const std::vector<WheelLoad>& loads,
                                      const firmware::Recording* truth);

}  // namespace host_sim::estimation
