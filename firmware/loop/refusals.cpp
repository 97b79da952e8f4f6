#include "firmware/loop/refusals.hpp"

namespace firmware {
namespace {

std::uint32_t packed(const Trip& trip) {
  const std::uint32_t channel = trip.channel ? static_cast<std::uint32_t>(model::index(*trip.channel)) + 1 : 0;
  const auto interlock = static_cast<std::uint32_t>(trip.interlock + 1);
  return static_cast<std::uint32_t>(trip.reason) | channel << 8U | interlock << 16U;
}

}  // namespace

void Refusals::add(const Trip& trip) {
  const std::uint32_t count = count_.load(std::memory_order_relaxed), what = packed(trip);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (entries_[i].what.load(std::memory_order_relaxed) == what) return;
  }
  if (count == most) return;
  entries_[count].what.store(what, std::memory_order_relaxed);
  entries_[count].value.store(static_cast<float>(trip.value), std::memory_order_relaxed);
  entries_[count].limit.store(static_cast<float>(trip.limit), std::memory_order_relaxed);
  count_.store(count + 1, std::memory_order_release);
}

Trip Refusals::at(std::size_t place) const {
  const Entry& entry = entries_[place];
  const std::uint32_t what = entry.what.load(std::memory_order_relaxed);
  const std::uint32_t channel = what >> 8U & 0xffU, interlock = what >> 16U & 0xffU;
  Trip trip;
  trip.reason = static_cast<Reason>(what & 0xffU);
  if (channel > 0) trip.channel = model::channel_at(channel - 1);
  trip.interlock = static_cast<std::int8_t>(static_cast<int>(interlock) - 1);
  trip.value = static_cast<double>(entry.value.load(std::memory_order_relaxed));
  trip.limit = static_cast<double>(entry.limit.load(std::memory_order_relaxed));
  return trip;
}

}  // namespace firmware
