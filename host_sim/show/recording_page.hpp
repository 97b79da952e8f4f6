// Recordings as a page: traces, spectra, statistics, and what was left out.
#pragma once

#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::show {

/// What a model makes of a recording: channels by model::Channel at the recorded instants, empty where it has none.
struct Simulated {
  std::string name;  ///< of the rig description
  Response channels;
};

/// A recording and the models behind it.
struct Shown {
  std::string name;  ///< for legends
  firmware::Recording recording;
  std::vector<Simulated> models{};
};

/// A trace of at most `most` points: of each stretch of samples its lowest and its highest, so that no peak is lost;
/// samples that were not recorded are gaps.
struct Trace {
  std::vector<double> time, values;
};
[[nodiscard]] Trace thinned(const firmware::Recording& recording, const std::vector<double>& values, std::size_t most);

/// Time from each recording's own beginning, a panel a channel: one zoom for all. Models are dashed.
void add_traces(report::Report& page, const std::vector<Shown>& shown);
/// Power spectral densities, a panel a channel.
void add_spectra(report::Report& page, const std::vector<Shown>& shown);
/// Mean, rms about it, lowest, highest, for each recording and channel.
void add_statistics(report::Report& page, const std::vector<Shown>& shown);

/// The page of `rigtwin show` and `rigtwin simulate --report`. Where z_r is recorded and two channels at least follow
/// it, the responses to it, too: several recordings then compare as one. Its first sentence says what was read.
[[nodiscard]] std::string recordings_page(const std::vector<Shown>& shown);

/// The first sentence of that page.
[[nodiscard]] std::string sentence(const std::vector<Shown>& shown);

}  // namespace host_sim::show
