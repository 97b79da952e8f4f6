// Readers of the control tables of a rig description: [limits], [estimator], [valves], [delay_budget], and for
// rig_controller [controller], [gpio], [converters], [lasers].
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/table/rig_description_table.hpp"

namespace firmware {

/// What [waivers] may hold: what a rig goes without that a safe rig has.
inline constexpr std::array<std::string_view, 11> waiver_names{
    "no_heartbeat",         "no_enable",          "no_stop",
    "stop_fails_dangerous", "enable_active_low",  "no_probe",
    "unproven_stability",   "no_following_error", "no_enable_feedback",
    "off_centre",           "wide_limits"};

void read_waivers(DescriptionTable& top, std::map<std::string, std::string>& waivers);
void read_controller(DescriptionTable& top, const model::RigParameters<double>& rig, double sample_rate,
                     ControllerDescription& controller);
void read_delay_budget(DescriptionTable& top, model::RigKind kind, DelayBudget& budget);
void read_arming(DescriptionTable& top, const std::map<std::string, std::string>& waivers,
                 ControllerDescription& controller);
void read_hardware(DescriptionTable& top, const model::RigParameters<double>& rig, double period,
                   const std::map<std::string, std::string>& waivers, HardwareDescription& hardware);
/// A test of the stop button needs one.
void check_stop_test(const DescriptionTable& top, const RigDescription& description);

}  // namespace firmware
