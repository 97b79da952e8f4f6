// The last look at a command before it becomes a voltage.
#pragma once

#include <cstdint>

namespace hal::linux {

/// Keeps a set point within a range and its change within a rate, whoever asks for what:
///
///   (1)  u ← clamp(wanted, lowest, highest)      (2)  u ← clamp(u, u_last ± rate · dt)
///
/// dt [s] is the time since the last one, at most `longest` periods of it: after a pause the drive does not jump.
class CommandLimit {
 public:
  struct Bounds {
    double lowest = -0.125;  ///< [m]
    double highest = 0.125;  ///< [m]
    double rate = 0.7;       ///< [m/s]
    double period = 1e-3;    ///< most that one step may count as having taken [s]
  };
  CommandLimit(const Bounds& bounds, double rest) : bounds_(bounds), last_(rest) {}

  [[nodiscard]] double limit(double wanted, double dt) {
    double u = wanted;
    if (!(u >= bounds_.lowest)) u = bounds_.lowest;  // also what is no number
    if (u > bounds_.highest) u = bounds_.highest;
    const double way = bounds_.rate * (dt < bounds_.period ? dt : bounds_.period) * (1.0 + 1e-9);
    if (u > last_ + way) u = last_ + way;
    if (u < last_ - way) u = last_ - way;
    if (u != wanted) ++limited_;
    return last_ = u;
  }

  [[nodiscard]] double last() const { return last_; }
  [[nodiscard]] std::uint64_t limited() const { return limited_; }  ///< how many were

 private:
  Bounds bounds_;
  double last_;
  std::uint64_t limited_ = 0;
};

}  // namespace hal::linux
