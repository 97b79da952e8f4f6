// `rigtwin diagnose` a second time, as plainly as its theory allows: simulate, whiten, scan, fit, compare by one evidence.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/prepare/sample_hold.hpp"

namespace reference {

using Description = firmware::RigDescription;
using Cause = firmware::PlacedEffect;
using Readings = host_sim::Response;

/// The described rig, but for its tolerated parameters [tolerances, −1 … 1] and the causes that were added.
struct Model {
  std::vector<double> tolerated;  ///< in the order of Description::tolerance
  std::vector<Cause> causes;
};
[[nodiscard]] model::RigParameters<double> rig_of(const Description& description, const Model& model);
[[nodiscard]] std::string words(const Cause& cause);  ///< "sensor_lag of F"

// Simulate (prediction.cpp) -------------------------------------------------------------------------------------------

/// A recording of which the samples from `from` to `to` are compared.
struct Measured {
  firmware::Recording recording;
  host_sim::SimulationInput input;
  std::vector<model::Channel> channels{};  ///< compared
  std::size_t from = 0, to = 0;
  int fine_steps = 1;  ///< of the model a sample, where forces have corners; of a beginning half as many
  /// The newest simulations before their sensors, by the numbers of their rig: most candidates differ in a sensor alone.
  mutable std::map<std::vector<double>, Readings> simulated{};
  std::array<std::optional<host_sim::identification::Renewals>, model::channel_count> renewals{};  ///< of held channels
  [[nodiscard]] double hold_period(model::Channel channel) const;                                  ///< [s]; 0: not held
};

/// At most so many seconds of it. One that begins in motion is simulated from rest and compared when that is forgotten.
[[nodiscard]] Measured measured(const Description& description, firmware::Recording recording, double seconds);

/// What a model would have recorded. Of a hil rig the component with its machine, driven by the recorded x_cmd, and the
/// virtual tyre, (1). The motion that drives a quarter car is itself compared with its accelerometer, (2).
///
///   (1)  F_w = laws(k_t dz_w + b_t ḋz_w),  dz_w = z_r − z_w as recorded
///   (2)  z̈_r = (−z₋₂ + 16 z₋₁ − 30 z₀ + 16 z₁ − z₂)/12h²  of the z_r that drives, below 90 Hz
///
/// Sensors are the model's own, but for a hold, which is renewed when the recording was. Of what is no rig all is NaN.
[[nodiscard]] Readings predicted(const Description& description, const Model& model, const Measured& measured);

// Whiten (whitening.cpp) ----------------------------------------------------------------------------------------------

/// The bands [Hz] of the error model: narrow where modes are, wide enough above for many independent bins.
inline constexpr std::array<double, 14> band_edges{0, 0.5, 1, 2, 3, 4.5, 6.5, 9, 13, 18, 26, 40, 60, 90};
inline constexpr std::size_t bands = band_edges.size() - 1;

/// The residual of all channels at a frequency has the covariance
///
///   (7)  Σ(f) = diag(σ_c² h_c(f) + ε² S_c) + ⟨D Dᴴ⟩/Σw²          ε = hypot(2·10⁻⁴, (ωh)⁴/30)
///
/// σ_c: declared noise; h_c: 1, of a held channel P/h sinc²(fP); S_c: power of the channel in the band; ε: error of the
/// simulation, as the product has it; D: what noise of z_r of the declared size, drawn four times, changes in the
/// prediction of `noise`, mean over 1 Hz: what that noise makes of the channels, and of the instants of friction.
/// z̈_r counts as independent of the others, and where the noise of ω² z_r is above that of the accelerometer its variance
/// is taken larger by the ratio of both: a sensor that blurs z̈_r blurs that noise too, and would be believed for it.
///
///   (8)  r(f) = L⁻¹ √(2/Σw²) Σ_k w_k (measured − predicted)_k e^{−2πi fk},   Σ = L Lᴴ
///
/// is white: real and imaginary part of each channel, up to 90 Hz. w: a cosine taper of 0.25 s at each end.
class Whitening {
 public:
  Whitening(const Description& description, const Measured& measured, const Model& noise);

  [[nodiscard]] Eigen::VectorXd operator()(const Measured& measured, const Readings& predicted) const;
  /// Of each residual: channel · bands + band.
  [[nodiscard]] const std::vector<std::size_t>& cells() const { return cells_; }

 private:
  [[nodiscard]] Eigen::MatrixXcd spectra(const Measured& measured, const Readings& of, const Readings& less) const;
  [[nodiscard]] double frequency(std::size_t bin) const { return static_cast<double>(bin) * resolution_; }

  std::size_t length_, bins_;
  double resolution_;  ///< [Hz]
  std::vector<double> taper_;
  std::vector<Eigen::MatrixXcd> factors_;  ///< √(2/Σw²) L⁻¹ by hertz
  std::vector<std::size_t> cells_;
};

// Evidence (evidence.cpp) ---------------------------------------------------------------------------------------------

/// K of (2): a smooth complex response error has about two values a band.
inline constexpr double directions = 4.0;
/// −ln prior of a cause: one of thirty effects; one in a sensor is in one of the channels.
inline constexpr double log_prior = 3.4;
/// Before a recording is seen a positive parameter is anywhere in four decades, another in two of its sizes.
inline constexpr double width_of_logarithm = 9.2, width_in_sizes = 2.0;
/// Chance that the catalogue does not hold everything.
inline constexpr double outside_share = 0.05;

/// Power of the whitened residuals of one channel in one band.
struct Cell {
  double power = 0.0;  ///< P = Σ r²
  double count = 0.0;  ///< ν, of which P is χ² where only noise is left
};

/// (2)  E = P where P ≤ ν,  else ν + K ln(1 + x/K),   x = P − ν
[[nodiscard]] double counted(const Cell& cell);
/// (3)  w = dE/dP = 1/(1 + x/K), 1 below the noise
[[nodiscard]] double weight(const Cell& cell);

/// The parameters' terms of (4): Σ (2 ln width − ln 2π) − ln|C|,  C = (H + diag(12/width²))⁻¹,  H = Jᵀ W J.
[[nodiscard]] double occam(const Eigen::MatrixXd& hessian, const std::vector<double>& widths);

/// (5) of one model: the probability that a discrepancy is in any cell, 1 − Π 1/(1 + r). In which K of the ν directions
/// it is nobody knows, so the power alone tells, z standard deviations out (Wilson and Hilferty, PNAS 17, 1931):
///
///   (5a)  z = ((P/ν)^⅓ − 1 + q)/√q,   q = 2/9ν
///   (5b)  r = c/(1 − c) · √(2π) exp(z²/2)/(z ln 10¹⁰),   z ≥ 1           any of ten orders of magnitude alike before
///
/// c: chance of a discrepancy in a cell, outside_share over all.
[[nodiscard]] double unexplained(const std::vector<Cell>& cells);

/// p(M | y) of models by their −2 ln p(y, M); 0 beyond 1000 : 1 of the best.
[[nodiscard]] std::vector<double> posterior(const std::vector<double>& minus_two_ln);

// Causes (causes.cpp) -------------------------------------------------------------------------------------------------

/// A number that is fitted, by its coordinate u:
///
///   (9)  tolerated: in units of the tolerance;   positive: value = e^u;   of either sign: value = neutral + size · u
struct Parameter {
  std::size_t number;  ///< of the model's tolerated parameters, or of the values of a cause
  std::optional<std::size_t> cause{};
  bool logarithmic = false;
  double neutral = 0.0, size = 1.0, lower = -1.0, upper = 1.0;  ///< bounds of u

  [[nodiscard]] double width() const {
    return std::min(logarithmic ? width_of_logarithm : width_in_sizes, upper - lower);
  }
  [[nodiscard]] double get(const Model& model) const;
  void put(Model& model, double u) const;
};
[[nodiscard]] std::vector<Parameter> parameters_of(const Model& model, const Measured& measured,
                                                   const model::MotionScales& scales);

/// How large things are, in which cards give starts. `predicted`: by the described rig.
[[nodiscard]] model::MotionScales scales_of(const Description& description, const Measured& measured,
                                            const Readings& predicted);
/// Every cause that has a place on the rig, with each of its card's starts.
[[nodiscard]] std::vector<Cause> candidates(const Description& description, const Measured& measured,
                                            const model::MotionScales& scales);

// Fit and scan (fit.cpp) ----------------------------------------------------------------------------------------------

struct Fit {
  Model model;
  std::vector<Parameter> parameters{};
  Eigen::VectorXd residual{};
  Eigen::MatrixXd jacobian{};
  double evidence = 0.0;  ///< (4), but for a discrepancy's own price, which is in (5)
};

/// A cause, and by how much Σ E is expected to fall with it.
struct Scanned {
  Cause cause;
  double gain;
};

/// The recordings of a rig, or their first `seconds`, with the weights of their residuals.
class Problem {
 public:
  Problem(const Description& description, const std::vector<firmware::Recording>& recordings, double seconds,
          const Model& noise);

  [[nodiscard]] Eigen::VectorXd residual(const Model& model) const;
  [[nodiscard]] std::vector<Cell> cells(const Eigen::VectorXd& residual) const;

  /// Gauss–Newton in the bounds, weighted by (3), until E falls by less than 0.3. `known`: columns of J for the tolerated
  /// parameters, to be kept; then first with the weights of noise, as E has minima where cells are given up.
  [[nodiscard]] Fit fit(const Model& start, const Eigen::MatrixXd& known, int most) const;

  /// Each candidate beside a fit, the best first: the change d of the residual by its start, a times as large, while all
  /// parameters make way: min (r + a d + J u)ᵀ W (r + a d + J u) + 3 |u|².  a is within 2, of an effect with a sign free.
  [[nodiscard]] std::vector<Scanned> scan(const Fit& fit) const;

 private:
  [[nodiscard]] double counted(const Eigen::VectorXd& residual) const;  ///< Σ E
  [[nodiscard]] Eigen::VectorXd weights(const Eigen::VectorXd& residual) const;
  void differentiate(Fit& fit, Eigen::Index from) const;  ///< columns of J from there on, over 0.01 of u

  Description description_;
  std::vector<Measured> recordings_;
  std::vector<Whitening> whitenings_;
  std::vector<std::size_t> cells_;  ///< of each residual
  model::MotionScales scales_;
};

// Search and verdict (diagnose.cpp) -----------------------------------------------------------------------------------

struct Verdict {
  struct Found {
    Cause cause;
    double confidence;  ///< (6)
  };
  std::vector<Found> causes;  ///< of all models that are kept, the surest first
  double unexplained = 0.0;   ///< (5)
};

[[nodiscard]] Verdict diagnose(const Description& description, const std::vector<firmware::Recording>& recordings);

}  // namespace reference
