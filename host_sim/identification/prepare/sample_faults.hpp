// What a recorder does to single samples: it strikes a few of them far off, and it rounds all of them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace host_sim::identification {

/// Samples that are far off by themselves: a bit that flipped, a spike on the line. Motion is no outlier, because
/// samples beside it belong to it.
///
///   (1)  p_k = polynomial of fourth degree through the six samples on either side of k, without k itself
///   (2)  e_k = (x_k − p_k) / √(1 + l_k),  l_k: variance of p_k ÷ σ², so that white noise leaves e of variance σ²
///   (3)  s = 1.4826 · median |e| of the 192 samples around k; tails = q_95 of |e|/s of the channel ÷ 1.96, at least 1
///   (4)  |e_k| > thresholds::outlier_deviations · tails · s
///   (5)  rms of what the polynomial leaves beside k ≤ thresholds::quiet_beside_outlier · s
///   (6)  a polynomial with a jump between two samples explains all, k included, worse by thresholds::no_jump² · s²
///
/// s is at least thresholds::rounding_error of `step` and thresholds::least_outlier_scale of the channel's spread. A
/// bend and a pulse of several samples fail (5), a jump fails (6). One sample beside k may be left out of both, and two
/// where thresholds::strikes_often outliers were found without. Largest first; what was found is left out of the fits
/// that follow. Source: F. R. Hampel, J. Am. Stat. Assoc. 69, 1974 (median absolute deviation).
///
/// A rig that touches a stop for a millisecond makes such samples, too; assess/lost_samples.hpp counts only what the
/// model does not explain.
///
/// The first and the last two samples have too few neighbours. `unusable`: samples that say nothing; empty: none.
/// At the limit of a channel that is cut off there is no noise, so no sample counts that has one of these among its six
/// neighbours on either side. `step`: of quantisation, 0: none. Returns places, ascending; none where none stands
/// thresholds::surest_outlier · s off, or where more than thresholds::most_outliers of the samples would be outliers:
/// then it is how the channel is.
[[nodiscard]] std::vector<std::size_t> find_outliers(const std::vector<double>& samples,
                                                     const std::vector<bool>& unusable = {}, double step = 0.0);

/// The |value| at which a channel is cut off: the largest that comes again exactly, four times and more. Beyond it are
/// at most a quarter as many: what an interpolation makes of the corners. nullopt: it is not.
[[nodiscard]] std::optional<double> cut_off_at(const std::vector<double>& samples);

/// Of one channel, as they are left out.
struct Outliers {
  std::size_t count = 0;        ///< in the recording at its own rate
  std::vector<std::size_t> at;  ///< samples of the simulation that are among them
  std::vector<double> values;   ///< recorded there [SI]
};

/// A test whether outliers come at random: the values of another channel at the outliers, compared with all values of
/// that channel. Outliers within six samples of each other count as one.
///
///   (8)  √n sup |share of the n places whose value lies below v − share of all samples below v|
///
/// Above λ with a chance of 2 e^{−2λ²} where they are random. Source: A. Kolmogorov, Giornale dell'Istituto Italiano
/// degli Attuari 4, 1933. `places` ascend.
[[nodiscard]] double place_deviation(const std::vector<double>& values, const std::vector<std::size_t>& places);

/// e_k / s of (2) and (3), for a look at one channel beside the outliers of another; 0 where there are too few samples.
[[nodiscard]] std::vector<double> relative_deviations(const std::vector<double>& samples,
                                                      const std::vector<bool>& unusable = {}, double step = 0.0);

/// p_k of (1) in the place of each of these samples.
void mend_outliers(std::vector<double>& samples, const std::vector<std::size_t>& outliers,
                   const std::vector<bool>& unusable = {});

/// The step to which samples are rounded: the greatest distance of which every distance between two of them is a
/// multiple. 0: there is none, or too few different values to tell.
///
///   (7)  x_k = x_0 + n_k · step   within thresholds::grid_error · step, for thresholds::on_the_grid of the samples
///
/// The lowest and the highest value are no part of it: a limit lies where it wants.
[[nodiscard]] double quantisation_step(std::vector<double> samples);

/// rms of the error of rounding, step/√12: uniform, and white where the signal or other noise passes a step in a sample
/// or two. Source: B. Widrow, I. Kollár, Quantization Noise, 2008, ch. 5.
[[nodiscard]] double rounding_noise(double step);

}  // namespace host_sim::identification
