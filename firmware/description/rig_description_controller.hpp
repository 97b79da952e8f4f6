// Readers of the control tables of a rig description: [limits], [estimator], [valves], [delay_budget], and for
// rig_controller [controller], [gpio], [converters], [lasers].
#pragma once

#include "firmware/description/rig_description.hpp"
#include "firmware/description/rig_description_table.hpp"

namespace firmware {

void read_controller(DescriptionTable& top, const model::RigParameters<double>& rig, ControllerDescription& controller);
void read_delay_budget(DescriptionTable& top, model::RigKind kind, DelayBudget& budget);
void read_hardware(DescriptionTable& top, const model::RigParameters<double>& rig, HardwareDescription& hardware);

}  // namespace firmware
