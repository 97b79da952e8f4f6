// A transfer as a page.
#pragma once

#include <string>

#include "host_sim/transfer/report/transfer_result.hpp"

namespace host_sim::transfer {

/// First screen: verdict, bands over the measurement, budget of the uncertainty. Then the naive way, parameters,
/// spectra, the next measurement, traces.
[[nodiscard]] std::string report_html(const Transfer& transfer, const firmware::RigDescription& from,
                                      const firmware::RigDescription& to);

}  // namespace host_sim::transfer
