// Says when the innovations of a filter contradict its model.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/loop/kalman/estimator_equations.hpp"

namespace firmware {

/// Of a right model the normalised innovations ν = e/√s of each channel are white, independent and standard normal. In
/// blocks of N samples of a channel
///
///   (1)  level      Σ ν/√N                            constant error: an offset
///   (2)  variance   (Σ ν² − N)/√(2N)                  noise or model larger or smaller than described
///   (3)  colour     Σ ν_k ν_{k−L}/√N,  L = 1, 2, 4, 8, 16, 32     dynamics that the model does not have
///
/// are standard normal, (2) with a skewness γ = √(8/N), for which its limits are moved by (z² − 1) γ/6 (Cornish and
/// Fisher). A model is called wrong when one of them leaves ± z, with
///
///   (4)  2 (1 − Φ(z)) = false_alarms · N h/3600 s/(8 channels)
///
/// so that a right model is called wrong at most `false_alarms` times an hour (Bonferroni; nearly equal, because the
/// statistics are nearly independent). Innovations of periods in which the road moved otherwise than described
/// (KalmanFilter (5)) are set aside: N are the others. Where more than half of a block is set aside, the road is not
/// the one that was described, and that is said: Test::road, with the share in place of a statistic. The first blocks after a start are left out: a recording may begin in
/// mid-motion, and the filter forgets where it began as slowly as the road does, 1/(2π f_c) = 3 s.
class InnovationMonitor {
 public:
  static constexpr int block = 4096;  ///< N: 4 s at 1 kHz; half of it needs √2 of the error to be seen, but 2 s less
  static constexpr int settling = 4;  ///< blocks left out after a start: 16 s at 1 kHz, five of those times
  static constexpr std::array<int, 6> shifts{1, 2, 4, 8, 16, 32};  ///< L: from the noise's band to 16 Hz at 1 kHz
  enum class Test : unsigned char { none, level, variance, colour, road };

  /// What the last alarm was about.
  struct Alarm {
    Test test = Test::none;
    int channel = 0;         ///< number of the filter's channel
    double statistic = 0.0;  ///< in standard deviations; of `road` the share of the block that was set aside
  };

  InnovationMonitor(int channels, double period, double false_alarms);

  /// As constructed. In place: a second monitor has no room on a board's stack.
  void restart();

  /// One normalised innovation of a channel.
  void take(int channel, double innovation);
  /// One that is not to be judged.
  void set_aside(int channel);

  [[nodiscard]] bool model_wrong() const { return wrong_; }  ///< by a block since the last start
  [[nodiscard]] std::uint32_t alarms() const { return alarms_; }
  [[nodiscard]] std::uint32_t blocks() const { return blocks_; }  ///< judged, over all channels
  [[nodiscard]] const Alarm& last() const { return last_; }
  [[nodiscard]] double limit() const { return limit_; }  ///< z

 private:
  static constexpr std::size_t kept = 32;
  struct PerChannel {
    double sum = 0.0, squares = 0.0;
    std::array<double, shifts.size()> products{};
    std::array<double, kept> past{};
    int taken = 0, aside = 0;
    int newest = 0;
    int blocks = 0;
  };
  void judge(int channel);
  void compare(Test test, int channel, double statistic, double lower, double upper);

  double limit_;
  std::array<PerChannel, estimator_channels> channels_{};
  bool wrong_ = false;
  std::uint32_t alarms_ = 0, blocks_ = 0;
  Alarm last_{};
};

/// z with 1 − Φ(z) = tail, 1e-15 … 0.5, in + − × ÷: bisection on Simpson's rule over the density, error below 1e-6.
[[nodiscard]] double normal_quantile(double tail);

}  // namespace firmware
