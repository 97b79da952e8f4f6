#include "tests/truth/catalogue.hpp"

namespace truth {

const std::vector<Candidate>& rig_effects() {
  static const std::vector<Candidate> all{
      {"actuator_delay", "hb", {{"delay", 4e-3, 11e-3}}, "delay", 1, 1e-3, 15e-3, false, ""},
      {"actuator_lag", "hb", {{"time_constant", 2e-3, 8e-3}}, "time_constant", 1, 1e-3, 15e-3, false, ""},
      {"actuator_resonance",
       "hb",
       {{"frequency", 18, 40}, {"damping_ratio", 0.3, 0.8}},
       "frequency",
       -1,
       10,
       80,
       false,
       ""},
      {"actuator_rate_limit", "hb", {{"velocity", 0.2, 0.4}}, "velocity", -1, 0.05, 2, false, ""},
      {"coulomb_friction", "qhb", {{"force", 20, 80}}, "force", 1, 10, 250, false, ""},
      {"viscous_damping", "qhb", {{"damping", 80, 250}}, "damping", 1, 40, 600, false, ""},
      {"quadratic_damping", "qhb", {{"coefficient", 150, 800}}, "coefficient", 1, 50, 4000, false, ""},
      {"progressive_spring", "qhb", {{"cubic_stiffness", 5e6, 2e7}}, "cubic_stiffness", 1, 1e6, 2e8, true, ""},
      {"bump_stop",
       "qhb",
       {{"clearance", 5e-3, 12e-3}, {"stiffness", 3e4, 1.5e5}},
       "clearance",
       -1,
       2e-3,
       25e-3,
       false,
       ""},
      {"backlash", "qhb", {{"gap", 0.5e-3, 3e-3}}, "gap", 1, 0.3e-3, 5e-3, false, ""},
      {"top_mount", "qhb", {{"stiffness", 1.5e5, 5e5}}, "stiffness", -1, 6e4, 1e6, false, ""},
      {"relaxation",
       "qhb",
       {{"stiffness", 4e3, 1.5e4}, {"time_constant", 0.01, 0.1}},
       "stiffness",
       1,
       1e3,
       4e4,
       false,
       ""},
      {"seal_friction", "qhb", {{"force", 8, 40}}, "force", 1, 4, 150, false, ""},
      {"body_guide_friction", "q", {{"force", 15, 60}}, "force", 1, 5, 150, false, ""},
      {"wheel_guide_friction", "q", {{"force", 20, 80}}, "force", 1, 5, 200, false, ""},
      {"body_guide_damping", "q", {{"damping", 40, 200}}, "damping", 1, 10, 800, false, ""},
      {"wheel_guide_damping", "q", {{"damping", 30, 150}}, "damping", 1, 10, 600, false, ""},
      {"tyre_lift_off", "qh", {}, "", 1, 0, 0, false, ""},
      {"progressive_tyre", "qh", {{"cubic_stiffness", 1e9, 8e9}}, "cubic_stiffness", 1, 2e8, 3e10, true, ""},
      {"force_sensor_inertia", "q", {{"mass", 0.8, 6}}, "mass", 1, 0.2, 10, false, ""},
  };
  return all;
}

const std::vector<Candidate>& sensor_effects() {
  // gain: the parameter is what it differs from 1 by; offset: in noise rms; saturation: in rms of the channel.
  static const std::vector<Candidate> all{
      {"sensor_lag", "qhb", {{"time_constant", 1e-3, 6e-3}}, "time_constant", 1, 0.5e-3, 20e-3, false, ""},
      {"sensor_delay", "qhb", {{"delay", 1.5e-3, 8e-3}}, "delay", 1, 0.5e-3, 20e-3, false, ""},
      {"sensor_gain", "qhb", {{"gain", 0.06, 0.15}}, "gain", 1, 0.05, 0.4, true, ""},
      {"sensor_offset", "qhb", {{"offset", 4, 30}}, "offset", 1, 3, 300, true, ""},
      {"sensor_saturation", "qhb", {{"limit", 1.0, 1.8}}, "limit", -1, 0.5, 2.5, false, ""},
      {"sensor_hold", "qhb", {{"period", 4e-3, 12e-3}}, "period", 1, 2.5e-3, 30e-3, false, ""},
  };
  return all;
}

const std::vector<Candidate>& outside_effects() {
  static const std::vector<Candidate> all{
      {"fading_damping", "qhb", {{"fade", 0.12, 0.5}}, "fade", 1, 0.08, 0.8, false, "damping fades through the record"},
      {"stiffness_drift",
       "qhb",
       {{"stiffening", 0.06, 0.25}},
       "stiffening",
       1,
       0.03,
       0.5,
       false,
       "the spring gets stiffer through the record"},
      {"hysteresis",
       "qhb",
       {{"wen_force", 40, 150}, {"wen_stiffness", 3e4, 1.5e5}},
       "wen_force",
       1,
       10,
       400,
       false,
       "hysteresis of the Bouc-Wen kind in the component"},
      {"stribeck_friction",
       "qhb",
       {{"stribeck_force", 20, 60}, {"stribeck_excess", 20, 80}, {"stribeck_velocity", 0.02, 0.06}},
       "stribeck_excess",
       1,
       10,
       300,
       false,
       "friction that falls with velocity (Stribeck)"},
      {"cubic_damping",
       "qhb",
       {{"cubic_damping", 800, 5000}},
       "cubic_damping",
       1,
       100,
       2e4,
       false,
       "damping force with the cube of velocity"},
      {"asymmetric_damper",
       "qhb",
       {{"asymmetry", 0.15, 0.45}},
       "asymmetry",
       1,
       0.05,
       0.8,
       false,
       "a damper harder in compression than in rebound"},
      {"parasitic_mass",
       "qhb",
       {{"parasitic_mass", 1, 4}, {"parasitic_frequency", 16, 24}, {"parasitic_ratio", 0.03, 0.1}},
       "parasitic_mass",
       1,
       0.3,
       10,
       false,
       "a loose mass on the component, a second resonance"},
  };
  return all;
}

const std::vector<Candidate>& outside_sensors() {
  // hum and rounding in noise rms; gain drift over the record.
  static const std::vector<Candidate> all{
      {"mains_hum", "qb", {{"hum", 5, 20}}, "hum", 1, 4.5, 60, false, "50 Hz hum in a channel"},
      {"cross_talk",
       "q",
       {{"cross_talk", 0.03, 0.1}},
       "cross_talk",
       1,
       0.01,
       0.3,
       false,
       "the wheel's acceleration leaks into another channel"},
      {"jitter",
       "qb",
       {{"jitter", 3e-3, 8e-3}, {"jitter_frequency", 0.2, 0.7}},
       "jitter",
       1,
       1e-3,
       15e-3,
       false,
       "a channel is late by a time that comes and goes"},
      {"quantisation",
       "qb",
       {{"rounding", 12, 40}},
       "rounding",
       1,
       10.5,
       100,
       false,
       "a channel comes in coarse steps"},
      {"gain_drift",
       "qb",
       {{"gain_drift", 0.15, 0.5}},
       "gain_drift",
       1,
       0.1,
       0.9,
       false,
       "a sensor's gain drifts with its temperature"},
  };
  return all;
}

std::vector<std::string> suspects(Kind kind) {
  if (kind == Kind::quarter_car) return {"zdd_r", "zdd_w", "zdd_b", "F_w", "dz_w", "dz_b"};
  return {"x_act", "F"};
}

}  // namespace truth
