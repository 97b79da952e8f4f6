// A spring on a bench and the quarter car it is carried to: a pair whose responses have closed forms.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/transfer/posterior/posterior.hpp"
#include "host_sim/transfer/predict/second_rig.hpp"

namespace linear_pair {

inline constexpr double rate = 1000.0, stiffness = 31500.0, own_damping = 1140.0, body_mass = 290.0, wheel_mass = 40.0,
                        tyre_stiffness = 200e3, tyre_damping = 100.0;

/// The spring on its bench; noise of F [N].
inline firmware::RigDescription bench(const std::string& more = "", double noise = 10.0) {
  return firmware::parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 31500.0\ndamping = 0.0\n[noise]\nF "
      "= " +
          std::to_string(noise) + "\n[limits]\nspeed = 1.5\n" + more,
      "bench.toml");
}

/// The car, with a damper of its own beside the spring.
inline firmware::RigDescription car(const std::string& more = "") {
  return firmware::parse_rig(
      "kind = 'quarter_car'\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\n"
      "stiffness = 200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n" +
          more,
      "car.toml");
}

inline firmware::FootPointMotion road(const firmware::RigDescription& rig, double seconds, std::uint64_t seed = 5) {
  firmware::IsoRoad iso;
  iso.seed = seed;
  iso.bandwidth = 30.0;
  return firmware::excitation(
      rig.rig, firmware::drive_over(iso, rig.sample_rate, static_cast<std::size_t>(seconds * rig.sample_rate)),
      rig.sample_rate);
}

/// What the bench records on such a road.
inline firmware::Recording recorded(const firmware::RigDescription& rig, double seconds, std::uint64_t seed = 5) {
  host_sim::RunOptions options;
  options.seed = seed;
  host_sim::Run run = host_sim::run_closed_loop(rig, road(rig, seconds, seed), options);
  run.recording.source = "bench.csv";
  return std::move(run.recording);
}

/// The identification problem of a recording, all of it fitted.
struct Problem {
  host_sim::identification::IdentificationProblem problem;
  host_sim::identification::SearchSpace space;
  host_sim::identification::Hypothesis given;
};
inline Problem problem_of(const firmware::RigDescription& rig, firmware::Recording recording) {
  namespace id = host_sim::identification;
  std::vector<id::Record> records;
  records.push_back({std::move(recording), id::Use::fitted});
  id::PreparedData data = id::prepare(rig, std::move(records));
  const id::Hypothesis given = id::described_hypothesis(rig, data.recordings);
  id::IdentificationProblem problem(std::move(data.recordings), given);
  id::SearchSpace space = id::search_space(rig, problem.samples(), given);
  return {std::move(problem), std::move(space), given};
}

/// A posterior that is one point: the component as described.
inline host_sim::transfer::Posterior known(const firmware::RigDescription& from) {
  host_sim::transfer::ComponentModel model;
  model.hypothesis = {from.rig, {}};
  model.draws.resize(0, 1);
  host_sim::transfer::Posterior posterior;
  posterior.models.push_back(std::move(model));
  return posterior;
}

/// Motion and wheel load for an input of 1, at frequency f [Hz]:
///
///   (1)  −ω² m_w z_w = (k_t + iω b_t)(z_r − z_w) − F,   −ω² m_b z_b = F,   F = (k + iω b)(z_w − z_b) + F_extra
struct CarResponse {
  std::complex<double> load, body, stroke;  ///< F_w, z̈_b, dz_b
};
inline CarResponse car_response(double f, double z_r, double extra_force, double k = stiffness) {
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f), tyre = tyre_stiffness + s * tyre_damping,
                                                                 spring = k + s * own_damping;
  // Two equations in z_w and z_b, by Cramer's rule.
  const std::complex<double> a = wheel_mass * s * s + tyre + spring, b = -spring, c = -spring,
                             d = body_mass * s * s + spring, right1 = tyre * z_r - extra_force, right2 = extra_force,
                             determinant = a * d - b * c;
  const std::complex<double> z_w = (right1 * d - b * right2) / determinant,
                             z_b = (a * right2 - right1 * c) / determinant;
  return {tyre * (z_r - z_w), s * s * z_b, z_w - z_b};
}

}  // namespace linear_pair
