// What the second rig will show, with bands, and where their width comes from.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "host_sim/transfer/common/statistics.hpp"
#include "host_sim/transfer/posterior/posterior.hpp"
#include "host_sim/transfer/predict/second_rig.hpp"

namespace host_sim::transfer {

/// Sources of the width of a band.
enum class Source : unsigned char { component, rival_effects, discrepancy, rig, noise, calibration };
inline constexpr std::size_t source_count = 6;
inline constexpr std::array<std::string_view, source_count> source_names{"component", "rival_effects", "discrepancy",
                                                                         "rig",       "noise",         "calibration"};

/// Shares of a variance, which sum up to 1; all 0 where there is none.
using Budget = std::array<double, source_count>;

/// What an extra force of the component changes on the second rig, as a share of the force it has: Prediction (1), (2).
struct ForceEffect {
  std::array<std::vector<std::complex<double>>, 2> response;  ///< G_y F_s/z_r, by line
  std::vector<std::complex<double>> stroke;                   ///< of dz_b, ÷ its own response: a relative change
  std::vector<double> stroke_density;                         ///< S of dz_b [m²/Hz]
};

/// Predictive draws. In each of them
///
///   component      a model with its probability, a draw of its posterior; put into the rig by with_component()
///   rig            the second rig's own tolerated parameters, uniform within their tolerances
///   discrepancy    δ_b, complex normal for each band:
///                    (1)  H_y ← H_y + G_y δ_b F_s/z_r     G_y: response of y to an extra force of the component
///                    (2)  F_s/z_r = m_b z̈_b/z_r − iω b_own dz_b/z_r   what accelerates the body, without the second
///                                                                     rig's own damper b_own = b_to − b_from
///                    (3)  S_y ← S_y |1 + ΔH_y/H_y|², rms² in proportion to ∫ S_y df; of the weighted acceleration to
///                         ∫ W_k² S_y df
///   simulation     each line of H times 1 + thresholds::simulation_error z
///   noise          a line of H gets complex noise of variance S_n/(S_zz K), a spectrum S_n and what scatters of it,
///                  rms² the noise's variance
///   calibration    of the first rig's sensors: ComponentModel (5). Of the second rig's, whose readings are predicted:
///                    (4)  H_y, S_y^½ and the quantities of y ← … · (1 + δ_y)/(1 + δ_z)   δ_z: of z_r, where it was
///                                                                                       recorded and drives
///
/// Each source alone, all others at their centre, gives the budget: its variance ÷ the sum of these variances. Beside
/// them interactions are of second order.
struct Prediction {
  Outcome centre;              ///< diagnosed model at its mode, second rig as described
  std::vector<Outcome> draws;  ///< of all sources together
  std::array<Budget, quantity_count> budget{};
  std::array<std::vector<Budget>, 2> response_budget;  ///< of |H|, by line
  ForceEffect force_effect;                            ///< of (1), (2) at the centre

  [[nodiscard]] Bands quantity(Quantity which) const;
  [[nodiscard]] std::vector<Bands> response(std::size_t which) const;  ///< of |H|, by line
  [[nodiscard]] std::vector<Bands> density(std::size_t which) const;
};

/// `draws`, `source_draws`: thresholds::predictive_draws and source_draws where nothing else is asked for.
[[nodiscard]] Prediction predict_second_rig(const firmware::RigDescription& from, const Posterior& posterior,
                                            const SecondRig& second, std::uint64_t seed, std::size_t draws,
                                            std::size_t source_draws);

/// Of draws of one model alone, nothing else uncertain: what the naive way gives.
[[nodiscard]] Prediction predict_naively(const firmware::RigDescription& from, const ComponentModel& model,
                                         const SecondRig& second, std::size_t draws);

/// Change of each quantity, and of ln |H| at each line, with each coordinate of the diagnosed model by one standard
/// deviation of its posterior.
struct Sensitivity {
  std::vector<std::size_t> parameters;  ///< that travel, of the diagnosed model
  Eigen::MatrixXd gradient;             ///< ∂(ln quantity; ln |H| lines)/∂u, a column for each
};
[[nodiscard]] Sensitivity sensitivity_of(const firmware::RigDescription& from, const Posterior& posterior,
                                         const SecondRig& second);

}  // namespace host_sim::transfer
