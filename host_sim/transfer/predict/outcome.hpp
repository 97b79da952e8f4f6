// What is compared between prediction and measurement: responses, spectra and single numbers.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <string_view>
#include <vector>

#include "host_sim/comparison/simulation.hpp"

namespace host_sim::transfer {

using Complex = std::complex<double>;

/// Responses to the foot point and the channels that they belong to.
inline constexpr std::array<std::string_view, 2> response_names{"F_w/z_r", "zdd_b/z_r"};
inline constexpr std::array<std::string_view, 2> response_units{"N/m", "1/s²"};
inline constexpr std::array<model::Channel, 2> response_channel{model::Channel::F_w, model::Channel::zdd_b};

/// rms values of a channel are about its mean.
enum class Quantity : unsigned char {
  rms_F_w,                   ///< dynamic wheel load [N]
  dynamic_load_coefficient,  ///< rms_F_w ÷ static load: the fluctuation of the wheel load, D. Cebon, 1999 [1]
  rms_zdd_b,                 ///< [m/s²]
  weighted_zdd_b,            ///< rms of z̈_b weighted with W_k, comfort [m/s²]
  rms_dz_b,                  ///< stroke [m]
  peak_dz_b,                 ///< largest |stroke| [m]
};
inline constexpr std::size_t quantity_count = 6;
inline constexpr std::array<std::string_view, quantity_count> quantity_names{
    "rms_F_w", "dynamic_load_coefficient", "rms_zdd_b", "weighted_zdd_b", "rms_dz_b", "peak_dz_b"};
inline constexpr std::array<std::string_view, quantity_count> quantity_units{"N", "1", "m/s²", "m/s²", "m", "m"};
inline constexpr std::array<model::Channel, quantity_count> quantity_channel{
    model::Channel::F_w,   model::Channel::F_w,  model::Channel::zdd_b,
    model::Channel::zdd_b, model::Channel::dz_b, model::Channel::dz_b};

/// One run, or several together. H = S_zy/S_zz, by blocks of thresholds::block with a Hann window; all runs count as
/// one long one.
struct Outcome {
  std::array<std::vector<std::complex<double>>, 2> response;  ///< at the lines of the Analysis
  std::array<std::vector<double>, 2> density;                 ///< of F_w and z̈_b [unit²/Hz]
  std::array<double, quantity_count> quantity{};
};

/// |W_k(f)| of ISO 2631-1:1997, annex A: band limits 0.4 and 100 Hz, transition 12.5 Hz (Q 0.63), upward step 2.37 Hz
/// (Q 0.91) to 3.35 Hz (Q 0.91). Vertical vibration of a seated person.
[[nodiscard]] double vertical_weighting(double frequency);

/// What runs over the same inputs have in common: lines, foot-point spectra.
class Analysis {
 public:
  /// `foot_points`: z_r of each run, all at one rate [Hz].
  Analysis(std::vector<std::vector<double>> foot_points, double sample_rate, double static_load);

  [[nodiscard]] const std::vector<double>& frequencies() const { return frequencies_; }  ///< of the lines [Hz]
  [[nodiscard]] const std::vector<double>& foot_power() const { return foot_power_; }    ///< S_zz [m²/Hz]
  [[nodiscard]] double averages() const { return averages_; }                            ///< independent blocks
  [[nodiscard]] double line_width() const { return line_width_; }                        ///< [Hz]
  [[nodiscard]] double static_load() const { return static_load_; }                      ///< [N]
  [[nodiscard]] std::size_t runs() const { return foot_points_.size(); }

  /// Of the channels F_w, z̈_b and dz_b of each run; a channel that is empty has no response and NaN for its quantities.
  [[nodiscard]] Outcome of(std::span<const Response> runs) const;

 private:
  std::vector<std::vector<double>> foot_points_;
  double sample_rate_, static_load_;
  std::size_t block_ = 0, first_line_ = 0;
  double line_width_ = 0.0, averages_ = 0.0;
  std::vector<double> frequencies_, foot_power_;
};

}  // namespace host_sim::transfer
