#include "firmware/loop/guards/energy_guard.hpp"

#include <limits>

namespace firmware {

EnergyGuard::EnergyGuard(const Limits& limits, double virtual_damping, double tyre_damping, double period,
                         double growth_time)
    : gain_(limits.energy_gain),
      quiet_(limits.energy_quiet),
      growth_time_(growth_time),
      period_(period),
      most_cycles_(limits.energy_cycles),
      memory_(limits.energy_memory > period ? 1.0 - period / limits.energy_memory : 0.0),
      virtual_damping_(virtual_damping / period),
      tyre_damping_(tyre_damping / period) {}

void EnergyGuard::start(double deflection) {
  fed_ = taken_ = fed_outwards_ = taken_outwards_ = growing_ = 0.0;
  deflection_ = lowest_ = highest_ = mean_deflection_ = deflection;
  offset_free_ = mean_force_ = 0.0;
  falling_ = begun_ = false;
  cycles_ = 0;
}

std::optional<Trip> EnergyGuard::follow(double force, double deflection, double wheel_way, hal::Time now) {
  if (!begun_) mean_force_ = force;
  begun_ = true;
  mean_force_ += (1.0 - memory_) * (force - mean_force_);                 // (1)
  mean_deflection_ += (1.0 - memory_) * (deflection - mean_deflection_);  // (2)
  const double before = offset_free_;
  offset_free_ = deflection - mean_deflection_;
  const double way = offset_free_ - before;
  const double fed = -(force - mean_force_) * way;
  const double taken = virtual_damping_ * (way * way) + tyre_damping_ * (wheel_way * wheel_way);
  const bool outwards = way * (before + offset_free_) > 0.0;
  fed_ = memory_ * fed_ + fed;                                       // (3)
  taken_ = memory_ * taken_ + taken;                                 // (4)
  fed_outwards_ = memory_ * fed_outwards_ + (outwards ? fed : 0.0);  // (5)
  taken_outwards_ = memory_ * taken_outwards_ + (outwards ? taken : 0.0);

  const double change = deflection - deflection_;
  const bool turns = falling_ && change > 0.0;
  if (change != 0.0) falling_ = change < 0.0;
  if (before * offset_free_ < 0.0) growing_ = 0.0;  // an oscillation: judged at its turns
  std::optional<Trip> hazard = judge_growth(now);
  if (turns) {
    const bool wide = highest_ - lowest_ > quiet_;
    cycles_ = wide && fed_ > gain_ * taken_ ? cycles_ + 1 : 0;
    if (cycles_ >= most_cycles_) {
      const double value = taken_ > 0.0 ? fed_ / taken_ : std::numeric_limits<double>::max();
      hazard = Trip{Reason::energy, std::nullopt, value, gain_, now};
      cycles_ = 0;
    }
    lowest_ = highest_ = deflection_;
  }
  deflection_ = deflection;
  if (deflection < lowest_) lowest_ = deflection;
  if (deflection > highest_) highest_ = deflection;
  return hazard;
}

std::optional<Trip> EnergyGuard::judge_growth(hal::Time now) {
  if (fed_outwards_ <= gain_ * taken_outwards_) {
    growing_ = 0.0;
  } else if (offset_free_ > quiet_ || offset_free_ < -quiet_) {
    growing_ += period_;
  }
  if (growing_ <= growth_time_) return std::nullopt;
  growing_ = 0.0;
  const double value = taken_outwards_ > 0.0 ? fed_outwards_ / taken_outwards_ : std::numeric_limits<double>::max();
  return Trip{Reason::growth, std::nullopt, value, gain_, now};
}

}  // namespace firmware
