// Third-octave bands of a signal.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace host_sim {

/// A third-octave band of the base-ten system:
///
///   (1)  f_m = 1000 · 10^(n/10) Hz,   edges f_m · 10^(±1/20)
///
/// Source: IEC 61260-1:2014, 5.2–5.5.
struct Band {
  int number;     ///< n
  double lower;   ///< [Hz]
  double centre;  ///< exact mid-band frequency f_m [Hz]
  double upper;   ///< [Hz], the next band's lower edge to the bit
};

[[nodiscard]] Band third_octave_band(int number);

/// The nominal name of f_m from IEC 61260-1 annex E: "12.5", "16", "1000", "0.8".
[[nodiscard]] std::string nominal_name(const Band& band);

/// The bands that `samples` samples at `sample_rate` resolve: from the lowest that is at least four frequency lines
/// (sample_rate/samples) wide to the highest that begins below half the sample rate. Empty for fewer than 16 samples.
[[nodiscard]] std::vector<Band> resolved_bands(std::size_t samples, double sample_rate);

/// The rms of a signal without its mean, by band, and the rms outside the bands:
///
///   (2)  below² + Σ rms_i² + above² = variance of the signal, to rounding
struct BandRms {
  double below = 0.0;       ///< slower than the lowest band [unit of the signal]
  std::vector<double> rms;  ///< for each band [unit of the signal]
  double above = 0.0;       ///< faster than the highest band
};

/// `bands` must adjoin, as resolved_bands() returns them. The whole signal is transformed: mean removed, first and last
/// 5 % tapered with half a cosine, padded with zeros to a fast length. Without the taper the slow part of a signal with
/// different ends (a road) would leak into higher bands. The result is scaled to the variance of the signal, which
/// makes (2) exact. The power of a frequency line is spread evenly over its width, so two bands may share it.
[[nodiscard]] BandRms band_rms(std::span<const double> signal, double sample_rate, std::span<const Band> bands);

}  // namespace host_sim
