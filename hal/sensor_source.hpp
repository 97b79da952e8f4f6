// Where samples come from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hal/result.hpp"
#include "hal/time.hpp"

namespace hal {

/// How many channels a rig may have. What a channel's index means is agreed between the configuration and the user of
/// the samples; hal does not know.
inline constexpr std::size_t channel_capacity = 16;

/// Can the value be trusted? Age is judged by the user, who knows how old a sample may be.
enum class Quality : unsigned char {
  missing,     ///< no sample, or no such channel
  good,        ///< finite and inside the measuring range
  not_finite,  ///< NaN or infinite
  clipped,     ///< at or beyond an end of the measuring range, or at an end of the converter
};

/// One channel's sample.
struct Reading {
  double value = 0.0;                  ///< [SI]; counts became SI in the back-end
  Time taken = never;                  ///< when it was sampled (not: fetched), on the rig's clock
  Quality quality = Quality::missing;  ///< set by SensorSource::read; a back-end tells missing from there
};

/// One sample of each channel, by channel index.
struct Frame {
  std::array<Reading, channel_capacity> channels{};
};

/// A channel's place in the rig.
struct ChannelSetup {
  bool fitted = false;                                       ///< is there such a sensor?
  double lowest = -std::numeric_limits<double>::infinity();  ///< lower end of the measuring range [SI]
  double highest = std::numeric_limits<double>::infinity();  ///< upper end of the measuring range [SI]
};

using SensorSetup = std::array<ChannelSetup, channel_capacity>;

/// Where samples come from: converters or serial lines on the rig, a model in simulation, a recording in replay.
///
/// Returns within the control period, on the thread that owns it, without allocating.
/// timeout: no frame this period.   disconnected: make the rig safe and open the device anew.   refused: not used.
/// A back-end fills value and stamp and leaves the quality of a channel without a sample at `missing`, of a sample at
/// an end of its converter at `clipped`, of every other at `good`; finiteness and range are checked here, for every
/// back-end alike.
class SensorSource {
 public:
  explicit SensorSource(const SensorSetup& setup);
  virtual ~SensorSource() = default;

  [[nodiscard]] Result<Frame> read() { return checked(do_read()); }

  [[nodiscard]] const SensorSetup& setup() const { return setup_; }
  [[nodiscard]] bool fitted(std::size_t channel) const { return setup_[channel].fitted; }

 private:
  virtual Result<Frame> do_read() = 0;
  [[nodiscard]] Result<Frame> checked(Result<Frame> frame) const;

  SensorSetup setup_;
};

}  // namespace hal
