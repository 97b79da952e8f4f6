// Figures as Plotly takes them.
#pragma once

#include <string>

#include "host_sim/report/report.hpp"

namespace host_sim::report {

/// {"data": […], "layout": {…}} for Plotly.newPlot, safe inside an HTML script element. Throws std::logic_error for a
/// figure that cannot be right.
[[nodiscard]] std::string plotly_json(const Figure& figure);

}  // namespace host_sim::report
