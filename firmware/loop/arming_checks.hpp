// What is looked at before a drive may be led.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/reference/ramp.hpp"
#include "hal/command_output.hpp"
#include "hal/time.hpp"
#include "model/components/channel.hpp"

namespace firmware {

/// What an engineer does before a run, one step after the other, one period a call:
///
///   compare    converter against last command, measured position against command, while the drive has no power. Of a
///              converter that answers too late nothing is known: it is asked again, as one that differs. A
///              first arming begins in the middle: off it a wrong sign of x_act would throw the drive to the other side
///   rest       power on; force and position averaged for tare_time: nothing may move
///   probe      a small move, 16 a s²(1 − s)² over 1 s: its answer shows signs and sizes
///   return     hil, component_bench: slowly to rest, where the component carries nothing
///   tare       the force averaged again; its mean is the offset of the sensor
///
/// With u the command, x the measured position, f the force, each less its mean at rest, and sums over the probe:
///
///   (1)  gain = Σ u x / Σ u²,   ρ² = (Σ u x)² / (Σ u² Σ x²)     expected: gain 0.5 … 1.5, ρ ≥ 0.8
///   (2)  k = Σ x f / Σ x²                                       expected: k_low/3 … 3 k_high
///   (3)  σ_k = σ_f / √(Σ x²)                                     refused where 3 σ_k > k_low/3: the noise hides the
///                                                                sign
///   (4)  k > allowed_gain · k_probe                              refused: the loop has been proven for less
///
/// Where (1) has failed, the force is judged against the command: u in place of x in (2) and (3). All checks of a step
/// are made, also behind one that has failed.
///
/// k_probe is (2) of the described component under the same probe, allowed_gain what `rigtwin stability --write-limits`
/// has found the loop to bear. Both are unknown on a simulated rig. k_low … k_high is the stiffness of the described component, with its absorber free and blocked. Without a spring (2)
/// is Σ ẋ f > 0, the sign of its damping. Thresholds: ρ = 0.8 is noise of 0.75 of the answer's rms, at which the gain
/// of a thousand samples is still known to 3 %. The band of the gain admits any drive that can be used, and no wrong
/// sign, factor of two, or unit. The factor 3 on k admits friction and tolerances, and finds a wrong sign and a wrong
/// unit. At rest means
/// standstill: neither force nor position may move by more than sway and wander, peak to peak. Half of these bands
/// would refuse sound rigs with a soft mount; twice as wide they would pass a factor of two in the gain.
class ArmingChecks {
 public:
  static constexpr double patience = 1.0;    ///< a converter may take so long to show the command [s]
  static constexpr double probe_time = 1.0;  ///< [s]
  static constexpr double lowest_gain = 0.5, highest_gain = 1.5, lowest_correlation = 0.8;
  static constexpr double stiffness_factor = 3.0;

  struct Expected {
    bool force_answers = false;                       ///< hil: (2) and (3) are judged
    bool returns = false;                             ///< the force is tared at rest
    double lowest_stiffness = 0.0;                    ///< k_low [N/m]; 0: no spring
    double highest_stiffness = 0.0;                   ///< k_high [N/m]
    model::Channel position = model::Channel::x_act;  ///< the channel that measures the drive
    model::Channel force = model::Channel::F;         ///< the one that is tared
  };

  ArmingChecks(const Settings& settings, const Expected& expected);

  /// From `home` [m], where the command stands; `known`: the sign of the position has been shown before.
  void begin(double home, hal::Time now, bool known = true);

  /// What is seen in a period; what is not measured has no value.
  struct Seen {
    hal::Time now{};
    double command = 0.0;               ///< for this instant [m]
    std::optional<double> read_back{};  ///< of the converter [m]; one that cannot tell has none
    bool silent = false;                ///< it can tell, and has not answered in time
    std::optional<double> position{};   ///< [m]
    std::optional<double> force{};      ///< as read [N]
  };
  /// The first failed check, or nothing; all of them are failed(). Afterwards done(), powered() and next() are those of
  /// this period.
  [[nodiscard]] std::optional<Trip> look(const Seen& seen);
  /// What the comparison would refuse now, into failed(): for an arming that something else ends. A converter that may
  /// still be on its way to the command is left out.
  void list(const Seen& seen);
  [[nodiscard]] std::span<const Trip> failed() const { return {failed_.data(), failures_}; }

  [[nodiscard]] bool done() const { return step_ == Step::done; }
  [[nodiscard]] bool powered() const { return step_ != Step::compare; }  ///< the drive needs its enable
  [[nodiscard]] hal::Command next();                                     ///< the command one period on
  [[nodiscard]] double tare() const { return tare_; }                    ///< mean force at rest [N]; 0: not tared

  /// The probe of this amplitude [m] at the share s of its time, about 0.
  [[nodiscard]] static hal::Command probe_at(double s, double amplitude);

 private:
  enum class Step : unsigned char { compare, rest, probe, back, tare, done };
  /// Sums about a first value, for mean and spread.
  struct Average {
    double first = 0.0, sum = 0.0, squares = 0.0, lowest = 0.0, highest = 0.0;
    std::uint64_t count = 0;
    void add(double value);
    [[nodiscard]] double mean() const;
    [[nodiscard]] double variance() const;
  };

  void enter(Step step);
  void refuse(Reason reason, std::optional<model::Channel> channel, double value, double limit, hal::Time now);
  void compare(const Seen& seen);
  void judge_place(const Seen& seen);
  void rest(const Seen& seen);
  void judge_rest(hal::Time now, bool last);
  void probe(const Seen& seen);
  void judge_probe(hal::Time now);
  void judge_force(hal::Time now, bool by_command);
  void judge_distance(const Seen& seen, double tolerance);

  Arming settings_;
  Ramps ramps_;
  double period_;
  Expected expected_;
  std::uint64_t rest_periods_;
  std::uint64_t probe_periods_;

  Step step_ = Step::done;
  hal::Time since_{};
  bool known_ = true;
  double home_ = 0.0;
  std::uint64_t count_ = 0;  ///< periods in this step
  Average force_{};
  Average position_{};
  double tare_ = 0.0;
  SmoothMove back_{};
  double last_position_ = 0.0;
  double last_command_ = 0.0;
  /// Sums of the probe; v and w are the differences of x and u.
  double uu_ = 0.0, ux_ = 0.0, xx_ = 0.0, xf_ = 0.0, uf_ = 0.0, vf_ = 0.0, wf_ = 0.0;
  std::array<Trip, 4> failed_{};
  std::size_t failures_ = 0;
};

}  // namespace firmware
