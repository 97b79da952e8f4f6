#include "firmware/loop/energy_guard.hpp"

#include <limits>

namespace firmware {

EnergyGuard::EnergyGuard(const Limits& limits, double virtual_damping, double tyre_damping, double period)
    : gain_(limits.energy_gain),
      quiet_(limits.energy_quiet),
      most_cycles_(limits.energy_cycles),
      memory_(limits.energy_memory > period ? 1.0 - period / limits.energy_memory : 0.0),
      virtual_damping_(virtual_damping / period),
      tyre_damping_(tyre_damping / period) {}

void EnergyGuard::start(double deflection) {
  fed_ = taken_ = 0.0;
  deflection_ = lowest_ = highest_ = deflection;
  falling_ = false;
  cycles_ = 0;
}

std::optional<Trip> EnergyGuard::follow(double force, double deflection, double wheel_way) {
  const double way = deflection - deflection_;
  fed_ = memory_ * fed_ - force * way;                                                                     // (1)
  taken_ = memory_ * taken_ + (virtual_damping_ * (way * way) + tyre_damping_ * (wheel_way * wheel_way));  // (2)
  const bool turns = falling_ && way > 0.0;
  if (way != 0.0) falling_ = way < 0.0;

  std::optional<Trip> hazard;
  if (turns) {
    const bool wide = highest_ - lowest_ > quiet_;
    cycles_ = wide && fed_ > gain_ * taken_ ? cycles_ + 1 : 0;
    if (cycles_ >= most_cycles_) {
      const double value = taken_ > 0.0 ? fed_ / taken_ : std::numeric_limits<double>::max();
      hazard = Trip{Reason::energy, std::nullopt, value, gain_, hal::never};
      cycles_ = 0;
    }
    lowest_ = highest_ = deflection_;
  }
  deflection_ = deflection;
  if (deflection < lowest_) lowest_ = deflection;
  if (deflection > highest_) highest_ = deflection;
  return hazard;
}

}  // namespace firmware
