#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

namespace truth {

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): one 64-bit word of state, the same numbers with every compiler.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }  ///< 0 … 1
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double logarithmic(double low, double high) { return low * std::pow(high / low, uniform()); }
  int below(int count) { return static_cast<int>(uniform() * count); }
  bool chance(double probability) { return uniform() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  double normal() {  ///< mean 0, rms 1 (Box and Muller)
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace truth
