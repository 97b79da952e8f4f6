// Statistics over the records of a campaign: a common distribution of each quantity, drift, outliers.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace host_sim::campaign {

/// One quantity of one record: a value with its 95 % interval.
struct Estimate {
  std::size_t record;  ///< number in the campaign, from 0
  double value, lower, upper;

  [[nodiscard]] double deviation() const { return (upper - lower) / (2.0 * 1.959964); }
};

/// A quantity over the campaign: an effect's parameter ("coulomb_friction: force [N]"), a rig's ("suspension.damping").
///
/// Each record's value is the fleet's mean plus what the record has of its own plus its error:
///
///   (1)  x_i = μ + b_i + e_i,   b_i ~ N(0, τ²),  e_i ~ N(0, σ_i²)
///   (2)  τ² = max(0, (Q − (k − 1))/(Σw − Σw²/Σw)),   w = 1/σ_i², Q = Σ w (x_i − Σwx/Σw)²
///   (3)  μ = Σ v x/Σ v,   v = 1/(σ_i² + τ²),   its variance 1/Σ v
///   (4)  shrunk_i = μ + (x_i − μ) τ²/(τ² + σ_i²),   variance σ_i² τ²/(τ² + σ_i²) + (σ_i²/(τ² + σ_i²))²/Σ v
///   (5)  drift: slope of the straight line through x_i over the number of the record, weights v
///   (6)  z_i = (x_i − μ_{−i})/√(σ_i² + τ_{−i}² + 1/Σ_{−i} v): without the record itself, which would hide it
///
/// A value whose |z| would be the largest of k once in twenty fleets is no member: (2) to (5) are of the others, and it
/// is not shrunk.
///
/// (4) is the best guess of a record's true value where the fleet is normal: its mean square error is least. Sources:
/// R. DerSimonian and N. Laird, Controlled Clinical Trials 7, 1986 (2); B. Efron and C. Morris, J. Am. Stat. Assoc. 70,
/// 1975 (4).
struct Quantity {
  std::vector<Estimate> estimates;
  double mean = 0.0, mean_deviation = 0.0;  ///< μ and its standard deviation
  double spread = 0.0;                      ///< τ, from record to record
  std::vector<double> shrunk, shrunk_deviation;
  double slope = 0.0, slope_deviation = 0.0;  ///< by record
  std::vector<double> z;                      ///< (6); 0 for fewer than four

  [[nodiscard]] bool drifts() const;  ///< the slope is beyond three of its deviations, and there are five records
};

/// (1)–(6). Intervals without a width (a value at its bound) count as wide as 10⁻⁶ of the value.
[[nodiscard]] Quantity fleet_of(std::vector<Estimate> estimates);

/// One record, as its verdict tells it.
struct Row {
  std::string name;
  std::string verdict;                     ///< "named" …; empty: it failed
  std::string failure;                     ///< the line of its error
  std::string effects;                     ///< in words: "coulomb_friction (.98)"
  std::map<std::string, Estimate> values;  ///< by quantity
  double before = 0.0, after = 0.0;        ///< gap of the worst channel on held-out data
  double duration = 0.0;                   ///< [s] of the diagnosis
  bool unexplained = false;
};

/// The whole campaign.
struct Campaign {
  std::vector<Row> rows;                       ///< in their order
  std::map<std::string, Quantity> quantities;  ///< those of two records at least
  std::vector<std::size_t> outliers;           ///< rows that stand out, worst first
  std::vector<std::string> why;                ///< of each of them, in words
};

/// Rows with all that they say together. An outlier is a row that failed; whose largest |z| over n values is beyond
/// what one of n would be once in twenty campaigns; or whose verdict is that of less than a tenth of the records.
[[nodiscard]] Campaign campaign_of(std::vector<Row> rows);

}  // namespace host_sim::campaign
