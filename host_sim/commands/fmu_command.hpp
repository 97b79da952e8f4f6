// rigtwin fmu: a rig as a functional mock-up unit.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace host_sim {

struct FmuOptions {
  std::string rig;
  std::string out;
  std::string json;
  int fmi = 2;  ///< version of the standard
};

void add_fmu(CLI::App& app, FmuOptions& options);

}  // namespace host_sim
