#include "tests/bench/replicate_rival/hidden_rig.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "firmware/simulation/road.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/replicate/drive_model.hpp"

namespace replicate_rival {
namespace {

using model::Channel;
constexpr double speed = 27.78;          // [m/s] over the road
constexpr double identify_up_to = 60.0;  // [Hz], above the band of the target

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()(double from, double to) {
    return from + (to - from) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  double logarithmic(double from, double to) { return from * std::pow(to / from, (*this)(0.0, 1.0)); }

 private:
  std::mt19937_64 engine_;  // its sequence is part of the C++ standard
};

std::string formatted(const char* format, double value) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::vector<double> positions(const firmware::FootPointMotion& motion) {
  std::vector<double> z;
  for (const auto& m : motion) z.push_back(m.position);
  return z;
}

std::vector<double> road_of(const HiddenRig& rig, double seconds, double bandwidth, std::uint64_t seed) {
  const firmware::IsoRoad road{.roughness = firmware::class_roughness(std::string(1, rig.road)),
                               .speed = speed,
                               .bandwidth = bandwidth,
                               .seed = seed};
  const double rate = rig.truth.sample_rate;
  return positions(firmware::drive_over(road, rate, static_cast<std::size_t>(seconds * rate)));
}

}  // namespace

HiddenRig draw_rig(std::uint64_t seed) {
  Uniform draw(seed);
  HiddenRig hidden;
  hidden.road = draw(0.0, 1.0) < 0.5 ? 'B' : 'C';
  const double friction = draw.logarithmic(20.0, 200.0), clearance = draw(6e-3, 20e-3);
  const bool play = draw(0.0, 1.0) < 0.5;
  const double gap = draw(0.2e-3, 0.6e-3), mount = draw.logarithmic(300e3, 1000e3);
  const double lag = draw(15e-3, 25e-3), delay = draw(3e-3, 6e-3);
  std::string text = firmware::read_rig(RIGTWIN_SOURCE_DIR "/host_sim/rigs/paper_rig_fdva.toml").text;
  text += formatted("\n[effects.actuator_delay]\ndelay = %.6g\n", delay) +
          formatted("[effects.actuator_lag]\ntime_constant = %.6g\n", lag) +
          formatted("[effects.coulomb_friction]\nforce = %.6g\n", friction) +
          formatted("[effects.bump_stop]\nclearance = %.6g\nstiffness = 200e3\n", clearance) +
          (play ? formatted("[effects.backlash]\ngap = %.6g\n", gap)
                : formatted("[effects.top_mount]\nstiffness = %.6g\n", mount)) +
          "[limits]\nspeed = 3.0\n[tolerance]\n";
  for (const char* path :
       {"body.mass", "wheel.mass", "tyre.stiffness", "tyre.damping", "suspension.stiffness", "suspension.damping",
        "fdva.piston_area", "fdva.duct_length", "fdva.oil_viscosity", "fdva.minor_loss", "fdva.coupling_stiffness",
        "effects.actuator_delay.delay", "effects.actuator_lag.time_constant", "effects.coulomb_friction.force",
        "effects.bump_stop.clearance", "effects.bump_stop.stiffness"})
    text += '"' + std::string(path) + "\" = 0.035\n";
  text += play ? "\"effects.backlash.gap\" = 0.035\n" : "\"effects.top_mount.stiffness\" = 0.035\n";
  hidden.described = firmware::parse_rig(text, "described.toml");
  hidden.truth = hidden.described;
  for (const auto& [path, bound] : hidden.described.tolerance) {
    const double off = draw(0.01, 0.03) * (draw(0.0, 1.0) < 0.5 ? -1.0 : 1.0);
    *firmware::find_parameter(hidden.truth.rig, path) *= 1.0 + off;
  }
  hidden.name = std::string(1, hidden.road) + formatted(", %.0f N", friction) +
                formatted(", stop %.1f mm", 1e3 * clearance) +
                (play ? formatted(", play %.1f mm", 1e3 * gap) : formatted(", mount %.0f kN/m", 1e-3 * mount));
  return hidden;
}

firmware::Recording target_of(const HiddenRig& rig, double seconds, std::uint64_t seed) {
  const auto road = road_of(rig, seconds, 30.0, seed);
  const host_sim::replicate::DriveModel truth(rig.truth, {Channel::zdd_w});
  firmware::Recording target;
  target.source = "target.csv";
  target.sample_period = rig.truth.period();
  target.time = firmware::sample_times(road.size(), rig.truth.sample_rate);
  target[Channel::zdd_w] = truth.answer(road).front();
  firmware::Gaussian noise(seed, 11);
  for (double& v : target[Channel::zdd_w]) v += rig.truth.noise[index(Channel::zdd_w)].value_or(0.0) * noise();
  return target;
}

std::vector<double> identifying_command(const HiddenRig& rig, double seconds, std::uint64_t seed) {
  return road_of(rig, seconds, identify_up_to, seed);
}

firmware::Recording run(const firmware::RigDescription& truth, const std::vector<double>& command, std::uint64_t seed) {
  host_sim::RunOptions options;
  options.seed = seed;
  host_sim::Run made = host_sim::run_closed_loop(truth, firmware::through_samples(command, truth.sample_rate), options);
  if (made.recording.size() < 2)
    throw firmware::InputError(truth.source, 0, "the rig stopped before its first sample", "a run");
  made.recording.source = "run.csv";
  return std::move(made.recording);
}

double share_at_stops(const HiddenRig& rig, double seconds, std::uint64_t seed) {
  const host_sim::replicate::DriveModel truth(rig.truth, {Channel::dz_b});
  firmware::RigDescription copy = rig.truth;
  const double clearance = *firmware::find_parameter(copy.rig, "effects.bump_stop.clearance");
  const auto deflection = truth.answer(road_of(rig, seconds, 30.0, seed)).front();
  std::size_t beyond = 0;
  for (const double d : deflection) beyond += std::abs(d) > clearance ? 1U : 0U;
  return static_cast<double>(beyond) / static_cast<double>(deflection.size());
}

}  // namespace replicate_rival
