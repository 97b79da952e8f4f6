// A plan as a page and as sentences.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host_sim/plan/plan.hpp"

namespace host_sim::plan {

/// The number of visible effects, and the change that would help most.
[[nodiscard]] std::string summary(const Plan& plan);
/// A value of the effect's parameter with its unit.
[[nodiscard]] std::string value_text(const PlannedEffect& effect, double value);
/// Advice that is worth a sentence, best first; and what is said where there is none.
[[nodiscard]] std::vector<Advice> helpful(const Plan& plan);
inline constexpr std::string_view nothing_helps =
    "No other level, octave, sensor or number of open ducts that was tried shows effects sooner by a tenth.";
/// One piece of advice.
[[nodiscard]] std::string sentence(const Advice& advice);
/// Five: what shows, what would be known, what would not, what would be taken for what, what to change.
[[nodiscard]] std::vector<std::string> sentences(const Plan& plan);
/// Those sentences and one picture first; the rows of all effects and parameters are folded below. `road`: what the rig
/// is driven over, in words.
[[nodiscard]] std::string report_html(const Plan& plan, const firmware::RigDescription& description,
                                      const std::string& road);

}  // namespace host_sim::plan
