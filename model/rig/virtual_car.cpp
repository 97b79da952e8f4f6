#include "model/rig/rig_model.hpp"

namespace model {

template class RigModel<double, 512, ModelVariant::virtual_car>;

}  // namespace model
