#include "hal/linux/gpio_roles.hpp"

namespace hal::linux {

Result<StopButton::Level> GpioStopButton::do_read() {
  const Result<EdgeLine::State> first = first_->read();
  if (!first) return first.fault();
  const Result<EdgeLine::State> second = second_ ? second_->read() : first;
  if (!second) return second.fault();
  const Time now = clock_.now();
  const auto since = [now](const EdgeLine::State& state) {
    return state.since != never ? state.since : now;  // held from before: no edge told when
  };
  if (first->active) opened_.first = since(*first);
  if (second_ && second->active) opened_.second = since(*second);
  if (!channels_.agree(first->now, second->now, now)) return Fault::refused;
  if (!first->active && !second->active) return Level{};
  Time began = first->active ? since(*first) : since(*second);
  if (second->active && since(*second) < began) began = since(*second);
  return Level{true, began, second_ != nullptr && !StopChannels::one_press(opened_.first, opened_.second)};
}

Result<bool> GpioDriveEnable::do_feedback() {
  const Result<EdgeLine::State> state = feedback_->read();
  if (!state) return state.fault();
  return state->now;
}

Result<std::uint32_t> GpioInterlocks::do_read() {
  std::uint32_t open = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Result<EdgeLine::State> state = lines_[i]->read();
    if (!state) return state.fault();
    if (state->active) open |= std::uint32_t{1} << i;
  }
  return open;
}

Result<void> GpioHeartbeat::do_beat() {
  level_ = 1U - level_;
  return line_->write(level_);
}

}  // namespace hal::linux
