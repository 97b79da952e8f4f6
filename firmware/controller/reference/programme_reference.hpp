// The blocks of a programme as one reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/loop/reference/reference.hpp"

namespace firmware::controller {

/// Roads one after the other, without a jump at the joints.
///
/// A programme is a row of parts: each repetition of a block, and each pause, which stands where its block ends. The
/// last B samples of a part are faded into the first B of the next one as in CycleReference (equations 1 to 3). B is
/// 2 s, or a quarter of the shorter road. A pause stands still for its whole length between two joints.
/// A road is scaled about its beginning: x = x₀ + L (r − x₀).
class ProgrammeReference final : public Reference {
 public:
  struct Block {
    std::span<const Motion> road;  ///< at least one sample; outlives the reference
    double level = 1.0;
    std::uint64_t repetitions = 1;
    std::uint64_t pause = 0;  ///< [samples]
  };
  /// Where a sample lies, both from 1. A joint belongs to the part that begins, a pause to its block.
  struct Place {
    std::uint64_t block = 1;
    std::uint64_t cycle = 1;
  };

  /// At least one block. `most_repetitions` of each are played: for a look at the whole programme two hold every joint.
  ProgrammeReference(std::span<const Block> blocks, double period, std::uint64_t most_repetitions = UINT64_MAX);

  [[nodiscard]] std::uint64_t samples() const { return parts_.back().begin + parts_.back().length; }
  [[nodiscard]] Place place(std::uint64_t sample) const;

 private:
  struct Part {
    std::span<const Motion> road;  ///< empty: stands
    double level = 1.0;
    double stands_at = 0.0;    ///< [m]
    std::uint64_t begin = 0;   ///< sample of the run
    std::uint64_t length = 0;  ///< samples, both joints included
    std::uint64_t joint = 0;   ///< B at its beginning
    Place place{};

    [[nodiscard]] Motion at(std::uint64_t i) const;
  };

  std::optional<Motion> do_at(std::uint64_t sample) override;
  [[nodiscard]] std::size_t part_of(std::uint64_t sample) const;
  void append(Part part, double period);

  double period_;
  std::vector<Part> parts_;
  std::size_t newest_ = 0;  ///< part that was asked for last
};

}  // namespace firmware::controller
