// A rig whose machine and sensors are ideal: what a compensated loop is compared with.
#pragma once

#include "model/rig/rig_parameters.hpp"

namespace host_sim::compensation {

[[nodiscard]] model::RigParameters<double> without_delay(model::RigParameters<double> rig);

}  // namespace host_sim::compensation
