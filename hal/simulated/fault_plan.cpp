#include "hal/simulated/fault_plan.hpp"

#include "hal/interlocks.hpp"

namespace hal::simulated {

std::string_view FaultPlan::check() const {
  for (const ChannelFault& fault : channels) {
    if (fault.channel >= channel_capacity) return "a channel fault names a channel that hal does not have";
    if (fault.delay_samples >= delay_capacity) return "a channel fault delays by more samples than are kept";
    if (fault.bit < -1 || fault.bit > 63) return "a channel fault turns over a bit outside 0 to 63";
    if (!(fault.probability >= 0.0 && fault.probability <= 1.0)) return "a channel fault has no probability of 0 to 1";
  }
  for (const OpenInterlock& open : open_interlocks) {
    if (open.interlock >= Interlocks::capacity) return "an open interlock is one that hal does not have";
  }
  for (const LateWake& late : late_wakes) {
    if (late.by < Time{}) return "a late wake comes early";
  }
  return {};
}

}  // namespace hal::simulated
