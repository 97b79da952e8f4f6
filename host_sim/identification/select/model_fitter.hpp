// Fits candidate models to one problem: a set of effects, and one effect more beside it.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host_sim/identification/select/candidates.hpp"
#include "host_sim/identification/select/selection_criterion.hpp"

namespace host_sim::identification {

class LinearRefit;

/// Leaves of a fit its result, not the Jacobian and prediction that only a next step would need: megabytes for minutes.
void drop_jacobian(Fit& fit);

/// Whether a value of an effect lies at a limit of its card. No such rig is built, so it is another effect.
[[nodiscard]] bool ends_at_bound(const firmware::PlacedEffect& effect);

/// The only holder of the problem that a search works on: fits use it as it is, update_input_noise() weights it anew.
///
/// A candidate is first scanned: what it gains while all else is refitted linearly (linear_refit.hpp, 1). So one start
/// costs one simulation, and a sensor effect none.
class ModelFitter {
 public:
  /// `common`: parameters that are free in every model. Problem and criterion outlive the fitter.
  ModelFitter(IdentificationProblem& problem, std::vector<FreeParameter> common, const SelectionCriterion& criterion)
      : problem_(problem), common_(std::move(common)), criterion_(criterion) {}

  [[nodiscard]] const IdentificationProblem& problem() const { return problem_; }
  [[nodiscard]] const SelectionCriterion& criterion() const { return criterion_; }
  /// The same with other common parameters.
  [[nodiscard]] ModelFitter with_common(std::vector<FreeParameter> common) const {
    return {problem_, std::move(common), criterion_};
  }
  /// Weights residuals anew for a hypothesis; what was fitted must be refitted. false: nothing changed.
  bool update_input_noise(const Hypothesis& hypothesis) { return problem_.update_input_noise(hypothesis); }

  [[nodiscard]] CandidateModel fitted(const Hypothesis& start, std::vector<firmware::PlacedEffect> effects,
                                      int most = 12, const Eigen::MatrixXd& known_jacobian = {}) const;

  /// The same with the whole Jacobian found at the minimum.
  [[nodiscard]] CandidateModel refitted(const Hypothesis& start, std::vector<firmware::PlacedEffect> effects,
                                        int most = 12) const;
  void refit(CandidateModel& model, int most) const;

  /// A model of other weights of the residuals, refitted under those of the problem.
  [[nodiscard]] static CandidateModel refitted_in(IdentificationProblem& problem, const SearchSpace& space,
                                                  const SelectionCriterion& criterion, const CandidateModel& model);

  /// Without one of its effects, after at most so many steps of a fit.
  [[nodiscard]] CandidateModel without(const CandidateModel& whole, std::size_t leave_out, int most = 6) const;

  /// With the effect that one of them contains in its place, beginning where this one is; nullopt: it contains none.
  [[nodiscard]] std::optional<CandidateModel> simplified(const CandidateModel& whole, std::size_t effect) const;

  /// One more effect: the candidates with the largest gain, fitted, best first. At most `most`; no more than
  /// thresholds::always_fitted of those far behind the best, and none that gains less than `least`.
  [[nodiscard]] std::vector<CandidateModel> extended(const CandidateModel& base, const Scales& scales, std::size_t most,
                                                     double least = 0.0) const;

  /// One more fault of the recordings: the best of those whose promise is at least `least`, with the group and values
  /// that are worth their penalty. nullopt: none promises as much.
  [[nodiscard]] std::optional<CandidateModel> extended_by_fault(const CandidateModel& base, double least) const;

  /// With a filter that the noises show (filters_seen), also on channels whose noise does not say.
  [[nodiscard]] CandidateModel filtered(const CandidateModel& base, const PlacedFault& filter) const;

  /// Without one of the faults, after at most so many steps of a fit. 0: everything else as it was.
  [[nodiscard]] CandidateModel without_fault(const CandidateModel& whole, std::size_t leave_out, int most = 6) const;

  /// With the hold of a channel whose renewals are regular, where it is not there yet.
  [[nodiscard]] std::optional<CandidateModel> held(const CandidateModel& base, const Scales& scales,
                                                   model::Channel channel) const;

  /// Whether an effect is a hold that the values themselves show by regular repetition: nothing else repeats them, so
  /// it has no rivals, however alike they are below 90 Hz.
  [[nodiscard]] bool is_seen(const firmware::PlacedEffect& effect) const;

  /// Refitted in growing shares of the windows: with free play, stops or friction a long recording has many minima, a
  /// short one few. Also from the state at the start that the model's own rig, with what was found, makes of the first
  /// seconds, and, where more than noise is left, from other distances at which play or a stop ends. As it was where
  /// that is no better. Source: numerical continuation, E. Allgower and K. Georg, 1990.
  void refit_by_continuation(CandidateModel& model) const;

  /// Whether a model leaves nothing but noise, in each band and altogether (thresholds::leaves_noise).
  [[nodiscard]] bool leaves_noise(const CandidateModel& model) const;

 private:
  struct Scanned;
  struct Direction;

  /// Everything that may move in a model with these effects: common parameters, then those of the hypothesis' faults,
  /// those of the effects last.
  [[nodiscard]] std::vector<FreeParameter> parameters(const Hypothesis& hypothesis,
                                                      const std::vector<firmware::PlacedEffect>& effects) const;

  /// Candidates beside a model, with the gain of their starts (linear_refit.hpp); best first.
  [[nodiscard]] std::vector<Scanned> scan(const CandidateModel& base, const Scales& scales) const;
  /// What the candidate's starts change; of those of either sign each parameter's part.
  [[nodiscard]] std::vector<Direction> directions_of(const CandidateModel& base, const Candidate& candidate) const;
  /// Keeps a start with the sizes that explain most together, of parameters of either sign.
  static void keep_best_sizes(const LinearRefit& others, std::span<const Direction> tried, const Start& start,
                              Scanned& scanned);

  /// A candidate beside a model, fitted from its best start or two; columns of the Jacobian of the model are kept.
  [[nodiscard]] CandidateModel fitted_beside(const CandidateModel& base, const Scanned& scanned) const;

  /// Where recordings begin in motion: refitted from starts estimated anew, with this rig and with its dry friction
  /// left out of that estimate, since what sticks at first shows nothing of the start.
  void refit_from_new_start(CandidateModel& model) const;
  /// Refitted from a gap or a clearance thresholds::distance_shift times as large, and as small.
  void refit_from_other_distances(CandidateModel& model) const;
  /// Fitted in growing shares of the windows.
  [[nodiscard]] CandidateModel grown_from(Hypothesis start, const std::vector<firmware::PlacedEffect>& effects) const;

  /// A hold with a clock of its own: the phase and the stretch with which its values are taken, by golden section over
  /// what the renewals allow. All else moves linearly inside its bounds, since a little damping looks like a little
  /// time.
  void set_clock(CandidateModel& model, model::Channel channel) const;
  /// The same of a hold whose clock was set before all else was found: what was left out since may have made up for it.
  void set_clock_anew(CandidateModel& model, model::Channel channel) const;

  [[nodiscard]] bool repeats_regularly(model::Channel channel) const;

  // A model whose last fault is fitted, with the values and channels that improve the criterion.

  /// The last filter and one of the same order and nearly the same corner (thresholds::alike_filters) as one filter.
  void join_filters(CandidateModel& model) const;
  void bend_drift(CandidateModel& model) const;
  void improve_group(CandidateModel& model) const;

  IdentificationProblem& problem_;
  std::vector<FreeParameter> common_;
  const SelectionCriterion& criterion_;
};

}  // namespace host_sim::identification
