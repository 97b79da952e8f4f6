// The machine that moves the foot point of a quarter car: z_cmd → delay → lag → resonance → rate limit → z_r.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/rig/rig_model.hpp"
#include "tests/support/reference_parameters.hpp"

namespace foot_machine_test {
namespace {

using model::Channel;
using model::RigKind;
using Parameters = model::RigParameters<double>;
using Rig = model::RigModel<double>;
constexpr double h = 1e-3;

Parameters car() { return support::linear_rig(RigKind::quarter_car); }

model::Motion<double> command(std::size_t k) {
  const double w = 2.0 * 3.141592653589793 * 4.0, t = static_cast<double>(k) * h;
  return {0.01 * std::sin(w * t) * std::sin(w * t), 0.02 * w * std::sin(w * t) * std::cos(w * t),
          0.02 * w * w * (std::cos(w * t) * std::cos(w * t) - std::sin(w * t) * std::sin(w * t))};
}

std::vector<model::Signals<double>> drive(const Parameters& parameters, std::size_t samples) {
  const Rig rig(parameters, h);
  auto x = rig.start();
  std::vector<model::Signals<double>> signals{rig.signals(x)};
  for (std::size_t k = 1; k < samples; ++k) {
    rig.step(x, {.foot_point = command(k)});
    signals.push_back(rig.signals(x));
  }
  return signals;
}

double of(const model::Signals<double>& s, Channel channel) { return s[index(channel)]; }

// Point. A delay of whole samples: z_r is the command of so many samples before, and the car does what it did without.
TEST(FootMachine, DelaysTheFootPoint) {
  Parameters late = car();
  late.effects.add(model::ActuatorDelay<double>{0.006});
  const auto with = drive(late, 400), without = drive(car(), 400);
  for (std::size_t k = 10; k < 400; ++k) {
    EXPECT_NEAR(of(with[k], Channel::z_r), command(k - 6).position, 1e-15) << k;
    EXPECT_EQ(of(with[k], Channel::z_cmd), command(k).position) << k;
    EXPECT_NEAR(of(with[k], Channel::F_w), of(without[k - 6], Channel::F_w), 1e-9) << k;
  }
}

// Point. T ż_r + z_r = z_cmd, which the car sees with both derivatives: z̈_r by (2) of StrokeAcceleration, within h³
// z⁽⁵⁾/20 of the derivative of ż_r = (z_cmd − z_r)/T.
TEST(FootMachine, LagsTheFootPoint) {
  constexpr double lag = 0.02;
  Parameters slow = car();
  slow.effects.add(model::ActuatorLag<double>{lag});
  const auto signals = drive(slow, 500);
  for (std::size_t k = 5; k < 500; ++k) {
    const double rate = (command(k).position - of(signals[k], Channel::z_r)) / lag;
    EXPECT_NEAR(of(signals[k], Channel::zdd_r), (command(k).velocity - rate) / lag, 2e-3 * 25.0) << k;
    const double z_w = of(signals[k], Channel::z_w);
    EXPECT_NEAR(of(signals[k], Channel::dz_w), of(signals[k], Channel::z_r) - z_w, 1e-15);
  }
}

// Law. The rate limit holds for the foot point, whatever is commanded.
TEST(FootMachine, LimitsTheSpeedOfTheFootPoint) {
  constexpr double limit = 0.05;
  Parameters limited = car();
  limited.effects.add(model::ActuatorRateLimit<double>{limit});
  const auto signals = drive(limited, 500);
  double fastest = 0.0;
  for (std::size_t k = 1; k < 500; ++k) {
    fastest = std::max(fastest, std::abs(of(signals[k], Channel::z_r) - of(signals[k - 1], Channel::z_r)) / h);
  }
  EXPECT_LE(fastest, limit * (1.0 + 1e-9));
  EXPECT_GT(fastest, 0.9 * limit);
}

// Law. Started in motion, the machine is as if it had always moved so: no knock at the first steps.
TEST(FootMachine, StartsInMotionWithoutAKnock) {
  Parameters slow = car();
  slow.effects.add(model::ActuatorDelay<double>{0.0045});
  slow.effects.add(model::ActuatorLag<double>{0.02});
  slow.effects.add(model::ActuatorResonance<double>{30.0, 0.7});
  const Rig rig(slow, h);
  constexpr double speed = 0.1;
  model::Column<double, model::plain_core_states> core = model::Column<double, model::plain_core_states>::Zero();
  core(model::CoreIndex::wheel_velocity) = core(model::CoreIndex::body_velocity) = speed;
  auto x = rig.start(core, {0.0, speed, 0.0}, {});
  const double behind = speed * (0.0045 + 0.02 + 2.0 * 0.7 / (2.0 * 3.141592653589793 * 30.0));
  EXPECT_NEAR(of(rig.signals(x), Channel::z_r), -behind, 1e-12);
  for (int k = 1; k < 50; ++k) {
    rig.step(x, {.foot_point = {speed * h * k, speed, 0.0}});
    EXPECT_NEAR(of(rig.signals(x), Channel::z_r), speed * h * k - behind, 1e-12) << k;
    EXPECT_NEAR(of(rig.signals(x), Channel::zdd_r), 0.0, 1e-7) << k;
  }
}

// Law. Without effects of the machine the command is the foot point, to the bit.
TEST(FootMachine, IsAbsentWithoutEffects) {
  EXPECT_FALSE(Rig(car(), h).has_foot_machine());
  for (const auto& s : drive(car(), 100)) EXPECT_EQ(of(s, Channel::z_cmd), of(s, Channel::z_r));
}

}  // namespace
}  // namespace foot_machine_test
