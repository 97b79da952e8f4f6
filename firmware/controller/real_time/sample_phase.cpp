#include "firmware/controller/real_time/sample_phase.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace firmware::controller {
namespace {

constexpr int looked_at = 64;
constexpr std::size_t fewest = 16;  // stamps that differ

/// a modulo b, in 0 … b − 1.
std::int64_t remainder(std::int64_t a, std::int64_t b) {
  const std::int64_t r = a % b;
  return r < 0 ? r + b : r;
}

}  // namespace

hal::Time SamplePhase::next(hal::Time now) const {
  const hal::Time first = stamp + age;
  return now + hal::nanoseconds(remainder((first - now).ns, period.ns));
}

std::optional<SamplePhase> measured_phase(hal::Clock& clock, hal::SensorSource& sensors,
                                          std::span<const std::size_t> channels, hal::Time period, hal::Time age) {
  std::vector<hal::Time> stamps;
  hal::Time due = clock.now();
  for (int i = 0; i < looked_at; ++i) {
    const auto frame = sensors.read();
    for (const std::size_t channel : channels) {
      if (!frame || frame->channels[channel].quality == hal::Quality::missing) continue;
      const hal::Time taken = frame->channels[channel].taken;
      if (taken != hal::never && (stamps.empty() || stamps.back() != taken)) stamps.push_back(taken);
      break;  // one trigger: all channels have one stamp
    }
    due += period;
    clock.sleep_until(due);
  }
  if (stamps.size() < fewest) return std::nullopt;
  // Phases against the last stamp, −T/2 … T/2: around it the circle is a line.
  const hal::Time last = stamps.back();
  std::vector<std::int64_t> phases;
  for (const hal::Time stamp : stamps) {
    phases.push_back(remainder((stamp - last).ns + period.ns / 2, period.ns) - period.ns / 2);
  }
  std::sort(phases.begin(), phases.end());
  const std::size_t tenth = phases.size() / 10;
  if (phases[phases.size() - 1 - tenth] - phases[tenth] > period.ns / 4) return std::nullopt;
  return SamplePhase{last + hal::nanoseconds(phases[phases.size() / 2]), age, period};
}

}  // namespace firmware::controller
