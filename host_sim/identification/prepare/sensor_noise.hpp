// The noise of a sensor: declared, or estimated from its samples.
#pragma once

#include <optional>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/identification/prepare/noise_spectrum.hpp"

namespace host_sim::identification {

/// rms of the white noise in samples of a smooth signal, from sixth differences:
///
///   (1)  σ² = median over stretches of 64 samples of  mean (δ⁶x)² / (m Σ w²),   w = 1 −6 15 −20 15 −6 1
///   (2)  m = (1 − 2/9k)³ = 0.967                          median ÷ mean of χ²_k/k
///   (3)  k = 64/Σρ² = 20,  ρ_j = C(12, 6+j)/C(12, 6)      so many of the 64 correlated differences count
///
/// A signal below a tenth of the sample rate leaves less than 4e-3 of its amplitude in δ⁶x. The median ignores
/// stretches with events. Source: T. Gasser, L. Sroka, C. Jennen-Steinmetz, Residual variance and residual pattern in
/// nonlinear regression, Biometrika 73, 1986 (differences of second order there).
struct NoiseEstimate {
  double rms = 0.0;
  double relative_error = 0.0;  ///< standard error of rms ÷ rms, from the scatter of the stretches
};
[[nodiscard]] NoiseEstimate noise_estimate(const std::vector<double>& samples);
[[nodiscard]] double estimated_noise(const std::vector<double>& samples);

/// Ratio of a channel's noise to its declared noise.
struct NoiseFactor {
  double value = 1.0;
  double half_width = 0.0;  ///< of the 95 % interval
};

/// Level and colour of a channel's noise, and how well they are known.
struct SensorNoise {
  ChannelNoise noise;
  std::optional<NoiseFactor> factor;  ///< nullopt: nothing declared, or its samples say nothing
  bool rounded = false;               ///< rounding makes it louder than declared, or is most of it; `factor` is without
};

/// The noise in samples. It is white where (1) of the samples, which weighs the highest third of the frequencies, and
/// of every other one, an octave below, agree within thresholds::white_noise; else the spectrum is fitted
/// (noise_spectrum.hpp, with `expected`).
[[nodiscard]] ChannelNoise noise_in(const std::vector<double>& samples, double period, model::Channel channel,
                                    const std::optional<NoiseColour>& expected = {});

/// Noise that was found in samples, with what was declared, an rms, as a prior. Beyond thresholds::noise_as_declared
/// the level of white noise is the mean of both in logarithms, weighted by what is known of each: a factor of
/// thresholds::usual_noise_factor, and the relative error of what was found. Coloured noise, noise that ends below
/// the Nyquist frequency, and noise at a rate at which motion may reach beyond thresholds::noise_begins, is what was
/// found, within that factor. What was declared
/// stands where the samples do not tell noise from motion, with the colour of the other channels.
[[nodiscard]] SensorNoise with_declared(ChannelNoise found, std::optional<double> declared, double period,
                                        const std::optional<NoiseColour>& expected = {});

/// How exact the model is that is compared with a channel:
///
///   (4)  thresholds::model_exactness · rms(x − x̄)
///
/// A channel that shows motion alone above its noise (sampled_recording.cpp) is not taken for more exact than that: a
/// simulated channel without noise has the error of the simulation, and what its spectrum falls off with is no filter.
[[nodiscard]] double exactness_of_model(const std::vector<double>& samples, const std::vector<bool>& filled);

/// Both for a channel. Of a channel that is held, the new values are looked at, and their noise is taken for white.
/// `step`: of rounding (sample_faults.hpp), whose noise belongs to that of the channel:
///
///   (3)  σ² = declared² + step²/12,  or found, step²/12 at least
[[nodiscard]] SensorNoise find_sensor_noise(const firmware::RigDescription& description,
                                            const firmware::Recording& recording, model::Channel channel,
                                            const std::optional<NoiseColour>& expected = {}, double step = 0.0);

/// Its factor.
[[nodiscard]] std::optional<NoiseFactor> noise_factor(const firmware::RigDescription& description,
                                                      const firmware::Recording& recording, model::Channel channel);

/// Its level: rms [SI] of white noise that has the power per sample of the channel's noise below its corner.
[[nodiscard]] double sensor_noise(const firmware::RigDescription& description, const firmware::Recording& recording,
                                  model::Channel channel);

}  // namespace host_sim::identification
