// Periods that begin late: counted, not made up for, and too many of them in a row end the run.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using hal::simulated::LateWake;
using model::RigKind;

// Late periods: counted each, never made up for. Three wakes of 0.4 ms too late shift everything after by 1.2 ms; the
// number of periods per time falls, none is run twice.
TEST(LatePeriods, AreCountedAndNeverMadeUpFor) {
  const std::array<LateWake, 3> late{{{{ms * 100, ms * 101}, hal::microseconds(400)},
                                      {{ms * 150, ms * 151}, hal::microseconds(400)},
                                      {{ms * 200, ms * 201}, hal::microseconds(400)}}};
  Scene scene(RigKind::component_bench, 400);
  scene.faults.late_wakes = late;
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
  EXPECT_EQ(run.loop.counters().late_periods, 3U);
  const auto rows = run.rows(Mode::running);
  ASSERT_EQ(rows.size(), 400U);
  EXPECT_EQ(rows[99].time, ms * 99);
  EXPECT_EQ(rows[100].time, ms * 100 + hal::microseconds(400));
  EXPECT_EQ(rows[100].counters.late_periods, 1U);
  EXPECT_EQ(rows[100].late, hal::microseconds(400));
  EXPECT_EQ(rows[101].late, hal::Time{});
  EXPECT_EQ(rows[399].time, ms * 399 + hal::microseconds(1200));
}

// Jitter below a quarter of a period is no lateness, and does not shift the periods that follow.
TEST(LatePeriods, AreToldFromJitter) {
  const std::array<LateWake, 2> late{
      {{{ms * 100, ms * 101}, hal::microseconds(250)}, {{ms * 200, ms * 201}, hal::microseconds(251)}}};
  Scene scene(RigKind::component_bench, 400);
  scene.faults.late_wakes = late;
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.counters().late_periods, 1U);
  const auto rows = run.rows(Mode::running);
  EXPECT_EQ(rows[100].time, ms * 100 + hal::microseconds(250));
  EXPECT_EQ(rows[101].time, ms * 101);
  EXPECT_EQ(rows[201].time, ms * 201 + hal::microseconds(251));
}

// Five in a row: the machine that runs the program is too slow for its rig, and a hil loop with more delay than it was
// designed for is about to become unstable.
TEST(LatePeriods, TripWhenTheyDoNotEnd) {
  const LateWake late{{ms * 300}, ms};
  Scene scene(RigKind::hil, 1000);
  scene.faults.late_wakes = {&late, 1};
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::late);
  EXPECT_EQ(run.loop.trip().value, 5.0);
  EXPECT_EQ(run.rows(Mode::running).back().sample, 304U);
  expect_safe_end(run);
}

// A machine that was suspended: its clock says nothing, nobody watched the rig.
TEST(LatePeriods, ASuspensionIsAGap) {
  for (const int length : {5, 3000}) {
    const hal::simulated::Suspension suspension{ms * 300, ms * length};
    Scene scene(RigKind::component_bench, 900);
    scene.faults.suspensions = {&suspension, 1};
    Journey run{scene};
    run.whole();
    EXPECT_EQ(run.loop.trip().reason, length > 10 ? Reason::gap : Reason::reference_ended);
    if (length > 10) {
      EXPECT_EQ(run.loop.trip().value, 3.0);
      EXPECT_EQ(run.loop.trip().time, ms * 300);
    }
  }
}

// One in five 9 ms late takes two thirds of the time away: seen after five of them, not after 15 s. One in twenty is
// not.
TEST(LatePeriods, CountByHowLateTheyAre) {
  for (const int every : {5, 20}) {
    std::vector<LateWake> late;
    // Periods move by the lateness: one of `every` in the rig's own time.
    for (int k = 0; k < 60; ++k) {
      const int at = 100 + k * (every + 9);
      late.push_back({{ms * at, ms * at + hal::microseconds(900)}, hal::milliseconds(9)});
    }
    Scene scene(RigKind::component_bench, 900);
    scene.faults.late_wakes = late;
    Journey run{scene};
    run.whole();
    EXPECT_EQ(run.loop.trip().reason, every == 5 ? Reason::late : Reason::reference_ended) << every;
    if (every == 5) {
      EXPECT_LE(run.loop.counters().late_periods, 5U);
    }
  }
}

// Four late ones of five: with a leak of a quarter the bucket holds 4, 3.75, then 4.75, 5.75: the fifth late one trips.
TEST(LatePeriods, TripWhenFourOfFiveAreLate) {
  const std::array<LateWake, 2> late{{{{ms * 100, ms * 108}, ms}, {{ms * 109, ms * 116}, ms}}};
  Scene scene(RigKind::component_bench, 400);
  scene.faults.late_wakes = late;
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::late);
  EXPECT_EQ(run.loop.trip().value, 5.75);
  expect_safe_end(run);
}

// One late period of five for ever: what the leak makes up for. A hil loop has 0.2 periods more delay then.
TEST(LatePeriods, LetOneOfFivePass) {
  std::vector<LateWake> late;
  for (int k = 1; k < 70; ++k) late.push_back({{ms * (6 * k), ms * (6 * k) + hal::microseconds(500)}, ms});
  Scene scene(RigKind::component_bench, 400);
  scene.faults.late_wakes = late;
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended);
  EXPECT_GT(run.loop.counters().late_periods, 60U);
}

// 10 ms without a look at the rig are a hazard by themselves; 9.9 ms count as one late period.
TEST(LatePeriods, TripAtOnceAfterAGap) {
  for (const std::int64_t microseconds : {9'900, 10'100, 6'000'000}) {
    const LateWake late{{ms * 100, ms * 101}, hal::microseconds(microseconds)};
    Scene scene(RigKind::component_bench, 400);
    scene.faults.late_wakes = {&late, 1};
    Journey run{scene};
    run.whole();
    const bool gap = microseconds > 10'000;
    EXPECT_EQ(run.loop.trip().reason, gap ? Reason::gap : Reason::reference_ended) << microseconds;
    if (!gap) continue;
    EXPECT_NEAR(run.loop.trip().value, 1e-6 * static_cast<double>(microseconds), 1e-12);
    EXPECT_EQ(run.rows(Mode::running).back().sample, 100U) << "the period that begins too late is the last one";
    expect_safe_end(run);
  }
}

}  // namespace
