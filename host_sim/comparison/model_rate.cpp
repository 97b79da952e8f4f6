#include "host_sim/comparison/model_rate.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/signal/interpolation.hpp"

namespace host_sim {

std::size_t model_steps_per_sample(double sample_period, double longest) {
  constexpr double margin = 0.05;
  return static_cast<std::size_t>(
      std::max(1.0, std::ceil(sample_period / std::max(longest, longest_model_step) - margin)));
}

bool is_stepped(const std::vector<double>& command) {
  std::size_t jumps = 0, moves = 0;
  for (std::size_t k = 1; k < command.size(); ++k) {
    if (command[k] == command[k - 1]) continue;
    ++moves;
    const bool still_before = k < 2 || command[k - 1] == command[k - 2];
    const bool still_behind = k + 1 >= command.size() || command[k + 1] == command[k];
    if (still_before && still_behind) ++jumps;
  }
  return jumps > 0 && 2 * jumps > moves;
}

double longest_step(model::RigKind kind, const firmware::Recording& recording) {
  constexpr double fastest = 30.0;  // [Hz] where longest_model_step is right
  if (kind != model::RigKind::component_bench || is_stepped(recording[model::Channel::x_cmd])) {
    return longest_model_step;
  }
  return longest_model_step * std::max(1.0, 2.0 * fastest * recording.sample_period);
}

firmware::Recording interpolated(const firmware::Recording& recording, std::size_t factor) {
  if (factor == 1 || recording.size() < 2) return recording;
  const std::size_t count = factor * (recording.size() - 1) + 1;
  firmware::Recording finer = recording.without_samples();
  finer.sample_period = recording.sample_period / static_cast<double>(factor);
  finer.time.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    finer.time[k] = recording.time[k / factor] + static_cast<double>(k % factor) * finer.sample_period;
  }
  const Interpolation interpolation(factor);
  for (std::size_t c = 0; c < finer.channels.size(); ++c) finer.channels[c] = interpolation(recording.channels[c]);
  const auto held = [&](const auto& values, auto& result) {
    if (values.empty()) return;
    result.resize(count);
    for (std::size_t k = 0; k < count; ++k) result[k] = values[k / factor];
  };
  const std::vector<double>& command = recording[model::Channel::x_cmd];
  if (is_stepped(command)) held(command, finer[model::Channel::x_cmd]);
  for (std::size_t j = 0; j < finer.ducts.size(); ++j) held(recording.ducts[j], finer.ducts[j]);
  held(recording.filled, finer.filled);
  for (std::size_t k = 0; k < finer.filled.size(); ++k) {
    const bool next = k % factor != 0 && recording.filled[k / factor + 1];
    finer.filled[k] = finer.filled[k] || next;
  }
  return finer;
}

}  // namespace host_sim
