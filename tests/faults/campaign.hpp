// Random faults in random states, and what must hold whatever they are.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "firmware/loop/kalman/steady_gains.hpp"
#include "firmware/loop/semi_active.hpp"
#include "tests/faults/guard_watch.hpp"
#include "tests/faults/plant_watch.hpp"
#include "tests/faults/scenario.hpp"
#include "tests/firmware/loop/kalman/linear_car.hpp"

namespace faults {

/// A scenario, played in virtual time with the invariants checked in every period. What was violated first; empty:
/// none.
class Trial {
 public:
  explicit Trial(std::uint64_t seed)
      : scenario_(seed),
        journey_(scenario_.scene),
        loop_(journey_.loop),
        plant_(scenario_, journey_),
        guards_(scenario_, journey_) {
    if (scenario_.filtered) attach_filter();
  }

  [[nodiscard]] std::string play() {
    std::size_t next = 0;
    before_ = journey_.rig.drive().position;
    for (int k = 0; k < Scenario::periods && violated_.empty(); ++k) {
      for (; next < scenario_.requests.size() && scenario_.requests[next].period <= k; ++next) {
        ask(scenario_.requests[next]);
      }
      const Mode mode = loop_.mode();
      const Reason reason = loop_.trip().reason;
      journey_.rig.roles().clock.sleep_until(loop_.due());
      look_at_motion();
      loop_.step();
      now_ = journey_.rig.now();
      look_at_state(mode, reason);
      look_at_recording();
      plant_.look();
      guards_.look();
      if (violated_.empty()) violated_ = plant_.violated();
      if (violated_.empty()) violated_ = guards_.violated();
    }
    return violated_.empty() ? violated_ : violated_ + " [" + scenario_.text() + "]";
  }

  [[nodiscard]] Reason reason() const { return loop_.trip().reason; }
  [[nodiscard]] bool has_run() const { return has_run_; }

 private:
  // A drive at the speed limit of 0.7 m/s stops within 35 ms at 20 m/s², and the longest time without a period is 20
  // ms.
  static constexpr double braking_time = 0.035 + 2.0 * 0.020 + 0.005;                            // [s]
  static constexpr double reach = rig_under_test::half_stroke + 0.7 * 0.7 / 40.0 + 0.7 * 0.020;  // [m]

  void attach_filter() {
    firmware::KalmanSettings settings;
    for (const auto channel : {model::Channel::z_r, model::Channel::dz_w, model::Channel::dz_b, model::Channel::zdd_b,
                               model::Channel::zdd_w, model::Channel::F_w}) {
      settings.noise[model::index(channel)] = support::LinearCar::noise(channel);
    }
    equations_.emplace(settings, scenario_.scene.parameters);
    gains_ = std::make_unique<firmware::SteadyGains>(*equations_, h);
    companion_ = std::make_unique<firmware::SemiActive>(*equations_, *gains_, firmware::DuctPolicySettings{}, h,
                                                        scenario_.scene.settings.supervision);
    loop_.attach(*companion_);
  }

  void ask(const Request& request) {
    using What = Request::What;
    plant_.asked(request.what);
    asked_ = request.what == What::acknowledge || request.what == What::rest || request.what == What::arm;
    if (request.what == What::arm) loop_.arm();
    if (request.what == What::disarm) loop_.disarm();
    if (request.what == What::start) loop_.start();
    if (request.what == What::hold) loop_.hold();
    if (request.what == What::resume) loop_.resume();
    if (request.what == What::level) static_cast<void>(loop_.level(request.level));
    if (request.what == What::stop) loop_.stop();
    if (request.what == What::rest) loop_.go_to_rest();
    if (request.what == What::acknowledge) loop_.acknowledge();
  }

  void violate(const char* what, double value, double limit) {
    if (!violated_.empty()) return;
    char text[200];
    std::snprintf(text, sizeof text, "%s: %.6g, limit %.6g, at %.3f s in %s after %s", what, value, limit,
                  journey_.rig.now().seconds(), std::string(name(loop_.mode())).c_str(),
                  std::string(name(loop_.trip().reason)).c_str());
    violated_ = text;
  }

  /// As the program wants it, unless the watchdog has taken it.
  [[nodiscard]] bool power() const { return journey_.rig.enabled() && !journey_.rig.watchdog_has_acted(); }

  /// The drive itself, whatever the program says.
  void look_at_motion() {
    const double position = journey_.rig.drive().position;
    const double moved = std::abs(position - before_);
    const double time = (journey_.rig.now() - now_).seconds();
    before_ = position;
    if (std::abs(position) > reach && scenario_.pushes.empty())
      violate("beyond stroke and braking distance [m]", std::abs(position), reach);
    // A drive that has power at all times is led from where its converter says it stands, which may lie by the tolerance.
    const bool shown = !scenario_.scene.drive_enable && !scenario_.read_back_errors.empty();
    const double most = 1.02 * 0.7 * (time + h) + (shown ? scenario_.scene.settings.arming.position_tolerance : 0.0);
    const bool unknown = power() && !had_power_ && scenario_.position_lies();
    if (moved > most && !unknown && scenario_.stuck_enables.empty()) violate("a jump [m]", moved, most);
    had_power_ = power();
    // A beat since the last look gave power meanwhile, if the program wants it.
    const bool powered = journey_.rig.enabled() && journey_.rig.beats() != beats_;
    beats_ = journey_.rig.beats();
    if (scenario_.scene.drive_enable && !had_power_ && !powered && !scenario_.moves_by_itself()) {
      without_power_ = moved > 1e-12 ? without_power_ + time : 0.0;
      if (without_power_ > braking_time) violate("motion without power [s]", without_power_, braking_time);
    } else {
      without_power_ = 0.0;
    }
  }

  void look_at_state(Mode before, Reason reason) {
    has_run_ = has_run_ || loop_.mode() == Mode::running;
    const bool safe = loop_.mode() == Mode::safe;
    if (safe && loop_.trip().reason == Reason::none) violate("safe without a reason", 0.0, 0.0);
    if (safe && before == Mode::safe && loop_.trip().reason != reason) violate("the first reason is lost", 0.0, 0.0);
    const Reason now = loop_.trip().reason;
    // A rig that was stopped off the middle is refused until a probe has shown the sign.
    const bool fault = is_fault(now) && now != Reason::arming_off_centre;
    if (scenario_.faultless() && fault) violate("a fault where there is none", 0.0, 0.0);
    const bool by_motion = now == Reason::speed || now == Reason::acceleration || now == Reason::stroke ||
                           now == Reason::energy || now == Reason::growth || now == Reason::following_error ||
                           now == Reason::measured_speed || now == Reason::measured_stroke || now == Reason::force;
    if (scenario_.moves_as_described() && by_motion) violate("motion is blamed without a fault", 0.0, 0.0);
    // Braking, and twice the whole stroke at 0.2 m/s.
    constexpr double longest = 0.1 + 2.0 * 0.25 / 0.2;
    const double moved = std::abs(journey_.rig.drive().position - stood_);
    stood_ = journey_.rig.drive().position;
    if (!safe || before != Mode::safe || asked_) safe_time_ = 0.0;
    asked_ = false;
    safe_time_ += h;
    if (safe && safe_time_ > longest && moved > 1e-9 && !scenario_.moves_by_itself())
      violate("not at rest in its time [s]", safe_time_, longest);
    using Device = hal::simulated::DeviceFault::Device;
    if (safe && !scenario_.fails(Device::valves) && journey_.rig.openings() != scenario_.scene.safe_position) {
      violate("valves not safe", 0.0, 0.0);
    }
  }

  void look_at_recording() {
    while (const auto record = journey_.journal.pop()) {
      if (record->period != recorded_) violate("a period is not on record", static_cast<double>(record->period), 0.0);
      recorded_ = record->period + 1;
      last_ = record->trip.reason;
    }
    if (journey_.journal.lost() > 0) violate("records are lost", 1.0, 0.0);
    if (last_ != loop_.trip().reason) violate("the reason is not on record", 0.0, 0.0);
  }

  Scenario scenario_;
  Journey journey_;
  firmware::ControlLoop& loop_;
  std::optional<firmware::EstimatorEquations> equations_;  ///< as the two below: of a quarter car with a filter
  std::unique_ptr<firmware::SteadyGains> gains_;
  std::unique_ptr<firmware::SemiActive> companion_;
  PlantWatch plant_;
  GuardWatch guards_;
  std::string violated_;
  hal::Time now_{};
  double before_ = 0.0;  ///< position of the drive [m]
  double stood_ = 0.0;   ///< the same after the period before [m]
  std::uint64_t beats_ = 0;
  bool had_power_ = false;
  bool has_run_ = false;
  bool asked_ = false;
  double without_power_ = 0.0;  ///< moving for so long [s]
  double safe_time_ = 0.0;      ///< [s]
  std::uint64_t recorded_ = 0;
  Reason last_ = Reason::none;
};

}  // namespace faults
