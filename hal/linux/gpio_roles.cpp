#include "hal/linux/gpio_roles.hpp"

namespace hal::linux {

Result<StopButton::Level> GpioStopButton::do_read() {
  const Result<EdgeLine::State> state = line_->read();
  if (!state) return state.fault();
  if (!state->active) return Level{};
  return Level{true, state->since != never ? state->since : clock_.now()};  // held from before: no edge told when
}

Result<void> GpioHeartbeat::do_beat() {
  level_ = 1U - level_;
  return line_->write(level_);
}

}  // namespace hal::linux
