#include "firmware/controller/real_time/delay_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace firmware::controller {
namespace {

constexpr std::size_t measurements = 1000;  // so that P99.9 is the second largest

hal::Time quantile_999(std::vector<std::int64_t>& values) {
  if (values.empty()) return {};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return hal::nanoseconds(*at);
}

}  // namespace

hal::Time measured_sample_age(const hal::Rig& roles, hal::Time first, hal::Time period) {
  std::vector<std::int64_t> ages;
  hal::Time due = first;
  roles.clock.sleep_until(due);
  const hal::Time end = roles.clock.now() + hal::milliseconds(1000);
  for (std::size_t i = 0; i < measurements && roles.clock.now() < end; ++i) {
    const auto frame = roles.sensors.read();
    const hal::Time now = roles.clock.now();
    std::int64_t oldest = 0;
    bool any = false;
    for (std::size_t c = 0; frame && c < hal::channel_capacity; ++c) {
      if (frame->channels[c].quality != hal::Quality::good) continue;
      oldest = std::max(oldest, (now - frame->channels[c].taken).ns);
      any = true;
    }
    if (any && i >= 8) ages.push_back(oldest);  // the first ones come out of the converters' queues
    due = std::max(due + period, now);
    roles.clock.sleep_until(due);
  }
  return quantile_999(ages);
}

hal::Time measured_computation(const std::function<void()>& step, hal::Clock& machine) {
  std::vector<std::int64_t> times;
  for (std::size_t i = 0; i < measurements; ++i) {
    const hal::Time begin = machine.now();
    step();
    times.push_back((machine.now() - begin).ns);
  }
  return quantile_999(times);
}

}  // namespace firmware::controller
