// The parts of a rig description that say how it is controlled: [limits], [estimator], [valves], [delay_budget], and
// for rig_controller [controller], [gpio], [converters], [lasers].
#pragma once

#include "host_sim/rig_description.hpp"
#include "host_sim/rig_description_table.hpp"

namespace host_sim {

void read_controller(DescriptionTable& top, const model::RigParameters<double>& rig, ControllerDescription& controller);
void read_delay_budget(DescriptionTable& top, model::RigKind kind, DelayBudget& budget);
void read_hardware(DescriptionTable& top, const model::RigParameters<double>& rig, HardwareDescription& hardware);

}  // namespace host_sim
