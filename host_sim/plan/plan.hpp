// Predicts the result of an experiment before it is made.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/plan/advice.hpp"
#include "host_sim/plan/effect_size.hpp"
#include "host_sim/plan/open_parameters.hpp"
#include "host_sim/plan/rehearsal.hpp"

namespace host_sim::plan {

/// The effect that another one would be taken for.
struct TakenFor {
  std::string name;  ///< of an effect, in words, or of a parameter: "body.mass"
  double left;       ///< [standard deviations] that are left of the effect with that refitted in its place
};

/// One parameter of an effect, the others in the middle of their card's starts.
struct PlannedEffect {
  Subject subject;
  std::size_t parameter;
  Size at_default;
  std::optional<double> shows_at;  ///< value with thresholds::shows
  /// Value at which what is left beside the nearest rival is thresholds::told_apart; of the effect's leading parameter,
  /// the first that has a size.
  std::optional<double> named_at{};
  std::vector<TakenFor> taken_for{};  ///< of the leading parameter at thresholds::told_apart: nearest first
  std::string why{};                  ///< it does not show; empty where it does
};

/// Rows: effects at thresholds::told_apart alone. Columns: what is refitted in their place.
struct SeparationMatrix {
  std::vector<std::string> rows, columns;
  std::vector<double> left;  ///< row after row [standard deviations]
};

struct Plan {
  std::vector<PlannedEffect> effects;  ///< most detectable first
  SeparationMatrix separations;
  std::vector<PlannedParameter> parameters;
  std::vector<OpenCombination> open;
  std::vector<Advice> advice;  ///< best first
  std::vector<model::Channel> channels;
  std::vector<std::string> remarks;
  double duration = 0.0;  ///< [s]
};

/// Share of the whole that is done, and what.
using PlanProgress = std::function<void(double share, const std::string& what)>;

/// All that can be said before the experiment: by simulations of the described rig over the road and linear refits
/// (rehearsal.hpp, 1). InputError, UsageError where it cannot be made.
[[nodiscard]] Plan make_plan(const firmware::RigDescription& description, Setting setting,
                             const PlanProgress& progress = {});

/// "sensor_lag of F"
[[nodiscard]] std::string words(const Subject& subject);
/// "N/m"; of a sensor effect that of its channel; empty for a pure number.
[[nodiscard]] std::string unit_of(const Subject& subject, std::size_t parameter);

}  // namespace host_sim::plan
