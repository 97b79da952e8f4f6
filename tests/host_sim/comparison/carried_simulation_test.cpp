// A simulation in pieces is the simulation of the whole, to the bit.
#include "host_sim/comparison/carried_simulation.hpp"

#include <gtest/gtest.h>

#include "firmware/simulation/road.hpp"
#include "tests/live/changing_rig.hpp"

namespace {

using namespace host_sim;
using model::Channel;

// Law. The state is carried whole: with friction, a delay and oil, at one and at four steps a sample.
TEST(CarriedSimulation, IsSimulateInPieces) {
  for (firmware::RigDescription rig : {sample::quarter_car_fdva(), sample::component_bench()}) {
    rig.rig.effects.add<model::CoulombFriction>({30.0});
    const bool bench = rig.rig.kind == model::RigKind::component_bench;
    if (bench) rig.rig.effects.add<model::ActuatorDelay>({0.0034});
    firmware::IsoRoad road;
    SimulationInput input;
    input.period = 1e-3;
    input.channel = bench ? Channel::x_cmd : Channel::z_r;
    input.deflection_reached = !bench;
    input.motion = firmware::drive_over(road, 1000.0, 1001);
    const std::vector<Channel> channels = response_channels(rig.rig.kind, input);
    for (const int substeps : {1, 4}) {
      const Response whole = simulate(rig.rig, input, resting(rig.rig, input), 0, substeps, channels);
      CarriedSimulation carried(rig.rig, input, substeps, channels);
      carried.start(input, 0);
      Response piece;
      for (std::size_t from = 0; from < 1000; from += 250) {
        carried.run(input, from, from + 250, piece);
        for (const Channel channel : channels) {
          for (std::size_t k = 0; k < 250; ++k) {
            ASSERT_EQ(piece[index(channel)][k], whole[index(channel)][from + 1 + k]) << model::name(channel);
          }
        }
      }
    }
  }
}

}  // namespace
