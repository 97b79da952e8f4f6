#include "tests/bench/rths/methods.hpp"

#include "firmware/loop/compensation/compensator.hpp"

namespace rths {
namespace {

using firmware::compensation::Compensator;
using firmware::compensation::Kind;
using firmware::compensation::Settings;

constexpr double baseline_delay = 4.64e-3;  ///< J1 of the baseline [s]
constexpr double first_mode = 22.7;         ///< of the structure [rad/s]
constexpr double late_and_held = 1.5;       ///< the force is a step late and held for a step [steps]

Settings plain(Kind kind, int order) {
  Settings s;
  s.kind = kind;
  s.order = order;
  s.given = inverse_of({});
  s.force_lead = 0.0;
  s.limit = 1.0;  // the benchmark judges by its criteria, not by our guards
  s.force_limit = 1e6;
  s.rate = 100.0;
  return s;
}

/// 1/M with the mean delay of a command that is held for a step, e^{sh/2}.
Settings with_held_command(Settings s) {
  const auto a = s.given;
  double factor = 1.0;
  for (std::size_t n = 1; n < a.size(); ++n) {
    factor *= 0.5 * period / static_cast<double>(n);
    for (std::size_t i = n; i < a.size(); ++i) s.given[i] += factor * a[i - n];
  }
  return s;
}

std::function<firmware::Compensation*()> made(const Settings& settings) {
  return [settings]() -> firmware::Compensation* { return new Compensator(settings, period); };
}

}  // namespace

std::vector<Method> methods() {
  Settings after_baseline = plain(Kind::polynomial, 3);
  after_baseline.given = {1.0, baseline_delay, 0.0, 0.0};
  Settings smith = plain(Kind::smith, 2);
  smith.machine.delay = smith.given[1];
  smith.component = {.stiffness = Plant{}.stiffness, .damping = Plant{}.damping()};
  Settings damping = plain(Kind::virtual_damping, 2);
  damping.damping = firmware::compensation::damping_against_delay(Plant{}.stiffness, first_mode, damping.given[1]);
  Settings adaptive_damping = damping;
  adaptive_damping.kind = Kind::adaptive_virtual_damping;
  Settings force = plain(Kind::adaptive_time_series, 3);
  force.force_lead = late_and_held;

  return {
      {.name = "none"},
      {.name = "baseline", .controller = Controller::baseline},
      {.name = "baseline_polynomial", .controller = Controller::baseline, .compensation = made(after_baseline)},
      {.name = "polynomial", .compensation = made(plain(Kind::polynomial, 1))},
      {.name = "inverse_2", .compensation = made(plain(Kind::inverse, 2))},
      {.name = "inverse", .compensation = made(with_held_command(plain(Kind::inverse, 3)))},
      {.name = "adaptive_time_series_2", .compensation = made(plain(Kind::adaptive_time_series, 2))},
      {.name = "adaptive_time_series", .compensation = made(plain(Kind::adaptive_time_series, 3))},
      {.name = "feedforward_feedback", .compensation = made(with_held_command(plain(Kind::feedforward_feedback, 3)))},
      {.name = "smith", .compensation = made(smith)},
      {.name = "virtual_damping", .compensation = made(damping)},
      {.name = "adaptive_virtual_damping", .compensation = made(adaptive_damping)},
      {.name = "adaptive_time_series_force", .compensation = made(force)}};
}

}  // namespace rths
