#include "host_sim/frf/response_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/frf/delay.hpp"

namespace host_sim::frf {
namespace {

using std::numbers::pi;

// The channels of a request by number: the reference first (instrument or input), then the input, then outputs.
struct Channels {
  std::vector<model::Channel> list;
  std::size_t references = 1;

  explicit Channels(const Request& request) {
    if (request.instrument) list.push_back(*request.instrument);
    list.push_back(request.input);
    references = list.size();
    list.insert(list.end(), request.outputs.begin(), request.outputs.end());
  }
  [[nodiscard]] std::size_t input() const { return references - 1; }
  [[nodiscard]] std::size_t output(std::size_t i) const { return references + i; }
};

using Shifts = std::vector<std::ptrdiff_t>;  // by channel

double common_rate(std::span<const firmware::Recording> recordings) {
  const firmware::Recording& first = recordings.front();
  for (const firmware::Recording& other : recordings) {
    if (std::abs(other.sample_period / first.sample_period - 1.0) <= 1e-4) continue;
    throw firmware::InputError(
        other.source, 0,
        "the sample rate is " + firmware::shortest(std::round(1e3 / other.sample_period) / 1e3) + " Hz",
        firmware::shortest(std::round(1e3 / first.sample_period) / 1e3) + " Hz as in " + first.source);
  }
  const double rate = 1.0 / first.sample_period;
  const double whole = std::round(rate);  // 1/0.001 and stamps that are rounded give 999.9999…
  return std::abs(rate - whole) <= 1e-9 * rate ? whole : rate;
}

void check_channels(const firmware::Recording& recording, const Channels& channels) {
  for (const model::Channel channel : channels.list) {
    const std::vector<double>& samples = recording.required(channel, "for the frequency response");
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    if (*low == *high) {
      throw firmware::InputError(recording.source, 0, "channel " + std::string(model::name(channel)) + " never changes",
                                 "a signal");
    }
  }
}

std::size_t add_all(CrossSpectra& spectra, std::span<const firmware::Recording> recordings, const Channels& channels,
                    const Shifts& shifts) {
  std::size_t blocks = 0;
  for (const firmware::Recording& recording : recordings) {
    std::vector<ShiftedSignal> signals;
    for (std::size_t i = 0; i < channels.list.size(); ++i) {
      signals.push_back({recording[channels.list[i]], shifts[i]});
    }
    blocks += spectra.add(signals);
  }
  return blocks;
}

// Delays against the reference, by channel, from blocks four times as long where the recordings allow it.
std::vector<std::optional<std::ptrdiff_t>> find_delays(std::span<const firmware::Recording> recordings,
                                                       const Channels& channels, double rate,
                                                       const BlockScheme& scheme) {
  std::vector<std::optional<std::ptrdiff_t>> delays(channels.list.size());
  std::size_t shortest = recordings.front().size(), all = 0;
  for (const firmware::Recording& recording : recordings) {
    shortest = std::min(shortest, recording.size());
    all += recording.size();
  }
  const std::size_t most = std::min({4 * scheme.length, shortest, all / 2});
  if (most < shortest_block) return delays;
  const std::size_t length = good_fft_size_at_most(most);
  const BlockScheme longer{length, all < 8 * length ? length / 2 : length, WindowShape::hann, Detrend::mean};
  CrossSpectra spectra(rate, longer, channels.list.size(), 1);
  if (add_all(spectra, recordings, channels, Shifts(channels.list.size())) < 2) return delays;
  for (std::size_t i = 1; i < channels.list.size(); ++i) delays[i] = find_delay(spectra, i);
  return delays;
}

double wrapped(double angle) { return angle - 2.0 * pi * std::ceil((angle - pi) / (2.0 * pi)); }  // in (−π, π]

LineSpectra line_spectra(const CrossSpectra& spectra, const Channels& channels, std::size_t output, std::size_t k) {
  const std::size_t x = channels.input(), y = channels.output(output);
  return {spectra.power(0, k),    spectra.power(x, k),    spectra.power(y, k),
          spectra.cross(0, x, k), spectra.cross(0, y, k), spectra.cross(x, y, k)};
}

OutputResponse response(const CrossSpectra& spectra, const Channels& channels, std::size_t output,
                        const std::vector<std::size_t>& lines, const Request& request, const Quantiles& quantiles,
                        double delay) {
  OutputResponse result;
  result.output = request.outputs[output];
  std::optional<double> before;
  for (const std::size_t k : lines) {
    const LineSpectra s = line_spectra(spectra, channels, output, k);
    const Complex h = estimate(s, request.estimator);
    const Bounds b = bounds(s, request.estimator, quantiles);
    const bool known = std::isfinite(std::abs(h));
    double phase = known ? wrapped(std::arg(h) - 2.0 * pi * spectra.frequency(k) * delay) : 0.0;
    if (request.unwrap && before) phase += 2.0 * pi * std::round((*before - phase) / (2.0 * pi));
    if (b.determined) before = phase;
    const double turned = known ? phase - std::arg(h) : 0.0;
    result.magnitude.push_back(std::abs(h));
    result.phase.push_back(phase);
    result.coherence.push_back(coherence(s.xx, s.yy, s.xy));
    result.magnitude_ci95.push_back({b.lowest_magnitude, b.highest_magnitude});
    result.phase_ci95.push_back(known ? Interval{b.lowest_phase + turned, b.highest_phase + turned}
                                      : Interval{-pi, pi});
    result.determined.push_back(b.determined);
  }
  return result;
}

/// `needed` [s]: what two blocks take.
firmware::InputError too_short_error(const firmware::Recording& recording, double sample_rate, const BlockWish& wish,
                                     double needed) {
  std::string expected = "at least " + firmware::shortest(std::ceil(100.0 * needed) / 100.0) + " s";
  if (wish.block) {
    expected += " for two blocks of " + firmware::shortest(*wish.block) + " s";
  } else {
    expected += " for a peak " + firmware::shortest(std::round(1e4 * wish.bandwidth()) / 1e4) +
                " Hz wide, or other --lowest-damping, --lowest-frequency, --block";
  }
  return {
      recording.source, 0,
      "the recording is too short: " + firmware::shortest(static_cast<double>(recording.size()) / sample_rate) + " s",
      expected};
}

}  // namespace

Responses estimate_responses(std::span<const firmware::Recording> recordings, const Request& request) {
  if (recordings.empty() || request.outputs.empty() ||
      request.instrument.has_value() != (request.estimator == Estimator::instrument)) {
    throw std::invalid_argument("estimate_responses: nothing to estimate");
  }
  const Channels channels(request);
  Responses result;
  result.request = request;
  result.sample_rate = common_rate(recordings);
  std::vector<std::size_t> lengths;
  const firmware::Recording* shortest_recording = &recordings.front();
  for (const firmware::Recording& recording : recordings) {
    check_channels(recording, channels);
    result.recordings.push_back(recording.source);
    lengths.push_back(recording.size());
    result.duration += static_cast<double>(recording.size()) / result.sample_rate;
    if (recording.size() < shortest_recording->size()) shortest_recording = &recording;
  }
  const auto too_short = [&](double needed) {
    return too_short_error(*shortest_recording, result.sample_rate, request.blocks, needed);
  };
  const std::optional<BlockChoice> blocks = choose_blocks(lengths, result.sample_rate, request.blocks);
  if (!blocks) throw too_short(needed_duration(request.blocks, result.sample_rate));
  result.blocks = *blocks;
  const BlockScheme& scheme = result.blocks.scheme;

  const auto delays = find_delays(recordings, channels, result.sample_rate, scheme);
  const std::vector<double> window = make_window(scheme.window, scheme.length);
  Shifts shifts(channels.list.size());
  if (request.compensate_delay) {
    for (std::size_t i = 1; i < shifts.size(); ++i) {
      const std::ptrdiff_t delay = delays[i].value_or(0);
      if (1.0 - window_match(window, delay) > noticeable_delay_bias) shifts[i] = delay;
    }
  }

  CrossSpectra spectra(result.sample_rate, scheme, channels.list.size(), channels.references);
  result.averages = add_all(spectra, recordings, channels, shifts);
  if (result.averages < 2) {
    const auto [earliest, latest] = std::minmax_element(shifts.begin(), shifts.end());
    throw too_short(result.duration +
                    static_cast<double>(*latest - *earliest + static_cast<std::ptrdiff_t>(scheme.hop)) /
                        result.sample_rate);
  }
  result.effective_averages = spectra.effective_averages();

  std::vector<std::size_t> lines;
  for (std::size_t k = 1; k + 1 < spectra.lines(); ++k) {
    const double frequency = spectra.frequency(k);
    if (frequency < request.lowest_frequency || frequency > request.highest_frequency) continue;
    lines.push_back(k);
    result.frequency.push_back(frequency);
    if (request.instrument) {
      const std::size_t x = channels.input();
      result.instrument_coherence.push_back(
          coherence(spectra.power(0, k), spectra.power(x, k), spectra.cross(0, x, k)));
    }
  }

  const Quantiles quantiles(result.effective_averages);
  const std::size_t x = channels.input();
  for (std::size_t i = 0; i < request.outputs.size(); ++i) {
    const std::size_t y = channels.output(i);
    const double turned_back = static_cast<double>(shifts[y] - shifts[x]) / result.sample_rate;
    OutputResponse output = response(spectra, channels, i, lines, request, quantiles, turned_back);
    if (delays[y] && (delays[x] || x == 0)) output.delay = *delays[y] - delays[x].value_or(0);
    output.compensated = shifts[y] != 0 || shifts[x] != 0;
    const double of_y = window_match(window, delays[y].value_or(0));
    const double of_x = window_match(window, delays[x].value_or(0));
    output.delay_bias = 1.0 - (of_x > 0.0 ? of_y / of_x : 0.0);
    result.outputs.push_back(std::move(output));
  }
  return result;
}

}  // namespace host_sim::frf
