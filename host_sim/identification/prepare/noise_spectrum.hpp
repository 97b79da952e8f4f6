// The spectrum of a sensor's noise: its level and its colour.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "model/components/channel.hpp"

namespace host_sim::identification {

/// Spectrum of white noise behind a Butterworth low-pass, with T the sample period and H(x) that of
/// common/butterworth.hpp:
///
///   (1)  h(f) = |H(x)|²
///        x = tan(πfT)/tan(π corner T)    digital: computed from the samples
///          = f/corner                    analogue: computed for more samples than were kept
///          = sin(πfT)/sin(π corner T)    folded: before the converter; noise above the Nyquist frequency came back
///                                        (order 1: exactly, of one time constant)
///   (2)  h(f) = |Σ_k H((f + k/T)/corner) (1 − e^{−2πi fT})/(2πi (fT + k)) e^{2πi kd}|²
///                                        held: before the converter, of noise that is a value a sample and is read
///                                        d samples after it was renewed; with d = 0 of first order it is folded noise
struct NoiseColour {
  enum class Filter : unsigned char { digital, analogue, folded, held };

  double corner = 0.0;  ///< [Hz]; 0: white
  int order = 0;
  Filter filter = Filter::digital;
  double late = 0.0;  ///< [samples] d of held noise; −0.1 … 0.1

  [[nodiscard]] bool is_white() const { return order == 0; }
  [[nodiscard]] double power(double f, double period) const;  ///< (1)
  [[nodiscard]] double mean_power(double period) const;       ///< of (1), 0 Hz to the Nyquist frequency
  friend bool operator==(const NoiseColour&, const NoiseColour&) = default;
};

/// The noise of one channel. Its power at a frequency, per sample, is level² h(f); its rms is level √(mean of h).
struct ChannelNoise {
  double level = 0.0;
  NoiseColour colour{};
  double relative_error = 0.0;     ///< standard error of `level` ÷ level; 1: not known, `level` is a guess
  double corner_half_width = 0.0;  ///< [Hz] of the 95 % interval
  double highest_level = 0.0;      ///< the channel's own spectrum holds no more of this colour; 0: not looked at
  bool on_signal = false;          ///< a hypothesis has this low-pass for the signal, too
  bool ends = false;  ///< in rounding, below the Nyquist frequency: white noise does not, a driven motion may

  [[nodiscard]] double rms(double period) const;
  [[nodiscard]] bool is_known() const;        ///< to thresholds::noise_level_known
  [[nodiscard]] bool shows_a_filter() const;  ///< and its corner to thresholds::corner_known
};
using ChannelNoises = std::array<ChannelNoise, model::channel_count>;

/// Noise from the spectrum above the motion, f ≥ thresholds::noise_begins. There a channel holds noise and the tail of
/// what the corners of the rig leave: a step of a force or acceleration has the power of (4) at every frequency, a
/// bend of a position the square of that.
///
///   (3)  S(f) = h(f) (level² + b q(f)),      level² ≥ 0, b ≥ 0
///   (4)  q(f) = 1 / (4 sin²(πfT))
///
/// The motion itself reaches above noise_begins, too, where a road or a machine drives it there: its acceleration falls
/// with a power of the frequency. Beside (4) the tails of
///
///   (4′)  q(f) = 1 / (2πfT)^{2n},            n = thresholds::flattest_motion … steepest_motion
///
/// are tried over white noise where `is_foot_point`. (A road behind a Butterworth low-pass of fourth order has n = 3 in
/// zdd_r.)
///
/// (3) is fitted by maximum likelihood to band powers P of ν degrees of freedom, the median over the lines of a band,
/// which single lines do not move:
///
///   (5)  min  Σ 2ν (P/S + ln S) + thresholds::colour_price · parameters
///
/// over white noise and low-passes of order 1 … 4, as far as the channel holds their noise at low frequencies, too: an
/// acceleration hardly moves at 2 Hz, and noise behind 40 Hz would be seen there. (2) is tried without a tail
/// only. Its power, and that of (4′), is known to a share e(f) (thresholds::form_known_to), and for both
///
///   (6)  1/ν′ = 1/ν + e²       takes the place of ν in (5), with ln(ν/ν′) added for each band
///
/// until the kind of low-pass is found. Then d of (2) is fitted with the corner and (d/thresholds::usual_reading)²
/// added to (5), and the form is known; so it is for every noise of first order, of which (2) is nearly each kind.
///
/// `level` is thresholds::least_of_tail of the lowest power of a band, ÷ h, at least: below a tail, noise is not seen.
/// `expected`: the colour of other channels, which one recorder has filtered; it costs nothing, and another corner
/// thresholds::other_corner_price. A corner under a tail that no other channel has is a guess, and its half width is
/// the corner itself. nullopt: too few samples. Source of (5): P. Whittle, as in noise/whitening.hpp.
struct NoiseSpectrumFit {
  ChannelNoise noise;
  double tail = 0.0;  ///< b
};
[[nodiscard]] std::optional<NoiseSpectrumFit> fit_noise_spectrum(const std::vector<double>& samples, double period,
                                                                 bool is_position,
                                                                 const std::optional<NoiseColour>& expected = {},
                                                                 bool is_foot_point = false);

/// The colour that positions, which have no tails, agree on: the middle corner. nullopt: they are white, or one alone
/// has a corner that lies below all that are seen.
[[nodiscard]] std::optional<NoiseColour> expected_colour(const ChannelNoises& noises);

}  // namespace host_sim::identification
