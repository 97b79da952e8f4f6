// Does the rig go where it is told?
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "hal/command_output.hpp"
#include "model/components/machine.hpp"
#include "model/numerics/delay_line.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// Compares the measured position (x_act of hil and component_bench, z_r of quarter_car) with the commands:
///
///   (1)  x̂ = machine(x_cmd(t − τ))         expected: delay, lag, resonance and rate limit of the rig description
///   (2)  e = x − x̂                         following error
///   (3)  v = (x(k) − x(k − n))/(n h),       n h = speed_window
///
/// x is the reading without the gain and offset that the description gives its sensor; delay, lag and half of the hold
/// of that sensor belong to τ. Hazards: |e| > following for longer than following_time; |x| > half of measured_stroke,
/// or |v| > measured_speed (in a slow motion low_speed), in bridged_in_a_row steps in a row (a single wrong sample is no motion). A small motion
/// allows a small error only:
///
///   (4)  a = following_least + (following/speed) |v̂| + following_share |x̂|      v̂ the expected speed
///   (5)  ē² and ā²: means of (e − e₀)² and a² over following_memory, by a first-order filter
///
/// e₀ is the error at rest while the rig armed, up to position_tolerance: an offset of a sensor is no motion.
/// ē² > ā² is a hazard, too. following/speed (14 ms) is the unknown delay that `following` allows at full speed, so a
/// drive that follows late by less never trips, whatever it does; one that stands still has e = x̂ and trips at any
/// amplitude above following_least where |v̂| < |x̂| / 14 ms, that is below 11 Hz. Means and not a time without a break,
/// since the error of a motion to and fro passes 0. Not judged of a sensor that is described to saturate. (LinuxCNC's
/// FERROR and MIN_FERROR.)
///
/// The guard steps once a period; less often where τ is longer than its line of 28 samples or the window longer than
/// 15: then once every so many periods that both fit. Static memory, 0.8 KiB.
class MotionGuard {
 public:
  /// `low_speed`: limit of (3) in a slow motion [m/s].
  MotionGuard(const Limits& limits, const Supervision& supervision, const model::RigParameters<double>& rig,
              double period, double low_speed = never_reached);

  /// From here on the rig moves slowly, or not. A drive that was faster has following_time to become slow after x̂ is.
  void move_slowly(bool slow) { slow_ = slow; }

  /// The drive rests at `position`, and did so for long.
  void start(double position);

  /// One period: the command for this instant, and what was measured. While the rig arms e₀ is taken, and (5) is not
  /// judged: ArmingChecks compares.
  [[nodiscard]] std::optional<Trip> follow(const hal::Command& command, const SampleGuard& samples,
                                           hal::Time now = hal::never, bool arming = false);

  [[nodiscard]] double expected() const { return reached_.position; }  ///< x̂ [m]
  [[nodiscard]] double error() const { return error_; }                ///< e [m]; 0 without a sensor
  [[nodiscard]] double speed() const { return speed_; }                ///< v [m/s]; 0 until the window is full
  [[nodiscard]] int stride() const { return stride_; }                 ///< periods a step

 private:
  static constexpr std::size_t line_length = 32;
  static constexpr std::size_t window_length = 16;
  static constexpr double rest_time = 0.02;  ///< smoothing of e₀ [s]
  using Line = model::DelayLine<model::Stroke<float>, line_length, float>;

  [[nodiscard]] std::optional<Trip> judge(double position, hal::Time now);

  model::Channel channel_;
  double gain_ = 1.0;
  double offset_ = 0.0;
  double following_;
  double following_least_;
  double following_delay_;  ///< following/speed [s]
  double following_share_;
  double memory_;                                 ///< of (5), a step's share
  double mean_error_ = 0.0, mean_allowed_ = 0.0;  ///< ē², ā² [m²]
  double offset_at_rest_ = 0.0;                   ///< e₀ [m]
  double half_stroke_;
  double highest_speed_;
  double low_speed_;
  bool slow_ = false;
  int calm_ = 0;  ///< steps in a row with an expected speed below low_speed
  int confirmations_;

  double period_;            ///< of the guard's own step [s]
  int stride_ = 1;           ///< [periods]
  std::size_t window_ = 1;   ///< n
  int following_steps_ = 0;  ///< so many steps may be beyond `following`
  Line line_{};
  model::Machine<double> machine_{};
  model::Machine<double>::State state_ = model::Machine<double>::State::Zero();
  model::Stroke<double> delayed_{};  ///< x_cmd(t − τ)
  model::Stroke<double> reached_{};  ///< x̂

  std::array<float, window_length> positions_{};  ///< the last ones measured, a ring
  std::size_t newest_ = 0;
  std::size_t measured_ = 0;  ///< how many of them there are
  int until_step_ = 0;        ///< [periods]
  double error_ = 0.0;
  double speed_ = 0.0;
  int away_ = 0;  ///< steps in a row beyond `following`
  int far_ = 0;   ///< beyond the stroke
  int fast_ = 0;  ///< beyond the speed
};

}  // namespace firmware
