// What can be set about the control of the ducts.
#pragma once

#include <array>
#include <string_view>

namespace firmware {

/// Who decides which ducts are open.
enum class DuctPolicyKind : unsigned char {
  plan,            ///< the plan of the run
  force_velocity,  ///< all ducts while F_c ż_w > 0, else none
  rollout,         ///< the number that makes a predicted cost smallest
};
inline constexpr std::array<std::string_view, 3> duct_policy_names{"plan", "force_velocity", "rollout"};

/// Settings of [valves]. README.md of this folder says where the defaults come from.
struct DuctPolicySettings {
  DuctPolicyKind policy = DuctPolicyKind::plan;
  double wheel_load = 1.0;         ///< weight of (F_w/500 N)² in the cost
  double body_acceleration = 0.0;  ///< weight of (z̈_b/1 m/s²)²
  double component_force = 0.0;    ///< weight of ((k_b dz_b + F_c)/m_b/1 m/s²)²: body force without the damper's
  double stroke = 0.0;             ///< weight of (dz_b/7 mm)²
  double horizon = 0.1;            ///< of the prediction, from where the valves have moved [s]
  double dwell = 0.02;             ///< least time between two switchings [s]
  double delay = 0.0;              ///< of the valves: from the command to their place [s]
  double closing_time = 0.01;      ///< of a valve [s]: decides the pressure peak of a closing duct
  double pressure_peak = 10e5;     ///< highest that a closing duct may see [Pa]; above, it stays open
};

}  // namespace firmware
