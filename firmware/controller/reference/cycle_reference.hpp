// A road that repeats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/loop/reference/reference.hpp"

namespace firmware::controller {

/// Sample i of a joint of B samples from motion a to motion b: (1) to (3) of CycleReference.
[[nodiscard]] Motion joint(const Motion& a, const Motion& b, std::uint64_t i, std::uint64_t samples, double period);

/// B of a road of n samples.
[[nodiscard]] std::uint64_t joint_samples(std::uint64_t n, double period);

/// The same motion over and over, with a joint without a jump.
///
/// A table of n samples repeats every P = n − B samples: the last B samples of a cycle are faded into the first B of
/// the next one by w = 10s³ − 15s⁴ + 6s⁵, s = i/B, whose first and second derivatives vanish at both ends:
///
///   (1)  x = (1 − w) a + w b                 a: sample P + i of the cycle that ends, b: sample i of the next one
///   (2)  ẋ = (1 − w) ȧ + w ḃ + ẇ (b − a)
///   (3)  ẍ = (1 − w) ä + w b̈ + 2 ẇ (ḃ − ȧ) + ẅ (b − a)
///
/// B is 2 s, or a quarter of the table if that is shorter. Ends 30 mm apart then cost at most 0.028 m/s and 43 mm/s²
/// (ẇ ≤ 1.875/T, ẅ ≤ 5.774/T²). The first cycle begins and the last one ends as the table does.
class CycleReference final : public Reference {
 public:
  /// `cycles` ≥ 1; 0: without end. One cycle is the table itself.
  CycleReference(std::span<const Motion> table, std::uint64_t cycles, double period);

  [[nodiscard]] std::uint64_t cycle_samples() const { return cycle_; }  ///< P

 private:
  std::optional<Motion> do_at(std::uint64_t sample) override;

  std::span<const Motion> table_;
  std::uint64_t cycles_;
  double period_;
  std::uint64_t blend_;  ///< B
  std::uint64_t cycle_;  ///< P
};

}  // namespace firmware::controller
