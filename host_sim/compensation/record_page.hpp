// What a compensation would have made of a recorded run, as a page.
#pragma once

#include <string>

#include "host_sim/compensation/machine_record.hpp"

namespace host_sim::compensation {

/// "The machine missed its command by 38 %; led by the inverse of the machine it would have missed it by 1.2 %."
[[nodiscard]] std::string sentence(const MachineRecord& record);

/// That sentence; the error of each method as bars; commanded, reached, and reached with the exact inverse over time.
[[nodiscard]] std::string record_page(const MachineRecord& record, const firmware::Recording& recording);

}  // namespace host_sim::compensation
