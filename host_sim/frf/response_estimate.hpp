// Measured frequency responses of recordings: what is asked for, and what comes out.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/frf/block_choice.hpp"
#include "host_sim/frf/estimators.hpp"
#include "host_sim/recording.hpp"
#include "model/channel.hpp"

namespace host_sim::frf {

struct Request {
  model::Channel input = model::Channel::z_r;
  std::vector<model::Channel> outputs;       ///< each once, none of them the input
  std::optional<model::Channel> instrument;  ///< for Estimator::instrument, and only for it
  Estimator estimator = Estimator::h1;
  BlockWish blocks;
  bool compensate_delay = true;
  bool unwrap = false;            ///< phases run on over ±π
  double lowest_frequency = 0.0;  ///< lines below are left out [Hz]
  double highest_frequency = std::numeric_limits<double>::infinity();
};

/// 95 % bounds.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// One output over the input; all vectors by frequency line.
struct OutputResponse {
  model::Channel output{};
  std::vector<double> magnitude;         ///< |H| [unit of the output / unit of the input]; not finite: no input power
  std::vector<double> phase;             ///< arg H [rad]; −ωτ for an output that is the input a time τ later
  std::vector<double> coherence;         ///< of input and output, 0 … 1
  std::vector<Interval> magnitude_ci95;  ///< high may be infinite
  std::vector<Interval> phase_ci95;      ///< phase ± π where nothing is known of it
  std::vector<bool> determined;          ///< whether the data tell H from 0
  std::optional<std::ptrdiff_t> delay;   ///< of the output against the input, found by correlation [samples]
  bool compensated = false;              ///< blocks were shifted by it, and the phase turned back
  double delay_bias = 0.0;               ///< the share of |H| that the delay takes (or would have) in blocks unshifted
};

struct Responses {
  Request request;
  double sample_rate = 0.0;             ///< [Hz]
  double duration = 0.0;                ///< of all recordings [s]
  std::vector<std::string> recordings;  ///< the files
  BlockChoice blocks;
  std::size_t averages = 0;                  ///< K
  double effective_averages = 0.0;           ///< K independent ones would know as much
  std::vector<double> frequency;             ///< [Hz], without 0 and half the sample rate, where phases mean nothing
  std::vector<double> instrument_coherence;  ///< of instrument and input; empty without an instrument
  std::vector<OutputResponse> outputs;       ///< as requested

  /// 1/T [Hz]
  [[nodiscard]] double resolution() const { return sample_rate / static_cast<double>(blocks.scheme.length); }
};

/// A delay is compensated where it takes more than this share of |H|.
inline constexpr double noticeable_delay_bias = 1e-3;

/// Joins the recordings' blocks and estimates. InputErrors: a channel that is missing or never changes, sample rates
/// that differ by more than 10⁻⁴, recordings too short for the blocks.
[[nodiscard]] Responses estimate_responses(std::span<const Recording> recordings, const Request& request);

}  // namespace host_sim::frf
