// rigtwin diagnose --live: names what begins to be wrong while a rig runs.
#pragma once

#include <string>

namespace host_sim {

struct DiagnoseOptions;

/// Where rig_controller listens for its operator: as given, else as the description `rig` says, else the usual one.
[[nodiscard]] std::string operators_socket(const std::string& given, const std::string& described);

/// A controller's datagrams until it ends, or a recording from its beginning to its end. InputError: no datagrams, or
/// they are those of another rig. RunStopped: the diagnosis has stopped the rig.
void diagnose_live(const DiagnoseOptions& options);

}  // namespace host_sim
