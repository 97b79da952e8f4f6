// The roles of hal that GPIO lines play.
#pragma once

#include <memory>

#include "hal/clock.hpp"
#include "hal/heartbeat.hpp"
#include "hal/linux/gpio.hpp"
#include "hal/stop_button.hpp"
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

/// Pressed is the line's active value; also one that was active between two reads, with the stamp of its edge.
class GpioStopButton final : public StopButton {
 public:
  GpioStopButton(std::unique_ptr<EdgeLine> line, Clock& clock) : line_(std::move(line)), clock_(clock) {}

 private:
  Result<Level> do_read() override;

  std::unique_ptr<EdgeLine> line_;
  Clock& clock_;
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
