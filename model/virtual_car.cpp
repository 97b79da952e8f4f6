#include "model/rig_model.hpp"

namespace model {

template class RigModel<double, 512, Scope::virtual_car>;

}  // namespace model
