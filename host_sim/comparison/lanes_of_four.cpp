// Compiled for processors with AVX2 (host_sim/CMakeLists.txt).
#include "host_sim/comparison/lane_loop.hpp"

namespace host_sim {

void simulate_four(const LaneSimulation& simulation) { run_lanes<4>(simulation); }

}  // namespace host_sim
