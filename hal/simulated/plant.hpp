// What the simulated back-end is fed by.
#pragma once

#include <span>

#include "hal/command_output.hpp"
#include "hal/sensor_source.hpp"
#include "hal/valve_bank.hpp"

namespace hal::simulated {

/// A rig that somebody else simulates: hal knows neither its equations nor its units beyond SI.
///
/// The plant lives on a grid of periods. It is measured exactly once at every instant of the grid, in order, before it
/// is advanced to the next: sensor noise drawn in do_measure is the same whoever reads how often.
class Plant {
 public:
  virtual ~Plant() = default;

  /// What its sensors show at this instant, by channel index; a channel that is not fitted need not be filled.
  void measure(std::span<double, channel_capacity> values) { do_measure(values); }

  /// The area of an air spring is told to go to `area`, from now on.
  void command_area(double area) { do_command_area(area); }

  /// One period on: the command is where the drive is told to be at its end, the openings hold during it.
  void advance(const Command& command, Openings openings) { do_advance(command, openings); }

 private:
  virtual void do_measure(std::span<double, channel_capacity> values) = 0;
  virtual void do_advance(const Command& command, Openings openings) = 0;
  virtual void do_command_area(double /*area*/) {}
};

}  // namespace hal::simulated
