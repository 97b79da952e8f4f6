// Forward selection, then elimination and swaps: which effects, alone or together, explain the recordings.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/identification/select/model_fitter.hpp"

namespace host_sim::identification {

/// An effect that could stand in the place of one that was found.
struct Rival {
  firmware::PlacedEffect effect;
  double penalised_chi_squared;  ///< of the model with it
  Hypothesis hypothesis;         ///< that model
};

/// A parameter that may be off in the place of an effect, or of another parameter.
struct RivalParameter {
  std::string path;
  double value;                  ///< [SI]
  double penalised_chi_squared;  ///< relative to the model's own
  Hypothesis hypothesis;         ///< the model with it
};

/// Something acted on the rig from outside; those samples are left out.
struct ExternalEvent {
  std::size_t recording = 0;
  double from = 0.0, to = 0.0;  ///< [s], as in the recording
  double gain = 0.0;            ///< of the criterion
};

/// How far the size of an effect depends on what it must not depend on (law_constancy.hpp).
struct LawConstancy {
  double gain = 0.0;       ///< of −2 ln evidence, by a size that changes with the amplitude, or with time
  double share = 0.0;      ///< [1] √ of its gain of χ² relative to that of the effect: relative change of its size
  bool with_time = false;  ///< that gain belongs to time

  /// Whether the law is another one than that of the effect.
  [[nodiscard]] bool fails() const;
};

/// What is known of a cause beside its values: an effect or a fault of the recordings in a model, or a parameter.
struct FoundCause {
  double gain = 0.0;                         ///< how much larger χ² is without it, all else refitted
  std::vector<Rival> rivals{};               ///< effects in its place, the nearest first
  std::vector<RivalParameter> parameters{};  ///< parameters in its place, the nearest first (rival_parameters.hpp)
  LawConstancy constancy{};                  ///< of an effect

  /// The model has become another one, whose penalised χ² is larger by `shift`: rivals keep their distance.
  void shift_rivals(double shift) {
    for (Rival& rival : rivals) rival.penalised_chi_squared += shift;
  }
};

/// A parameter outside its tolerance, or without one and not as described. The penalised χ² of its rivals are relative
/// to that of the model.
struct SuspectParameter {
  std::string path;
  FoundCause cause;
};

struct SearchResult {
  CandidateModel nothing;  ///< only the tolerated parameters refitted
  CandidateModel best;
  std::vector<FoundCause> causes{};  ///< of each effect in `best`
  std::vector<FoundCause> faults{};  ///< of each fault of the recordings in `best`
  std::vector<ExternalEvent> events{};
  std::vector<FreeParameter> freed;        ///< parameters that no tolerance binds in `best`
  std::vector<SuspectParameter> suspects;  ///< each of them
  std::vector<CandidateModel> alone;       ///< single effects that were tried, best first; until they are compared
  Scales scales{};                         ///< from `nothing` before any effect was tried
  std::vector<std::string> remarks;        ///< rivals that only effects of sensors make
};

/// Called during a search: share of the whole, what is done, simulations and candidates so far.
using ProgressCallback =
    std::function<void(double share, const std::string& what, std::size_t simulations, std::size_t candidates)>;

struct SearchOptions {
  SelectionCriterion criterion;
  bool truncates = true;  ///< may fit shares of the windows first; false where the problem is such a share already
  ProgressCallback progress;
};

/// Forward selection with a beam:
///
///   1  holds that the values themselves show
///   2  each model of the beam with one effect more, the best candidates fitted, as long as SelectionCriterion accepts
///      also where a model leaves noise in every band: what is spread over all of them shows in none
///   2b a fault of the recordings instead of an effect, where that is better    fault_candidates.hpp
///   3  after each effect the noise of the input is passed through what was found, and all is refitted
///   4  where more than noise is left and there are corners: refit by continuation
[[nodiscard]] SearchResult search(IdentificationProblem& problem, const SearchSpace& space,
                                  const SearchOptions& options);

/// Backward elimination, then swaps: the model without each effect, then with each other candidate in its place. What
/// is better replaces it; the others become its rivals.
void compare(IdentificationProblem& problem, const SearchSpace& space, const SearchOptions& options,
             SearchResult& found);

/// The share of the fitted windows that holds `seconds` of the longest; 1 where that would save nothing.
[[nodiscard]] double share_with(const IdentificationProblem& problem, double seconds);

/// Refits on a whole problem what was found on a part of it; rivals keep their distance, in proportion to the number of
/// residuals.
void refit_on(IdentificationProblem& problem, const SearchSpace& space, const SelectionCriterion& criterion,
              SearchResult& found);

}  // namespace host_sim::identification
