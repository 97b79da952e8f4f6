#include "host_sim/commands/diagnose_live.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/internet_address.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/run_stopped.hpp"
#include "host_sim/commands/common/ending_signals.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/diagnose_command.hpp"
#include "host_sim/live/live_report.hpp"
#include "host_sim/live/live_watch.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/watch/receiver.hpp"

namespace host_sim {
namespace {

/// [s] without a datagram, first and later. Half: a controller that arms its pumps slowly is given up. Twice: the user
/// waits for nothing.
constexpr double patience = 10.0;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void print_end(const live::Progress& progress, const std::vector<live::Finding>& findings) {
  std::printf("%.1f s of motion watched, %zu candidates; %zu finding%s\n", progress.watched, progress.candidates,
              findings.size(), findings.size() == 1 ? "" : "s");
  if (progress.watched == 0.0) {
    std::printf("not watched yet: %.1f s of motion were lacking%s%s\n", progress.lacking,
                progress.waits_for.empty() ? "" : "; ", progress.waits_for.c_str());
  }
}

/// The samples of row k.
live::LiveSample sample_at(const firmware::Recording& recording, std::size_t k) {
  live::LiveSample sample;
  sample.time = recording.time[k];
  if (!recording.filled.empty() && recording.filled[k]) return sample;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (!recording.channels[c].empty()) sample.values[c] = recording.channels[c][k];
  }
  for (std::size_t d = 0; d < recording.ducts.size(); ++d) {
    if (!recording.ducts[d].empty()) sample.ducts[d] = recording.ducts[d][k];
  }
  return sample;
}

void diagnose_recording(const DiagnoseOptions& options, const firmware::RigDescription& description) {
  const auto parts = read_parts(options.live, description.channels, description.sample_rate, description.rig.kind);
  live::LiveDiagnosis diagnosis(description);
  const bool quiet = options.json == "-";
  for (const firmware::Recording& part : parts) {
    if (std::abs(part.sample_period * description.sample_rate - 1.0) > 1e-6) {
      throw firmware::InputError(
          part.source, 0, "is sampled at " + firmware::shortest(1.0 / part.sample_period) + " Hz",
          "the sample_rate of the description, " + firmware::shortest(description.sample_rate) + " Hz");
    }
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (const live::Finding& finding : diagnosis.push(sample_at(part, k))) {
        if (!quiet) std::printf("%.2f s  %s\n", finding.named_at, sentence(finding).c_str());
      }
    }
  }
  if (diagnosis.progress().stage == live::Progress::Stage::waiting && !diagnosis.progress().waits_for.empty()) {
    throw firmware::InputError(parts.front().source, 0, diagnosis.progress().waits_for,
                               "a recording of a rig that moves, with the channels of its description");
  }
  if (!write_json(options.json, to_json(diagnosis.progress(), diagnosis.findings(), ""))) {
    print_end(diagnosis.progress(), diagnosis.findings());
  }
}

void diagnose_controller(const DiagnoseOptions& options, const firmware::RigDescription& description) {
  const firmware::InternetAddress from =
      firmware::parse_host_port("--live", options.live, {.port_alone = true, .any_port = true});
  const std::string socket = operators_socket(options.socket, description.hardware.schedule.socket);
  const sigset_t ending = block_ending_signals();
  const bool quiet = options.json == "-";
  watch::Feed feed;
  live::LiveWatch diagnosis(description, socket, feed, [quiet](const std::string& line) {
    if (quiet) return;
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  });
  const watch::Receiver receiver(from, feed);
  if (!quiet) {
    std::printf("values from UDP %s (rig_controller --publish)\n", receiver.address().text().c_str());
    std::fflush(stdout);
  }
  double heard = now();
  while (true) {
    const timespec pause{0, 100'000'000};
    if (::sigtimedwait(&ending, nullptr, &pause) > 0) break;
    const watch::Link link = feed.link(now());
    if (link == watch::Link::live) heard = now();
    if (link == watch::Link::ended || !diagnosis.state().error.empty()) break;
    if (now() - heard > patience) {
      throw firmware::InputError(receiver.address().text(), 0,
                                 (link == watch::Link::waiting ? "no datagram came in " : "no datagram has come for ") +
                                     firmware::shortest(patience) + " s",
                                 "a controller that publishes there (rig_controller --publish)");
    }
  }
  diagnosis.finish();
  const live::LiveWatch::State state = diagnosis.state();
  if (state.failure) std::rethrow_exception(state.failure);
  if (!write_json(options.json, to_json(state.progress, state.findings, state.stop))) {
    print_end(state.progress, state.findings);
  }
  if (state.stopped) throw firmware::RunStopped("the diagnosis has stopped the run: " + state.stop);
  if (!state.stop.empty()) throw firmware::InputError(socket, 0, state.stop, "the socket of the controller (--socket)");
}

}  // namespace

std::string operators_socket(const std::string& given, const std::string& described) {
  if (!given.empty()) return given;
  return described.empty() ? "/run/rigtwin/control.sock" : described;
}

void diagnose_live(const DiagnoseOptions& options) {
  if (options.rig.empty()) throw firmware::UsageError("diagnose --live: --rig is needed");
  if (!options.data.empty() || !options.holdout.empty() || !options.out.empty() || !options.campaign.empty()) {
    throw firmware::UsageError("diagnose --live takes no --data, --holdout, --campaign or --out");
  }
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  std::error_code error;
  const bool names_a_file = options.live.find('/') != std::string::npos || options.live.ends_with(".csv") ||
                            options.live.ends_with(".mat") || std::filesystem::exists(options.live, error);
  if (names_a_file) return diagnose_recording(options, description);
  diagnose_controller(options, description);
}

}  // namespace host_sim
