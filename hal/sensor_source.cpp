#include "hal/sensor_source.hpp"

#include <cmath>

namespace hal {

SensorSource::SensorSource(const SensorSetup& setup) : setup_(setup) {
  for (const ChannelSetup& channel : setup_) {
    require(channel.lowest < channel.highest, "a measuring range begins below its end");
  }
}

Result<Frame> SensorSource::checked(Result<Frame> frame) const {
  if (!frame) return frame;
  for (std::size_t i = 0; i < channel_capacity; ++i) {
    Reading& reading = (*frame).channels[i];
    if (!setup_[i].fitted || reading.quality == Quality::missing) {
      reading = Reading{};
    } else if (!std::isfinite(reading.value)) {
      reading.quality = Quality::not_finite;
    } else if (reading.quality == Quality::clipped || reading.value <= setup_[i].lowest ||
               reading.value >= setup_[i].highest) {
      reading.quality = Quality::clipped;
    } else {
      reading.quality = Quality::good;
    }
  }
  return frame;
}

}  // namespace hal
