// The part of a rig description that only rig_controller uses: devices and scheduling.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace firmware {

/// [controller]: how the program runs.
struct ScheduleDescription {
  int priority = 80;           ///< SCHED_FIFO, 1 … 99
  int cpu = -1;                ///< on which the loop runs; −1: any
  int late_in_a_row = 5;       ///< number of consecutive late periods that ends the run
  double wake_early = 200e-6;  ///< before a period, to rehearse it, at most so long [s] and a quarter of it; 0: not
  double allowed_delay =
      0.0;  ///< of sample age and computation together [s]: what `rigtwin stability` says is left; 0: unknown
  double allowed_gain = 0.0;  ///< factor on the force that it says the loop bears; 0: unknown
  std::string socket;         ///< path of the operator's socket; empty: the usual one
  std::string proven;  ///< "sha256:…": loop_fingerprint() of the description that `rigtwin stability` found stable
};

/// [gpio]: lines of one chip, by label and names.
struct GpioDescription {
  std::string chip;
  std::vector<std::string> valves;      ///< duct 1 first
  bool valves_active_low = false;       ///< open is the low level
  std::string stop;                     ///< empty: no stop button
  std::string stop_2;                   ///< its second contact; empty: none
  std::string stop_bias = "pull-down";  ///< what a contact that is open, or its cut wire, leaves: one of line_biases
  bool stop_active_low = true;          ///< pressed is the low level
  std::string enable;                   ///< output that gives the drive power; empty: none
  bool enable_active_low = false;       ///< on is the low level
  std::string enable_feedback;          ///< contact that is closed while the drive has no power; empty: none
  std::string enable_feedback_bias = "pull-down";  ///< as stop_bias; power is the level of the pull
  std::string high_pressure;                       ///< output of the power unit's second stage; empty: none
  std::string hold_to_run;                         ///< interlock that somebody holds closed while the rig arms
  struct Interlock {
    std::string name, line;
  };
  std::vector<Interlock> interlocks;         ///< normally closed contacts
  std::string interlock_bias = "pull-down";  ///< as stop_bias; open is the level of the pull
  std::string heartbeat;                     ///< empty: no watchdog
  std::size_t source_line = 0;               ///< of the table in its file
};

/// How an input is held where no contact does: by the chip, or by a resistor outside. The pull gives the level of an
/// open contact and of a cut wire.
inline constexpr std::array<std::string_view, 4> line_biases{"pull-down", "pull-up", "external-pull-down",
                                                             "external-pull-up"};
[[nodiscard]] constexpr bool pulls_down(std::string_view bias) {
  return bias == "pull-down" || bias == "external-pull-down";
}

/// [converters]
struct ConverterDescription {
  std::string trigger;
  double trigger_rate = 0.0;  ///< [Hz]; 0: left alone
  double sample_age = 0.0;    ///< of its samples when a period begins [s]; 0: a quarter of the period
  struct Input {
    std::size_t channel;  ///< of model::Channel
    std::string device, input;
    double scale = 1.0, offset = 0.0;  ///< [SI unit/count], [SI unit]
  };
  std::vector<Input> inputs;  ///< [converters.F] and the like
  struct Output {
    std::string device, output;
    double scale = 1.0, offset = 0.0;  ///< of the command [m/count], [m]; of the area [1/count], [1]
    int lowest_counts = 0, highest_counts = 65535;
    /// What it puts out at its two ends.
    [[nodiscard]] std::pair<double, double> ends() const {
      return std::minmax({scale * lowest_counts + offset, scale * highest_counts + offset});
    }
  };
  std::optional<Output> command;  ///< [converters.command]
  std::optional<Output> area;     ///< [converters.area]: of an air spring
};

/// [lasers.dz_b] and the like: RIFTEK RF60x on a serial port.
struct LaserDescription {
  std::size_t channel;
  std::string port;
  int baud = 921600;
  int address = 1;
  double range = 0.0;                ///< [m]
  double scale = 1.0, offset = 0.0;  ///< [SI unit/m], [SI unit]
};

struct HardwareDescription {
  ScheduleDescription schedule;
  std::optional<GpioDescription> gpio;
  std::optional<ConverterDescription> converters;
  std::vector<LaserDescription> lasers;
};

}  // namespace firmware
