// [estimator] and the policy of [valves] in a rig description: reader and writer.
#pragma once

#include <functional>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/table/rig_description_table.hpp"

namespace firmware {

void read_estimator(DescriptionTable& top, model::RigKind kind, ControllerDescription& controller);
/// The keys of [valves] other than `safe` and `plan`.
void read_duct_policy(DescriptionTable& valves, const model::RigParameters<double>& rig,
                      ControllerDescription& controller);

using WriteLine = std::function<void(const std::string& key, const std::string& value)>;
/// What differs from the defaults.
void write_estimator(const ControllerDescription& controller, const WriteLine& line);
void write_duct_policy(const DuctPolicySettings& settings, const WriteLine& line);

}  // namespace firmware
