// The entries of a rig's state vectors, by name.
#pragma once

namespace model {

/// The joined state, RigModel::State::core: first the car, then the component. A car alone has the first four entries.
/// A plain component, one without relaxation and top mount, has the piston's two only.
struct CoreIndex {
  enum : int {
    wheel_position,      ///< z_w [m]
    wheel_velocity,      ///< ż_w [m/s]
    body_position,       ///< z_b [m]
    body_velocity,       ///< ż_b [m/s]
    piston_travel,       ///< y [m]
    piston_velocity,     ///< ẏ [m/s]
    relaxed_deflection,  ///< r [m], of the relaxing branch
    inner_deflection,    ///< e [m], behind the top mount
  };
};

/// The state of a component, in the same order.
struct ComponentIndex {
  enum : int { piston_travel, piston_velocity, relaxed_deflection, inner_deflection };
};

inline constexpr int car_states = 4;
inline constexpr int component_states = 4;
inline constexpr int plain_component_states = 2;
inline constexpr int core_states = car_states + component_states;
inline constexpr int plain_core_states = car_states + plain_component_states;

/// Which parts a state vector with this many entries has: a component (2 or 4), or car and component (6 or 8).
template <int States>
struct StateLayout {
  static_assert(States == plain_component_states || States == component_states || States == plain_core_states ||
                    States == core_states,
                "a component, or car and component");
  static constexpr bool has_car = States > component_states;
  static constexpr int component = has_car ? car_states : 0;  ///< the component's first entry
  static constexpr bool is_plain = States - component == plain_component_states;
};

}  // namespace model
