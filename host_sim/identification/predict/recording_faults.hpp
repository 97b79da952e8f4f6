// Faults of a recording as part of a hypothesis: what lies between the rig's channels and the samples in the file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/comparison/simulation.hpp"

namespace host_sim::identification {

/// A cause that the catalogue of effects does not hold, since no component of the rig makes it:
///
///   clock          (1)  reading(t) = truth(t − offset + rate · t)        t from the first sample of the recording
///   common_filter  (2)  a Butterworth low-pass of order 1 … 4, analogue or digital (low_pass.hpp)
///                  (2b) `inverse`: what was before it
///   mains_hum      (3)  reading(t) = truth(t) + a_c cos(2π f t) + b_c sin(2π f t)      for each channel c
///   drift          (4)  parameter(t) = value · (1 + change · g(t/T)),   T: length of the recording
///                       g(s) = (1 − e^{−κ s})/(1 − e^{−κ})              a first-order warm-up; κ = 0: g = s
///
/// (1): offset > 0 is late; with rate > 0 the clock of these channels runs slow. (1) to (3) act on each of `channels`
/// behind the model's own sensors, in the order (2), (1), (3); (2b) before them. In (4) `value` is that of the
/// hypothesis' rig, at the beginning of the recording. (2b): the input is behind the filter, and these channels are
/// not. A rig that is driven by what the filter left shows what it would show behind the same filter, as far as it is
/// linear.
enum class FaultKind : unsigned char { clock, common_filter, mains_hum, drift };

struct PlacedFault {
  FaultKind kind{};
  std::vector<model::Channel> channels{};  ///< of a drift: none
  std::string path{};                      ///< of a drift: the parameter
  int order = 1;                           ///< of a filter
  bool digital = false;                    ///< of a filter: computed from the samples
  bool inverse = false;                    ///< of a filter: (2b)
  bool seen = false;                       ///< of a filter: the colours of the noises say which channels it has
  std::vector<double> values{};  ///< offset [s], rate [1] | corner [Hz] | f [Hz], a_1, b_1, a_2 … [SI] | change, κ [1]
  /// Whether each of the values is fitted; a clock may have an offset or a rate alone, a drift no κ.
  std::vector<bool> fitted{};

  [[nodiscard]] bool acts_on(model::Channel channel) const;
  /// Whether it is this channel's clock or filter: an inverse filter acts on the channels it is not of.
  [[nodiscard]] bool is_of(model::Channel channel) const { return acts_on(channel) != inverse; }
};

/// A clock whose offset [s] and rate [1] are fitted, and a filter whose corner [Hz] is.
[[nodiscard]] PlacedFault clock_fault(std::vector<model::Channel> channels, double offset, double rate);
[[nodiscard]] PlacedFault filter_fault(std::vector<model::Channel> channels, double corner, int order);

/// True if one of the faults acts between a channel's sensor and its samples.
[[nodiscard]] bool alters(const std::vector<PlacedFault>& faults, model::Channel channel);

/// True if a parameter of the rig changes with time.
[[nodiscard]] bool drifts(const std::vector<PlacedFault>& faults);

/// (1) of a signal that is known at samples `period` [s] apart: on a polynomial of fifth order between them, constant
/// beyond its ends.
[[nodiscard]] std::vector<double> shifted(const std::vector<double>& values, double offset, double rate, double period);

/// (2b): what a channel is on the rig itself, of what it is on a rig that is driven by the filtered input. Its own
/// sensor, which may cut it off, comes behind that.
[[nodiscard]] std::vector<double> before_filter_of_input(const std::vector<PlacedFault>& faults, model::Channel channel,
                                                         std::vector<double> values, double period);

/// Samples of a channel as the other faults leave them; `period` [s].
[[nodiscard]] std::vector<double> with_faults(const std::vector<PlacedFault>& faults, model::Channel channel,
                                              std::vector<double> values, double period);

/// A rig whose parameters drift, as one that changes in small steps; no step where nothing drifts. `samples` of the
/// recording, `period` [s] apart.
[[nodiscard]] RigVariation variation_of(const model::RigParameters<double>& rig, const std::vector<PlacedFault>& faults,
                                        std::size_t samples, double period);

/// The faults of a description's recorder in a recording that is driven by the channel `input` and explains `channels`.
/// What the input has is undone in the others: (2b), a clock that is early. Hum has its amplitude as a cosine.
[[nodiscard]] std::vector<PlacedFault> described_faults(const firmware::RecorderDescription& recorder,
                                                        model::Channel input,
                                                        const std::vector<model::Channel>& channels);

/// The reverse: what a rig description says of these faults.
[[nodiscard]] firmware::RecorderDescription recorder_of(const std::vector<PlacedFault>& faults, model::Channel input,
                                                        const std::vector<model::Channel>& channels);

/// Gives hum the phase that measured − read has at its frequency, least squares; the amplitude stays.
void set_phases(PlacedFault& hum, const firmware::Recording& measured, const Response& read);

/// Simulated channels as a described recorder records them; `measured` gives the phase of hum. Both at one rate.
void record_with(const firmware::RecorderDescription& recorder, model::Channel input,
                 const firmware::Recording& measured, Response& channels);

/// The rig of (4) at a share of the recording, 0 … 1.
[[nodiscard]] model::RigParameters<double> drifted(const model::RigParameters<double>& rig,
                                                   const std::vector<PlacedFault>& faults, double share);

}  // namespace host_sim::identification
