// Families in the place of a free curve.
#include "host_sim/identification/learn/curve_family.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/host_sim/identification/example_law.hpp"

namespace {

using namespace host_sim::identification;
using sample::law_of;

/// A free curve that went exactly through a law, every point known to 1 N.
CurveFit curve_through(const PlacedLaw& law) {
  CurveFit curve;
  const PlacedLaw flat = flat_curve(law.place, law.over, {-law.largest, law.largest, law.rms});
  for (const double x : flat.at) {
    if (x != 0.0) curve.at.push_back(x);
  }
  const auto n = static_cast<Eigen::Index>(curve.at.size());
  curve.force.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) curve.force(i) = law.force(curve.at[static_cast<std::size_t>(i)]);
  curve.matrix = Eigen::MatrixXd::Identity(n, n);
  curve.gradient = Eigen::VectorXd::Zero(n);
  curve.model.fit.hypothesis.laws.push_back(flat);
  return curve;
}

// Truth by construction. The family that a curve was drawn from comes first, with its values.
TEST(CurveFamily, findsTheFamilyOfACurve) {
  const std::vector<PlacedLaw> laws{
      law_of(LawFamily::power, {200.0, 1.55}), law_of(LawFamily::two_slopes, {150.0, 80.0}),
      law_of(LawFamily::two_powers, {150.0, 80.0, 1.7}), law_of(LawFamily::levelling, {150.0, 0.08}),
      law_of(LawFamily::one_sided, {900.0, 500.0, 0.1}, CurveOver::deflection)};
  for (const PlacedLaw& law : laws) {
    const std::vector<FamilyMember> list = families_of(curve_through(law), false);
    ASSERT_FALSE(list.empty());
    EXPECT_EQ(list.front().law.family, law.family);
    for (std::size_t v = 0; v < law.values.size(); ++v)
      EXPECT_NEAR(list.front().law.values[v], law.values[v], 0.08 * law.values[v]) << v;
  }
}

// Law. Friction falls only beside friction, and what depends on the deflection is no friction.
TEST(CurveFamily, asksForFrictionBeside) {
  const auto holds = [](const std::vector<FamilyMember>& list, LawFamily family) {
    return std::any_of(list.begin(), list.end(), [&](const FamilyMember& m) { return m.law.family == family; });
  };
  const PlacedLaw falling = law_of(LawFamily::falling, {60.0, 0.03});
  EXPECT_FALSE(holds(families_of(curve_through(falling), false), LawFamily::falling));
  EXPECT_EQ(families_of(curve_through(falling), true).front().law.family, LawFamily::falling);
  const auto along = families_of(curve_through(law_of(LawFamily::power, {60.0, 2.0}, CurveOver::deflection)), true);
  EXPECT_FALSE(holds(along, LawFamily::falling));
  EXPECT_FALSE(holds(along, LawFamily::soft_sign));
}

// Law. A curve is flat where it begins, and stays inside what the recordings excite.
TEST(CurveFamily, aFlatCurveKeepsToTheRange) {
  const PlacedLaw curve = flat_curve(CurvePlace::suspension, CurveOver::deflection, {-0.05, 0.4, 0.1});
  EXPECT_GE(curve.at.front(), -0.0511);
  EXPECT_NEAR(curve.at.back(), 0.4, 1e-12);
  EXPECT_EQ(std::count(curve.at.begin(), curve.at.end(), 0.0), 1);
  EXPECT_TRUE(std::all_of(curve.values.begin(), curve.values.end(), [](double f) { return f == 0.0; }));
}

}  // namespace
