// The words of an effect, as its card has them.
#include "host_sim/identification/report/shape_words.hpp"

#include <gtest/gtest.h>

namespace {

using host_sim::identification::shape_words;

std::string words_of(const char* effect, std::vector<double> values) {
  model::RigParameters<double> rig;
  rig.suspension.damping = 200.0;
  return shape_words({firmware::find_effect(effect), std::nullopt, std::move(values)}, rig);
}

// Point. Figures stand where the card says, in its units; a figure of the other sign has words of its own. 250 against
// 150 N s/m is 67 % more.
TEST(ShapeWords, AreThoseOfTheCardWithItsFigures) {
  EXPECT_EQ(words_of("stribeck_friction", {20.0, 0.5, 0.01}),
            "breaks away at 30 N, falls to 20 N by 20 mm/s (Stribeck)");
  EXPECT_EQ(words_of("asymmetric_damper", {-100.0}), "rebound 67 % harder than compression");
  EXPECT_EQ(words_of("asymmetric_damper", {100.0}), "rebound 40 % softer than compression");
  EXPECT_EQ(words_of("progressive_spring", {-1.0}), "softens with |x|^3");
  EXPECT_EQ(words_of("actuator_lag", {0.01}), "");
}

// Fault. A slope that is not above zero can be compared with nothing.
TEST(ShapeWords, AreNoneWhereAFigureIsNone) { EXPECT_EQ(words_of("asymmetric_damper", {-500.0}), ""); }

}  // namespace
