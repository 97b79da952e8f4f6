// The search for laws: law_candidates.cpp fits the candidates, learn_laws.cpp chooses one of them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/identification/learn/curve_fit.hpp"
#include "host_sim/identification/learn/law_beside.hpp"
#include "host_sim/identification/learn/learn_laws.hpp"
#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/identification/select/selection_criterion.hpp"

namespace host_sim::identification {

/// The laws that are tried, and what becomes of the best.
class LawSearch {
 public:
  LawSearch(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
            const Reasons& reasons, SearchResult& found)
      : problem_(problem),
        part_(part_of(problem)),
        space_(space),
        progress_(progress),
        reasons_(reasons),
        found_(found) {}

  Learned learn();

 private:
  struct Curve {
    Beside beside;
    CurveFit fit;
    double cost = 0.0;  ///< as that of a candidate model, at the price of the simplest family
  };
  /// A law on the whole problem.
  struct Candidate {
    CandidateModel model;
    double cost = 0.0;
    LawFamily family = LawFamily::points;
  };

  [[nodiscard]] std::vector<Beside> places();
  [[nodiscard]] Hypothesis start_beside(const EffectsBeside& effects) const;
  [[nodiscard]] std::optional<Hypothesis> start_of(const Beside& beside) const;
  [[nodiscard]] std::vector<Curve> curves();
  void grow(Curve& curve) const;
  [[nodiscard]] std::optional<Candidate> fitted_as(LawFamily family, const IdentificationProblem& problem,
                                                   const Hypothesis& start, const EffectsBeside& effects) const;
  [[nodiscard]] std::vector<Candidate> candidates(const std::vector<Curve>& curves) const;
  [[nodiscard]] std::optional<Hypothesis> start_of_stack(LawFamily family, const EffectsBeside& effects,
                                                         double gap) const;
  [[nodiscard]] std::vector<Candidate> stacks() const;
  [[nodiscard]] std::optional<Hypothesis> start_of_surface(LawFamily family, const EffectsBeside& effects) const;
  [[nodiscard]] bool may_have_surface() const;
  [[nodiscard]] std::vector<Candidate> surfaces() const;
  [[nodiscard]] std::optional<Hypothesis> start_of_free_surface(const EffectsBeside& effects) const;
  [[nodiscard]] std::optional<Candidate> free_surface(const std::vector<Candidate>& others) const;
  [[nodiscard]] std::vector<Contender> contenders(const std::vector<Candidate>& list) const;
  [[nodiscard]] double cost_of(const CandidateModel& model, double freedom) const;
  [[nodiscard]] static bool is_possible(const Candidate& candidate);
  void eliminate(Candidate& law) const;
  [[nodiscard]] static bool can_be_described(const PlacedLaw& law);
  [[nodiscard]] bool is_kept(const Candidate& law, Learned& learned) const;
  [[nodiscard]] bool is_kept_alone(Candidate& law, Learned& learned) const;
  [[nodiscard]] bool replace_by_effect(const Candidate& law);
  void weigh_anew();
  void adopt(Candidate law);
  void tell(double share, const char* what) const {
    if (progress_) progress_(share, what, problem_.work().simulations(), problem_.work().candidates());
  }

  /// As much of the recordings as tells laws apart, at a coarse step.
  [[nodiscard]] static IdentificationProblem part_of(const IdentificationProblem& problem) {
    const double seconds = thresholds::seconds_of_curves / static_cast<double>(problem.fitted_count());
    return problem.truncated_and_coarse(share_with(problem, seconds));
  }

  IdentificationProblem& problem_;
  const IdentificationProblem part_;
  const SearchSpace& space_;
  const ProgressCallback& progress_;
  const Reasons& reasons_;
  SearchResult& found_;
  SelectionCriterion criterion_{};
  std::optional<LawBehindMount> behind_mount_{};
  mutable std::vector<double> gains_{};  ///< of the effects beside the law
  std::size_t slot_ = 0;                 ///< of the rig's laws that is free
  /// Of the effects found, under the problem's present weights: cost and χ².
  double best_cost_ = 0.0, chi_squared_without_ = 0.0;
};

}  // namespace host_sim::identification
