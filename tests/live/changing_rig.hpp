// A simulated rig that changes while it runs, as samples one after the other.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/live/live_diagnosis.hpp"

namespace sample {

/// A run over an ISO 8608 road (class B) with the described sensors' noise, and what happens in it.
struct Run {
  double duration = 60.0;  ///< [s]
  std::uint64_t seed = 1;
  double speed = 27.78;      ///< [m/s]
  double changes_at = 45.0;  ///< [s]
  double level = 1.0;        ///< of the road in the second half of the run: it rises or falls over ten seconds
  /// The rig from then on; none: it stays as it is.
  std::function<void(model::RigParameters<double>&)> change{};
  /// What the reader makes of a sample.
  std::function<void(host_sim::live::LiveSample&)> reader{};
  /// What is wrong with the rig all the time.
  std::function<void(model::RigParameters<double>&)> from_the_beginning{};
};

/// The samples of a run: one model, whose state goes on when its parameters change.
void drive(const firmware::RigDescription& rig, const Run& run,
           const std::function<void(const host_sim::live::LiveSample&)>& take);

/// Every finding of a diagnosis of that run.
[[nodiscard]] std::vector<host_sim::live::Finding> diagnosed(const firmware::RigDescription& rig, const Run& run);

/// The paper's quarter car, hil rig and the hil rig's component on a bench, with their sensors' noise.
[[nodiscard]] firmware::RigDescription quarter_car();
[[nodiscard]] firmware::RigDescription hil();
[[nodiscard]] firmware::RigDescription component_bench();
/// The same car and hil rig with the paper's FDVA.
[[nodiscard]] firmware::RigDescription quarter_car_fdva();
[[nodiscard]] firmware::RigDescription hil_fdva();

}  // namespace sample
