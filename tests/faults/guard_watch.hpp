// Invariants of the control loop's guards, checked on the simulated rig.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/faults/scenario.hpp"
#include "tests/faults/watch.hpp"

namespace faults {

/// Looks at a rig after each period, beside PlantWatch. The first thing that is violated stays; empty: nothing.
///
///   time      a program that leads the drive and then has not looked for 12.5 ms, or was suspended for as long, is in safe
///             in its next period: 10 ms, the period itself, and what a late one before may have left of its quarter
///   power     the drive that is led behind an arming has its enable written on; the second stage of its power unit is on
///             then and only then, but for two periods
///   speed     over 20 periods the command's limit is kept but for 2 %, and a period more; that limit is not reached for
///             100 ms on end; the velocity of the drive changes by no more than the limit of the acceleration, but for 5 %;
///             a drive that runs away at 1.2 times the limit of the measured speed, or of a slow motion, does so for
///             less than 30 ms: window and three samples are 13
///   arming    nothing has moved by more than 1.5 `wander` in the 18 periods before it passes, the force has no noise beyond
///             `sway`; a probe does not pass with a wrong sign or gain
///   force     of a bench or a hil rig, or of a quarter car with a Kalman filter, torn off for three half seconds of a run in each of which the drive moves by 3 mm
///             rms: the run has ended
///   loop      a hil rig with a force of the wrong sign is not driven beyond 60 mm
class GuardWatch : public Watch {
 public:
  GuardWatch(const Scenario& scenario, const rig_under_test::Journey& journey)
      : Watch("guard", scenario, journey), looked_(journey.rig.now()) {
    places_.fill(journey.rig.drive().position);
  }

  /// After a period.
  void look() {
    mode_ = journey_.loop.mode();
    const double place = journey_.rig.drive().position;
    look_at_time();
    look_at_power();
    look_at_speed(place);
    look_at_arming(place);
    look_at_torn_force(place);
    const bool driven = scenario_.scene.parameters.kind == model::RigKind::hil &&
                        scenario_.scene.deviations.force_sign < 0.0 && std::abs(place) > 0.06;
    if (driven) violate("a loop that drives the car [m]", std::abs(place), 0.06);
    before_ = mode_;
    looked_ = journey_.rig.now();
    places_[newest_ = (newest_ + 1) % places_.size()] = place;
  }

 private:
  static constexpr std::size_t window = 20;  // [periods]

  [[nodiscard]] bool behind_arming() const { return leads_drive(mode_) && mode_ != Mode::arming; }
  [[nodiscard]] double place(std::size_t periods_ago) const {
    return places_[(newest_ + places_.size() + 1 - periods_ago) % places_.size()];
  }

  void look_at_time() {
    const hal::Time now = journey_.rig.now();
    double gap = (now - looked_).seconds();
    for (const auto& s : scenario_.suspensions) {
      if (s.at > looked_ && s.at <= now) gap += s.length.seconds();
    }
    if (gap > 0.0125 && leads_drive(before_) && leads_drive(mode_)) violate("nobody watched [s]", gap, 0.0125);
  }

  void look_at_power() {
    const bool off = scenario_.scene.drive_enable && behind_arming() && !journey_.rig.enabled();
    led_off_ = off ? led_off_ + 1 : 0;
    if (led_off_ > 2) violate("a drive is led without its enable [periods]", led_off_, 2.0);
    if (!scenario_.scene.high_pressure) return;
    const bool high = journey_.rig.high_pressure();
    const bool wrong = high != behind_arming();
    const bool stays = high && scenario_.fails(hal::simulated::DeviceFault::Device::high_pressure);
    wrong_stage_ = wrong && !stays ? wrong_stage_ + 1 : 0;
    if (wrong_stage_ > 2) violate("the second pressure stage [periods]", wrong_stage_, 2.0);
  }

  /// Where the place that the drive is given power at, or the instants of its steps, are not those of the command.
  [[nodiscard]] bool leaps() const {
    return scenario_.moves_by_itself() || scenario_.position_lies() || !scenario_.read_back_errors.empty() ||
           scenario_.fails(hal::simulated::DeviceFault::Device::command);
  }

  void look_at_speed(double place_now) {
    const bool led = behind_arming() && journey_.rig.powered();
    led_ = led ? led_ + 1 : 0;
    const double speed = (place_now - place(1)) / h, before = (place(1) - place(2)) / h;
    const auto& limits = scenario_.scene.settings.limits;
    const int settled = 80;  // the motion guard's own time for a drive that becomes slow
    const bool slow = (mode_ == Mode::armed || mode_ == Mode::ready) && led_ > settled;
    const double most = 1.2 * (slow ? scenario_.scene.settings.highest_low_speed() : limits.highest_measured_speed());
    runs_away_ = led && std::abs(speed) > most ? runs_away_ + 1 : 0;
    if (runs_away_ > 30) violate("a drive runs away [m/s]", std::abs(speed), most);
    if (leaps() || !scenario_.stuck_drives.empty() || !scenario_.late.empty()) return;
    if (led_ > static_cast<int>(window)) {
      const double way = std::abs(place_now - place(window));
      const double longest = 1.02 * limits.speed * h * static_cast<double>(window + 1);
      if (way > longest) violate("faster than the limit, over 20 periods [m]", way, longest);
    }
    at_limit_ = led && std::abs(speed) > 0.98 * limits.speed ? at_limit_ + 1 : 0;
    if (at_limit_ > 100) violate("at the limit of the speed [periods]", at_limit_, 100.0);
    const double step = 1.05 * limits.highest_acceleration() * h;
    if (led_ > 3 && std::abs(speed - before) > step)
      violate("a velocity that jumps [m/s]", std::abs(speed - before), step);
  }

  void look_at_arming(double place_now) {
    if (before_ != Mode::arming || mode_ != Mode::armed) return;
    const auto& arming = scenario_.scene.settings.arming;
    const auto& deviations = scenario_.scene.deviations;
    double lowest = place_now, highest = place_now;
    for (std::size_t i = 1; i <= 18; ++i) {
      lowest = std::min(lowest, place(i));
      highest = std::max(highest, place(i));
    }
    if (arming.wander > 0.0 && scenario_.late.empty() && highest - lowest > 1.5 * arming.wander) {
      violate("armed while the drive moves [m]", highest - lowest, 1.5 * arming.wander);
    }
    if (arming.sway > 0.0 && deviations.force_noise > arming.sway) {
      violate("armed while the force sways [N]", deviations.force_noise, arming.sway);
    }
    if (arming.probe_amplitude <= 0.0) return;
    const auto off = [](double gain, double least, double most) { return gain < least || gain > most; };
    if (off(deviations.position_sign, 0.45, 1.55))
      violate("armed with a wrong position", deviations.position_sign, 1.0);
    if (scenario_.scene.parameters.kind != model::RigKind::hil || scenario_.torn) return;
    const double most =
        arming.allowed_gain > 0.0 ? 3.0 : 9.0;  // of the softest that is described: spring, or with coupling
    if (off(deviations.force_sign, 0.1, most)) violate("armed with a wrong force", deviations.force_sign, 1.0);
    // 3 σ/√(Σ x²) of a third of the spring, Σ x² = 256 a² B(5, 5) 1 s/h; σ of rectangular noise
    const double squares = 256.0 / 630.0 / h * arming.probe_amplitude * arming.probe_amplitude;
    const double hides = 3.0 * deviations.force_noise / std::sqrt(3.0 * squares);
    const double spring = scenario_.scene.parameters.suspension.stiffness / 3.0;
    if (hides > 1.5 * spring) violate("armed behind noise that hides the sign [N/m]", hides, 1.5 * spring);
  }

  void look_at_torn_force(double place_now) {
    const bool torn =
        scenario_.torn && (scenario_.filtered || scenario_.scene.parameters.kind != model::RigKind::quarter_car) &&
        journey_.rig.now().seconds() > h * static_cast<double>(scenario_.scene.deviations.force_torn_after) &&
        in_run(mode_);
    if (!torn) torn_ = lively_ = 0;
    if (!torn) return;
    if (torn_++ % piece == 0) moved_ = {};
    moved_[0] += place_now;
    moved_[1] += place_now * place_now;
    if (torn_ % piece != 0) return;
    const double mean = moved_[0] / piece, rms = std::sqrt(std::max(0.0, moved_[1] / piece - mean * mean));
    lively_ += rms > 3e-3 ? 1 : 0;
    if (lively_ > 2) violate("a torn-off force [half seconds]", lively_, 2.0);
  }

  Mode mode_ = Mode::idle, before_ = Mode::idle;
  hal::Time looked_;
  std::array<double, window + 2> places_{};  ///< after each period, a ring [m]
  std::size_t newest_ = 0;
  int led_ = 0;      ///< periods behind an arming with power
  int led_off_ = 0;  ///< without it
  int wrong_stage_ = 0;
  int runs_away_ = 0;
  int at_limit_ = 0;
  static constexpr int piece = 500;  // [periods]
  int torn_ = 0;                     ///< periods
  int lively_ = 0;                   ///< pieces of them in which the drive moves
  std::array<double, 2> moved_{};    ///< sums of place and its square meanwhile
};

}  // namespace faults
