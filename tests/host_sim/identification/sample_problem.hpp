// A small identification problem whose answer is known: a bench with a spring and a damper, made by the model itself.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"
#include "tests/support/reference_road.hpp"
#include "tests/support/rig_texts.hpp"

namespace sample {

inline constexpr double period = 1e-3, force_noise = 10.0, deflection_noise = 2e-5;

/// F = k x + b ẋ with declared noise, the stiffness tolerated by 5 %.
inline firmware::RigDescription bench() {
  firmware::RigDescription d = firmware::parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 30000.0\ndamping = 1000.0\n"
      "[noise]\nF = 10.0\nx_act = 2e-5\n[tolerance]\n'suspension.stiffness' = 0.05\n",
      "bench.toml");
  return d;
}

/// What a rig answers to 0.7, 2.3 and 11 Hz on x_cmd, with noise of the declared size.
inline firmware::Recording recorded(const firmware::RigDescription& truth, double seconds = 8.0,
                                    std::uint64_t seed = 5) {
  firmware::Recording r;
  r.sample_period = period;
  r.source = "sample.csv";
  const auto n = static_cast<std::size_t>(seconds / period);
  r.time = firmware::sample_times(n, 1.0 / period);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = period * static_cast<double>(k), pi2 = 2.0 * std::numbers::pi;
    r[model::Channel::x_cmd].push_back(8e-3 * std::sin(pi2 * 0.7 * t) + 4e-3 * std::sin(pi2 * 2.3 * t) +
                                       1e-3 * std::sin(pi2 * 11.0 * t));
  }
  const host_sim::SimulationInput input = host_sim::simulation_input(truth.rig, r);
  const host_sim::Response response = host_sim::simulate(truth.rig, input, host_sim::resting(truth.rig, input));
  support::NormalNoise noise(seed);
  for (std::size_t k = 0; k < n; ++k) {
    r[model::Channel::x_act].push_back(response[index(model::Channel::x_act)][k] + deflection_noise * noise());
    r[model::Channel::F].push_back(response[index(model::Channel::F)][k] + force_noise * noise());
  }
  return r;
}

/// The description against recordings of a rig that may differ from it.
inline std::vector<host_sim::identification::PreparedRecording> prepared(
    const firmware::RigDescription& description, const firmware::RigDescription& truth,
    host_sim::identification::Use use = host_sim::identification::Use::shared, double seconds = 8.0) {
  std::vector<host_sim::identification::PreparedRecording> list;
  list.push_back(host_sim::identification::prepare_recording(description, recorded(truth, seconds), use, false));
  return list;
}

inline firmware::RigDescription with_effect(firmware::RigDescription description, const char* name,
                                            std::vector<double> values,
                                            std::optional<model::Channel> channel = std::nullopt) {
  firmware::put_effect(description.rig, {firmware::find_effect(name), channel, std::move(values)});
  return description;
}

}  // namespace sample
