// Whether the bands of a transfer mean what they say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace transfer_calibration {

/// Ranks of true values among draws, as counts of `bins` equally likely bins.
///
///   (1)  χ² = Σ (count − n/bins)² ÷ (n/bins)      of bins − 1 degrees of freedom where ranks are uniform
///
/// Source: S. Talts et al., Validating Bayesian inference algorithms with simulation-based calibration, 2018.
struct Ranks {
  static constexpr std::size_t bins = 8;
  std::vector<std::size_t> counts = std::vector<std::size_t>(bins);
  void add(double share);  ///< of the draws that are smaller than the truth, 0 … 1
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] double chi_squared() const;
  [[nodiscard]] double p() const;
};

/// Rigs drawn from the prior: tolerated parameters uniform within their tolerances. Each is recorded on a bench by the
/// firmware, its posterior sampled and its wheel load predicted on the quarter car.
struct PriorResult {
  std::map<std::string, Ranks> ranks;  ///< by parameter, and "rms_F_w" of the prediction
};
[[nodiscard]] PriorResult calibrate_on_prior(std::size_t rigs, std::uint64_t seed);

/// What hides in a pair of rigs of tests/truth beside what both descriptions say.
enum class Hidden : unsigned char {
  known,       ///< nothing, or on the first rig an effect of the catalogue
  second_rig,  ///< an effect of the second rig alone, which the first cannot know
  component,   ///< a law of the component on both rigs that the catalogue does not hold; the car is known exactly
};

/// A hil rig and a quarter car of tests/truth with one component, transferred by the whole of rigtwin transfer.
struct TruthCase {
  std::uint64_t seed = 0;
  std::string outside;  ///< effect of the second rig alone, or law of the component; empty: none
  std::string failure;  ///< why there is no result
  double coverage50 = 0.0, coverage95 = 0.0;
  double coverage50_without = 0.0, coverage95_without = 0.0;  ///< without the discrepancy process; draws as they are
  double discrepancy = 0.0;                                   ///< largest share of the force over the bands
  double confounded = 0.0;  ///< largest share of a parameter's variance that stands for it
  double deviation = 0.0;   ///< largest of a band, relative
  std::string travels;      ///< laws and effects that were learned on the first rig and carried over
  double load = 0.0;        ///< share of the quantities in their 95 % bands
  bool holds = false;       ///< the verdict
  bool said = false;        ///< does not hold, or the effect is named on the second rig
};
[[nodiscard]] TruthCase transfer_truth(std::uint64_t seed, Hidden hidden, double duration);

}  // namespace transfer_calibration
