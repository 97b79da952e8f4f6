// A law that is an effect of the catalogue, and an effect that is a law's limit.
#include "host_sim/identification/learn/law_and_effects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "host_sim/identification/learn/law_beside.hpp"
#include "tests/host_sim/identification/example_law.hpp"

namespace {

using namespace host_sim::identification;
using sample::law_of;

firmware::PlacedEffect effect(const char* name, std::vector<double> values) {
  return {firmware::find_effect(name), std::nullopt, std::move(values)};
}

// Point. Families that are an effect of the catalogue, by hand: 50 N at r is 50/r³ of a cubic spring; friction of 85 N
// that falls by 25 is Stribeck's of 60 N; 12 and −8 N at r are slopes that differ by 200 N s/m. Others are none.
TEST(LawAndEffects, KnowsAnEffectByItsFamily) {
  const auto cubic = effect_like(law_of(LawFamily::power, {50.0, 2.9}, CurveOver::deflection), {});
  ASSERT_TRUE(cubic);
  EXPECT_EQ(cubic->entry->name, "progressive_spring");
  EXPECT_NEAR(cubic->values[0], 50e3, 1e-9);
  EXPECT_FALSE(effect_like(law_of(LawFamily::power, {50.0, 1.5}), {}));

  const EffectsBeside friction{effect("coulomb_friction", {85.0})};
  const auto stribeck = effect_like(law_of(LawFamily::falling, {25.0, 0.01}), friction);
  ASSERT_TRUE(stribeck);
  EXPECT_EQ(stribeck->entry->name, "stribeck_friction");
  EXPECT_NEAR(stribeck->values[0], 60.0, 1e-12);
  EXPECT_NEAR(stribeck->values[1], 25.0 / 60.0, 1e-12);
  EXPECT_NEAR(stribeck->values[2], 0.01, 1e-12);
  EXPECT_FALSE(effect_like(law_of(LawFamily::falling, {25.0, 0.01}), {})) << "no friction to fall from";
  EXPECT_FALSE(effect_like(law_of(LawFamily::falling, {25.0, 0.3}), friction)) << "slower than its card allows";

  // −30 N at r and flat from there is a fall by 30 N.
  const double r = law_of(LawFamily::knee, {}).rms;
  const auto knee = effect_like(law_of(LawFamily::knee, {-30.0, -1.0, r}), friction);
  ASSERT_TRUE(knee);
  EXPECT_EQ(knee->entry->name, "stribeck_friction");
  EXPECT_NEAR(knee->values[0], 55.0, 1e-12);
  EXPECT_NEAR(knee->values[1], 30.0 / 55.0, 1e-12);
  EXPECT_NEAR(knee->values[2], r / 1.7, 1e-12);
  EXPECT_FALSE(effect_like(law_of(LawFamily::knee, {-30.0, -15.0, r}), friction)) << "falls on";
  EXPECT_FALSE(effect_like(law_of(LawFamily::knee, {30.0, 1.0, r}), friction)) << "rises";
  EXPECT_FALSE(effect_like(law_of(LawFamily::knee, {-30.0, -1.0, r}), {})) << "no friction to fall from";

  const auto slopes = effect_like(law_of(LawFamily::two_slopes, {12.0, -8.0}), {});
  ASSERT_TRUE(slopes);
  EXPECT_EQ(slopes->entry->name, "asymmetric_damper");
  EXPECT_NEAR(slopes->values[0], 200.0, 1e-9);
}

// Point. Beside a curve there is no other over the same variable at the same place; sensors and other places are free.
TEST(LawAndEffects, NoTwoCurvesStandAtOnePlace) {
  const firmware::PlacedEffect damping = effect("quadratic_damping", {100.0}), stop = effect("bump_stop", {0.01, 1e5}),
                               guide = effect("body_guide_friction", {10.0}),
                               lag{firmware::find_effect("sensor_lag"), model::Channel::F, {1e-3}};
  EXPECT_FALSE(may_act_beside(damping, CurvePlace::suspension, CurveOver::velocity));
  EXPECT_TRUE(may_act_beside(damping, CurvePlace::suspension, CurveOver::deflection));
  EXPECT_FALSE(may_act_beside(stop, CurvePlace::suspension, CurveOver::deflection));
  EXPECT_TRUE(may_act_beside(stop, CurvePlace::tyre, CurveOver::deflection));
  EXPECT_FALSE(may_act_beside(guide, CurvePlace::body_guide, CurveOver::velocity));
  EXPECT_TRUE(may_act_beside(guide, CurvePlace::wheel_guide, CurveOver::velocity));
  EXPECT_TRUE(may_act_beside(lag, CurvePlace::suspension, CurveOver::velocity));
}

// Law. A curve stands in the place of dry friction if it steps at rest, not wherever friction was found before.
TEST(LawAndEffects, FrictionStepsAtRest) {
  const EffectsBeside friction{effect("coulomb_friction", {40.0})};
  EXPECT_TRUE(draws_friction(law_of(LawFamily::soft_sign, {45.0, 0.005}), friction, {}));
  EXPECT_FALSE(draws_friction(law_of(LawFamily::power, {45.0, 3.0}), friction, {}));
  EXPECT_FALSE(draws_friction(law_of(LawFamily::soft_sign, {45.0, 0.005}), friction, friction));
  EXPECT_FALSE(draws_friction(law_of(LawFamily::soft_sign, {45.0, 0.005}), {}, {}));
}

// Law. A family refines the effect that is its limit, where it takes its place; friction that falls does beside it.
TEST(LawAndEffects, ALimitIsRefinedInItsPlace) {
  const EffectsBeside friction{effect("coulomb_friction", {40.0})}, square{effect("quadratic_damping", {300.0})};
  const PlacedLaw soft = law_of(LawFamily::soft_sign, {45.0, 0.005}), falling = law_of(LawFamily::falling, {9.0, 0.01});
  EXPECT_TRUE(refines(soft, friction, {}));
  EXPECT_FALSE(refines(soft, friction, friction));
  EXPECT_FALSE(refines(soft, square, {}));
  EXPECT_TRUE(refines(falling, friction, friction));
  EXPECT_TRUE(refines(law_of(LawFamily::power, {9.0, 1.6}), square, {}));
  EXPECT_FALSE(refines(law_of(LawFamily::power, {9.0, 1.6}, CurveOver::deflection), square, {}));
}

// Point. The force of what a law takes the place of: 300 v|v| less what stays.
TEST(LawAndEffects, AddsUpWhatIsReplaced) {
  const EffectsBeside all{effect("coulomb_friction", {40.0}), effect("quadratic_damping", {300.0})};
  const ForceOfEffects both(all, {}, CurvePlace::suspension, CurveOver::velocity);
  EXPECT_NEAR(both(-0.2), -(40.0 + 300.0 * 0.04), 1e-9);
  const ForceOfEffects one(all, {all[0]}, CurvePlace::suspension, CurveOver::velocity);
  EXPECT_NEAR(one(0.2), 300.0 * 0.04, 1e-9);
}

}  // namespace
