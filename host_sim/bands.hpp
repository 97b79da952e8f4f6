// Third-octave bands: where in frequency a signal, or the error of one, lies.
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

/// The name that people use for f_m, from IEC 61260-1 annex E: "12.5", "16", "1000", "0.8".
[[nodiscard]] std::string nominal_name(const Band& band);

/// The bands that `samples` samples at `sample_rate` can tell: from the lowest that is at least four frequency lines
/// (sample_rate/samples) wide to the highest that begins below half the sample rate. Empty for fewer than 16 samples.
[[nodiscard]] std::vector<Band> resolved_bands(std::size_t samples, double sample_rate);

/// The rms of a signal, without its mean, band by band, and what lies outside the bands:
///
///   (2)  below² + Σ rms_i² + above² = variance of the signal, to rounding
struct BandRms {
  double below = 0.0;       ///< slower than the lowest band [unit of the signal]
  std::vector<double> rms;  ///< for each band [unit of the signal]
  double above = 0.0;       ///< faster than the highest band
};

/// Adjoining bands, as resolved_bands() returns them. From the transform of the whole signal: its mean removed, its
/// first and last 5 % tapered with half a cosine, padded with zeros to a fast length. The taper keeps the slow part of
/// a signal whose ends do not meet – as of a road – out of the bands above; what it takes away is given back in
/// proportion, which makes (2) exact. The power of a line of the spectrum is spread evenly over its width, and so
/// shared by two bands.
[[nodiscard]] BandRms band_rms(std::span<const double> signal, double sample_rate, std::span<const Band> bands);

}  // namespace host_sim
