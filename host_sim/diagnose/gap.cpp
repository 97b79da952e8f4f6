#include "host_sim/diagnose/gap.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/readings.hpp"

namespace host_sim::diagnose {

using model::Channel;

namespace {

/// Sums of squares over a window, clipped samples left out.
struct Misfit {
  double error = 0.0, data = 0.0;

  void add(const Evidence& e, Channel channel, const Response& response, Window window) {
    const auto c = index(channel);
    window = e.known(channel, window);
    for (std::size_t k = window.from; k < window.to; ++k) {
      if (!e.clipped[c].empty() && e.clipped[c][k]) continue;
      const double measured = e.recording[channel][k];
      error += std::pow(response[c][k] - measured, 2);
      data += measured * measured;
    }
  }
};

/// rms of the error over the held-out windows, by channel, relative to the rms of the channel.
std::map<Channel, double> errors(const Case& all, const Hypothesis& hypothesis) {
  const auto responses = respond(all, hypothesis);
  std::map<Channel, double> result;
  for (const Channel channel : all.evidence.front().channels) {
    Misfit misfit;
    for (const std::size_t r : all.judged) misfit.add(all.evidence[r], channel, responses[r], all.evidence[r].judge);
    result[channel] = misfit.data > 0.0 ? std::sqrt(misfit.error / misfit.data) : 0.0;
  }
  return result;
}

std::map<Channel, double> noise_floors(const Case& all, const std::vector<CarriedNoise>& noises) {
  std::map<Channel, double> result;
  for (const Channel channel : all.evidence.front().channels) {
    const auto c = index(channel);
    double noise = 0.0, data = 0.0;
    for (const std::size_t r : all.judged) {
      const Evidence& e = all.evidence[r];
      const Window judge = e.known(channel, e.judge);
      for (std::size_t k = judge.from; k < judge.to; ++k) data += std::pow(e.recording[channel][k], 2);
      double variance = e.noise[c] * e.noise[c] + noises[r].variance[c];
      // z_r alone does not tell of faster motion than this.
      if (channel == Channel::zdd_r) {
        variance += variance_above(acceleration_edge * e.acceleration_known, e.recording[channel], judge, e.noise[c],
                                   e.drive.period);
      }
      noise += variance * static_cast<double>(judge.size());
    }
    result[channel] = data > 0.0 ? std::sqrt(noise / data) : 0.0;
  }
  return result;
}

}  // namespace

double pooled_error(const Case& all, const Hypothesis& hypothesis) {
  double sum = 0.0, terms = 0.0;
  for (const std::size_t r : all.fitted) {
    const Evidence& e = all.evidence[r];
    const Response response = read_channels(hypothesis, e, e.drive, hypothesis.starts[r], e.fit.to);
    for (const Channel channel : e.channels) {
      Misfit misfit;
      misfit.add(e, channel, response, e.fit);
      if (!(misfit.data > 0.0)) continue;
      sum += misfit.error / misfit.data;
      terms += 1.0;
    }
  }
  return terms > 0.0 ? std::sqrt(sum / terms) : 0.0;
}

std::map<Channel, Gap> gaps(const Case& all, const std::vector<CarriedNoise>& noises, const Hypothesis& given,
                            const Hypothesis& refit, const Hypothesis& after) {
  std::map<Channel, Gap> result;
  if (all.judged.empty()) return result;
  const auto of_given = errors(all, given), of_refit = errors(all, refit), of_after = errors(all, after),
             floors = noise_floors(all, noises);
  for (const auto& [channel, error] : of_given) {
    result[channel] = {error, of_refit.at(channel), of_after.at(channel), floors.at(channel)};
  }
  return result;
}

}  // namespace host_sim::diagnose
