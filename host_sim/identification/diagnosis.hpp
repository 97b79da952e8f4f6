// Where rig and model disagree, which effect is missing, and what is left when it is added.
#pragma once

#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/learn/learned_law.hpp"
#include "host_sim/identification/prepare/prepare.hpp"
#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// A diagnosis beside what it was made with, for whoever goes on from the selected model (transfer/).
struct Identified {
  IdentificationProblem problem;
  SearchSpace space;
  SearchResult found;
  Learned learned;
  Diagnosis diagnosis;
};
[[nodiscard]] Identified identify(const firmware::RigDescription& description, std::vector<Record> records,
                                  const ProgressCallback& progress = {});

/// The whole way of recordings to a verdict; each step stands in a folder of this room. InputError in one line where
/// the recordings cannot be used.
[[nodiscard]] Diagnosis diagnose(const firmware::RigDescription& description, std::vector<Record> records,
                                 const ProgressCallback& progress = {});

}  // namespace host_sim::identification
