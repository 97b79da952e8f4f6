// Converters by libiio, on this machine.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/area_output.hpp"
#include "hal/clock.hpp"
#include "hal/command_output.hpp"
#include "hal/linux/command_limit.hpp"
#include "hal/linux/opened.hpp"
#include "hal/linux/sensors.hpp"

namespace hal::linux {

/// Channels of analogue-to-digital converters, all sampled by one trigger, captured in buffers of one sample: every
/// further place in a buffer would be a period of delay. Stamps are the kernel's, on CLOCK_MONOTONIC.
///
///   (1)  value = scale · counts + offset
class IioConverters final : public SensorPart {
 public:
  struct Input {
    std::size_t channel = 0;  ///< place in the frame
    std::string device;       ///< name or id, "ads8688"
    std::string input;        ///< "voltage0"
    double scale = 1.0;       ///< [SI unit/count]
    double offset = 0.0;      ///< [SI unit]
  };
  struct Wanted {
    std::string trigger;  ///< name or id; empty: the devices have one each of their own
    double rate = 0.0;    ///< set the trigger to it [Hz]; 0: it is left alone
    std::vector<Input> inputs;
  };
  [[nodiscard]] static Opened<IioConverters> open(const Wanted& wanted);
  ~IioConverters() override;
  IioConverters(const IioConverters&) = delete;
  IioConverters& operator=(const IioConverters&) = delete;

  /// The newest sample of each channel, without waiting. disconnected: a converter is gone.
  [[nodiscard]] Result<void> read(Frame& frame, Time now) override;

 private:
  struct Capture;
  explicit IioConverters(std::unique_ptr<Capture> capture);
  std::unique_ptr<Capture> capture_;
};

/// One output of a digital-to-analogue converter, locked for this program while it is open.
///
///   (1)  counts = (value − offset)/scale, rounded, within lowest_counts … highest_counts
class IioOutput {
 public:
  struct Wanted {
    std::string device;   ///< name or id
    std::string output;   ///< "voltage0"
    double scale = 1.0;   ///< [SI unit/count]
    double offset = 0.0;  ///< value at 0 counts [SI unit]
    long lowest_counts = 0, highest_counts = 65535;
  };
  [[nodiscard]] static Opened<IioOutput> open(const Wanted& wanted);
  ~IioOutput();
  IioOutput(const IioOutput&) = delete;
  IioOutput& operator=(const IioOutput&) = delete;

  Result<void> write(double value);
  /// By (1). refused: the converter does not show what it puts out.
  [[nodiscard]] Result<double> read_back() const;

 private:
  IioOutput(const Wanted& wanted, int file) : wanted_(wanted), file_(file) {}

  Wanted wanted_;
  int file_;  ///< the converter's raw value in sysfs
};

/// The set point of the drive [m], limited once more.
class IioCommand final : public CommandOutput {
 public:
  struct Wanted {
    IioOutput::Wanted output;
    CommandLimit::Bounds bounds{};
    double rest = 0.0;  ///< where the drive is taken to be at first [m], if the converter does not show it
  };
  [[nodiscard]] static Opened<IioCommand> open(const Wanted& wanted, Clock& clock);

  [[nodiscard]] const CommandLimit& limit() const { return limit_; }

 private:
  IioCommand(const Wanted& wanted, Clock& clock, std::unique_ptr<IioOutput> output);
  Result<void> do_write(const Command& command) override;
  Result<double> do_read_back() override { return output_->read_back(); }

  double longest_;  ///< most that one step may count as having taken [s]
  Clock& clock_;
  std::unique_ptr<IioOutput> output_;
  CommandLimit limit_;
  Time last_ = never;
};

/// The area of an air spring, as its relative change [1]. Opened and closed at rest: 0.
class IioArea final : public AreaOutput {
 public:
  [[nodiscard]] static Opened<IioArea> open(const IioOutput::Wanted& wanted);
  ~IioArea() override { static_cast<void>(output_->write(0.0)); }
  IioArea(const IioArea&) = delete;
  IioArea& operator=(const IioArea&) = delete;

 private:
  explicit IioArea(std::unique_ptr<IioOutput> output) : output_(std::move(output)) {}
  Result<void> do_write(double area) override { return output_->write(area); }

  std::unique_ptr<IioOutput> output_;
};

/// Devices, channels and triggers that are there, for people.
[[nodiscard]] std::string list_iio();

/// Version of the library, "libiio 0.24".
[[nodiscard]] std::string iio_library();

}  // namespace hal::linux
