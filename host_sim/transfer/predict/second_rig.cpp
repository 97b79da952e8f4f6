#include "host_sim/transfer/predict/second_rig.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/noise/thresholds.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::transfer {

using identification::PreparedRecording;
using model::Channel;
using Rig = model::RigParameters<double>;

namespace {

double static_load_of(const Rig& rig) {
  constexpr double gravity = 9.81;
  return (rig.body.mass + rig.wheel.mass) * gravity;
}

void analyse(SecondRig& second) {
  std::vector<std::vector<double>> foot_points;
  for (const PreparedRecording& drive : second.drives) {
    std::vector<double> z;
    for (const auto& m : drive.input.motion) z.push_back(m.position);
    foot_points.push_back(std::move(z));
  }
  second.analysis.emplace(std::move(foot_points), 1.0 / second.drives.front().input.period,
                          static_load_of(second.description.rig));
  for (auto& density : second.noise_density) density.assign(second.analysis->frequencies().size(), 0.0);
}

/// Readings behind the rig's sensors.
Response read(const identification::Hypothesis& hypothesis, const PreparedRecording& drive, Response truth) {
  for (const Channel channel : drive.channels) {
    if (!identification::is_altered(hypothesis, channel)) continue;
    truth[index(channel)] = identification::sensor_readings(hypothesis, drive, channel, truth[index(channel)]);
  }
  return truth;
}

}  // namespace

std::vector<std::vector<Response>> SecondRig::run(const std::vector<Rig>& rigs) const {
  constexpr std::size_t batch = 8;
  const std::size_t batches = (rigs.size() + batch - 1) / batch;
  std::vector<std::vector<Response>> runs(rigs.size(), std::vector<Response>(drives.size()));
  identification::for_all(batches * drives.size(), [&](std::size_t job) {
    const std::size_t d = job % drives.size(), first = job / drives.size() * batch;
    const std::size_t last = std::min(first + batch, rigs.size());
    std::vector<identification::Hypothesis> hypotheses;
    for (std::size_t i = first; i < last; ++i) hypotheses.push_back({rigs[i], starts});
    std::vector<identification::SimulatedRig> simulated;
    for (const auto& h : hypotheses) simulated.push_back({&h, &h.starts[d], &drives[d].input});
    auto truths = identification::true_channels_of_each(simulated, drives[d], 0, {drives[d].substeps});
    for (std::size_t i = first; i < last; ++i) {
      runs[i][d] = read(hypotheses[i - first], drives[d], std::move(truths[i - first]));
    }
  });
  return runs;
}

SecondRig on_road(const firmware::RigDescription& to, const firmware::FootPointMotion& motion) {
  SecondRig second;
  second.description = to;
  PreparedRecording drive;
  const double period = to.period();
  drive.recording.sample_period = period;
  drive.recording.time = firmware::sample_times(motion.size(), to.sample_rate);
  drive.recording.source = to.source;
  for (const auto& m : motion) {
    drive.recording[Channel::z_r].push_back(m.position);
    drive.recording[Channel::zdd_r].push_back(m.acceleration);
  }
  drive.input.period = period;
  drive.input.motion = motion;
  drive.at_rest = true;
  drive.channels.assign(outcome_channels.begin(), outcome_channels.end());
  drive.substeps = fine_steps(period);
  drive.fitted = {0, motion.size()};
  second.starts.push_back(resting(to.rig, drive.input));
  second.drives.push_back(std::move(drive));
  analyse(second);
  for (std::size_t c = 0; c < outcome_channels.size(); ++c) {
    const double level = to.noise[index(outcome_channels[c])].value_or(0.0);
    second.noise_variance[c] = level * level;
    std::fill(second.noise_density[c].begin(), second.noise_density[c].end(), 2.0 * level * level * period);
  }
  return second;
}

SecondRig on_recordings(const firmware::RigDescription& to, const identification::Identified& diagnosed) {
  SecondRig second;
  second.description = to;
  const auto& problem = diagnosed.problem;
  const PreparedRecording& first = problem.samples().front();
  if (first.input.wheel_prescribed || first.input.channel != Channel::z_r) {
    throw firmware::InputError(first.recording.source, 0, "z_r is not recorded",
                               "the foot point that drives the prediction of the second rig");
  }
  for (std::size_t r = 0; r < problem.samples().size(); ++r) {
    PreparedRecording drive = problem.samples()[r];
    Response measured;
    for (const Channel channel : outcome_channels) {
      if (problem.samples()[r].explains(channel)) measured[index(channel)] = drive.recording[channel];
    }
    drive.channels.assign(outcome_channels.begin(), outcome_channels.end());
    second.drives.push_back(std::move(drive));
    second.measured.push_back(std::move(measured));
    second.starts.push_back(diagnosed.found.best.fit.hypothesis.starts[r]);
  }
  analyse(second);
  const double runs = static_cast<double>(second.drives.size());
  for (std::size_t r = 0; r < problem.recordings().size(); ++r) {
    const identification::ProblemRecording& recording = problem.recordings()[r];
    const auto& channels = recording.samples->channels;
    const double period = recording.samples->compared_period();
    for (std::size_t c = 0; c < outcome_channels.size(); ++c) {
      const auto place = std::find(channels.begin(), channels.end(), outcome_channels[c]);
      if (place == channels.end()) continue;
      const auto row = static_cast<Eigen::Index>(place - channels.begin());
      const identification::ChannelNoise& own = recording.noise[index(*place)];
      second.noise_variance[c] += (std::pow(own.rms(period), 2) + recording.input_noise.variance[index(*place)]) / runs;
      for (std::size_t k = 0; k < second.noise_density[c].size(); ++k) {
        const double f = second.analysis->frequencies()[k];
        const auto band = static_cast<std::size_t>(f / identification::thresholds::covariance_band);
        double variance = own.level * own.level * own.colour.power(f, period);
        if (band < recording.input_noise.spectrum.size()) {
          variance += recording.input_noise.spectrum[band](row, row).real();
        }
        second.noise_density[c][k] += 2.0 * variance * period / runs;
      }
    }
  }
  return second;
}

}  // namespace host_sim::transfer
