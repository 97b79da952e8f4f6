// Kalman filter and duct policy of a rig description, ready for the control loop.
#pragma once

#include <memory>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/companion.hpp"
#include "firmware/loop/kalman/kalman_filter.hpp"

namespace firmware {

/// Settings of the filter with the noise of its channels ([noise]) and the road's bandwidth. InputError when a channel
/// has no noise or the settings do not fit the rig.
[[nodiscard]] KalmanSettings kalman_settings(const RigDescription& description);

/// The filter of a description with [estimator] kind = "kalman". InputError when a state is not observable: it names
/// the state.
[[nodiscard]] std::unique_ptr<KalmanFilter> kalman_filter(const RigDescription& description,
                                                          const EstimatorEquations& equations);

/// What rides along with the control loop; nothing with the observer.
[[nodiscard]] std::unique_ptr<Companion> companion(const RigDescription& description);

}  // namespace firmware
