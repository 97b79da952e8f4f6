// Rig descriptions as texts, for tests and for programs without Google Test.
#pragma once

#include <string_view>

namespace support {

/// Each kind with every table that it needs, and an FDVA.
inline constexpr std::string_view hil_text = R"(kind = "hil"
sample_rate = 1000.0
[body]
mass = 290.0
[wheel]
mass = 40.0
[tyre]
stiffness = 200e3
damping = 100.0
[suspension]
stiffness = 31500.0
damping = 0.0
[machine]
virtual_damping = 1140.0
[fdva]
piston_area = 30e-4
duct_diameter = 12e-3
duct_length = 0.6361571127
oil_density = 860.0
oil_viscosity = 32e-6
minor_loss = 1.5
coupling_stiffness = 55e3
ducts = 6
open_ducts = 2
[effects.actuator_delay]
delay = 0.010
)";

inline constexpr std::string_view quarter_car_text = R"(kind = "quarter_car"
sample_rate = 1000.0
[body]
mass = 290.0
[wheel]
mass = 40.0
[tyre]
stiffness = 200e3
damping = 100.0
[suspension]
stiffness = 31500.0
damping = 1140.0
)";

inline constexpr std::string_view bench_text = R"(kind = "component_bench"
sample_rate = 1000.0
[suspension]
stiffness = 31500.0
damping = 1140.0
)";

}  // namespace support
