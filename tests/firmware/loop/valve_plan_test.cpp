#include "firmware/loop/valve_plan.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace {

using firmware::ValvePlan;
using hal::Openings;

TEST(ValvePlan, HoldsOneSetAllTheTime) {
  const ValvePlan plan(Openings::first(2));
  EXPECT_EQ(plan.at({}), Openings::first(2));
  EXPECT_EQ(plan.at(hal::milliseconds(1'000'000)), Openings::first(2));
}

// A change belongs to exactly one sample: at its time, not a nanosecond before.
TEST(ValvePlan, ChangesAtItsTimes) {
  const std::array<ValvePlan::Change, 3> changes{{{hal::milliseconds(10), Openings::first(3)},
                                                  {hal::milliseconds(11), Openings{}},
                                                  {hal::milliseconds(500), Openings::from_bits(0b101)}}};
  const ValvePlan plan(Openings::first(1), changes);
  EXPECT_EQ(plan.at(hal::milliseconds(10) - hal::nanoseconds(1)), Openings::first(1));
  EXPECT_EQ(plan.at(hal::milliseconds(10)), Openings::first(3));
  EXPECT_EQ(plan.at(hal::milliseconds(11) - hal::nanoseconds(1)), Openings::first(3));
  EXPECT_EQ(plan.at(hal::milliseconds(11)), Openings{});
  EXPECT_EQ(plan.at(hal::milliseconds(499)), Openings{});
  EXPECT_EQ(plan.at(hal::milliseconds(500)), Openings::from_bits(0b101));
  EXPECT_EQ(plan.at(hal::milliseconds(9999)), Openings::from_bits(0b101));
}

// The bisection finds what a search from the front finds, for every length up to a full plan.
TEST(ValvePlan, FindsEveryChangeOfEveryLength) {
  for (const std::size_t length : {1U, 2U, 3U, 63U, 64U, 255U, 256U}) {
    std::vector<ValvePlan::Change> changes;
    for (std::size_t i = 0; i < length; ++i) {
      changes.push_back(
          {hal::milliseconds(static_cast<int>(3 * i)), Openings::from_bits(static_cast<unsigned>(i % 64))});
    }
    const ValvePlan plan(Openings::first(6), changes);
    for (int t = 0; t < static_cast<int>(3 * length) + 5; ++t) {
      const std::size_t passed = std::min(length - 1, static_cast<std::size_t>(t) / 3);
      ASSERT_EQ(plan.at(hal::milliseconds(t)), changes[passed].open) << t << " of " << length;
    }
  }
}

TEST(ValvePlan, SaysWhatIsWrongWithIt) {
  const std::array<ValvePlan::Change, 2> standing{{{hal::milliseconds(5), {}}, {hal::milliseconds(5), {}}}};
  EXPECT_FALSE(ValvePlan::check(standing).empty());
  const std::array<ValvePlan::Change, 1> before{{{hal::milliseconds(-5), {}}}};
  EXPECT_FALSE(ValvePlan::check(before).empty());
  std::vector<ValvePlan::Change> many(ValvePlan::capacity + 1);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].at = hal::milliseconds(static_cast<int>(i));
  EXPECT_FALSE(ValvePlan::check(many).empty());
  many.pop_back();
  EXPECT_TRUE(ValvePlan::check(many).empty());
}

TEST(ValvePlanDeathTest, IsMadeOfSoundChangesOnly) {
  const std::array<ValvePlan::Change, 1> before{{{hal::milliseconds(-5), {}}}};
  EXPECT_DEATH(ValvePlan(Openings{}, before), "");
}

TEST(ValvePlan, KnowsWhichDuctsItNeeds) {
  const std::array<ValvePlan::Change, 1> change{{{hal::milliseconds(5), Openings::first(3)}}};
  EXPECT_TRUE(ValvePlan(Openings::first(1), change).within(3));
  EXPECT_FALSE(ValvePlan(Openings::first(1), change).within(2));
  EXPECT_FALSE(ValvePlan(Openings::first(4), change).within(3));
}

}  // namespace
