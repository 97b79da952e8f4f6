// A parity relation fitted to recordings: its tolerated parameters inside their bounds, and what is left.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/identification/parity/parity_relation.hpp"
#include "host_sim/identification/parity/thresholds.hpp"
#include "host_sim/least_squares/gauss_newton.hpp"

namespace host_sim::identification {

/// A relation's residual over one recording, and the samples that count.
struct ResidualSeries {
  std::vector<double> values;
  std::vector<bool> trusted;
};

/// Power spectra of a relation by line, the first at 0 Hz.
struct RelationSpectra {
  std::vector<Eigen::MatrixXcd> cross;     ///< of the residual (0) and of what each parameter makes of it (1 … p)
  std::vector<double> noise;               ///< of the residual as the sensors' noise makes it
  std::vector<double> noise_of_component;  ///< of it, what passes through the component's model
  double resolution = 0.0, blocks = 0.0;
};

/// Fits the parameters θ (relative changes) of a relation,
///
///   (1)  min_θ Σ_f |R(f) + Σ_i θ_i M_i(f)|² / N(f),   −tolerance ≤ θ ≤ tolerance
///
/// R: residual, M_i: its change with parameter i, N: power of the noise; all through one smooth window φ, so nothing is
/// differentiated by differences. Masses and the tyre enter linearly. The component's force does not: its parameters
/// are linearised again at each step (full_gauss_newton_steps, least_squares/).
class RelationFit {
 public:
  RelationFit(const firmware::RigDescription& description, const std::vector<firmware::Recording>& recordings,
              const SmoothWindow& window, const ParityRelation& relation,
              double highest = thresholds::parity_band_edges.back());

  [[nodiscard]] bool has_data() const { return spectra_.blocks > 0.0; }
  [[nodiscard]] const RelationSpectra& spectra() const { return spectra_; }
  /// Power of the fitted residual at a line.
  [[nodiscard]] double power(std::size_t line) const;
  /// The fitted residual, by recording.
  [[nodiscard]] std::vector<ResidualSeries> residual() const;

  // As full_gauss_newton_steps() asks.
  bool find_jacobian();
  [[nodiscard]] NormalEquations normal_equations() const;
  [[nodiscard]] StepBox box(double trust) const;
  double move(const Eigen::VectorXd& theta);

 private:
  /// A relation linearised where the component's parameters are.
  struct Linearised {
    std::vector<ResidualSeries> residual;                  ///< by recording
    std::vector<std::vector<std::vector<double>>> change;  ///< M_i, by parameter and recording
    std::vector<double> lower, upper;                      ///< bounds of θ
    std::vector<std::string> component_paths;              ///< of the last parameters: the component's
    std::vector<std::vector<double>> component_noise;      ///< a sample of the noise of its force, by recording
  };
  using Rig = model::RigParameters<double>;

  void add_component_parameters(Rig& bench, std::vector<double>& nominal);
  void add_recording(const firmware::Recording& recording, const Rig& bench, const std::vector<double>& nominal);
  void add_component(const firmware::Recording& recording, const Rig& bench, const std::vector<double>& nominal,
                     std::vector<double>& residual, std::vector<double>& component_noise);
  [[nodiscard]] std::vector<bool> trusted_samples(const firmware::Recording& recording) const;
  void find_spectra();
  void add_sensor_noise(std::vector<double>& noise) const;
  [[nodiscard]] double noise_of(const firmware::Recording& recording, model::Channel channel) const;
  [[nodiscard]] double tolerance(const std::string& path) const;

  const firmware::RigDescription& description_;
  const std::vector<firmware::Recording>& recordings_;
  const SmoothWindow& window_;
  const ParityRelation& relation_;
  double highest_;                            ///< [Hz] that the recordings hold
  std::map<std::string, double> deviations_;  ///< of the component's parameters so far, relative
  Linearised linear_;
  RelationSpectra spectra_;
  Eigen::VectorXd theta_;
};

}  // namespace host_sim::identification
