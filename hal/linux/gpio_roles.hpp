// The roles of hal that GPIO lines play.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "hal/clock.hpp"
#include "hal/drive_enable.hpp"
#include "hal/heartbeat.hpp"
#include "hal/interlocks.hpp"
#include "hal/linux/gpio.hpp"
#include "hal/stop_button.hpp"
#include "hal/stop_channels.hpp"
#include "hal/valve_bank.hpp"

namespace hal::linux {

/// Duct j + 1 is line j of one request; open is its active value. The request carries the safe position, and gives it
/// back.
class GpioValveBank final : public ValveBank {
 public:
  /// `lines` were requested with the safe position on them.
  GpioValveBank(std::unique_ptr<OutputLines> lines, std::size_t installed, Openings safe_position)
      : ValveBank(installed, safe_position), lines_(std::move(lines)) {}

 private:
  Result<void> do_write(Openings openings) override { return lines_->write(openings.bits()); }

  std::unique_ptr<OutputLines> lines_;
};

/// Pressed is the line's active value; also one that was active between two reads, with the stamp of its edge. A second
/// contact of the same button is compared with the first (StopChannels); either is a press.
class GpioStopButton final : public StopButton {
 public:
  /// `second` may be nothing.
  GpioStopButton(std::unique_ptr<EdgeLine> first, std::unique_ptr<EdgeLine> second, Clock& clock)
      : first_(std::move(first)), second_(std::move(second)), clock_(clock) {}

  /// When each contact opened last, or `never`; of the second `never` as well where there is none.
  struct Contacts {
    Time first = never, second = never;
  };
  [[nodiscard]] const Contacts& opened() const { return opened_; }

 private:
  Result<Level> do_read() override;

  std::unique_ptr<EdgeLine> first_;
  std::unique_ptr<EdgeLine> second_;
  Clock& clock_;
  StopChannels channels_{};
  Contacts opened_{};
};

/// A line that is active while the drive has power. The request carries the inactive value, and gives it back. A second
/// line, active while a contact shows power, is read back where there is one.
class GpioDriveEnable final : public DriveEnable {
 public:
  /// `feedback` may be nothing.
  GpioDriveEnable(std::unique_ptr<OutputLines> line, std::unique_ptr<EdgeLine> feedback)
      : line_(std::move(line)), feedback_(std::move(feedback)) {}

  [[nodiscard]] bool feedback_fitted() const override { return feedback_ != nullptr; }

 private:
  Result<void> do_write(bool on) override { return line_->write(on ? 1U : 0U); }
  Result<bool> do_feedback() override;

  std::unique_ptr<OutputLines> line_;
  std::unique_ptr<EdgeLine> feedback_;
};

/// Open is the lines' active value; also one that was active between two reads.
class GpioInterlocks final : public Interlocks {
 public:
  explicit GpioInterlocks(std::vector<std::unique_ptr<EdgeLine>> lines)
      : Interlocks(lines.size()), lines_(std::move(lines)) {}

 private:
  Result<std::uint32_t> do_read() override;

  std::vector<std::unique_ptr<EdgeLine>> lines_;
};

/// A line that changes with every beat, for a watchdog outside: a program that hangs leaves it still, high or low.
class GpioHeartbeat final : public Heartbeat {
 public:
  explicit GpioHeartbeat(std::unique_ptr<OutputLines> line) : line_(std::move(line)) {}

 private:
  Result<void> do_beat() override;

  std::unique_ptr<OutputLines> line_;
  unsigned level_ = 0;
};

}  // namespace hal::linux
