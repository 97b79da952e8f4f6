// How a simulated sensor goes wrong.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/sensor_source.hpp"
#include "hal/simulated/fault_plan.hpp"

namespace hal::simulated {

/// Turns what the plant shows into what the sensors deliver; one call a sampling instant, in order.
class ChannelFaults {
 public:
  explicit ChannelFaults(const FaultPlan& plan) : plan_(plan), random_(plan.seed) {}

  [[nodiscard]] Frame apply(const Frame& shown, Time instant);

 private:
  void apply(const ChannelFault& fault, Reading& reading);
  [[nodiscard]] std::uint64_t draw();

  FaultPlan plan_;
  std::uint64_t random_;
  std::array<Frame, delay_capacity> history_{};  ///< what the plant showed, newest at newest_
  std::size_t newest_ = 0;
  std::array<std::optional<Reading>, channel_capacity> frozen_{};
};

}  // namespace hal::simulated
