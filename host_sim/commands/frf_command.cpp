#include "host_sim/commands/frf_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/verbosity.hpp"
#include "host_sim/frf/response_estimate.hpp"
#include "host_sim/frf/response_page.hpp"
#include "host_sim/frf/result_json.hpp"
#include "host_sim/frf/universal_file.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/signal/bands.hpp"

namespace host_sim {
namespace {

using frf::Estimator;
using frf::Responses;
using model::Channel;

constexpr double degree = std::numbers::pi / 180.0;

std::string listed(std::span<const std::string_view> words) {
  std::string list;
  for (const std::string_view word : words) list += (list.empty() ? "" : ", ") + std::string(word);
  return list;
}

Channel channel_of(const std::string& option, const std::string& word) {
  if (const auto channel = model::find_channel(word)) return *channel;
  std::string known;
  for (const auto& channel : model::channel_names) known += (known.empty() ? "" : ", ") + std::string(channel.name);
  throw firmware::UsageError(option + ": unknown channel " + firmware::in_quotes(word) + ", expected one of " + known);
}

/// The index of a word in the list of choices.
std::size_t choice(const std::string& option, const std::string& word, std::span<const std::string_view> words) {
  const auto at = std::find(words.begin(), words.end(), word);
  if (at == words.end())
    throw firmware::UsageError(option + ": is " + firmware::in_quotes(word) + ", expected one of " + listed(words));
  return static_cast<std::size_t>(at - words.begin());
}

void demand(const std::string& option, std::optional<double> value, double lowest, double highest) {
  if (!value || (*value >= lowest && *value <= highest)) return;
  throw firmware::UsageError(option + ": is " + firmware::shortest(*value) + ", expected a number from " +
                             firmware::shortest(lowest) + " to " + firmware::shortest(highest));
}

frf::Request request_of(const FrfOptions& options) {
  frf::Request request;
  request.input = channel_of("--input", options.input);
  for (const std::string& word : options.outputs) {
    const Channel output = channel_of("--output", word);
    if (output == request.input)
      throw firmware::UsageError("--output: " + word + " is also the input, expected another channel");
    if (std::find(request.outputs.begin(), request.outputs.end(), output) != request.outputs.end()) {
      throw firmware::UsageError("--output: " + word + " is given twice, expected each channel once");
    }
    request.outputs.push_back(output);
  }
  for (auto file = options.data.begin(); file != options.data.end(); ++file) {
    if (std::find(options.data.begin(), file, *file) == file) continue;
    throw firmware::UsageError("--data: " + file->string() + " is given twice, expected each recording once");
  }
  demand("--block", options.block, 1e-4, 1e6);
  demand("--overlap", options.overlap, 0.0, 0.95);
  demand("--lowest-damping", options.lowest_damping, 1e-4, 1.0);
  demand("--lowest-frequency", options.lowest_frequency, 1e-3, 1e5);
  demand("--from", options.from, 0.0, 1e6);
  demand("--to", options.to, 0.0, 1e6);
  request.blocks.block = options.block;
  request.blocks.overlap = options.overlap;
  request.blocks.lowest_damping = options.lowest_damping;
  request.blocks.lowest_frequency = options.lowest_frequency;
  request.blocks.window = static_cast<WindowShape>(choice("--window", options.window, window_names));
  request.blocks.detrend = static_cast<Detrend>(choice("--detrend", options.detrend, detrend_names));
  request.compensate_delay = !options.no_delay_compensation;
  request.unwrap = options.unwrap;
  request.lowest_frequency = options.from.value_or(request.lowest_frequency);
  request.highest_frequency = options.to.value_or(request.highest_frequency);
  return request;
}

/// Chooses estimator and instrument; returns a note for the user, or an empty text.
std::string choose_estimator(const FrfOptions& options, const firmware::RigDescription* rig,
                             std::span<const firmware::Recording> recordings, frf::Request& request) {
  constexpr std::array<std::string_view, 3> estimators{"h1", "h2", "hv"};
  if (!options.estimator.empty()) {
    request.estimator = static_cast<Estimator>(choice("--estimator", options.estimator, estimators));
  }
  const bool none = options.instrument == "none";
  if (options.instrument && !none) {
    if (!options.estimator.empty()) {
      throw firmware::UsageError("--estimator " + options.estimator +
                                 " has no instrument, expected --instrument without it");
    }
    request.instrument = channel_of("--instrument", *options.instrument);
    if (*request.instrument == request.input) {
      throw firmware::UsageError("--instrument: " + *options.instrument +
                                 " is also the input, expected another channel");
    }
    request.estimator = Estimator::instrument;
    return "";
  }
  // In the closed loop of a hil rig the noise of F reaches every channel except the road.
  const bool road = request.input == Channel::z_r || request.input == Channel::zdd_r;
  const bool has_road = std::all_of(recordings.begin(), recordings.end(),
                                    [](const firmware::Recording& r) { return r.has(Channel::z_r); });
  if (road || !has_road) return "";
  const bool hil = rig != nullptr && rig->rig.kind == model::RigKind::hil;
  if (hil && !none && options.estimator.empty()) {
    request.instrument = Channel::z_r;
    request.estimator = Estimator::instrument;
    return options.input + " is inside the closed loop, where noise circulates: z_r is used as instrument\n";
  }
  if (hil) {
    return "note: " + options.input + " is inside the closed loop; noise that circulates there biases " +
           std::string(name(request.estimator)) + " (--instrument z_r avoids the bias)\n";
  }
  const bool loop =
      rig == nullptr && std::any_of(recordings.begin(), recordings.end(), [](const firmware::Recording& r) {
        return r.has(Channel::x_cmd) || r.has(Channel::x_act);
      });
  if (loop && !none) {
    return "note: the recording holds z_r and a test machine's deflection; if that loop was closed, noise circulates "
           "in it "
           "and biases the estimate (--instrument z_r avoids the bias)\n";
  }
  return "";
}

void print_blocks(const Responses& r) {
  const auto& scheme = r.blocks.scheme;
  const double seconds = static_cast<double>(scheme.length) / r.sample_rate;
  const double overlap = 1.0 - static_cast<double>(scheme.hop) / static_cast<double>(scheme.length);
  std::printf(
      "  %zu averages, equivalent to %.1f independent averages: blocks of %.4g s (%zu samples, lines %.4g Hz apart), "
      "%s, "
      "%.0f %% overlap\n",
      r.averages, r.effective_averages, seconds, scheme.length, r.resolution(),
      std::string(name(scheme.window)).c_str(), 100.0 * overlap);
  const auto& wish = r.request.blocks;
  std::printf(
      "  %s: for a peak of %.3g %% damping at %.4g Hz the bias is -%.2g %% and the random error %.2g %% at a "
      "coherence of %g\n",
      wish.block ? "block length given" : "block length chosen for least error", 100.0 * wish.lowest_damping,
      wish.lowest_frequency, 100.0 * r.blocks.peak_bias, 100.0 * r.blocks.random_error, frf::expected_coherence);
  if (!wish.block && r.blocks.peak_bias > 0.1) {
    std::printf("  note: %.4g s are too short for such a sharp peak\n", r.duration);
  }
}

std::string delay_text(const Responses& r, const frf::OutputResponse& o) {
  if (!o.delay || !(std::abs(o.delay_bias) > frf::noticeable_delay_bias)) return "";
  char line[160];
  std::snprintf(line, sizeof line,
                o.compensated ? ", delay of %.4g ms compensated (without compensation: %.2g %% too small)"
                              : ", delay of %.4g ms not compensated (%.2g %% too small)",
                1e3 * static_cast<double>(*o.delay) / r.sample_rate, 100.0 * o.delay_bias);
  return line;
}

/// Prints the frequency line nearest to the centre of each third-octave band.
void print_response(const Responses& r, const frf::OutputResponse& o) {
  const std::string unit = std::string(model::unit(o.output)) + "/" + std::string(model::unit(r.request.input));
  std::printf("%s / %s [%s] by %s%s", std::string(model::name(o.output)).c_str(),
              std::string(model::name(r.request.input)).c_str(), unit.c_str(),
              std::string(name(r.request.estimator)).c_str(), delay_text(r, o).c_str());
  std::printf("\n  %9s %12s %25s %9s %17s %10s\n", "f [Hz]", "magnitude", "95 %", "phase [°]", "95 %", "coherence");
  std::vector<std::string> unknown;  // runs of bands: "0.1", "50 … 400"
  bool in_unknown = false;
  std::string run_begin;
  std::size_t last = r.frequency.size();
  for (int number = -60; number <= 30; ++number) {
    const Band band = third_octave_band(number);
    const auto at = std::lower_bound(r.frequency.begin(), r.frequency.end(), band.centre);
    auto k = static_cast<std::size_t>(at - r.frequency.begin());
    if (k > 0 && (k == r.frequency.size() || band.centre - r.frequency[k - 1] < r.frequency[k] - band.centre)) --k;
    if (k == last || r.frequency[k] < band.lower || r.frequency[k] >= band.upper) continue;
    last = k;
    if (!o.determined[k]) {
      if (in_unknown) {
        unknown.back() = run_begin + " … " + nominal_name(band);
      } else {
        unknown.push_back(run_begin = nominal_name(band));
      }
      in_unknown = true;
      continue;
    }
    in_unknown = false;
    std::printf("  %9.4g %12.5g %12.5g %12.5g %8.2f %8.2f %8.2f %10.4f\n", r.frequency[k], o.magnitude[k],
                o.magnitude_ci95[k].low, o.magnitude_ci95[k].high, o.phase[k] / degree, o.phase_ci95[k].low / degree,
                o.phase_ci95[k].high / degree, o.coherence[k]);
  }
  if (unknown.empty()) return;
  const std::vector<std::string_view> runs(unknown.begin(), unknown.end());
  std::printf("  not distinguishable from 0 in these data: %s Hz\n", listed(runs).c_str());
}

}  // namespace

void measure_responses(const FrfOptions& options) {
  frf::Request request = request_of(options);
  std::optional<firmware::RigDescription> rig;
  if (options.rig) rig = firmware::read_rig(*options.rig);
  std::vector<firmware::Recording> recordings;
  for (const auto& file : options.data) {
    for (firmware::Recording& part :
         rig ? read_parts(file, rig->channels, rig->sample_rate, rig->rig.kind) : read_parts(file)) {
      recordings.push_back(std::move(part));
    }
  }
  for (const firmware::Recording& recording : recordings) {
    if (!recording.remark.empty() && verbosity() != Verbosity::quiet)
      std::fprintf(stderr, "%s\n", recording.remark.c_str());
  }
  demand("--block", options.block, static_cast<double>(frf::shortest_block) * recordings.front().sample_period, 1e6);
  const std::string note = choose_estimator(options, rig ? &*rig : nullptr, recordings, request);
  const Responses result = estimate_responses(recordings, request);
  if (result.frequency.empty()) {
    throw firmware::UsageError("--from, --to: no line of the spectrum lies between, expected a range of at least " +
                               firmware::shortest(result.resolution()) + " Hz below " +
                               firmware::shortest(0.5 * result.sample_rate) + " Hz");
  }

  if (options.uff) firmware::write_file(*options.uff, frf::to_universal_file(result));
  if (options.report) firmware::write_file(*options.report, with_how_made(frf::response_page(result)));
  if (write_json(options.json, frf::to_json(result))) return;
  std::string files;
  for (const std::string& file : result.recordings) files += (files.empty() ? "" : ", ") + firmware::one_line(file);
  std::printf("%s: %.6g s at %.6g Hz\n%s", files.c_str(), result.duration, result.sample_rate, note.c_str());
  print_blocks(result);
  for (const frf::OutputResponse& output : result.outputs) print_response(result, output);
}

void add_frf(CLI::App& app, FrfOptions& options) {
  CLI::App* command = app.add_subcommand("frf", "Frequency responses of recordings, with their 95 % bounds");
  command->add_option("--data", options.data, "Recording (CSV or .mat); several are joined")->required();
  command->add_option("--input", options.input, "Input channel, for example z_r")->required();
  command->add_option("--output", options.outputs, "Output channel, for example F_w; may be given several times")
      ->required();
  command->add_option("--rig", options.rig,
                      "Rig description (TOML) with [channels] and sample rate; for a hil rig z_r "
                      "becomes the instrument of responses inside the loop");
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_option("--report", options.report, "Write the responses as a page (HTML)");
  command->add_option("--uff", options.uff, "Write the responses as universal file, datasets 58");
  command->add_option("--estimator", options.estimator,
                      "h1 (noise in the output; default), h2 (in the input) or hv (in both)");
  command->add_option(
      "--instrument", options.instrument,
      "Channel that has neither the noise of the input nor that of the output, for example z_r; or none");
  command->add_option("--lowest-damping", options.lowest_damping, "Damping ratio of the sharpest peak to be resolved")
      ->capture_default_str();
  command->add_option("--lowest-frequency", options.lowest_frequency, "Frequency of that peak [Hz]")
      ->capture_default_str();
  command->add_option("--block", options.block, "Block length [s] (default: chosen)");
  command->add_option("--overlap", options.overlap, "Overlap of blocks, 0 … 0.95 (default: chosen)");
  command->add_option("--window", options.window, "hann, hamming, blackman or rectangular")->capture_default_str();
  command->add_option("--detrend", options.detrend, "Removed from each block: none, mean or line")
      ->capture_default_str();
  command->add_option("--from", options.from, "Lowest frequency in the result [Hz]");
  command->add_option("--to", options.to, "Highest frequency in the result [Hz]");
  command->add_flag("--no-delay-compensation", options.no_delay_compensation,
                    "Do not shift the blocks of a delayed output");
  command->add_flag("--unwrap", options.unwrap, "Unwrap the phases");
  command->callback([&options] { measure_responses(options); });
}

}  // namespace host_sim
