#include "host_sim/comparison/carried_simulation.hpp"

#include <utility>
#include <variant>

#include "host_sim/comparison/simulation_loop.hpp"
#include "model/components/subsystems.hpp"

namespace host_sim {

using model::Channel;
using Rig = model::RigParameters<double>;

class CarriedSimulation::Loop {
 public:
  Loop(const Rig& rig, const SimulationInput& like, int substeps, std::vector<Channel> channels)
      : rig_(rig), loop_(loop_for(rig, substeps)), channels_(std::move(channels)) {
    if (like.deflection_reached) {
      model::LoadCell<double> cell{};
      rig.effects.act_on(cell);
      moving_mass_ = cell.moving_mass;
    }
    std::visit([&](auto& loop) { loop.become(answering(rig, like), like.period); }, loop_);
  }

  void start(const SimulationInput& input, std::size_t at) {
    SimulationInput first = input;
    first.motion = {input.motion[at]};
    if (!first.actuator_force.empty()) first.actuator_force = {input.actuator_force[at]};
    std::visit([&](auto& loop) { loop.start(first, resting(rig_, first)); }, loop_);
  }

  void run(const SimulationInput& input, std::size_t from, std::size_t to, Response& response) {
    for (const Channel channel : channels_) response[index(channel)].resize(to - from);
    std::visit(
        [&](auto& loop) {
          for (std::size_t k = from; k < to; ++k) {
            loop.advance(input, k);
            const auto measured = loop.measured();
            for (const Channel channel : channels_) response[index(channel)][k - from] = measured[index(channel)];
          }
        },
        loop_);
    auto& force = response[index(Channel::F)];
    if (!(moving_mass_ > 0.0) || force.empty()) return;
    for (std::size_t k = from; k < to; ++k) force[k - from] += moving_mass_ * input.motion[k + 1].acceleration;
  }

 private:
  using Loops = std::variant<SimulationLoop<PlainModel>, SimulationLoop<model::RigModel<>>>;
  static Loops loop_for(const Rig& rig, int substeps) {
    if (rig.laws.any() || rig.has_extensions()) return SimulationLoop<model::RigModel<>>(substeps);
    return SimulationLoop<PlainModel>(substeps);
  }

  Rig rig_;
  Loops loop_;
  std::vector<Channel> channels_;
  double moving_mass_ = 0.0;  ///< on a measured deflection, whose acceleration the samples know better [kg]
};

CarriedSimulation::CarriedSimulation(const Rig& rig, const SimulationInput& like, int substeps,
                                     std::vector<Channel> channels)
    : loop_(std::make_unique<Loop>(rig, like, substeps, std::move(channels))) {}
CarriedSimulation::CarriedSimulation(CarriedSimulation&&) noexcept = default;
CarriedSimulation& CarriedSimulation::operator=(CarriedSimulation&&) noexcept = default;
CarriedSimulation::~CarriedSimulation() = default;

void CarriedSimulation::start(const SimulationInput& input, std::size_t at) { loop_->start(input, at); }

void CarriedSimulation::run(const SimulationInput& input, std::size_t from, std::size_t to, Response& response) {
  loop_->run(input, from, to, response);
}

}  // namespace host_sim
