// Figures as JSON for Plotly.
#pragma once

#include <string>

#include "host_sim/report/report.hpp"

namespace host_sim::report {

/// {"data": […], "layout": {…}} for Plotly.newPlot, safe inside an HTML script element. Throws std::logic_error for an
/// invalid figure.
[[nodiscard]] std::string plotly_json(const Figure& figure);

}  // namespace host_sim::report
