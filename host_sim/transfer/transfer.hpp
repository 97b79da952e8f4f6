// From one rig to another: a component's model, learned on the first, predicts the second.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/transfer/report/transfer_result.hpp"

namespace host_sim::transfer {

/// What is transferred, and to what.
struct TransferInput {
  firmware::RigDescription from, to;
  std::vector<identification::Record> first;   ///< recordings of the first rig
  std::vector<identification::Record> second;  ///< of the second; empty: it drives over `road`
  firmware::FootPointMotion road;              ///< of the second rig, where it has no recordings
  std::size_t draws = 10000;                   ///< of the sampler
  std::uint64_t seed = 1;
};

/// In this order:
///
///   1  the two descriptions describe one component                       posterior/component_part.hpp
///   2  diagnosis of the first rig's recordings                           identification/
///   3  posterior: Laplace, rivals, discrepancy, sampler                  posterior/
///   4  prediction of the second rig, budget of its uncertainty           predict/
///   5  the measurement on the first rig that would narrow it most        predict/next_measurement.hpp
///   6  with recordings: validation, effects of each rig, equality        validate/
///   7  the naive way beside it                                           posterior/posterior.hpp
///
/// InputError where descriptions or recordings cannot be used.
[[nodiscard]] Transfer transfer_component(TransferInput input, const TransferProgress& progress = {});

}  // namespace host_sim::transfer
