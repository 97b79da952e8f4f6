// Measured frequency responses of recordings: request and result.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/frf/block_choice.hpp"
#include "host_sim/frf/estimators.hpp"
#include "model/components/channel.hpp"

namespace host_sim::frf {

struct Request {
  model::Channel input = model::Channel::z_r;
  std::vector<model::Channel> outputs;       ///< each once, none of them the input
  std::optional<model::Channel> instrument;  ///< for Estimator::instrument, and only for it
  Estimator estimator = Estimator::h1;
  BlockWish blocks;
  bool compensate_delay = true;
  bool unwrap = false;            ///< unwrapped phases
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
  std::vector<Interval> phase_ci95;      ///< phase ± π where H is not determined
  std::vector<bool> determined;          ///< H is distinguishable from 0
  std::optional<std::ptrdiff_t> delay;   ///< of the output against the input, found by correlation [samples]
  bool compensated = false;              ///< blocks were shifted by the delay and the phase corrected
  double delay_bias = 0.0;               ///< relative loss of |H| by the delay without shifted blocks
};

struct Responses {
  Request request;
  double sample_rate = 0.0;             ///< [Hz]
  double duration = 0.0;                ///< of all recordings [s]
  std::vector<std::string> recordings;  ///< the files
  BlockChoice blocks;
  std::size_t averages = 0;                  ///< K
  double effective_averages = 0.0;           ///< equivalent number of independent averages
  std::vector<double> frequency;             ///< [Hz], without 0 and half the sample rate, where phases are undefined
  std::vector<double> instrument_coherence;  ///< of instrument and input; empty without an instrument
  std::vector<OutputResponse> outputs;       ///< as requested

  /// 1/T [Hz]
  [[nodiscard]] double resolution() const { return sample_rate / static_cast<double>(blocks.scheme.length); }
};

/// A delay is compensated if it reduces |H| by more than this share [1]. 0.1 % is the random
/// error of an hour of recording at a coherence of 0.999; at 1 % the bias would exceed it, at 0.05 % nothing is gained.
inline constexpr double noticeable_delay_bias = 1e-3;

/// Estimates from the blocks of all recordings. InputErrors: a missing or constant channel, sample rates that differ by
/// more than 10⁻⁴, recordings too short for the blocks.
[[nodiscard]] Responses estimate_responses(std::span<const firmware::Recording> recordings, const Request& request);

}  // namespace host_sim::frf
