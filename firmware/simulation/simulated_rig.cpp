#include "firmware/simulation/simulated_rig.hpp"

#include <algorithm>

#include "firmware/loop/duct_control/rollout.hpp"

namespace firmware {

namespace {
constexpr std::uint32_t noise_stream = 2;  // of a run's seed; the road has its own
using model::Channel;
using model::RigKind;

/// At rest where the input has this value: foot point, deflection or force.
model::RigModel<>::State started(const model::RigModel<>& model, double input) {
  const RigKind kind = model.parameters().kind;
  if (kind == RigKind::quarter_car) return model.start(input);
  if (kind == RigKind::driven_mass) {
    return model.start(model::Column<double, model::plain_core_states>::Zero(), {input, 0.0, 0.0}, {});
  }
  return model.start(0.0, input);
}
}  // namespace

model::ModelledPart hardware_of(RigKind kind) {
  return kind == RigKind::hil ? model::ModelledPart::test_machine : model::ModelledPart::whole_rig;
}

bool is_hardware_channel(RigKind kind, Channel channel) {
  switch (channel) {
    case Channel::F:
    case Channel::x_act:
      return kind != RigKind::quarter_car;
    case Channel::zdd_b:
      return kind == RigKind::quarter_car || kind == RigKind::driven_mass;
    case Channel::x_cmd:
    case Channel::z_cmd:
      return false;
    default:
      return kind == RigKind::quarter_car;
  }
}

SimulatedRig::SimulatedRig(const RigDescription& description, std::uint64_t seed, Noise noise, double start)
    : model_(description.rig, description.period(), hardware_of(description.rig.kind)),
      state_(started(model_, start)),
      gaussian_(seed, noise_stream),
      range_(description.range),
      on_their_way_(
          static_cast<std::size_t>(nearest_periods(description.controller.ducts.delay, description.period()))) {
  if (noise == Noise::none) return;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (is_hardware_channel(description.rig.kind, model::channel_at(i)))
      deviation_[i] = description.noise[i].value_or(0.0);
  }
  draw_noise();
}

void SimulatedRig::draw_noise() {
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (deviation_[i] > 0.0) noise_[i] = deviation_[i] * gaussian_();
  }
}

void SimulatedRig::do_measure(std::span<double, hal::channel_capacity> values) {
  const model::Signals<double> signals = model_.measured(state_, &noise_);
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    values[i] = range_[i] ? std::clamp(signals[i], range_[i]->lower, range_[i]->upper) : signals[i];
  }
}

/// Where valves stand that were told so long ago; the first openings stand at once.
hal::Openings SimulatedRig::late(hal::Openings openings) {
  if (on_their_way_.empty()) return openings;
  if (!valves_told_) std::fill(on_their_way_.begin(), on_their_way_.end(), openings);
  valves_told_ = true;
  const hal::Openings standing = on_their_way_[oldest_];
  on_their_way_[oldest_] = openings;
  oldest_ = (oldest_ + 1) % on_their_way_.size();
  return standing;
}

void SimulatedRig::do_advance(const hal::Command& command, hal::Openings openings) {
  const auto open = static_cast<model::OpenDucts>(late(openings).bits());
  if (open != state_.ducts.open()) model_.open_ducts(state_, open);
  draw_noise();
  model_.step(state_, {.foot_point = {command.position, command.velocity, command.acceleration},
                       .command = {command.position, command.velocity},
                       .noise = &noise_});
}

}  // namespace firmware
