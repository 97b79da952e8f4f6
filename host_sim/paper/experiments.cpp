#include "host_sim/paper/experiments.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/description/text/run_stopped.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/report/embedded_files.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/report/figures.hpp"

namespace host_sim::paper {
namespace {

using stability::Axis;
using stability::LoopFamily;

constexpr double wheel_hz = 13.0;  // about: where to look for the wheel's root

firmware::RigDescription shipped(const std::string& name) { return firmware::parse_rig(embedded_file(name), name); }

Complex nearest_to_wheel(const std::vector<Complex>& roots) {
  const Complex target(0.0, full_turn * wheel_hz);
  return *std::min_element(roots.begin(), roots.end(),
                           [&](Complex a, Complex b) { return std::abs(a - target) < std::abs(b - target); });
}

Loop loop_of(std::string name, const firmware::RigDescription& description) {
  Loop loop{std::move(name), description, stability::analyse(description), {}, {}};
  loop.nyquist = stability::nyquist(loop.analysis.equation(), loop.analysis.roots.roots);
  loop.wheel_root = nearest_to_wheel(loop.analysis.roots.roots);
  return loop;
}

WheelRootPath wheel_path(std::string name, const firmware::RigDescription& description, Axis axis, double given) {
  constexpr double line = -80.0;
  const LoopFamily family(description.rig, description.delay_budget.sum());
  const stability::PoleSweep sweep = stability::pole_sweep(family, axis, line);
  std::size_t start = 0;
  for (std::size_t i = 0; i < axis.count; ++i) {
    if (std::abs(axis.value(i) - given) < std::abs(axis.value(start) - given)) start = i;
  }
  return {std::move(name), axis, stability::followed(sweep, start, nearest_to_wheel(sweep.roots[start]))};
}

firmware::RigDescription without_delay(firmware::RigDescription description) {
  description.rig.effects.get<model::ActuatorDelay>().active = false;
  return description;
}

/// A run over a class B road at 100 km/h.
Run drive(const firmware::RigDescription& description, firmware::SimulatedRig::Noise noise) {
  firmware::IsoRoad road;
  road.bandwidth = firmware::default_bandwidth(description.rig.kind, description.sample_rate);
  const auto samples = static_cast<std::size_t>(std::lround(road_run_seconds * description.sample_rate));
  RunOptions options;
  options.noise = noise;
  Run run = run_closed_loop(description, firmware::drive_over(road, description.sample_rate, samples), options);
  if (firmware::is_fault(run.trip.reason)) {
    throw firmware::RunStopped(description.source +
                               ": the firmware stopped the run: " + std::string(firmware::name(run.trip.reason)));
  }
  return run;
}

TransferEstimate from_road(const Run& run, const std::vector<double>& output, double sample_rate) {
  constexpr std::size_t segment = 8192;  // 0.12 Hz: the wheel's resonance is some 0.5 Hz wide
  return transfer_estimate(run.recording[model::Channel::z_r], output, sample_rate, segment, 0.5, 25.0, 90);
}

RoadRun hil_run(std::string name, const firmware::RigDescription& description) {
  const Run run = drive(description, firmware::SimulatedRig::Noise::none);
  return {std::move(name), from_road(run, run.recording[model::Channel::F_w], description.sample_rate),
          from_road(run, run.recording[model::Channel::zdd_b], description.sample_rate)};
}

RoadRun quarter_car_run(std::string name, const firmware::RigDescription& description,
                        firmware::SimulatedRig::Noise noise) {
  const Run run = drive(description, noise);
  const auto soft = std::find_if(run.recording.extra.begin(), run.recording.extra.end(),
                                 [](const firmware::ExtraColumn& c) { return c.name == "F_w_c"; });
  if (soft == run.recording.extra.end()) throw std::logic_error("a quarter-car run without its soft sensor");
  return {std::move(name), from_road(run, run.recording[model::Channel::F_w], description.sample_rate),
          from_road(run, soft->values, description.sample_rate)};
}

constexpr double kick_height = 0.5e-3;  // [m]: small, so that linear analysis can be held against the run
constexpr double kick_time = 0.08;      // [s]: its spectrum ends beyond the wheel's frequency
constexpr double kick_at = 0.2;         // [s]
constexpr double kicked_seconds = 6.0;

/// z = h/2 (1 − cos 2πt/T): a bump with smooth ends.
firmware::FootPointMotion bump(double sample_rate) {
  firmware::FootPointMotion motion(static_cast<std::size_t>(std::lround(kicked_seconds * sample_rate)));
  const double omega = full_turn / kick_time;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double t = static_cast<double>(i) / sample_rate - kick_at;
    if (t < 0.0 || t > kick_time) continue;
    motion[i] = {0.5 * kick_height * (1.0 - std::cos(omega * t)), 0.5 * kick_height * omega * std::sin(omega * t),
                 0.5 * kick_height * omega * omega * std::cos(omega * t)};
  }
  return motion;
}

KickedRun kicked(const Loop& loop) {
  firmware::RigDescription description = loop.description;
  description.controller.energy_gain =
      1e9;  // left to itself: the energy guard would end a growing loop too soon to be seen
  RunOptions options;
  options.noise = firmware::SimulatedRig::Noise::none;
  Run run = run_closed_loop(description, bump(description.sample_rate), options);
  KickedRun result;
  result.name = loop.name;
  result.time = run.recording.time;
  result.deflection = run.recording[model::Channel::x_act];
  result.wheel_acceleration = run.recording[model::Channel::zdd_w];
  result.trip = run.trip;
  if (loop.analysis.sampled) {
    const double period = loop.analysis.sampled->period;
    std::vector<Complex> continuous;
    for (const Complex z : loop.analysis.sampled->eigenvalues) {
      if (std::abs(z) > 1e-9) continuous.push_back(std::log(z) / period);
    }
    result.predicted = nearest_to_wheel(continuous).real();
  }
  // The wheel's own motion, from when the kick is over for a second: later what is left of a fast decay is the body's.
  const auto from = static_cast<std::size_t>((kick_at + kick_time + 0.1) * description.sample_rate);
  const auto length = std::min(result.time.size() - from, static_cast<std::size_t>(0.9 * description.sample_rate));
  if (result.time.size() > from) {
    result.measured = growth_rate(std::span(result.wheel_acceleration).subspan(from, length), description.sample_rate,
                                  static_cast<std::size_t>(0.15 * description.sample_rate));
  }
  return result;
}

WheelLoadGrowth wheel_load_growth(const Loop& loop) {
  const auto& a = loop.analysis;
  const stability::RoadResponse late(a.rig, a.delay, a.machine_delay), ideal(a.rig, 0.0, 0.0);
  const auto with = stability::peak(late, model::Channel::F_w, 0.1, 100.0);
  const auto without = stability::peak(ideal, model::Channel::F_w, 0.1, 100.0);
  return {with.magnitude / without.magnitude, with.frequency_hz, without.frequency_hz,
          with.magnitude / std::abs(ideal(model::Channel::F_w, full_turn * with.frequency_hz))};
}

/// The quarter car as a hil loop without delay and without virtual damping: the same equations.
stability::LinearRig as_loop(const firmware::RigDescription& quarter_car) {
  model::RigParameters<double> rig = quarter_car.rig;
  rig.kind = model::RigKind::hil;
  rig.effects = {};
  return stability::linearise(rig);
}

}  // namespace

Experiments experiment(const std::function<void(double)>& progress) {
  const auto done = [&](double share) {
    if (progress) progress(share);
  };
  const firmware::RigDescription linear = shipped("paper_linear.toml"), absorber = shipped("paper_hil_fdva.toml");
  firmware::RigDescription at_700 = absorber;
  at_700.rig.machine.virtual_damping = reported_unstable_damping;
  Experiments e;
  e.linear = loop_of("Eqs. (1)–(3), Table 1", linear);
  e.absorber = loop_of("FDVA, b̃ = 1140 N s/m", absorber);
  e.absorber_at_700 = loop_of("FDVA, b̃ = 700 N s/m", at_700);
  done(0.1);

  const Axis damping_axis{"virtual_damping", 0.0, 2000.0, 201}, delay_axis{"tau", 0.0, 0.030, 151};
  const auto given = [](const Loop& loop) { return loop.description.rig.machine.virtual_damping; };
  for (const Loop* loop : {&e.linear, &e.absorber}) {
    e.over_damping.push_back(
        wheel_path(loop == &e.linear ? "linear component" : "FDVA", loop->description, damping_axis, given(*loop)));
  }
  for (const Loop* loop : {&e.linear, &e.absorber, &e.absorber_at_700}) {
    e.over_delay.push_back(wheel_path(loop->name, loop->description, delay_axis, loop->analysis.delay));
  }
  e.map = stability::stability_map(LoopFamily(absorber.rig, absorber.delay_budget.sum()), {"tau", 0.0, 0.030, 121},
                                   {"virtual_damping", 0.0, 2000.0, 121});
  done(0.3);

  const auto& a = e.absorber.analysis;
  e.frequency_hz = stability::frequencies(0.3, 50.0, 500, a.roots.roots);
  e.late = stability::bode(a.rig, a.delay, a.machine_delay, e.frequency_hz);
  e.ideal = stability::bode(a.rig, 0.0, 0.0, e.frequency_hz);
  e.growth = wheel_load_growth(e.absorber);
  e.late_run = hil_run("10 ms", absorber);
  done(0.45);
  e.ideal_run = hil_run("no delay", without_delay(absorber));
  done(0.6);
  for (const Loop* loop : {&e.linear, &e.absorber, &e.absorber_at_700}) e.kicks.push_back(kicked(*loop));

  e.quarter_car = shipped("paper_rig_fdva.toml");
  e.quarter_car_true = stability::bode(as_loop(e.quarter_car), 0.0, 0.0, e.frequency_hz);
  e.rig_run = quarter_car_run("rig", e.quarter_car, firmware::SimulatedRig::Noise::as_described);
  done(0.8);
  firmware::RigDescription ideal = e.quarter_car;
  ideal.rig.effects.get<model::ForceSensorInertia>().active = false;
  e.simulated_run = quarter_car_run("simulation", ideal, firmware::SimulatedRig::Noise::none);

  const auto& f = absorber.rig.fdva;
  const double area = 0.25 * std::numbers::pi * f.duct_diameter * f.duct_diameter;
  const double inertance =
      f.oil_density * f.duct_length * f.piston_area * f.piston_area / (static_cast<double>(f.open_ducts) * area);
  e.absorber_hz = std::sqrt(f.coupling_stiffness / inertance) / full_turn;
  done(1.0);
  return e;
}

}  // namespace host_sim::paper
