// One recording whose answer is known, diagnosed and judged.
#pragma once

#include <cmath>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/identification/diagnosis.hpp"
#include "tests/confusion/model_list.hpp"
#include "tests/confusion/plan.hpp"
#include "tests/truth/truth.hpp"

namespace confusion {

/// An effect that a verdict names.
struct Named {
  std::string effect;  ///< "sensor_lag of F"
  double confidence = 0.0;
  bool right = false;  ///< it is in the rig
};

/// A parameter of a right answer.
struct Estimate {
  std::string path;    ///< "sensor_lag of F: time_constant", "body.mass"
  bool effect = true;  ///< else a tolerated parameter
  double error = 0.0;  ///< |found − true| ÷ |true|, of a gain ÷ |true − 1|
  bool held = false;   ///< the 95 % interval holds the true value
};

struct Outcome {
  Asked asked;
  std::string hidden;  ///< in words
  std::string found;   ///< in words
  double size = 0.0;   ///< of the hidden effect, in noise of a channel
  std::string verdict;
  bool unexplained = false;
  bool outside_said = false;  ///< what is outside the catalogue is a fault of the recording, and named as that
  std::string rest;
  std::vector<Named> named;
  std::size_t effects_hidden = 0;
  std::vector<Estimate> estimates;  ///< of the effects that were found; tolerated ones where all are right
  double gap = 0.0;                 ///< largest after ÷ noise floor of a channel, on held-out data
  std::string gap_channel;
  double residual_power = 0.0;  ///< χ² per residual that is left
  bool truth_is_rival = false;  ///< what was missed stands among the alternatives
  double wall = 0.0;            ///< [s] of the diagnosis
  double processor = 0.0;       ///< [s] of all its threads
  std::string failure;          ///< why there is no verdict
  // rough conditions only (judge_rough)
  std::string condition;
  std::size_t off_hidden = 0, off_found = 0;        ///< parameters that are not as described
  std::size_t faults_hidden = 0, faults_found = 0;  ///< of the recording
  std::size_t same_thing = 0;                       ///< effects that are another name of a parameter that is off
  bool wrong_rough = false;                         ///< effect, parameter or fault above 0.5 that is not there
  bool rough_right = false;
  // laws only (judge_law)
  bool shape_right = false;     ///< named as what it is, and as nothing else
  bool wrong_law = false;       ///< a sure name beside; of a rig without a law: a law
  double exponent_error = NAN;  ///< of a power; NaN: none is said, or none hides
  /// Of the force of a bench, on held-out data: as described, tolerances refitted, with the catalogue alone, with the
  /// law, by a black box, and noise. Empty elsewhere.
  std::map<std::string, double> errors_of_force{};
  std::map<std::string, double> law_numbers{};  ///< of the hidden law
  std::vector<ComparedModel> models{};          ///< with `compare_models`

  [[nodiscard]] std::size_t effects_found() const;  ///< of those hidden
  [[nodiscard]] bool exact() const;                 ///< all that is hidden is named, and nothing else
  /// A name above 0.5 that is not in the rig.
  [[nodiscard]] bool wrong_name() const;
  [[nodiscard]] bool flagged() const { return verdict == "unexplained" || unexplained; }
  /// single, pair, triple: exact, verdict named or ambiguous. none: no_discrepancy. unknown: flagged, or named as a
  /// fault of the recording, and no wrong name. rough: as README.
  [[nodiscard]] bool right() const;
};

/// Some unknowns of the generator are effects of the catalogue under another name: that name; empty: they are not.
[[nodiscard]] std::string_view name_in_catalogue(const truth::Truth& truth);

/// What the diagnosis of a recording is worth, beside the truth.
[[nodiscard]] Outcome judged(const Asked& asked, const truth::Truth& truth,
                             const host_sim::identification::Diagnosis& diagnosis);

/// "rough:<condition>" is drawn by truth::draw_rough.
/// Draws, simulates, writes as text, reads, diagnoses and judges. What is thrown becomes a failure.
/// `compare_models`: also with the evidence for each model that was compared (model_list.hpp).
[[nodiscard]] Outcome run(const Asked& asked, const truth::Wanted& wanted, bool compare_models = false);

[[nodiscard]] nlohmann::ordered_json to_json(const Outcome& outcome);
[[nodiscard]] Outcome outcome_from(const nlohmann::ordered_json& json);

}  // namespace confusion
