// The sequential score test on scores that are made here: what is named, when, and what is not.
#include "host_sim/live/score_test.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host_sim/live/thresholds.hpp"
#include "tests/support/reference_road.hpp"

namespace {

using namespace host_sim::live;
namespace thresholds = host_sim::live::thresholds;

constexpr double step = thresholds::block;

/// Blocks of three candidates: 0 and 1 are sizes of one cause, 2 is another with a direction of its own. `size`: of what
/// acts in the direction of 0, `other`: of 2; `information` of each.
class Blocks {
 public:
  explicit Blocks(unsigned seed) : noise_(seed) {}
  BlockScore next(double size, double other = 0.0, double information = 100.0) {
    BlockScore block;
    const double a = information;
    block.information = {a, a, a};
    const double common = std::sqrt(a) * noise_(), own = std::sqrt(a) * noise_();
    block.score = {a * size + common, 0.9 * a * size + 0.9 * common + 0.43 * std::sqrt(a) * noise_(), a * other + own};
    block.samples = 250.0;
    block.power = 250.0 + std::sqrt(500.0) * noise_() + a * (size * size + other * other) + 2.0 * size * common;
    block.begins = time_;
    block.ends = time_ += step;
    return block;
  }

 private:
  support::NormalNoise noise_;
  double time_ = 0.0;
};

ScoreTest test_of(double lower = -1e9) {
  return ScoreTest({{0, lower, 1e9, 0.0}, {0, lower, 1e9, 0.0}, {1, lower, 1e9, 0.0}}, step);
}

/// The first conclusion of `after` blocks with a size, behind `before` of another one.
std::optional<Onset> concluded(ScoreTest& test, Blocks& blocks, std::size_t before, std::size_t after, double was,
                               double is, double information_after = 100.0) {
  for (std::size_t i = 0; i < before; ++i) {
    if (auto onset = test.add(blocks.next(was))) return onset;
  }
  for (std::size_t i = 0; i < after; ++i) {
    if (auto onset = test.add(blocks.next(is, 0.0, information_after))) return onset;
  }
  return std::nullopt;
}

// Point. 5 % on both sides lie beyond 1.95996; of Student's t with 10 degrees of freedom beyond 2.22814 (tables).
TEST(ScoreTest, KnowsTheQuantilesOfTables) {
  EXPECT_NEAR(two_sided_quantile(0.05), 1.959964, 1e-6);
  EXPECT_NEAR(two_sided_quantile(1e-9), 6.109410, 1e-5);
  EXPECT_NEAR(normal_of_student(2.228139, 10.0), 1.959964, 0.005);
  EXPECT_LT(normal_of_student(-3.0, 79.0), -2.9);
}

// Point. The level is the rate of false names over the tests in an hour: 3 candidates, 20 windows, 14 400 blocks.
TEST(ScoreTest, DividesTheFalseNamesAmongItsTests) {
  EXPECT_NEAR(test_of().level(), two_sided_quantile(0.01 / (3.0 * 20.0 * 14400.0)), 1e-9);
}

// A size of one, with A = 100 a block, is 10 standard deviations a block: named as soon as it has lasted a second, with
// its size (one Newton step) and the block in which it began.
TEST(ScoreTest, NamesACauseWithItsSizeAndItsBegin) {
  Blocks blocks(1);
  ScoreTest test = test_of();
  const auto onset = concluded(test, blocks, 100, 40, 0.0, 1.0);
  ASSERT_TRUE(onset);
  EXPECT_TRUE(onset->named);
  EXPECT_EQ(onset->candidate, 0U);
  EXPECT_NEAR(onset->size, 1.0, 5.0 * onset->deviation);
  EXPECT_NEAR(onset->deviation, 1.0 / std::sqrt(100.0 * onset->motion / step), 0.3 * onset->deviation);
  EXPECT_NEAR(onset->since, 100 * step, 1.5 * step);
  EXPECT_LE(onset->motion, 5.0);
  EXPECT_GE(onset->motion, static_cast<double>(thresholds::lasting) * step);
  EXPECT_GT(onset->share, 0.8);
  EXPECT_EQ(onset->rivals, 0U) << "another size of the same cause is no rival";
}

// What is there from the beginning does not appear, however large it is, and what follows is told from it.
TEST(ScoreTest, SubtractsWhatWasThereBefore) {
  Blocks blocks(2);
  ScoreTest test = test_of();
  EXPECT_FALSE(concluded(test, blocks, 600, 0, 0.8, 0.8));
  Blocks more(3);
  ScoreTest again = test_of();
  const auto onset = concluded(again, more, 100, 40, 0.8, 2.4);
  ASSERT_TRUE(onset);
  EXPECT_NEAR(onset->size, 1.6, 0.2);
}

// (8). A motion that is twice as large shows twice as much of what the model gets wrong. That is no fault, and neither is
// a change that is smaller than it.
TEST(ScoreTest, DoesNotNameWhatIsSmallerThanWhatTheModelGetsWrong) {
  Blocks blocks(4);
  ScoreTest test = test_of();
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(test.add(blocks.next(0.0, 2.0)));
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(test.add(blocks.next(1.5, 2.0))) << "smaller than 2";
  Blocks others(4);
  ScoreTest larger = test_of();
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(larger.add(others.next(0.0, 2.0)));
  std::optional<Onset> onset;
  for (int i = 0; i < 40 && !onset; ++i) onset = larger.add(others.next(3.0, 2.0));
  ASSERT_TRUE(onset);
  EXPECT_TRUE(onset->named);
}

// (6). A mean score that does not follow the motion is that of the input's noise: with a quarter of the information the
// same score is no fault. A part of the size that the information would say is none either.
TEST(ScoreTest, AllowsAMeanThatDoesNotFollowTheMotion) {
  Blocks blocks(5);
  ScoreTest test = test_of();
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(test.add(blocks.next(0.5)));
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(test.add(blocks.next(2.0, 0.0, 25.0))) << "A θ is 50 in both";
}

// A push of half a second is over before it is named.
TEST(ScoreTest, LetsAPushPass) {
  Blocks blocks(6);
  ScoreTest test = test_of();
  ASSERT_FALSE(concluded(test, blocks, 100, 2, 0.0, 1.5));
  std::optional<Onset> onset;
  for (int i = 0; i < 60 && !onset; ++i) onset = test.add(blocks.next(0.0));
  ASSERT_TRUE(onset);
  EXPECT_TRUE(onset->passed);
  EXPECT_FALSE(onset->named);
}

// A rise of the residual of which the candidates explain less than half has no name.
TEST(ScoreTest, SaysWhatNoCandidateExplains) {
  Blocks blocks(7);
  ScoreTest test = test_of();
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(test.add(blocks.next(0.0)));
  std::optional<Onset> onset;
  for (int i = 0; i < 40 && !onset; ++i) {
    BlockScore block = blocks.next(1.0);
    block.power += 400.0;
    onset = test.add(block);
  }
  ASSERT_TRUE(onset);
  EXPECT_FALSE(onset->named);
  EXPECT_FALSE(onset->passed);
  EXPECT_LT(onset->share, thresholds::least_share);
}

// A candidate that cannot be negative is not named for what would be.
TEST(ScoreTest, KeepsToTheBoundsOfACard) {
  Blocks blocks(8);
  ScoreTest test = test_of(0.0);
  const auto onset = concluded(test, blocks, 100, 60, 0.0, -1.0);
  EXPECT_FALSE(onset && onset->named);
}

// Two causes of one direction: both are said; the one with a price is the rival.
TEST(ScoreTest, SaysRivalsThatNothingTellsApart) {
  ScoreTest test({{0, -1e9, 1e9, 9.2}, {1, -1e9, 1e9, 0.0}}, step);
  support::NormalNoise noise(9);
  std::optional<Onset> onset;
  for (int i = 0; i < 140 && !onset; ++i) {
    BlockScore block;
    block.information = {100.0, 100.0};
    const double b = (i < 100 ? 0.0 : 100.0) + 10.0 * noise();
    block.score = {b, b};
    block.samples = 250.0;
    block.power = 250.0 + std::sqrt(500.0) * noise() + (i < 100 ? 0.0 : 100.0);
    block.begins = step * i;
    block.ends = block.begins + step;
    onset = test.add(block);
  }
  ASSERT_TRUE(onset);
  EXPECT_TRUE(onset->named);
  EXPECT_EQ(onset->candidate, 1U);
  EXPECT_EQ(onset->rivals, 1U);
  ASSERT_EQ(onset->contenders.size(), 2U);
  EXPECT_EQ(onset->contenders[1].candidate, 0U);
}

// (5). Blocks that follow each other are alike: the same sums are less significant.
TEST(ScoreTest, TakesNeighboursThatAreAlikeForFewer) {
  ScoreTest test({{0, -1e9, 1e9, 0.0}}, step);
  support::NormalNoise noise(10);
  double slow = 0.0;
  std::size_t named = 0;
  for (int i = 0; i < 4000; ++i) {
    slow = 0.8 * slow + 0.6 * noise();
    BlockScore block;
    block.information = {100.0};
    block.score = {10.0 * slow};
    block.samples = 250.0;
    block.power = 250.0;
    block.begins = step * i;
    block.ends = block.begins + step;
    if (test.add(block)) {
      ++named;
      test.forget_window();
    }
  }
  EXPECT_EQ(named, 0U);
}

}  // namespace
