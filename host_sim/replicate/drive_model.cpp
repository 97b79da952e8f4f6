#include "host_sim/replicate/drive_model.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "firmware/simulation/road.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::replicate {

using model::Channel;
using Rig = model::RigParameters<double>;

firmware::RigDescription driven_part(const firmware::RigDescription& description) {
  firmware::RigDescription part = description;
  if (part.rig.kind != model::RigKind::hil) return part;
  part.rig.kind = model::RigKind::component_bench;
  part.rig.machine.virtual_damping = 0.0;
  part.rig.lever = {};
  part.rig.body = {};
  part.rig.wheel = {};
  part.rig.tyre = {};
  part.compensation.reset();
  for (auto tolerated = part.tolerance.begin(); tolerated != part.tolerance.end();) {
    const std::string& path = tolerated->first;
    const bool of_car = path.starts_with("body.") || path.starts_with("wheel.") || path.starts_with("tyre.") ||
                        path.starts_with("machine.") || path.starts_with("effects.tyre") ||
                        path.starts_with("effects.progressive_tyre");
    tolerated = of_car ? part.tolerance.erase(tolerated) : std::next(tolerated);
  }
  part.rig.effects.for_each([](auto& slot) {
    if (!std::remove_cvref_t<decltype(slot.effect)>::card.rigs.contains(model::RigKind::component_bench))
      slot.active = false;
  });
  return part;
}

Channel drive_channel(model::RigKind kind) {
  return kind == model::RigKind::quarter_car ? Channel::z_cmd : Channel::x_cmd;
}

Rig with_corners(const Rig& rig, double share) {
  Rig smoothed = rig;
  if (share >= 1.0) return smoothed;
  smoothed.effects.for_each([share](auto& slot) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    if (!slot.active || Effect::card.corner == model::Corner::none) return;
    if (!(share > 0.0)) {
      slot.active = false;
      return;
    }
    // What pushes grows with the share; a clearance, a gap or a speed stays. Bounds of a card are physical, the share
    // of a number within them may lie below.
    for (std::size_t i = 0; i < Effect::values.size(); ++i) {
      const std::string_view unit = Effect::card.parameters[i].unit;
      const bool pushes = unit == "N" || unit == "N/m" || Effect::card.corner == model::Corner::free_play;
      double& value = slot.effect.*Effect::values[i];
      if (pushes) value = std::max(Effect::card.parameters[i].lower, share * value);
    }
  });
  return smoothed;
}

DriveModel::DriveModel(const firmware::RigDescription& description, std::vector<Channel> channels)
    : rig_(description.rig), period_(description.period()), channels_(std::move(channels)) {}

SimulationInput DriveModel::input_of(const std::vector<double>& drive) const {
  SimulationInput input;
  input.period = period_;
  input.channel = drive_channel(rig_.kind);
  input.motion = firmware::through_samples(drive, 1.0 / period_);
  return input;
}

DriveModel::Answer DriveModel::answer(const Rig& rig, const std::vector<double>& drive) const {
  Response response = this->response(rig, drive, channels_);
  Answer answer;
  for (const Channel channel : channels_) answer.push_back(std::move(response[index(channel)]));
  return answer;
}

DriveModel::Answer DriveModel::answer(const std::vector<double>& drive) const { return answer(rig_, drive); }

Response DriveModel::response(const Rig& rig, const std::vector<double>& drive,
                              const std::vector<Channel>& channels) const {
  const SimulationInput input = input_of(drive);
  return simulate(rig, input, resting(rig, input), 0, 1, channels);
}

Response DriveModel::response(const std::vector<double>& drive, const std::vector<Channel>& channels) const {
  return response(rig_, drive, channels);
}

std::vector<std::vector<std::complex<double>>> DriveModel::linear_response(std::size_t length) const {
  constexpr double decayed = 32.0;  // [s] a mode that decays with 0.5 1/s keeps 1e-7
  constexpr double height = 1e-6;   // [m] duct losses and laws are at their tangents
  const auto count = std::min(length, static_cast<std::size_t>(decayed / period_));
  const double width = 1.0 / (full_turn * 0.12 / period_);  // [s] of a bell whose spectrum has fallen to 0.1 at 0.25/h
  const double middle = 8.0 * width + 4.0 * period_;
  std::vector<double> pulse(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = (static_cast<double>(k) * period_ - middle) / width;
    pulse[k] = height * std::exp(-0.5 * x * x);
  }
  const Answer answers = answer(with_corners(rig_, 0.0), pulse);
  RealTransform transform(length);
  const auto in = transform(pulse);
  const std::vector<std::complex<double>> drive(in.begin(), in.end());
  const double largest = std::abs(drive.front());
  std::vector<std::vector<std::complex<double>>> responses;
  for (const auto& a : answers) {
    const auto bins = transform(a);
    std::vector<std::complex<double>> h(bins.size());
    for (std::size_t k = 0; k < h.size(); ++k) {
      if (std::abs(drive[k]) > 1e-3 * largest) h[k] = bins[k] / drive[k];
    }
    responses.push_back(std::move(h));
  }
  return responses;
}

}  // namespace host_sim::replicate
