// Compiled for processors with AVX-512 (host_sim/CMakeLists.txt).
#include "host_sim/comparison/lane_loop.hpp"

namespace host_sim {

void simulate_eight(const LaneSimulation& simulation) { run_lanes<8>(simulation); }

}  // namespace host_sim
