#include "host_sim/replicate/target.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/replicate/thresholds.hpp"
#include "host_sim/report/formatted.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::replicate {

using model::Channel;

double FrequencyBand::weight(double f) const {
  const auto rise = [](double value, double edge) {  // 0 below, 1 above
    if (!(edge > 0.0)) return 1.0;
    const double x = (value / edge - 1.0 + thresholds::band_edge) / (2.0 * thresholds::band_edge);
    return 0.5 - 0.5 * std::cos(std::numbers::pi * std::clamp(x, 0.0, 1.0));
  };
  return rise(f, lowest) * (1.0 - rise(f, highest));
}

namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

double number_of(const std::string& text, const std::string& option) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value > 0.0) || !std::isfinite(value)) {
    throw firmware::UsageError(option + ": " + firmware::in_quotes(text) + " is no number above 0");
  }
  return value;
}

Channel channel_of(const std::string& name, const std::string& option) {
  const auto channel = model::find_channel(name);
  if (!channel) throw firmware::UsageError(option + ": there is no channel " + firmware::in_quotes(name));
  return *channel;
}

/// An error in the unit, told from the sizes: what no rig of this kind does.
void check_size(const firmware::Recording& recording, Channel channel, double rms) {
  const bool acceleration = model::unit(channel) == "m/s²", length = model::unit(channel) == "m";
  std::string wrong = formatted("%s has %.3g %s rms", std::string(model::name(channel)).c_str(), rms,
                                std::string(model::unit(channel)).c_str());
  if (!(rms > 0.0)) throw firmware::InputError(recording.source, 0, wrong, "a target that moves");
  if (acceleration && rms > 500.0) throw firmware::InputError(recording.source, 0, wrong, "an acceleration in m/s²");
  if (length && rms > 0.5) throw firmware::InputError(recording.source, 0, wrong, "a length in m, it looks like mm");
}

/// Where the spectrum is above the noise of its sensor, from thresholds::lowest_frequency on.
FrequencyBand band_above_noise(const firmware::RigDescription& description, Channel channel,
                               const std::vector<double>& values, std::string& remark) {
  const double rate = description.sample_rate;
  FrequencyBand band{thresholds::lowest_frequency, 0.1 * rate};
  const auto noise = description.noise[index(channel)];
  const std::string name(model::name(channel));
  const auto segment = static_cast<std::size_t>(std::min(2.0 * rate, static_cast<double>(values.size())));
  const PowerSpectrum spectrum = welch(values, rate, segment);
  double floor = noise ? 2.0 * *noise * *noise / rate : 0.0;
  if (!noise) {  // the quietest tenth of the spectrum
    std::vector<double> sorted(spectrum.density.begin() + 1, spectrum.density.end());
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10), sorted.end());
    floor = sorted[sorted.size() / 10];
  }
  const double least = thresholds::above_noise * floor;
  double below = band.highest, above = band.lowest;
  for (std::size_t k = 1; k < spectrum.frequency.size(); ++k) {
    const double f = spectrum.frequency[k];
    if (f < band.lowest || f > band.highest || !(spectrum.density[k] > least)) continue;
    below = std::min(below, f);
    above = std::max(above, f);
  }
  if (above > below) band = {std::max(band.lowest, below), above};
  remark = formatted("%s is replicated from %.3g to %.3g Hz, where it is above %s", name.c_str(), band.lowest,
                     band.highest, noise ? "its noise" : "the quietest tenth of its spectrum");
  return band;
}

}  // namespace

TargetRequest parse_request(const std::string& channels, const std::vector<std::string>& bands) {
  TargetRequest request;
  for (const std::string& word : split(channels, ',')) {
    const auto parts = split(word, ':');
    const Channel channel = channel_of(parts[0], "--channels");
    for (const auto& [other, weight] : request.channels) {
      if (other == channel) throw firmware::UsageError("--channels: " + parts[0] + " is there twice");
    }
    if (parts.size() > 2) throw firmware::UsageError("--channels: expected CHANNEL or CHANNEL:WEIGHT");
    request.channels.emplace_back(channel, parts.size() == 2 ? number_of(parts[1], "--channels") : 1.0);
  }
  for (const std::string& word : bands) {
    const auto parts = split(word, '=');
    const auto edges = split(parts.back(), ':');
    if (parts.size() > 2 || edges.size() != 2) {
      throw firmware::UsageError("--band: expected LOWEST:HIGHEST or CHANNEL=LOWEST:HIGHEST [Hz]");
    }
    const FrequencyBand band{number_of(edges[0], "--band"), number_of(edges[1], "--band")};
    if (!(band.highest > 1.2 * band.lowest)) {
      throw firmware::UsageError("--band: the highest frequency is not above the lowest by a fifth");
    }
    std::optional<Channel> channel;
    if (parts.size() == 2) channel = channel_of(parts[0], "--band");
    request.bands.emplace_back(channel, band);
  }
  return request;
}

Target make_target(const firmware::RigDescription& description, const TargetRequest& request,
                   const std::vector<firmware::Recording>& recordings) {
  constexpr double longest = 3600.0;  // [s] in memory
  Target target;
  target.period = description.period();
  SimulationInput driven;
  driven.channel = description.rig.kind == model::RigKind::quarter_car ? Channel::z_cmd : Channel::x_cmd;
  const auto possible = response_channels(description.rig.kind, driven);
  std::size_t total = 0;
  for (const firmware::Recording& recording : recordings) {
    if (std::abs(recording.sample_period * description.sample_rate - 1.0) > 1e-4) {
      throw firmware::InputError(
          recording.source, 0,
          "the target has " + formatted("%.6g", 1.0 / recording.sample_period) + " samples a second",
          firmware::shortest(description.sample_rate) + ", the rate of the rig (rigtwin import --rate makes it so)");
    }
    total += recording.size();
  }
  if (static_cast<double>(total) > longest * description.sample_rate) {
    throw firmware::InputError(recordings.front().source, 0,
                               formatted("a target of %.0f s", static_cast<double>(total) * target.period),
                               formatted("at most %.0f s, which are kept in memory", longest));
  }
  const auto lead = static_cast<std::size_t>(std::lround(thresholds::lead / target.period));
  const auto blend = static_cast<std::size_t>(std::lround(thresholds::blend / target.period));
  std::size_t at = 0;
  for (std::size_t e = 0; e < recordings.size(); ++e) {
    at += e == 0 ? lead : blend;
    target.events.push_back({at, at + recordings[e].size()});
    at += recordings[e].size();
  }
  const std::size_t length = at + lead;
  for (const auto& [channel, weight] : request.channels) {
    if (std::find(possible.begin(), possible.end(), channel) == possible.end() || channel == Channel::x_act) {
      std::string names;
      for (const Channel c : possible) names += (names.empty() ? "" : ", ") + std::string(model::name(c));
      throw firmware::UsageError("--channels: the rig has no answer " + std::string(model::name(channel)) +
                                 ", expected some of " + names);
    }
    std::vector<double> values(length, 0.0);
    for (std::size_t e = 0; e < recordings.size(); ++e) {
      const auto& samples = recordings[e].required(channel, "is the target");
      const Part part = target.events[e];
      if (samples.size() < lead) {
        throw firmware::InputError(recordings[e].source, 0,
                                   formatted("an event of %.3g s", static_cast<double>(samples.size()) * target.period),
                                   formatted("at least %.3g s", thresholds::lead));
      }
      double squares = 0.0;
      for (const double v : samples) squares += v * v;
      check_size(recordings[e], channel, std::sqrt(squares / static_cast<double>(samples.size())));
      std::copy(samples.begin(), samples.end(), values.begin() + static_cast<std::ptrdiff_t>(part.from));
      const auto fade = [](std::size_t k, std::size_t count) {
        return 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(count));
      };
      const std::size_t before = e == 0 ? lead : blend, after = e + 1 == recordings.size() ? lead : blend;
      for (std::size_t k = 1; k < std::min(before, samples.size()); ++k) {
        values[part.from - k] += fade(k, before) * samples[k];
      }
      for (std::size_t k = 1; k < std::min(after, samples.size()); ++k) {
        values[part.to - 1 + k] += fade(k, after) * samples[samples.size() - 1 - k];
      }
    }
    TargetChannel one{channel, weight, {}, {}};
    for (const auto& [of, band] : request.bands) {
      if (of == channel || (!of && !(one.band.highest > 0.0))) one.band = band;
    }
    if (!(one.band.highest > 0.0)) {
      const Part first = target.events.front();
      const std::vector<double> event(values.begin() + static_cast<std::ptrdiff_t>(first.from),
                                      values.begin() + static_cast<std::ptrdiff_t>(first.to));
      one.band = band_above_noise(description, channel, event, one.remark);
    }
    if (one.band.highest > 0.25 * description.sample_rate) {
      throw firmware::UsageError(formatted("--band: %.4g Hz is above a quarter of the sample rate", one.band.highest));
    }
    target.channels.push_back(one);
    target.values.push_back(std::move(values));
  }
  return target;
}

}  // namespace host_sim::replicate
