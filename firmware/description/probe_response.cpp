#include "firmware/description/probe_response.hpp"

#include <cstddef>
#include <memory>

#include "firmware/loop/arming_checks.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

double probe_stiffness(const RigDescription& description, double amplitude) {
  if (description.rig.kind != model::RigKind::hil || amplitude <= 0.0) return 0.0;
  using Model = model::RigModel<double>;
  // Not on the stack: the delay line alone takes some kilobytes.
  const auto machine =
      std::make_unique<const Model>(description.rig, description.period(), model::ModelledPart::test_machine);
  auto state = std::make_unique<Model::State>(machine->start());
  if (description.rig.has_fdva) machine->open_ducts(*state, description.controller.safe_ducts);
  const auto periods = static_cast<std::size_t>(ArmingChecks::probe_time * description.sample_rate);
  const auto rest = machine->measured(*state);  // offsets of sensors: an arming takes the means at rest off, too
  const double x_rest = rest[model::index(model::Channel::x_act)], f_rest = rest[model::index(model::Channel::F)];
  double squares = 0.0, products = 0.0;
  for (std::size_t k = 0; k <= periods; ++k) {
    const auto measured = machine->measured(*state);
    const double x = measured[model::index(model::Channel::x_act)] - x_rest;
    const double f = measured[model::index(model::Channel::F)] - f_rest;
    squares += x * x;
    products += x * f;
    const double share = static_cast<double>(k + 1) / static_cast<double>(periods);
    const hal::Command command = ArmingChecks::probe_at(share < 1.0 ? share : 1.0, amplitude);
    Model::Input input;
    input.command = {command.position, command.velocity};
    machine->step(*state, input);
  }
  return squares > 0.0 ? products / squares : 0.0;
}

}  // namespace firmware
