// The result of a diagnosis.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/assess/error_propagation.hpp"
#include "host_sim/identification/assess/experiment.hpp"
#include "host_sim/identification/assess/localisation.hpp"
#include "host_sim/identification/assess/named_effect.hpp"
#include "host_sim/identification/assess/overlay.hpp"
#include "host_sim/identification/assess/power_over_time.hpp"
#include "host_sim/identification/assess/prediction_error.hpp"
#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/learn/learned_law.hpp"
#include "host_sim/identification/parity/parity_residual.hpp"

namespace host_sim::identification {

enum class Verdict : unsigned char { no_discrepancy, named, ambiguous, unexplained };
[[nodiscard]] std::string_view name(Verdict verdict);

/// The experiment that an engineer does next: it tells two kinds of law apart that may both be there.
struct NextStep {
  std::string one, other;
  SineTest test;
};

/// Power of the whitened residuals per residual: 1 is noise.
struct ResidualPower {
  double given = 0.0, refit = 0.0, after = 0.0;  ///< rig as described, tolerances refitted, effects added
};

/// A parameter outside its tolerance, or described without one and not as described.
struct ParameterOff {
  std::string path;
  double described = 0.0;
  double tolerance = 0.0;  ///< relative; 0: described as exact
  Interval value{};
  double confidence = 0.0;
  std::vector<Alternative> alternatives;  ///< the nearest first
};

/// A fault of the measurement, not of the rig.
struct RecordingFault {
  std::string name;  ///< as in contract.md: noise_level, clock_offset …
  std::vector<model::Channel> channels;
  std::map<std::string, Interval> parameters;
  double confidence = 0.0;
  std::string path{};  ///< of a drift: the parameter that changes
  /// Not the noise alone: something that must be taken into account to explain the recording.
  bool is_cause = false;
  std::vector<Alternative> alternatives{};  ///< effects in its place, the nearest first
  std::string text{};                       ///< in words, where they are more than name and numbers
  /// Neither noise nor cause: how the sensor was set up. Nothing of it is wrong.
  [[nodiscard]] bool is_set_up() const { return name == "static_value"; }
};

struct Diagnosis {
  Verdict verdict{};
  std::vector<ParityResidual> relations;  ///< before anything is fitted but tolerances
  std::vector<RecordingLocation> locations;
  std::vector<BandPower> left_by_refit, left_after;  ///< tolerances refitted; effects, too
  std::vector<PowerOverTime> power_over_time;        ///< of the same two models
  std::vector<NamedEffect> effects;
  std::vector<DescribedLaw> laws;  ///< learned
  std::optional<NextStep> next_step;
  std::vector<DescribedLaw> described_curves;  ///< of the description, beside what the recordings show
  std::vector<ParameterOff> parameters_off;
  std::vector<RecordingFault> recording_faults;
  std::map<model::Channel, PredictionError> prediction_errors;
  std::map<std::string, Interval> parameters;              ///< tolerated, refitted
  std::map<std::string, UncertaintyBudget> budgets;        ///< of `parameters`
  std::map<model::Channel, PredictedChannel> predictions;  ///< by the model that was found
  std::vector<std::string> certificates;   ///< why a certificate does not hold (firmware::certificate_objections)
  std::vector<Undetermined> undetermined;  ///< combinations of parameters that the recordings leave open
  bool unexplained = false;                ///< a significant residual remains
  double unexplained_probability = 0.0;    ///< that more than noise is left in any band (estimate/evidence.hpp)
  std::string residual;                    ///< that residual in words; empty without one
  std::vector<Overlay> overlays;
  firmware::RigDescription rig;  ///< with effects and refitted parameters
  ResidualPower residual_power;
  std::size_t simulations = 0, candidates = 0;  ///< tried
  std::vector<std::string> not_tried;           ///< steps of the search for which its budget was spent
  std::vector<std::string> remarks;             ///< clipped samples, channels left out, noise estimated

  [[nodiscard]] bool has_cause_in_recording() const {
    return std::any_of(recording_faults.begin(), recording_faults.end(),
                       [](const RecordingFault& fault) { return fault.is_cause; });
  }
};

}  // namespace host_sim::identification
