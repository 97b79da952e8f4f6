// Lines of GPIO chips. Two implementations: gpio_v1.cpp for libgpiod 1.6, gpio_v2.cpp for 2.x; CMake picks one.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/linux/opened.hpp"
#include "hal/result.hpp"
#include "hal/time.hpp"

namespace hal::linux {

/// How an input is held where nothing drives it.
enum class Bias : unsigned char { as_is, pull_up, pull_down };

/// Some lines of one chip as outputs, in one request, written in one call. Given back with the values they began with.
class OutputLines {
 public:
  static constexpr std::size_t capacity = 8;

  struct Wanted {
    std::string chip;                ///< its label
    std::vector<std::string> lines;  ///< their names, 1 … 8
    bool active_low = false;         ///< 1 is the low level
    unsigned first = 0;              ///< bit i: line i, from the request on and again when given back
    std::string consumer;            ///< what others are told
  };
  [[nodiscard]] static Opened<OutputLines> open(const Wanted& wanted);
  ~OutputLines();
  OutputLines(const OutputLines&) = delete;
  OutputLines& operator=(const OutputLines&) = delete;

  /// Bit i to line i. disconnected: the chip is gone.
  [[nodiscard]] Result<void> write(unsigned bits);

 private:
  struct Lines;
  explicit OutputLines(std::unique_ptr<Lines> lines);
  std::unique_ptr<Lines> lines_;
};

/// One line as input, its edges queued by the kernel with their stamps on CLOCK_MONOTONIC (16 at most).
class EdgeLine {
 public:
  struct Wanted {
    std::string chip;
    std::string line;
    bool active_low = false;
    Bias bias = Bias::as_is;
    std::string consumer;
  };
  [[nodiscard]] static Opened<EdgeLine> open(const Wanted& wanted);
  ~EdgeLine();
  EdgeLine(const EdgeLine&) = delete;
  EdgeLine& operator=(const EdgeLine&) = delete;

  struct State {
    bool active = false;  ///< now, or at any time since the last read
    bool now = false;     ///< the level now
    Time since = never;   ///< when that began, as far as an edge said so
  };
  /// Takes the queued edges without waiting, and looks at the level. disconnected: the chip is gone.
  [[nodiscard]] Result<State> read();

 private:
  struct Line;
  explicit EdgeLine(std::unique_ptr<Line> line);
  std::unique_ptr<Line> line_;
};

/// What is there, for people: one text a chip, its lines with their users below it.
[[nodiscard]] std::string list_gpio();

/// Version of the library that was compiled in, "libgpiod 1.6.3".
[[nodiscard]] std::string gpio_library();

/// Paths of all GPIO chips, /dev/gpiochip0 first.
[[nodiscard]] std::vector<std::string> gpio_chip_paths();

}  // namespace hal::linux
