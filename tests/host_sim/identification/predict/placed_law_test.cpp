// Laws of a hypothesis: families of curves and their tables.
#include "host_sim/identification/predict/placed_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/laws/curve.hpp"
#include "model/laws/surface.hpp"
#include "tests/host_sim/identification/example_law.hpp"

namespace {

using namespace host_sim::identification;
using sample::law_of;

// Point. Each family by hand, at a point on either side of its corner and of zero.
TEST(PlacedLaw, familiesByHand) {
  const PlacedLaw power = law_of(LawFamily::power, {50.0, 1.5});
  EXPECT_NEAR(power.force(0.2), 50.0 * std::pow(2.0, 1.5), 1e-12);
  EXPECT_NEAR(power.force(-0.1), -50.0, 1e-12);
  const PlacedLaw slopes = law_of(LawFamily::two_slopes, {30.0, 20.0});
  EXPECT_NEAR(slopes.force(0.05), 15.0, 1e-12);
  EXPECT_NEAR(slopes.force(-0.05), -10.0, 1e-12);
  const PlacedLaw powers = law_of(LawFamily::two_powers, {30.0, 20.0, 2.0});
  EXPECT_NEAR(powers.force(0.2), 120.0, 1e-12);
  EXPECT_NEAR(powers.force(-0.2), -80.0, 1e-12);
  const PlacedLaw smooth = law_of(LawFamily::soft_sign, {40.0, 0.02});
  EXPECT_NEAR(smooth.force(-0.02), -40.0 * std::tanh(1.0), 1e-12);
  const PlacedLaw falling = law_of(LawFamily::falling, {60.0, 0.03});
  EXPECT_NEAR(falling.force(0.03), -60.0 * (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(falling.force(-0.03), 60.0 * (1.0 - std::exp(-1.0)), 1e-12);
  const PlacedLaw knee = law_of(LawFamily::knee, {100.0, 10.0, 0.05});
  EXPECT_NEAR(knee.force(0.15), (100.0 * 0.05 + 10.0 * 0.1) / 0.1, 1e-12);
  EXPECT_NEAR(knee.force(-0.02), -20.0, 1e-12);
  const PlacedLaw sided = law_of(LawFamily::one_sided, {100.0, 50.0, 0.05});
  EXPECT_EQ(sided.force(0.04), 0.0);
  EXPECT_NEAR(sided.force(0.07), 20.0, 1e-12);
  EXPECT_NEAR(sided.force(-0.07), -10.0, 1e-12);
  const PlacedLaw levelling = law_of(LawFamily::levelling, {60.0, 0.05});
  EXPECT_NEAR(levelling.force(0.2), 60.0 * 2.0 / 5.0, 1e-12);
  EXPECT_NEAR(levelling.force(-0.05), -60.0 * 0.5 / 2.0, 1e-12);
}

// Point. Surfaces by hand, and their tables: between points |x|² is straight, at most (Δx)²/8 · 2 off.
TEST(PlacedLaw, SurfacesByHand) {
  PlacedLaw load = law_of(LawFamily::follows_load, {30.0, 0.02});
  load.over = CurveOver::both;
  load.rms_velocity = 0.2;
  load.largest_velocity = 0.8;
  EXPECT_NEAR(load.force(-0.2, 0.02), 60.0 * std::tanh(1.0), 1e-12);
  EXPECT_NEAR(load.force(0.1, -1.0), -30.0, 1e-12);
  PlacedLaw stroke = load;
  stroke.family = LawFamily::along_stroke;
  stroke.values = {10.0, 2.0};
  EXPECT_NEAR(stroke.force(-0.2, 0.1), 10.0 * 4.0 * 0.5, 1e-12);
  EXPECT_NEAR(stroke.force(0.2), 40.0, 1e-12);  // while v is its rms

  model::RigParameters<double> rig;
  for (const PlacedLaw& law : {load, stroke}) {
    put_laws({law}, rig);
    ASSERT_EQ(rig.laws.surface_count, 1);
    EXPECT_EQ(rig.laws.curve_count, 0);
    const model::Surface<double> surface(rig.laws.surfaces[0]);
    for (double x = -0.4; x <= 0.4; x += 0.05) {
      for (const double v : {-0.7, -0.1, 0.05, 0.3}) {
        const double scale = std::abs(law.force(0.4, 0.8));
        EXPECT_NEAR(surface(x, v), law.force(x, v), 0.01 * scale) << x << " " << v;
      }
    }
  }
  // Moved 0.1 m in a step of 1 ms and on: central differences of the motion.
  const std::vector<double> forces = stroke.forces_along({0.0, 0.1, 0.2, 0.3}, 0.5);
  EXPECT_NEAR(forces[1], 10.0 * 1.0 * (0.2 / 1.0) / 0.2, 1e-12);
}

// Point. A free surface by hand: two rows of a plane, and a direction that lifts one corner by a quarter of its value;
// in and beyond its rows, and along a motion.
TEST(PlacedLaw, AFreeSurfaceIsASumOfTables) {
  model::SurfaceTable<double> plane;
  plane.rows = 3;
  plane.columns = 2;
  plane.deflection = {-0.1, 0.0, 0.2};
  plane.velocity = {0.0, 1.0};
  plane.value[0] = {-10.0, -5.0};
  plane.value[1] = {0.0, 5.0};
  plane.value[2] = {20.0, 25.0};
  model::SurfaceTable<double> corner = plane;
  corner.value = {};
  corner.value[2][1] = 0.25;
  PlacedLaw law = law_of(LawFamily::free_surface, {8.0});
  law.over = CurveOver::both;
  law.basis = std::make_shared<const SurfaceBasis>(SurfaceBasis{plane, {corner}});
  EXPECT_NEAR(law.force(-0.05, 0.5), -2.5, 1e-12);
  EXPECT_NEAR(law.force(0.1, 0.0), 10.0, 1e-12);
  EXPECT_NEAR(law.force(0.1, 1.0), 16.0, 1e-12);
  EXPECT_NEAR(law.force(0.3, 1.0), 38.0, 1e-12);
  EXPECT_NEAR(law.force(-0.2, 0.0), -20.0, 1e-12);
  EXPECT_NEAR(surface_of(law).value[2][1], 27.0, 1e-12);
  EXPECT_NEAR(law.forces_along({0.0, 0.1, 0.2}, 0.1)[1], 16.0, 1e-12);
}

// Law. A law of a guide stands at that guide, over the velocity.
TEST(PlacedLaw, GuidesAreTheirOwnPlace) {
  PlacedLaw law = law_of(LawFamily::power, {50.0, 1.5});
  law.place = CurvePlace::wheel_guide;
  model::RigParameters<double> rig;
  put_laws({law}, rig);
  EXPECT_EQ(rig.laws.curves[0].place, model::LawPlace::wheel_guide);
  EXPECT_EQ(name(law.place), "wheel_guide");
  law.place = CurvePlace::body_guide;
  put_laws({law}, rig);
  EXPECT_EQ(rig.laws.curves[0].place, model::LawPlace::body_guide);
}

// Point. A stack of sliders at its corners, by hand: out 2 mm, back 1 mm, with slip travels of 0.5 and 4 mm. A Maxwell
// branch that is moved at once keeps e⁻¹ of its force after T.
TEST(PlacedLaw, StacksRememberHowTheDeflectionWent) {
  PlacedLaw sliders = law_of(LawFamily::sliders, {10.0, 0.0, 20.0});
  sliders.at = {0.5e-3, 1e-3, 4e-3};
  EXPECT_NEAR(sliders.force(2e-3), 10.0 + 20.0 * 2.0 / 4.0, 1e-12);
  EXPECT_NEAR(sliders.force(-1.0), -30.0, 1e-12);
  const std::vector<double> forces = sliders.forces_along({0.0, 2e-3, 1e-3}, 1e-3);
  EXPECT_NEAR(forces[1], 20.0, 1e-12);
  EXPECT_NEAR(forces[2], -10.0 + 5.0, 1e-12);
  PlacedLaw maxwell = law_of(LawFamily::maxwell, {10.0});
  maxwell.at = {0.1};
  std::vector<double> moved(1001, 0.1);  // r, after which nothing moves for T
  moved[0] = 0.0;
  const std::vector<double> relaxing = maxwell.forces_along(moved, 1e-4);
  EXPECT_NEAR(relaxing.back() / relaxing[1], std::exp(-0.999), 1e-9);
  EXPECT_NEAR(relaxing[1], 10.0, 0.01);  // 10 N at once, less half of a period's relaxation: h/2T = 5e-4

  model::RigParameters<double> rig;
  put_laws({sliders}, rig);
  ASSERT_EQ(rig.laws.branch_count, 2);  // one without a force is none
  EXPECT_EQ(rig.laws.branches[0].slip_force, 10.0);
  EXPECT_NEAR(rig.laws.branches[1].stiffness, 20.0 / 4e-3, 1e-9);
  EXPECT_EQ(rig.laws.branches[1].time_constant, 0.0);
  sliders.values[0] = 0.0;
  put_laws({sliders}, rig);
  EXPECT_EQ(rig.laws.branch_count, 1);
  put_laws({maxwell}, rig);
  EXPECT_NEAR(rig.laws.branches[0].stiffness, 100.0, 1e-9);
  EXPECT_EQ(rig.laws.branches[0].time_constant, 0.1);
}

// Law. A table ascends through zero, has room in a rig, and holds the family's force at its points.
TEST(PlacedLaw, tablesHoldTheForce) {
  const std::vector<PlacedLaw> laws{law_of(LawFamily::power, {50.0, 1.5}), law_of(LawFamily::soft_sign, {40.0, 0.004}),
                                    law_of(LawFamily::knee, {100.0, 10.0, 0.05}),
                                    law_of(LawFamily::one_sided, {100.0, 50.0, 0.05})};
  for (const PlacedLaw& law : laws) {
    const LawTable table = table_of(law);
    ASSERT_LE(table.at.size(), 33U);
    EXPECT_TRUE(std::is_sorted(table.at.begin(), table.at.end()));
    EXPECT_EQ(std::adjacent_find(table.at.begin(), table.at.end()), table.at.end());
    EXPECT_EQ(std::count(table.at.begin(), table.at.end(), 0.0), 1);
    EXPECT_NEAR(table.at.back(), 0.4, 1e-12);
    for (std::size_t i = 0; i < table.at.size(); ++i) EXPECT_EQ(table.value[i], law.force(table.at[i]));
  }
}

// Law. The cubic that a rig puts through a table leaves 2 % of the largest force at most, wherever the family bends.
TEST(PlacedLaw, tablesAreDenseWhereTheCurveBends) {
  for (const PlacedLaw& law :
       {law_of(LawFamily::power, {50.0, 0.5}), law_of(LawFamily::power, {50.0, 2.6}),
        law_of(LawFamily::soft_sign, {40.0, 0.004}), law_of(LawFamily::falling, {60.0, 0.01}),
        law_of(LawFamily::knee, {100.0, 10.0, 0.02}), law_of(LawFamily::levelling, {100.0, 0.01})}) {
    const LawTable table = table_of(law);
    const model::Curve<double> cubic(table.at, table.value, table.at.size());
    double largest = 0.0, error = 0.0;
    for (double x = -0.4; x <= 0.4; x += 1e-4) {
      largest = std::max(largest, std::abs(law.force(x)));
      error = std::max(error, std::abs(law.force(x) - cubic(x)));
    }
    EXPECT_LT(error, 0.02 * largest) << static_cast<int>(law.family);
  }
}

// Bound. A table goes on as far as what is recorded, held out or not: a power of 3 that ended at 0.4 and went on
// straight would have 0.65 of its force at 0.6.
TEST(PlacedLaw, TablesGoOnAsFarAsTheRecord) {
  for (const double exponent : {1.5, 3.0}) {
    PlacedLaw law = law_of(LawFamily::power, {50.0, exponent});
    law.farthest = 0.6;
    const LawTable table = table_of(law);
    EXPECT_NEAR(table.at.back(), 0.6, 1e-12);
    const model::Curve<double> cubic(table.at, table.value, table.at.size());
    EXPECT_NEAR(cubic(0.59) / law.force(0.59), 1.0, 2.5e-3) << exponent;
    law.farthest = 0.1;  // never less than X
    EXPECT_NEAR(table_of(law).at.back(), 0.4, 1e-12);
  }
}

// Bound. Powers are off by 1 in 400 of the largest force at most, from dry friction's to a fifth: a law that is three
// hundred times the noise shows nothing of its table.
TEST(PlacedLaw, TablesOfPowersAreCloseEverywhere) {
  for (const double exponent : {0.5, 0.8, 1.1, 1.6, 2.0, 3.0, 5.0}) {
    const PlacedLaw law = law_of(LawFamily::two_powers, {50.0, 70.0, exponent});
    const LawTable table = table_of(law);
    const model::Curve<double> cubic(table.at, table.value, table.at.size());
    double error = 0.0;
    for (double x = -0.4; x <= 0.4; x += 1e-4) error = std::max(error, std::abs(law.force(x) - cubic(x)));
    EXPECT_LT(error, 2.5e-3 * law.force(-0.4) * -1.0) << exponent;
  }
}

}  // namespace
