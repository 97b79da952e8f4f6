// Random numbers that are the same on every machine.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

namespace firmware {

/// Normal samples of variance 1 from a seed.
///
/// Marsaglia's polar method on a Mersenne Twister, whose sequence the C++ standard fixes; std::normal_distribution and
/// the logarithm of the C library differ between platforms, so the logarithm is our own: only + − × ÷ √.
class Gaussian {
 public:
  /// `stream` separates the uses of one seed: road, sensor noise.
  Gaussian(std::uint64_t seed, std::uint32_t stream) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U), stream};
    engine_.seed(words);
  }

  double operator()() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0, v = 0.0, s = 0.0;
    do {
      u = uniform();
      v = uniform();
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double factor = std::sqrt(-2.0 * logarithm(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

  /// ln x for normal x > 0, within 2 ulp: ln(2^e m) = e ln 2 + 2 artanh((m − 1)/(m + 1)), m in √½ … √2.
  [[nodiscard]] static double logarithm(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    int exponent = static_cast<int>(bits >> 52U) - 1023;
    double m = std::bit_cast<double>((bits & 0xfffffffffffffULL) | 0x3ff0000000000000ULL);
    if (m > 1.4142135623730951) {
      m *= 0.5;
      ++exponent;
    }
    const double r = (m - 1.0) / (m + 1.0);  // |r| < 0.172: 0.172^25/25 < 1e-20
    const double r2 = r * r;
    double series = 0.0;
    for (int k = 23; k >= 1; k -= 2) series = series * r2 + 1.0 / k;
    return exponent * 0.6931471805599453 + 2.0 * r * series;
  }

 private:
  /// −1 … 1, 53 bits
  double uniform() { return static_cast<double>(engine_() >> 11U) * (1.0 / 4503599627370496.0) - 1.0; }

  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace firmware
