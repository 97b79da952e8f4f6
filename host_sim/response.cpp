#include "host_sim/response.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "host_sim/input_error.hpp"

namespace host_sim {
namespace {

using model::Channel;
using model::RigKind;
using Rig = model::RigParameters<double>;

/// Without the machine: what is known to have been reached needs no machine.
Rig without_machine(Rig rig) {
  rig.effects.for_each([](auto& slot) {
    if (std::remove_cvref_t<decltype(slot.effect)>::card.place == model::Place::machine) slot.active = false;
  });
  return rig;
}

/// Between two samples, where the model has it (model::hermite); its z̈ is the measured one, straight between.
model::Motion<double> between(const model::Motion<double>& from, const model::Motion<double>& to, double share,
                              double period) {
  const auto [position, velocity] =
      model::hermite<double>({from.position, from.velocity}, {to.position, to.velocity}, share, period);
  return {position, velocity, from.acceleration + share * (to.acceleration - from.acceleration)};
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// Measured channels that can tell a start: not constant, answered by the model.
std::vector<Channel> telling_channels(const Rig& rig, const Drive& drive, const Recording& recording) {
  std::vector<Channel> channels;
  for (const Channel channel : response_channels(rig.kind, drive)) {
    if (recording.has(channel) && rms(recording[channel]) > 0.0) channels.push_back(channel);
  }
  return channels;
}

}  // namespace

Drive drive_of(const Rig& rig, const Recording& recording) {
  Drive drive;
  drive.period = recording.sample_period;
  const double rate = 1.0 / drive.period;
  if (rig.kind == RigKind::component_bench) {
    drive.deflection_reached = recording.has(Channel::x_act) && !recording.has(Channel::x_cmd);
    drive.channel = drive.deflection_reached ? Channel::x_act : Channel::x_cmd;
    drive.motion =
        through_samples(recording.required(drive.channel, "drives the simulation of a component_bench"), rate);
  } else {
    drive.motion = through_samples(recording.required(Channel::z_r, "drives the simulation"), rate);
    if (recording.has(Channel::zdd_r)) {
      for (std::size_t k = 0; k < drive.size(); ++k) drive.motion[k].acceleration = recording[Channel::zdd_r][k];
    }
    if (recording.has(Channel::F_act)) drive.actuator_force = recording[Channel::F_act];
  }
  if (rig.has_fdva) {
    bool recorded = false;
    std::vector<model::OpenDucts> ducts(recording.size(), model::first_ducts(rig.fdva.open_ducts));
    for (std::size_t j = 0; j < recorded_ducts; ++j) {
      const auto& column = recording.ducts[j];
      if (column.empty()) continue;
      recorded = true;
      for (std::size_t k = 0; k < column.size(); ++k) {
        const auto bit = static_cast<model::OpenDucts>(1U << j);
        ducts[k] = static_cast<model::OpenDucts>(column[k] > 0.5 ? ducts[k] | bit : ducts[k] & ~bit);
        if ((ducts[k] >> rig.fdva.ducts) != 0) {
          throw InputError(recording.source, 0, "duct_" + std::to_string(j + 1) + " is open",
                           "at most the " + std::to_string(rig.fdva.ducts) + " ducts of the rig description");
        }
      }
    }
    if (recorded) drive.ducts = std::move(ducts);
  }
  return drive;
}

std::vector<Channel> response_channels(RigKind kind, const Drive& drive) {
  switch (kind) {
    case RigKind::quarter_car:
      return {Channel::z_w, Channel::z_b, Channel::zdd_w, Channel::zdd_b, Channel::dz_w, Channel::dz_b, Channel::F_w};
    case RigKind::hil:
      return {Channel::z_w,  Channel::z_b, Channel::zdd_w, Channel::zdd_b, Channel::dz_w,
              Channel::dz_b, Channel::F_w, Channel::x_cmd, Channel::x_act, Channel::F};
    case RigKind::component_bench:
      break;
  }
  if (drive.deflection_reached) return {Channel::F};
  return {Channel::x_act, Channel::F};
}

InitialState resting(const Rig& rig, const Drive& drive) {
  InitialState start = InitialState::Zero();
  const double first = drive.motion.empty() ? 0.0 : drive.motion.front().position;
  if (rig.kind == RigKind::component_bench) {
    start(4) = first;
  } else {
    start(0) = start(2) = first;
  }
  return start;
}

Response respond(const Rig& rig, const Drive& drive, const InitialState& start, std::size_t samples, int parts) {
  const bool bench = rig.kind == RigKind::component_bench;
  const model::RigModel<> model(drive.deflection_reached ? without_machine(rig) : rig, drive.period / parts);
  const std::size_t count = samples == 0 ? drive.size() : std::min(samples, drive.size());
  const std::vector<Channel> channels = response_channels(rig.kind, drive);
  Response response;
  for (const Channel channel : channels) response[index(channel)].resize(count);
  if (count == 0) return response;

  const auto& first = drive.motion.front();
  model::MachinePath<double> machine{};
  model.parameters().effects.act_on(machine);
  model::Stroke<double> reached{start(0) - start(2), start(1) - start(3)};
  if (bench) reached = {first.position, first.velocity};
  reached.position -= reached.velocity * machine.delay;
  auto x = model.start(start, first, reached);
  if (!drive.actuator_force.empty()) x.actuator_force = drive.actuator_force.front();

  for (std::size_t k = 0;; ++k) {
    const auto measured = model.measured(x);
    for (const Channel channel : channels) response[index(channel)][k] = measured[index(channel)];
    if (k + 1 == count) return response;
    if (!drive.ducts.empty() && drive.ducts[k] != x.ducts.open()) model.open_ducts(x, drive.ducts[k]);
    const auto& next = drive.motion[k + 1];
    const double actuator_force = drive.actuator_force.empty() ? 0.0 : drive.actuator_force[k + 1];
    for (int part = 1; part < parts; ++part) {
      const double share = static_cast<double>(part) / parts;
      const model::Motion<double> inside = between(drive.motion[k], next, share, drive.period);
      model.step(x, {.foot_point = inside,
                     .command = {inside.position, inside.velocity},
                     .actuator_force = x.actuator_force + (actuator_force - x.actuator_force) / (parts - part + 1)});
    }
    model.step(x, {.foot_point = next, .command = {next.position, next.velocity}, .actuator_force = actuator_force});
  }
}

bool begins_at_rest(const Rig& rig, const Drive& drive, const Recording& recording) {
  constexpr std::size_t beginning = 10;
  const InitialState start = resting(rig, drive);
  const Response quiet = respond(rig, drive, start, 1);
  for (const Channel channel : telling_channels(rig, drive, recording)) {
    const auto& data = recording[channel];
    const double allowed = 0.05 * rms(data);
    const double still = quiet[index(channel)].front();
    for (std::size_t k = 0; k < std::min(beginning, data.size()); ++k) {
      if (std::abs(data[k] - still) > allowed) return false;
    }
  }
  return true;
}

InitialState estimated_start(const Rig& rig, const Drive& drive, const Recording& recording,
                             const MeasuringRanges& range) {
  constexpr double window = 3.0;  // [s]: two periods of a body mode at 1.5 Hz decide position and velocity of the body
  const auto samples =
      std::max<std::size_t>(10, std::min(drive.size(), static_cast<std::size_t>(window / drive.period)));
  const std::vector<Channel> channels = telling_channels(rig, drive, recording);
  const bool bench = rig.kind == RigKind::component_bench;
  std::vector<int> unknowns;
  if (!bench) unknowns = {0, 1, 2, 3};
  if (rig.has_fdva && rig.fdva.open_ducts > 0) unknowns.insert(unknowns.end(), {4, 5});

  // Scale of each unknown: that of the motion, so that a finite difference sees it.
  double size = 0.0;
  for (const auto& m : drive.motion) size = std::max(size, std::abs(m.position));
  const double rate = 10.0;  // [1/s], of a body mode: velocities are about this times displacements
  InitialState start = resting(rig, drive);
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  for (int iteration = 0; iteration < 2 && n > 0 && size > 0.0; ++iteration) {
    const Response base = respond(rig, drive, start, samples);
    std::vector<Response> moved;
    std::vector<double> steps;
    for (const int u : unknowns) {
      const double step = 1e-4 * size * (u % 2 == 1 ? rate : 1.0);
      InitialState other = start;
      other(u) += step;
      moved.push_back(respond(rig, drive, other, samples));
      steps.push_back(step);
    }
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd slope(n);
    for (const Channel channel : channels) {
      const double weight = 1.0 / rms(recording[channel]);
      for (std::size_t k = 0; k < std::min(samples, drive.size()); ++k) {
        if (range[index(channel)] && !range[index(channel)]->holds(recording[channel][k])) continue;
        const double simulated = base[index(channel)][k];
        for (Eigen::Index i = 0; i < n; ++i) {
          const auto at = static_cast<std::size_t>(i);
          slope(i) = weight * (moved[at][index(channel)][k] - simulated) / steps[at];
        }
        normal.noalias() += slope * slope.transpose();
        right += slope * (weight * (recording[channel][k] - simulated));
      }
    }
    const Eigen::VectorXd change = normal.ldlt().solve(right);
    if (!change.allFinite()) break;
    for (Eigen::Index i = 0; i < n; ++i) start(unknowns[static_cast<std::size_t>(i)]) += change(i);
  }
  return start;
}

}  // namespace host_sim
