// A small part of rigtwin_uncertainty_budget: budgets are as wide as estimates and predictions scatter.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/uncertainty_budget/draws.hpp"

namespace {

/// Three deviations of a standard deviation that n draws have: 3/√(2n).
/// `predicted`: predictions too.
void expect_as_wide(const uncertainty_budget::Asked& asked, bool predicted = true) {
  const double tolerance = 3.0 / std::sqrt(2.0 * static_cast<double>(asked.draws));
  for (const uncertainty_budget::Compared& one : uncertainty_budget::compare(asked)) {
    if (!predicted && one.number.starts_with("rms")) continue;
    EXPECT_NEAR(one.spread / one.combined, 1.0, tolerance) << asked.rig << ' ' << one.number << ": " << one.parts;
  }
}

TEST(UncertaintyBudget, IsAsWideAsABenchScatters) {
  expect_as_wide({.rig = "component_bench", .draws = 120, .duration = 6.0});
}

TEST(UncertaintyBudget, IsAsWideAsACarScatters) {
  expect_as_wide({.rig = "quarter_car", .draws = 120, .duration = 6.0});
}

// Noise alone: without the other sources a wrong weight of the noise would show. What the input's noise does to a
// prediction directly, 1e-5 of it, is in no budget, so estimates alone are held against it.
TEST(UncertaintyBudget, IsAsWideAsNoiseScatters) {
  for (const char* const rig : {"component_bench", "quarter_car"}) {
    expect_as_wide({.rig = rig, .draws = 120, .duration = 6.0, .calibration = false, .tolerances = false}, false);
  }
}

}  // namespace
