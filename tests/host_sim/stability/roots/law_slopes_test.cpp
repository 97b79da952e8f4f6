// Laws from tables in the linear analysis: as the parameters that they are at rest.
#include <gtest/gtest.h>

#include "firmware/description/loop_proof.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using host_sim::stability::linear_part;
using host_sim::stability::linearise;
using model::LawOver;
using model::LawPlace;
using stability_tests::Rig;

/// A curve with the slope `slope` at 0 that bends away from there.
void add_curve(Rig& rig, LawPlace place, LawOver over, double slope, model::Channel channel = {}) {
  auto& curve = rig.laws.curves[rig.laws.curve_count++];
  curve = {place, over, channel, 5, {-1.0, -0.1, 0.0, 0.1, 1.0}, {}};
  curve.value = {-0.3 * slope, -0.1 * slope, 0.0, 0.1 * slope, 0.5 * slope};
}

// Law. Curves over velocity and deflection, a slider and a sensor's curve give the loop of the parameters; a slider
// with lost motion is inside of it, at rest, and gives none.
TEST(LawSlopes, AreTheParametersAtRest) {
  Rig laws = stability_tests::linear_rig(), parameters = laws;
  add_curve(laws, LawPlace::suspension, LawOver::velocity, 700.0);
  add_curve(laws, LawPlace::suspension, LawOver::deflection, 5e3);
  add_curve(laws, LawPlace::tyre, LawOver::velocity, 50.0);
  add_curve(laws, LawPlace::sensor, {}, 1.1, model::Channel::F);
  laws.laws.branches[0] = {.stiffness = 2e3, .slip_force = 30.0};
  laws.laws.branches[1] = {.stiffness = 4e3, .time_constant = 0.02};
  laws.laws.branches[2] = {.stiffness = 3e3, .slip_force = 30.0, .gap = 1e-3};
  laws.laws.branch_count = 3;
  parameters.suspension.damping += 700.0;
  parameters.suspension.stiffness += 7e3;
  parameters.tyre.damping += 50.0;
  parameters.effects.add(model::Channel::F, model::SensorGain<double>{1.1});
  parameters.effects.add(model::Relaxation<double>{4e3, 0.02});
  const auto a = linearise(laws), b = linearise(parameters);
  for (const double frequency : {1.0, 8.0, 14.0}) {
    const stability_tests::Complex s(0.0, 6.28 * frequency);
    EXPECT_LT(std::abs(a.p(s) / b.p(s) - 1.0), 1e-9);
    EXPECT_LT(std::abs(a.q(s) / b.q(s) - 1.0), 1e-9);
  }
  EXPECT_TRUE(a.left_out.empty());
  EXPECT_FALSE(linear_part(laws).laws.any());
}

// Point. What has no place among the parameters is said; what would make one negative is refused.
TEST(LawSlopes, WhatIsLeftOutIsSaid) {
  Rig rig = stability_tests::linear_rig();
  rig.laws.branches[0] = {.stiffness = 4e3, .time_constant = 0.02};
  rig.laws.branches[1] = {.stiffness = 4e3, .time_constant = 0.2};
  rig.laws.branch_count = 2;
  ASSERT_EQ(linearise(rig).left_out.size(), 1U);
  EXPECT_EQ(linearise(rig).left_out[0], "laws: branch 2 of the suspension");
  add_curve(rig, LawPlace::suspension, LawOver::velocity, -2000.0);
  EXPECT_THROW(static_cast<void>(linearise(rig)), host_sim::stability::UnfitLoop);
}

// Law. Another law is another loop: a proof of stability does not hold for it.
TEST(LawSlopes, ChangeTheFingerprintOfTheLoop) {
  firmware::RigDescription description;
  description.rig = stability_tests::linear_rig();
  const auto without = firmware::loop_fingerprint(description);
  add_curve(description.rig, LawPlace::suspension, LawOver::velocity, 700.0);
  const auto with = firmware::loop_fingerprint(description);
  EXPECT_NE(with, without);
  description.rig.laws.curves[0].value[4] += 1.0;
  EXPECT_NE(firmware::loop_fingerprint(description), with);
}

}  // namespace
