#include "model/components/quarter_car.hpp"

#include <gtest/gtest.h>

#include "model/rig/rig_equations.hpp"
#include "tests/support/reference_parameters.hpp"

namespace quarter_car_test {
namespace {

using Car = model::QuarterCar<double>;

// Round numbers, all different, so that no two terms can stand in for each other.
constexpr Car::Parameters car{.body_mass = 200.0,
                              .wheel_mass = 40.0,
                              .tyre_stiffness = 1e5,
                              .tyre_damping = 100.0,
                              .virtual_damping = 500.0,
                              .wheel_guide_damping = 30.0,
                              .body_guide_damping = 70.0};
constexpr Car::State state{.z_w = 0.02, .v_w = 0.5, .z_b = 0.01, .v_b = 0.3};

// Point (3). 1e5 (0.025 − 0.02) + 100 (0.9 − 0.5) = 500 + 40.
TEST(QuarterCar, HasATyreOfSpringAndDamper) { EXPECT_NEAR(Car::tyre_force(car, state, 0.025, 0.9), 540.0, 1e-9); }

// Point (1), (2). b̃ (ż_w − ż_b) = 100; body 60 + 100 − 70·0.3 = 139; wheel 540 − 160 − 30·0.5 = 365.
TEST(QuarterCar, HasTheNetForcesOfBodyAndWheel) {
  const Car::Forces net = Car::net_forces(car, state, 540.0, 60.0);
  EXPECT_NEAR(net.body, 139.0, 1e-9);
  EXPECT_NEAR(net.wheel, 365.0, 1e-9);
}

// Law. What the component and b̃ do to the body they do to the wheel: without tyre and guides no net force is left.
TEST(QuarterCar, KeepsMomentumWithoutTyreAndGuides) {
  Car::Parameters free = car;
  free.wheel_guide_damping = free.body_guide_damping = 0.0;
  const Car::Forces net = Car::net_forces(free, state, 0.0, 1234.5);
  EXPECT_NEAR(net.body + net.wheel, 0.0, 1e-9);
}

// Point. (200 + 40) · 9.81.
TEST(QuarterCar, StandsOnItsStaticWheelLoad) { EXPECT_NEAR(Car::static_wheel_load(car), 2354.4, 1e-9); }

// Point. ½ (200·0.09 + 40·0.25 + 1e5·25e-6) = 9 + 5 + 1.25.
TEST(QuarterCar, StoresKineticEnergyAndThatOfTheTyre) { EXPECT_NEAR(Car::energy(car, state, 0.025), 15.25, 1e-9); }

model::RigParameters<double> joined_rig() {
  auto rig = support::fdva_rig(model::RigKind::quarter_car);
  rig.suspension.damping = 200.0;
  return rig;
}

// Point (1)–(3) as rates of the state [z_w, ż_w, z_b, ż_b], friction of the guides against the motion:
// F_w = 2e5·0.01 + 100·0.5 = 2050; z̈_w = (2050 + 30 − 300 − 12)/40, z̈_b = (300 − 7)/290.
TEST(RigEquations, GiveTheCarItsRates) {
  const model::RigEquations<double> equations(joined_rig());
  const auto rate = equations.car({0.02, 0.5, 0.01, 0.3}, {.z_r = 0.03,
                                                           .v_r = 1.0,
                                                           .suspension_force = 300.0,
                                                           .tyre_force = 30.0,
                                                           .wheel_guide_friction = 12.0,
                                                           .body_guide_friction = 7.0});
  EXPECT_DOUBLE_EQ(rate(0), 0.5);
  EXPECT_NEAR(rate(1), 1768.0 / 40.0, 1e-12);
  EXPECT_DOUBLE_EQ(rate(2), 0.3);
  EXPECT_NEAR(rate(3), 293.0 / 290.0, 1e-12);
}

// Point (4), (5), (6), (8a) joined: dz_b = 0.01, ḋz_b = 0.2, y = 0.004, ẏ = 0.1, two ducts.
// F_s = 31500·0.01 + 200·0.2 + 55e3·0.006 + 50 (actuator) = 735. ÿ = (330 − c ẏ)/b with b = 21.768 kg, c = 154.80 N
// s/m.
TEST(RigEquations, JoinCarAndComponent) {
  const model::RigEquations<double> equations(joined_rig());
  model::RigEquations<double>::JoinedState x = model::RigEquations<double>::JoinedState::Zero();
  x.head<6>() << 0.02, 0.5, 0.01, 0.3, 0.004, 0.1;
  model::RigEquations<double>::JoinedInput drive{.z_r = 0.03, .v_r = 1.0};
  drive.actuator_force = 50.0;
  const auto rate = equations.joined(x, drive, 2);
  EXPECT_NEAR(rate(3), 735.0 / 290.0, 1e-12);
  EXPECT_NEAR(rate(1), (2050.0 - 735.0) / 40.0, 1e-12);
  EXPECT_DOUBLE_EQ(rate(4), 0.1);
  EXPECT_NEAR(rate(5), (330.0 - 15.480) / 21.768, 1e-3);  // b and c have five digits in the text
}

// Law. No duct open: the piston is locked, whatever pulls at it.
TEST(RigEquations, LockThePistonWithoutAnOpenDuct) {
  const model::RigEquations<double> equations(joined_rig());
  const auto rate = equations.component({0.1, 0.0, 0.0, 0.0}, {.deflection = 0.5, .velocity = 1.0}, 0);
  EXPECT_EQ(rate(0), 0.0);
  EXPECT_EQ(rate(1), 0.0);
}

}  // namespace
}  // namespace quarter_car_test
