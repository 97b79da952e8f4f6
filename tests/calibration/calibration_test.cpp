// A small part of rigtwin_plan_calibration: what plan promises diagnose names, and nothing below two standard
// deviations.
#include "tests/calibration/calibration.hpp"

#include <gtest/gtest.h>

#include <cstddef>

namespace {

TEST(Calibration, DiagnoseNamesWhatPlanPromises) {
  calibration::Asked asked;
  asked.kind = "component_bench";
  asked.part = 1;
  asked.parts = 5;
  asked.duration = 20.0;
  std::size_t promised = 0, unseen = 0;
  for (const calibration::Case& one : calibration::calibrate(asked)) {
    if (!one.failure.empty()) continue;
    (one.promised ? promised : unseen) += 1;
    if (one.promised) {
      EXPECT_TRUE(one.named) << one.effect << " of " << one.value << ": " << one.found;
    } else {
      EXPECT_FALSE(one.believed) << one.effect << " of " << one.value << ": " << one.found;
    }
  }
  EXPECT_GE(promised, 3U);
  EXPECT_GE(unseen, 2U);
}

}  // namespace
