// Rigs that the stability tests share.
#pragma once

#include <cmath>
#include <complex>
#include <random>

#include "firmware/description/rig_description.hpp"
#include "model/rig/rig_parameters.hpp"

namespace stability_tests {

using Rig = model::RigParameters<double>;
using Complex = std::complex<double>;

/// Eqs. (1)–(3) with Table 1 of the paper.
inline Rig linear_rig(double delay = 0.010, double virtual_damping = 0.0) {
  Rig rig;
  rig.kind = model::RigKind::hil;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, 1140.0};
  rig.machine.virtual_damping = virtual_damping;
  if (delay > 0.0) rig.effects.add(model::ActuatorDelay<double>{delay});
  return rig;
}

/// The reference FDVA, two ducts open.
inline Rig fdva_rig(double delay = 0.010, double virtual_damping = 1140.0) {
  Rig rig = linear_rig(delay, virtual_damping);
  rig.suspension.damping = 0.0;
  rig.has_fdva = true;
  rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

/// The air spring of paper_hil_aas.toml in place of the linear component.
inline Rig air_spring_rig(double delay, double virtual_damping, double skyhook) {
  Rig rig = linear_rig(delay, virtual_damping);
  rig.suspension = {};
  rig.air_spring.fitted = true;
  rig.air_spring.pressure = 7e5;
  rig.air_spring.area = 40.64e-4;
  rig.air_spring.volume = 0.588e-3;
  rig.air_spring.skyhook = skyhook;
  return rig;
}

inline firmware::RigDescription described(const Rig& rig, double sample_rate = 1000.0) {
  firmware::RigDescription description;
  description.rig = rig;
  description.sample_rate = sample_rate;
  description.source = "test rig";
  return description;
}

/// A rig near the reference ones, with or without FDVA, any number of ducts open, effects with a linear part or none.
inline Rig random_rig(unsigned seed, bool with_effects) {
  std::mt19937_64 random(seed);
  const auto factor = [&] { return std::exp(std::uniform_real_distribution<double>(-0.7, 0.7)(random)); };
  const auto chance = [&] { return std::uniform_real_distribution<double>(0.0, 1.0)(random); };
  Rig rig = chance() < 0.4 ? linear_rig() : fdva_rig();
  rig.body.mass *= factor();
  rig.wheel.mass *= factor();
  rig.tyre.stiffness *= factor();
  rig.tyre.damping *= factor();
  rig.suspension.stiffness *= factor();
  rig.suspension.damping *= factor();
  rig.machine.virtual_damping = 2000.0 * chance();
  if (rig.has_fdva) {
    rig.fdva.coupling_stiffness *= factor();
    rig.fdva.duct_length *= factor();
    rig.fdva.open_ducts = std::uniform_int_distribution<int>(0, 6)(random);
  }
  rig.effects.add(model::ActuatorDelay<double>{0.02 * chance()});
  if (!with_effects) return rig;
  if (chance() < 0.5) rig.effects.add(model::ActuatorLag<double>{0.003 * chance() + 1e-4});
  if (chance() < 0.5) rig.effects.add(model::ActuatorResonance<double>{40.0 + 60.0 * chance(), 0.2 + chance()});
  if (chance() < 0.5) rig.effects.add(model::Relaxation<double>{20e3 * chance(), 0.02 * chance() + 1e-3});
  if (chance() < 0.3) rig.effects.add(model::TopMount<double>{3e5 * factor()});
  if (chance() < 0.5) rig.effects.add(model::ViscousDamping<double>{300.0 * chance()});
  if (chance() < 0.5) rig.effects.add(model::Channel::F, model::SensorLag<double>{0.002 * chance() + 1e-4});
  if (chance() < 0.5) rig.effects.add(model::Channel::F, model::SensorDelay<double>{0.003 * chance()});
  if (chance() < 0.5) rig.effects.add(model::Channel::F, model::SensorGain<double>{0.8 + 0.4 * chance()});
  return rig;
}

/// K(s) of the component by hand (physics, section 5; relaxation and top mount from the catalogue).
inline Complex component_by_hand(const Rig& rig, Complex s) {
  Complex k = rig.suspension.stiffness + rig.suspension.damping * s;
  if (const auto& extra = rig.effects.get<model::ViscousDamping>(); extra.active) k += extra.effect.damping * s;
  if (rig.has_fdva) {
    const double k_c = rig.fdva.coupling_stiffness;
    if (rig.fdva.open_ducts == 0) {
      k += k_c;
    } else {
      const double pi = 3.14159265358979323846, n = rig.fdva.open_ducts, d = rig.fdva.duct_diameter;
      const double a = pi * d * d / 4.0, area = rig.fdva.piston_area, rho = rig.fdva.oil_density;
      const double b = rho * rig.fdva.duct_length * area * area / (n * a);
      const double c =
          128.0 * rho * rig.fdva.oil_viscosity * rig.fdva.duct_length / (pi * d * d * d * d) * area * area / n;
      const Complex z = b * s * s + c * s;
      k += k_c * z / (k_c + z);
    }
  }
  if (const auto& r = rig.effects.get<model::Relaxation>(); r.active) {
    k += r.effect.stiffness * r.effect.time_constant * s / (1.0 + r.effect.time_constant * s);
  }
  if (const auto& m = rig.effects.get<model::TopMount>(); m.active) {
    k = k * m.effect.stiffness / (k + m.effect.stiffness);
  }
  return k;
}

/// S M without the delays, by hand.
inline Complex path_by_hand(Rig rig, Complex s) {
  Complex path = 1.0;
  if (const auto& lag = rig.effects.get<model::ActuatorLag>(); lag.active) path /= 1.0 + lag.effect.time_constant * s;
  if (const auto& r = rig.effects.get<model::ActuatorResonance>(); r.active) {
    const double omega = 2.0 * 3.14159265358979323846 * r.effect.frequency;
    path *= omega * omega / (s * s + 2.0 * r.effect.damping_ratio * omega * s + omega * omega);
  }
  if (const auto& lag = rig.effects.get<model::SensorLag>(model::Channel::F); lag.active) {
    path /= 1.0 + lag.effect.time_constant * s;
  }
  if (const auto& gain = rig.effects.get<model::SensorGain>(model::Channel::F); gain.active) path *= gain.effect.gain;
  return path;
}

/// Determinant (m_b s² + D)(m_w s² + b_t s + k_t + D) − D² of physics, section 5, over m_b m_w.
inline Complex characteristic_by_hand(const Rig& rig, Complex s, double delay) {
  const Complex d =
      component_by_hand(rig, s) * path_by_hand(rig, s) * std::exp(-s * delay) + rig.machine.virtual_damping * s;
  const double m_b = rig.body.mass, m_w = rig.wheel.mass;
  return ((m_b * s * s + d) * (m_w * s * s + rig.tyre.damping * s + rig.tyre.stiffness + d) - d * d) / (m_b * m_w);
}

}  // namespace stability_tests
