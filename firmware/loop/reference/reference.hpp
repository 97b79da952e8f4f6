// What a run follows.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "model/numerics/motion.hpp"

namespace firmware {

using Motion = model::Motion<double>;

/// Where the foot point (quarter_car, hil) or the deflection (component_bench) shall be at sample k of a run, k = 0 at
/// its beginning. Asked once for each sample, in order, from 0 again at every start; works without heap, within the
/// period. No value: the run ends with the sample before.
class Reference {
 public:
  virtual ~Reference() = default;

  [[nodiscard]] std::optional<Motion> at(std::uint64_t sample) { return do_at(sample); }

 private:
  virtual std::optional<Motion> do_at(std::uint64_t sample) = 0;
};

/// A reference that was worked out before: one motion for each sample, in memory of the caller.
class TableReference final : public Reference {
 public:
  explicit TableReference(std::span<const Motion> samples) : samples_(samples) {}

 private:
  std::optional<Motion> do_at(std::uint64_t sample) override {
    if (sample >= samples_.size()) return std::nullopt;
    return samples_[static_cast<std::size_t>(sample)];
  }

  std::span<const Motion> samples_;
};

}  // namespace firmware
