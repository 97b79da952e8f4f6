// A transfer in sentences.
#pragma once

#include <string>
#include <vector>

#include "host_sim/transfer/report/transfer_result.hpp"

namespace host_sim::transfer {

/// The verdict in words and numbers, by frequency range.
[[nodiscard]] std::string verdict_text(const Transfer& transfer);

/// Neighbouring bands of one response with the same verdict, as one sentence each.
[[nodiscard]] std::vector<std::string> range_sentences(const Validation& validation, std::size_t response);

/// "±2.1 %", "0.8 %": two digits.
[[nodiscard]] std::string per_cent(double share);

/// "seal_friction (force = 25.1 N, 23.9 … 26.2)"
[[nodiscard]] std::string words(const OwnedEffect& effect);
[[nodiscard]] std::string words(const SharedValue& value);
[[nodiscard]] std::string words(const NextMeasurement& next);
/// How the rest of the first rig's recordings is treated.
[[nodiscard]] std::string discrepancy_text(const Posterior& posterior);

}  // namespace host_sim::transfer
