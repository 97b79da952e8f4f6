#include "hal/simulated/channel_faults.hpp"

#include <bit>
#include <limits>

namespace hal::simulated {

Frame ChannelFaults::apply(const Frame& shown, Time instant) {
  if (plan_.channels.empty()) return shown;
  newest_ = (newest_ + 1) % delay_capacity;
  history_[newest_] = shown;

  Frame delivered = shown;
  std::array<bool, channel_capacity> freezing{};
  for (const ChannelFault& fault : plan_.channels) {
    if (!fault.window.contains(instant)) continue;
    freezing[fault.channel] =
        freezing[fault.channel] || fault.kind == ChannelFault::Kind::freeze || fault.kind == ChannelFault::Kind::repeat;
    apply(fault, delivered.channels[fault.channel]);
  }
  for (std::size_t i = 0; i < channel_capacity; ++i) {
    if (!freezing[i]) frozen_[i].reset();
  }
  return delivered;
}

void ChannelFaults::apply(const ChannelFault& fault, Reading& reading) {
  using Kind = ChannelFault::Kind;
  if (fault.kind == Kind::freeze || fault.kind == Kind::repeat) {
    std::optional<Reading>& frozen = frozen_[fault.channel];
    if (!frozen) frozen = reading;
    const Time taken = reading.taken;
    reading = *frozen;
    if (fault.kind == Kind::repeat) reading.taken = taken;
    return;
  }
  if (fault.probability < 1.0) {
    const double drawn = static_cast<double>(draw() >> 11) * 0x1p-53;  // uniform in [0, 1)
    if (drawn >= fault.probability) return;
  }
  switch (fault.kind) {
    case Kind::drop:
      reading = Reading{};
      break;
    case Kind::delay:
      reading = history_[(newest_ + delay_capacity - fault.delay_samples) % delay_capacity].channels[fault.channel];
      break;
    case Kind::not_a_number:
      reading.value = std::numeric_limits<double>::quiet_NaN();
      break;
    case Kind::spike:
      reading.value += fault.spike;
      break;
    case Kind::bit_flip: {
      const unsigned bit = fault.bit >= 0 ? static_cast<unsigned>(fault.bit) : static_cast<unsigned>(draw() >> 58);
      reading.value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(reading.value) ^ (std::uint64_t{1} << bit));
      break;
    }
    case Kind::freeze:
    case Kind::repeat:
      break;
  }
}

std::uint64_t ChannelFaults::draw() {  // SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): integers only, any seed
  random_ += 0x9e3779b97f4a7c15U;
  std::uint64_t x = random_;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

}  // namespace hal::simulated
