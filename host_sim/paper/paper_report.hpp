// The HTML page and the JSON of `rigtwin paper`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host_sim/paper/experiments.hpp"
#include "host_sim/paper/statements.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::paper {

/// Counterparts of the paper's Figs. 2, 3, 4 and 6, each with the statements of the text that agree or disagree.
[[nodiscard]] report::Report paper_report(const Experiments& experiments, const std::vector<Statement>& statements);

/// {"agreeing", "statements": […], "kicks": […]}
[[nodiscard]] nlohmann::ordered_json paper_json(const Experiments& experiments,
                                                const std::vector<Statement>& statements);

/// "decays with 1.93 1/s", "grows with 2.51 1/s until the firmware stops it …"
[[nodiscard]] std::string in_words(const KickedRun& run);

}  // namespace host_sim::paper
