#include "firmware/simulation/road.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/simulation/road_stream.hpp"
#include "model/components/road_filter.hpp"

namespace firmware {

double road_density(double roughness, double speed, double frequency, double cut_off) {
  constexpr double n0 = model::RoadFilter<double>::reference_wave_number;
  return roughness * n0 * n0 * speed / (frequency * frequency + cut_off * cut_off);
}

double class_roughness(std::string_view letter) {
  if (letter.size() == 1 && letter[0] >= 'A' && letter[0] <= 'H') {
    return 16e-6 * static_cast<double>(1U << (2U * static_cast<unsigned>(letter[0] - 'A')));
  }
  throw UsageError("unknown road class " + in_quotes(letter) + ", expected one of A, B, C, D, E, F, G, H");
}

double default_bandwidth(model::RigKind kind, double sample_rate) {
  return std::min(kind == model::RigKind::hil ? 100.0 : 30.0, 0.2 * sample_rate);
}

FootPointMotion drive_over(const IsoRoad& road, double sample_rate, std::size_t samples) {
  RoadStream stream(road, sample_rate);
  FootPointMotion motion(samples);
  for (auto& m : motion) m = stream.next();
  return motion;
}

namespace {

/// [N s/m] √(k m), the impedance of mass and spring at their resonance; without a spring m ω at 1 Hz.
double impedance(const model::RigParameters<double>& rig) {
  constexpr double one_hertz = 6.283185307179586;  // [rad/s]
  const double spring = std::sqrt(rig.suspension.stiffness * rig.body.mass);
  return std::max({spring, rig.suspension.damping, spring > 0.0 ? 0.0 : rig.body.mass * one_hertz});
}

/// (1) of excitation(): the force and, from its samples, its rate.
FootPointMotion force_over(const model::RigParameters<double>& rig, FootPointMotion road, double sample_rate) {
  std::vector<double> force;
  for (const auto& m : road) force.push_back(impedance(rig) * m.velocity);
  return through_samples(force, sample_rate);
}

}  // namespace

double default_bandwidth(const model::RigParameters<double>& rig, double sample_rate) {
  if (rig.kind != model::RigKind::driven_mass || !(rig.suspension.stiffness > 0.0)) {
    return default_bandwidth(rig.kind, sample_rate);
  }
  constexpr double around_the_resonance = 3.0 / 6.283185307179586;  // three times its frequency [Hz per rad/s]
  return std::min(around_the_resonance * std::sqrt(rig.suspension.stiffness / rig.body.mass), 0.2 * sample_rate);
}

FootPointMotion excitation(const model::RigParameters<double>& rig, FootPointMotion road, double sample_rate) {
  if (rig.kind == model::RigKind::driven_mass) return force_over(rig, std::move(road), sample_rate);
  if (rig.kind != model::RigKind::component_bench || road.empty()) return road;
  DeflectionStream deflection(rig, sample_rate);
  for (auto& m : road) m = deflection.next(m);
  return road;
}

FootPointMotion through_samples(const std::vector<double>& z, double sample_rate) {
  const std::size_t n = z.size();
  FootPointMotion motion(n);
  const double h = 1.0 / sample_rate;
  for (std::size_t k = 0; k < n; ++k) {
    model::Motion<double>& m = motion[k];
    m.position = z[k];
    if (n < 3) {
      m.velocity = n < 2 ? 0.0 : (z[1] - z[0]) / h;
    } else if (k >= 2 && k + 2 < n) {
      // Differences of neighbours first: a constant signal then has a velocity of exactly 0, and so no sign for
      // friction.
      m.velocity = (8.0 * (z[k + 1] - z[k - 1]) - (z[k + 2] - z[k - 2])) / (12.0 * h);
      const double near = (z[k + 1] - z[k]) - (z[k] - z[k - 1]), far = (z[k + 2] - z[k]) - (z[k] - z[k - 2]);
      m.acceleration = (16.0 * near - far) / (12.0 * h * h);
    } else {
      const std::size_t i = std::clamp<std::size_t>(k, 1, n - 2);  // parabola through the three nearest
      const double curvature = ((z[i + 1] - z[i]) - (z[i] - z[i - 1])) / (h * h);
      const double away = k < i ? -h : (k > i ? h : 0.0);
      m.velocity = (z[i + 1] - z[i - 1]) / (2.0 * h) + curvature * away;
      m.acceleration = curvature;
    }
  }
  return motion;
}

}  // namespace firmware
