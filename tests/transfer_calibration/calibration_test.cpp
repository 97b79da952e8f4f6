// A few of the rigs that rigtwin_transfer_calibration draws by hundreds.
#include "tests/transfer_calibration/calibration.hpp"

#include <gtest/gtest.h>

namespace {

// Law. The true value is anywhere among the draws, as often low as high. 12 rigs, 8 bins: χ² of 7 exceeds 29.9 once in
// 10 000; five such tests fail by chance once in 2000 seeds.
TEST(TransferCalibration, RanksOfTruePriorDrawsAreUniform) {
  const auto result = transfer_calibration::calibrate_on_prior(12, 7501);
  EXPECT_EQ(result.ranks.size(), 5U);
  for (const auto& [name, ranks] : result.ranks) {
    EXPECT_EQ(ranks.count(), 12U);
    EXPECT_LT(ranks.chi_squared(), 29.9) << name;
  }
}

// Journey. A rig of tests/truth, which shares no equation with the model, whose body guide rubs: the first rig cannot
// know that. The prediction does not hold, or the friction is named on the second rig alone.
TEST(TransferCalibration, AnEffectOfTheSecondRigIsSaid) {
  const auto one = transfer_calibration::transfer_truth(7041, transfer_calibration::Hidden::second_rig, 12.0);
  ASSERT_EQ(one.failure, "");
  EXPECT_EQ(one.outside, "body_guide_friction");
  EXPECT_TRUE(one.said);
  EXPECT_LT(one.coverage95, 0.9);
}

// Journey. Bristles (LuGre) rub in the component of both rigs, which no effect of the catalogue says: the first rig's
// rest is carried over, and the bands hold on the second rig, which is known otherwise. The lines of a pair share one
// draw of the rest, so that a pair's coverage of 95 % bands scatters by some 0.04.
TEST(TransferCalibration, ARestOfTheComponentIsCarriedOver) {
  const auto one = transfer_calibration::transfer_truth(31, transfer_calibration::Hidden::component, 20.0);
  ASSERT_EQ(one.failure, "");
  EXPECT_GT(one.discrepancy, 0.02);
  EXPECT_GT(one.confounded, 0.1);
  EXPECT_GE(one.coverage95, 0.85);
  EXPECT_TRUE(one.holds);
}

// Point. (1): eight bins with one rank each are uniform; all eight in one bin are 7² + 7 · 1² = 56 from it.
TEST(TransferCalibration, CountsRanks) {
  transfer_calibration::Ranks even, heaped;
  for (int i = 0; i < 8; ++i) {
    even.add((i + 0.5) / 8.0);
    heaped.add(1.0);
  }
  EXPECT_DOUBLE_EQ(even.chi_squared(), 0.0);
  EXPECT_DOUBLE_EQ(heaped.chi_squared(), 56.0);
  EXPECT_LT(heaped.p(), 1e-6);
}

}  // namespace
