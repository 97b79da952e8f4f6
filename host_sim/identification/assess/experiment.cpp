#include "host_sim/identification/assess/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "firmware/recording/recording.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/common/multisine.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using model::RigKind;

struct Experiment {
  std::string words;
  double level = 1.0;
  std::optional<int> open_ducts{};
  std::optional<Band> band{};
  std::optional<Channel> sensor{};
  std::optional<RigKind> rig{};
};

SimulationInput changed(SimulationInput input, const Experiment& experiment) {
  if (experiment.band) {
    const MotionSize before = size_of(input.motion);
    input.motion = multisine(*experiment.band, input.period, input.size());
    const MotionSize after = size_of(input.motion);
    if (after.velocity > 0.0 && after.travel > 0.0) {
      scale(input.motion,
            std::min(before.velocity / after.velocity, thresholds::most_travel * before.travel / after.travel));
    }
  }
  scale(input.motion, experiment.level);
  if (experiment.open_ducts) input.ducts.clear();
  return input;
}

/// Σ (a − b)²/σ² of one channel; without σ that of a new sensor.
double apart(const std::vector<double>& a, const std::vector<double>& b, Window window, double sigma) {
  double squares = 0.0, power = 0.0;
  const std::size_t end = std::min({window.to, a.size(), b.size()});
  for (std::size_t k = window.from; k < end; ++k) {
    squares += std::pow(a[k] - b[k], 2);
    power += a[k] * a[k] / static_cast<double>(window.size());
  }
  const double noise =
      sigma > 0.0 ? sigma * sigma : thresholds::new_sensor_noise * thresholds::new_sensor_noise * power;
  return noise > 0.0 ? squares / noise : 0.0;
}

/// On the rig that recorded.
double separation_here(const ProblemRecording& r, const Hypothesis& one, const Hypothesis& other,
                       const Experiment& experiment) {
  const PreparedRecording& e = *r.samples;
  const SimulationInput input = changed(e.input, experiment);
  std::array<Response, 2> responses;
  const std::array<const Hypothesis*, 2> hypotheses{&one, &other};
  for (std::size_t h = 0; h < 2; ++h) {
    Hypothesis tried = *hypotheses[h];
    if (experiment.open_ducts) tried.rig.fdva.open_ducts = *experiment.open_ducts;
    responses[h] = read_channels(tried, e, input, resting(tried.rig, input), r.fitted.to, r.resolution());
  }
  double sum = 0.0;
  for (const Channel channel : e.channels) {
    const auto c = index(channel);
    sum += apart(responses[0][c], responses[1][c], r.fitted, std::max(e.noise[c], 1e-15));
  }
  if (experiment.sensor) {
    const auto c = index(*experiment.sensor);
    sum += apart(responses[0][c], responses[1][c], r.fitted, 0.0);
  }
  return sum;
}

/// On a rig of another kind that is moved so, in a window, with sensors of its own; `force_noise`: of F, 0 where it is
/// that of a new sensor, too. Nothing where the numbers do not make such a rig.
std::optional<double> separation_on(RigKind kind, const firmware::Recording& moved, Window window, double force_noise,
                                    const Hypothesis& one, const Hypothesis& other) {
  std::array<Response, 2> responses;
  std::vector<Channel> channels;
  const std::array<const Hypothesis*, 2> hypotheses{&one, &other};
  for (std::size_t h = 0; h < 2; ++h) {
    auto rig = hypotheses[h]->rig;
    rig.kind = kind;
    rig.effects.for_each_sensor([](auto& slot, Channel) { slot = {}; });
    if (firmware::find_rig_fault(rig, moved.sample_period)) return std::nullopt;
    const SimulationInput input = simulation_input(rig, moved);
    channels = response_channels(kind, input);
    responses[h] = simulate(rig, input, resting(rig, input), window.to);
  }
  double sum = 0.0;
  for (const Channel channel : channels) {
    sum += apart(responses[0][index(channel)], responses[1][index(channel)], window,
                 channel == Channel::F ? force_noise : 0.0);
  }
  return sum;
}

/// How the component was moved, as a hypothesis says.
std::vector<double> travel_of_component(const ProblemRecording& r, const Hypothesis& hypothesis) {
  const PreparedRecording& e = *r.samples;
  const Response here = true_channels(hypothesis, e, e.input, resting(hypothesis.rig, e.input), 0, r.resolution());
  return here[index(hypothesis.rig.kind == RigKind::quarter_car ? Channel::dz_b : Channel::x_act)];
}

/// On a rig of another kind, moved as the component or the road was here.
std::optional<double> separation_there(const ProblemRecording& r, const Hypothesis& one, const Hypothesis& other,
                                       RigKind kind) {
  const PreparedRecording& e = *r.samples;
  firmware::Recording moved;
  moved.sample_period = e.recording.sample_period;
  moved.time = e.recording.time;
  if (kind == RigKind::component_bench) {
    moved[Channel::x_act] = travel_of_component(r, one);
  } else {
    if (!e.recording.has(Channel::z_r)) return std::nullopt;
    moved[Channel::z_r] = e.recording[Channel::z_r];
  }
  return separation_on(kind, moved, r.fitted, 0.0, one, other);
}

/// A sine that grows to its amplitude in its first period, so that it begins at rest.
firmware::Recording sine(double frequency, double amplitude, double period, double seconds) {
  firmware::Recording moved;
  moved.sample_period = period;
  const auto count = static_cast<std::size_t>(seconds / period);
  moved.time = firmware::sample_times(count, 1.0 / period);
  auto& x = moved[Channel::x_act];
  for (const double t : moved.time) {
    const double s = std::min(t * frequency, 1.0);
    x.push_back(amplitude * s * s * s * (10.0 + s * (6.0 * s - 15.0)) *
                std::sin(2.0 * std::numbers::pi * frequency * t));
  }
  return moved;
}

std::vector<Experiment> experiments(const IdentificationProblem& problem, const Hypothesis& one) {
  const PreparedRecording& first = problem.samples().front();
  std::vector<Experiment> list;
  const auto add = [&list](std::string words) -> Experiment& {
    list.emplace_back();
    list.back().words = std::move(words);
    return list.back();
  };
  add("three times the level of excitation").level = 3.0;
  add("a third of the level of excitation").level = 1.0 / 3.0;
  for (const Band band : {Band{0.5, 3.0}, Band{3.0, 10.0}, Band{10.0, 30.0}, Band{30.0, 80.0}}) {
    if (band.to * first.input.period > 0.4) continue;
    char words[64];
    std::snprintf(words, sizeof words, "excitation from %g to %g Hz", band.from, band.to);
    add(words).band = band;
  }
  if (one.rig.has_fdva) {
    for (int open = 0; open <= one.rig.fdva.ducts; ++open) {
      if (open != one.rig.fdva.open_ducts) {
        add(std::to_string(open) + (open == 1 ? " duct open" : " ducts open")).open_ducts = open;
      }
    }
  }
  for (const Channel channel : response_channels(one.rig.kind, first.input)) {
    if (!first.explains(channel)) add("a sensor of " + std::string(model::name(channel))).sensor = channel;
  }
  if (one.rig.kind == RigKind::quarter_car) {
    add("the component alone on a bench, moved as it was here").rig = RigKind::component_bench;
  } else if (one.rig.kind == RigKind::driven_mass) {
    add("the component alone on a machine, moved as it was here").rig = RigKind::component_bench;
  } else {
    add("the component in a quarter car on this road").rig = RigKind::quarter_car;
  }
  return list;
}

}  // namespace

std::string best_experiment(const IdentificationProblem& problem, const Hypothesis& one, const Hypothesis& other) {
  const auto separation = [&](const Experiment& experiment) {
    double sum = 0.0;
    for (const ProblemRecording& r : problem.recordings()) {
      if (!r.is_fitted()) continue;
      sum += experiment.rig ? separation_there(r, one, other, *experiment.rig).value_or(0.0)
                            : separation_here(r, one, other, experiment);
    }
    return sum;
  };
  const double now = std::max(separation({}), 1.0);
  std::string best = "a longer recording: no other level, band, sensor or rig that was tried separates twice as well";
  double most = thresholds::separates_better * now;
  for (const Experiment& experiment : experiments(problem, one)) {
    const double there = separation(experiment);
    if (!(there > most)) continue;
    most = there;
    char factor[64];
    std::snprintf(factor, sizeof factor, " (separates %.2g times as well)", there / now);
    best = experiment.words + factor;
  }
  return best;
}

std::optional<SineTest> best_sine(const IdentificationProblem& problem, const Hypothesis& one,
                                  const Hypothesis& other) {
  double here = 0.0, seconds = 0.0, travel = 0.0, speed = 0.0, squares = 0.0, noise = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (!r.is_fitted()) continue;
    const double period = r.samples->input.period;
    here += separation_here(r, one, other, {});
    seconds += period * static_cast<double>(r.fitted.size());
    if (r.samples->explains(Channel::F)) noise = r.samples->noise[index(Channel::F)];
    const std::vector<double> x = travel_of_component(r, one);
    for (std::size_t k = r.fitted.from; k < std::min(r.fitted.to, x.size()); ++k) {
      travel = std::max(travel, std::abs(x[k]));
      squares += x[k] * x[k] * period;
      if (k > r.fitted.from) speed = std::max(speed, std::abs(x[k] - x[k - 1]) / period);
    }
  }
  if (!(seconds > 0.0) || !std::isfinite(travel) || !std::isfinite(speed)) return std::nullopt;
  if (!(noise > 0.0))  // a sensor that bears what the spring does here
    noise = thresholds::new_sensor_noise * one.rig.suspension.stiffness * std::sqrt(squares / seconds);
  const double now = std::max(here, 1.0) / seconds, period = problem.sample_period();
  std::optional<SineTest> best;
  double most = thresholds::separates_better;
  for (const double frequency : thresholds::sine_frequencies) {
    if (frequency * period > thresholds::sine_highest) continue;
    for (const double amplitude : thresholds::sine_amplitudes) {
      if (amplitude > travel || 2.0 * std::numbers::pi * frequency * amplitude > speed) continue;
      const double longest = std::max(thresholds::sine_seconds, 2.0 / frequency);
      const firmware::Recording moved = sine(frequency, amplitude, period, longest);
      const Window window{0, moved.time.size()};
      const double there =
          separation_on(RigKind::component_bench, moved, window, noise, one, other).value_or(0.0) / longest / now;
      if (!(there > most) || !std::isfinite(there)) continue;
      most = there;
      best = SineTest{frequency, amplitude, there};
    }
  }
  return best;
}

}  // namespace host_sim::identification
