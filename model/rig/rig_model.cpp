#include "model/rig/rig_model.hpp"

namespace model {

template std::optional<RigFault> find_fault(const RigParameters<double>& rig, double period, std::size_t longest);
template class RigModel<double>;

}  // namespace model
