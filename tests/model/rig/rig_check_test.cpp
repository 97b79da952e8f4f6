#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "model/rig/rig_model.hpp"
#include "tests/support/reference_parameters.hpp"

namespace {

using model::RigKind;
using Parameters = model::RigParameters<double>;
using Change = std::function<void(Parameters&)>;

constexpr std::size_t longest = model::RigModel<>::Line::longest;
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

std::string fault_of(Parameters rig, const Change& change, double period = 1e-3) {
  change(rig);
  const auto fault = find_fault(rig, period, longest);
  return fault ? std::string(fault->table) + "." + std::string(fault->key) : "none";
}

// Law. The rigs of the text are rigs.
TEST(FindFault, AcceptsTheRigsOfTheText) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    EXPECT_EQ(fault_of(support::linear_rig(kind), [](Parameters&) {}), "none");
    EXPECT_EQ(fault_of(support::fdva_rig(kind), [](Parameters&) {}), "none");
  }
}

// Fault. Each number alone, wrong in each way it can be: no number, endless, negative, zero where nothing can be zero.
TEST(FindFault, NamesEveryNumberThatCannotBe) {
  struct Number {
    std::string path;
    double& (*of)(Parameters&);
    bool may_be_zero;
  };
  const std::vector<Number> numbers{
      {"body.mass", [](Parameters& r) -> double& { return r.body.mass; }, false},
      {"wheel.mass", [](Parameters& r) -> double& { return r.wheel.mass; }, false},
      {"tyre.stiffness", [](Parameters& r) -> double& { return r.tyre.stiffness; }, false},
      {"tyre.damping", [](Parameters& r) -> double& { return r.tyre.damping; }, true},
      {"suspension.stiffness", [](Parameters& r) -> double& { return r.suspension.stiffness; }, true},
      {"suspension.damping", [](Parameters& r) -> double& { return r.suspension.damping; }, true},
      {"machine.virtual_damping", [](Parameters& r) -> double& { return r.machine.virtual_damping; }, true},
      {"fdva.piston_area", [](Parameters& r) -> double& { return r.fdva.piston_area; }, false},
      {"fdva.duct_diameter", [](Parameters& r) -> double& { return r.fdva.duct_diameter; }, false},
      {"fdva.duct_length", [](Parameters& r) -> double& { return r.fdva.duct_length; }, false},
      {"fdva.oil_density", [](Parameters& r) -> double& { return r.fdva.oil_density; }, false},
      {"fdva.oil_viscosity", [](Parameters& r) -> double& { return r.fdva.oil_viscosity; }, true},
      {"fdva.minor_loss", [](Parameters& r) -> double& { return r.fdva.minor_loss; }, true},
      {"fdva.coupling_stiffness", [](Parameters& r) -> double& { return r.fdva.coupling_stiffness; }, false},
  };
  for (const Number& number : numbers) {
    for (const double wrong : {nan, infinity, -infinity, -1e-9}) {
      EXPECT_EQ(fault_of(support::fdva_rig(RigKind::hil), [&](Parameters& r) { number.of(r) = wrong; }), number.path);
    }
    EXPECT_EQ(fault_of(support::fdva_rig(RigKind::hil), [&](Parameters& r) { number.of(r) = 0.0; }),
              number.may_be_zero ? "none" : number.path);
  }
}

// Fault. The period is the description's sample rate.
TEST(FindFault, NamesTheSampleRateForAPeriodThatCannotBe) {
  for (const double wrong : {0.0, -1e-3, nan, infinity}) {
    EXPECT_EQ(fault_of(
                  support::linear_rig(RigKind::hil), [](Parameters&) {}, wrong),
              ".sample_rate");
  }
}

// Law. A bench has no car: its masses and tyre are not asked for.
TEST(FindFault, AsksABenchForNoCar) {
  EXPECT_EQ(fault_of(support::linear_rig(RigKind::component_bench), [](Parameters& r) { r.body.mass = nan; }), "none");
}

// Fault. Virtual damping exists in a hil rig only.
TEST(FindFault, RefusesVirtualDampingWithoutVirtualCar) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::component_bench}) {
    EXPECT_EQ(fault_of(support::linear_rig(kind), [](Parameters& r) { r.machine.virtual_damping = 1.0; }),
              "machine.virtual_damping");
  }
}

// Fault. One to six ducts, none to all of them open.
TEST(FindFault, CountsDucts) {
  const auto with = [](int ducts, int open) {
    return fault_of(support::fdva_rig(RigKind::hil), [=](Parameters& r) {
      r.fdva.ducts = ducts;
      r.fdva.open_ducts = open;
    });
  };
  EXPECT_EQ(with(0, 0), "fdva.ducts");
  EXPECT_EQ(with(7, 0), "fdva.ducts");
  EXPECT_EQ(with(3, 4), "fdva.open_ducts");
  EXPECT_EQ(with(3, -1), "fdva.open_ducts");
  EXPECT_EQ(with(1, 0), "none");
  EXPECT_EQ(with(6, 6), "none");
}

// Fault. A delay as long as the line holds is allowed, a sample more is refused with its path.
TEST(FindFault, RefusesADelayBeyondTheCapacityOfTheLine) {
  const auto with = [](double delay, double period) {
    return fault_of(
        support::linear_rig(RigKind::hil), [=](Parameters& r) { r.effects.add(model::ActuatorDelay<double>{delay}); },
        period);
  };
  EXPECT_EQ(with(0.010, 1e-3), "none");
  EXPECT_EQ(with(0.125, 0.25e-3), "none");
  EXPECT_EQ(with((static_cast<double>(longest) + 1.0) * 0.25e-3, 0.25e-3), "actuator_delay.delay");
  EXPECT_EQ(with(-1e-3, 1e-3), "actuator_delay.delay");
  EXPECT_EQ(with(nan, 1e-3), "actuator_delay.delay");
  EXPECT_EQ(with(0.6, 0.1), "actuator_delay.delay") << "longer than any machine is late";
}

// Fault. An effect where the rig has no place for it.
TEST(FindFault, RefusesEffectsWithoutAPlace) {
  const auto with = [](RigKind kind, const Change& change) { return fault_of(support::linear_rig(kind), change); };
  const Change delay = [](Parameters& r) { r.effects.add(model::ActuatorDelay<double>{0.01}); };
  const Change inertia = [](Parameters& r) { r.effects.add(model::ForceSensorInertia<double>{5.0}); };
  const Change lift_off = [](Parameters& r) { r.effects.add(model::TyreLiftOff<double>{}); };
  const Change guide = [](Parameters& r) { r.effects.add(model::BodyGuideFriction<double>{5.0}); };
  const Change seal = [](Parameters& r) { r.effects.add(model::SealFriction<double>{5.0}); };
  EXPECT_EQ(with(RigKind::quarter_car, delay), "none") << "a machine moves the foot point";
  EXPECT_EQ(with(RigKind::hil, inertia), "force_sensor_inertia.");
  EXPECT_EQ(with(RigKind::component_bench, inertia), "force_sensor_inertia.");
  EXPECT_EQ(with(RigKind::component_bench, lift_off), "tyre_lift_off.");
  EXPECT_EQ(with(RigKind::hil, guide), "body_guide_friction.");
  EXPECT_EQ(with(RigKind::quarter_car, seal), "seal_friction.") << "no FDVA, no seal";
  EXPECT_EQ(with(RigKind::quarter_car, lift_off), "none");
  EXPECT_EQ(with(RigKind::component_bench, delay), "none");
}

// Law. Every fault says what is expected.
TEST(FindFault, SaysWhatIsExpected) {
  auto rig = support::linear_rig(RigKind::hil);
  rig.body.mass = -1.0;
  const auto fault = find_fault(rig, 1e-3, longest);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->expected, "a finite number > 0");
}

}  // namespace
