// The experiment before it is made: what the described rig would record, and what a change of the rig would change.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/identification/estimate/fit.hpp"
#include "host_sim/identification/select/candidates.hpp"

namespace host_sim::plan {

/// A variant that is rehearsed beside the rig.
struct Setting {
  firmware::FootPointMotion motion;       ///< of the road; of a component_bench the deflection
  std::vector<model::Channel> without{};  ///< channels that are not recorded
  std::optional<model::Channel> added{};  ///< a channel that the recorder does not have yet
  std::uint64_t seed = 1;                 ///< of the sensor noise
  bool stationary = false;                ///< a random road, any stretch of which is like the whole
};

/// A part of a stationary road that stands for the whole.
///
///   (1)  growth² = min(T/t, mean over channels of  Σ y² of the whole ÷ Σ y² of the stretch)      T, t: lengths
///
/// A signature that is stationary grows as √T; one that follows the size of the motion as its energy, and a stretch
/// with the highest peaks has more than its share of it.
struct Stretch {
  Setting setting;      ///< its motion
  double from = 0.0;    ///< [s]
  double growth = 1.0;  ///< of significances, from the stretch to the whole
};

/// Of the stretches of thresholds::stretch seconds the one whose fitted part comes nearest to the highest peak of every
/// channel that is compared, in their mean: what a limit or a clearance shows there it shows in the whole. nullopt:
/// the road is no longer, or not stationary.
[[nodiscard]] std::optional<Stretch> stretch_of(const firmware::RigDescription& description, const Setting& setting);

/// Change of the whitened residuals by a change of the rig.
struct Change {
  Eigen::VectorXf whitened;   ///< d
  Eigen::VectorXd tolerated;  ///< Jᵀd, J: columns of the tolerated parameters
};

/// The change a minus the change b.
[[nodiscard]] inline Change difference(const Change& a, const Change& b) {
  return {a.whitened - b.whitened, a.tolerated - b.tolerated};
}

/// The described rig, driven through its firmware and diagnosed' way of looking at recordings: prepare/, predict/ and
/// noise/ of identification, three quarters of the recording fitted.
///
///   (1)  ⟨a, b⟩ = aᵀb − aᵀJ (JᵀJ + P)⁻¹ Jᵀb      P: 12/width² of each tolerated parameter, as Fit (3)
///   (2)  significance of a change d = √⟨d, d⟩     [standard deviations], the tolerances refitted
///
/// The level of the noise costs nothing here: its information is independent of that of the mean (Fisher's matrix of a
/// normal distribution).
class Rehearsal {
 public:
  /// InputError where the rig cannot be driven over the road, or nothing is measured.
  Rehearsal(const firmware::RigDescription& description, const Setting& setting);
  Rehearsal(const Rehearsal&) = delete;
  Rehearsal& operator=(const Rehearsal&) = delete;
  ~Rehearsal() = default;

  [[nodiscard]] const identification::IdentificationProblem& problem() const { return *problem_; }
  [[nodiscard]] const identification::Hypothesis& given() const { return base_.hypothesis; }
  [[nodiscard]] const identification::SearchSpace& space() const { return space_; }
  [[nodiscard]] const identification::Scales& scales() const { return scales_; }
  [[nodiscard]] const std::vector<model::Channel>& recorded() const { return recorded_; }  ///< inputs too
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

  /// What an effect beside the described ones changes, from `absent` (residuals with the effect too small to act) or
  /// from the described rig. nullopt: the model refuses such a rig, or its simulation diverges.
  [[nodiscard]] std::optional<Change> change(const firmware::PlacedEffect& effect,
                                             const Eigen::VectorXf* absent = nullptr) const;
  /// Residuals with an effect; for `absent`.
  [[nodiscard]] std::optional<Eigen::VectorXf> residuals_with(const firmware::PlacedEffect& effect) const;
  /// J of parameters of the rig as described, a column each.
  [[nodiscard]] Eigen::MatrixXd jacobian(const std::vector<identification::FreeParameter>& parameters) const;
  [[nodiscard]] Change as_change(const Eigen::VectorXd& whitened) const;

  /// Whether an effect that hides in the recording leaves more than noise beside the effects that diagnose would
  /// explain it by, without those that only imitate others (search() and leaves_a_rest() of identification/select). Of
  /// a road that is longer than thresholds::rehearsed_diagnosis its beginning.
  [[nodiscard]] bool leaves_a_rest(const firmware::PlacedEffect& hidden) const;

  [[nodiscard]] double product(const Change& a, const Change& b) const;  ///< (1)
  [[nodiscard]] double significance(const Change& d) const;              ///< (2)

 private:
  [[nodiscard]] identification::Fit described_with(const std::vector<identification::FreeParameter>& parameters) const;

  firmware::RigDescription description_;  ///< with noise for every channel that is compared
  Setting setting_;
  std::vector<model::Channel> recorded_;
  std::vector<std::string> remarks_;
  std::optional<identification::IdentificationProblem> problem_;
  identification::SearchSpace space_;
  identification::Scales scales_;
  identification::Fit base_;  ///< tolerated parameters, J
  Eigen::LDLT<Eigen::MatrixXd> tolerances_;
};

/// The experiment on other rigs of the same description, their tolerated parameters at random ends of their tolerances.
/// Without those that cannot be driven, or all where nothing is tolerated.
[[nodiscard]] std::vector<std::unique_ptr<const Rehearsal>> within_tolerances(
    const firmware::RigDescription& description, const Setting& setting);

/// Channels that a model of this rig computes and that its recorder does not write.
[[nodiscard]] std::vector<model::Channel> unrecorded_channels(const Rehearsal& rehearsal);

}  // namespace host_sim::plan
