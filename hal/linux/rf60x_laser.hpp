// A RIFTEK RF60x laser on a serial port.
#pragma once

#include <string>

#include "hal/linux/opened.hpp"
#include "hal/linux/rf60x_parser.hpp"
#include "hal/linux/sensors.hpp"

namespace hal::linux {

/// A distance sensor that streams its results over a port of its own (RS-485 or RS-232, 8 bits, even parity, 1 stop
/// bit).
///
///   (1)  value = scale · D S/4000h + offset         stamp: when the first byte of the frame was on the line
///
/// The kernel stamps no bytes: a byte is taken to have come as many byte times ago as there are bytes behind it, which
/// is at most a period too late. A result that the sensor has not renewed keeps its old stamp.
class Rf60xLaser final : public SensorPart {
 public:
  struct Wanted {
    std::string port;         ///< "/dev/ttyS1"
    unsigned baud = 921600;   ///< as set in the sensor; its factory setting is 9600
    unsigned address = 1;     ///< in the network, 1 … 127
    std::size_t channel = 0;  ///< place in the frame
    double range = 0.25;      ///< S [m]
    double scale = 1.0;       ///< [SI unit/m], −1 where a growing distance is a falling quantity
    double offset = 0.0;      ///< [SI unit]
  };
  /// Opens the port and asks for the stream.
  [[nodiscard]] static Opened<Rf60xLaser> open(const Wanted& wanted);
  ~Rf60xLaser() override;  ///< asks the sensor to be quiet
  Rf60xLaser(const Rf60xLaser&) = delete;
  Rf60xLaser& operator=(const Rf60xLaser&) = delete;

  /// What has come since the last read. disconnected: the port is gone.
  [[nodiscard]] Result<void> read(Frame& frame, Time now) override;

  [[nodiscard]] const Rf60xParser::Counts& counts() const { return parser_.counts(); }

  /// Mean time between renewed results so far; nothing before the 16th. 5 ms is the factory's sampling period: a
  /// channel that is five loop periods old.
  [[nodiscard]] Time interval() const;

  /// The driver hands over bytes at once. Without it some collect them for up to 16 ms (USB converters), and samples
  /// are that old.
  [[nodiscard]] bool low_latency() const { return low_latency_; }

  /// What a user should know about the stream when the loop's period is `period`, or an empty text.
  [[nodiscard]] std::string warning(Time period) const;

 private:
  Rf60xLaser(const Wanted& wanted, int port);
  void keep(const Rf60xParser::Frame& result);

  Wanted wanted_;
  int port_;
  bool low_latency_ = false;
  Time byte_time_;
  Rf60xParser parser_;
  Reading newest_{};
  Time first_ = never;
  std::uint64_t renewed_ = 0;
};

}  // namespace hal::linux
