// A learned law on the page: its curve with its band, what the rig did behind it, and the rig as described beside it.
#pragma once

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::identification {

/// "suspension: grows with |v|^1.61 ± 0.04 (power law)"
[[nodiscard]] std::string words(const DescribedLaw& law);

/// "N s/m": of a number of a law; "1" for a pure number.
[[nodiscard]] std::string unit_of(const DescribedLaw& law, const LawNumber& number);

/// "to tell hysteresis from lag, run 0.5 Hz at ± 20 mm on a bench (a second of it separates them 12 times as well)";
/// `rig`: on which it was recorded.
[[nodiscard]] std::string words(const NextStep& next, model::RigKind rig);

/// Section, table of numbers and a figure for each law; nothing where there is none.
void add_laws(report::Report& page, const std::vector<DescribedLaw>& laws);

/// The same for the curves of the rig description: what somebody measured beside what the rig did.
void add_described_curves(report::Report& page, const std::vector<DescribedLaw>& curves);

}  // namespace host_sim::identification
