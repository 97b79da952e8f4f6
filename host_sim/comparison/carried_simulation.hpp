// A simulation that goes on where it stopped: a recording that is still being made, block by block.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "host_sim/comparison/simulation.hpp"

namespace host_sim {

/// simulate() in pieces. Each piece has an input of its own, whose first sample is the last one of the piece before:
/// responses of pieces one behind the other are those of simulate() over all of it, to the bit, where the motion
/// between samples is the same.
///
/// The rig must be one that the model can step (firmware::find_rig_fault), without effects of sensors: a caller passes
/// what it gets through these.
class CarriedSimulation {
 public:
  /// `like`: an input of the kind that all pieces have (channel, period, reached or commanded).
  CarriedSimulation(const model::RigParameters<double>& rig, const SimulationInput& like, int substeps,
                    std::vector<model::Channel> channels);
  CarriedSimulation(const CarriedSimulation&) = delete;
  CarriedSimulation& operator=(const CarriedSimulation&) = delete;
  CarriedSimulation(CarriedSimulation&&) noexcept;
  CarriedSimulation& operator=(CarriedSimulation&&) noexcept;
  ~CarriedSimulation();

  /// At rest above sample `at` of an input, or moving with it (resting()).
  void start(const SimulationInput& input, std::size_t at);

  /// From sample `from`, which is the one reached, to sample `to`: the channels at samples from + 1 … to, in
  /// response[channel][0 … to − from − 1].
  void run(const SimulationInput& input, std::size_t from, std::size_t to, Response& response);

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace host_sim
