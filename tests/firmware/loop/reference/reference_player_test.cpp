#include "firmware/loop/reference/reference_player.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/firmware/loop/rig_under_test.hpp"

namespace {

using namespace rig_under_test;
using firmware::Mode;
using firmware::Reason;
using firmware::ReferencePlayer;
using firmware::TableReference;
using model::RigKind;

struct Played {
  std::vector<Motion> motions;
  std::vector<double> levels;
};

/// Plays so many periods; `at` is told the period before each.
template <class At>
Played play(std::vector<Motion> reference, int periods, const At& at) {
  TableReference table(reference);
  ReferencePlayer player(table, h);
  Played played;
  played.motions.push_back(*player.start());
  for (int k = 0; k < periods; ++k) {
    at(player, k);
    const auto motion = player.next();
    if (!motion) break;
    played.motions.push_back(*motion);
    played.levels.push_back(player.level());
  }
  return played;
}

// Law. Velocity and acceleration that go out are the derivatives of the position: central differences over 1 ms of
// motions below 13 Hz, (2πf h)²/6 = 0.1 % of the largest value. The acceleration has a step where a smoothstep of the
// level begins or ends, 6 · 0.75 · 8 mm/s², of which a central difference sees half: 1.2 % of the sharpest.
void expect_one_motion(const Played& played) {
  double fastest = 0.0, sharpest = 0.0;
  for (const Motion& m : played.motions) {
    fastest = std::max(fastest, std::abs(m.velocity));
    sharpest = std::max(sharpest, std::abs(m.acceleration));
  }
  for (std::size_t k = 1; k + 1 < played.motions.size(); ++k) {
    const Motion &a = played.motions[k - 1], &m = played.motions[k], &b = played.motions[k + 1];
    ASSERT_NEAR(m.velocity, (b.position - a.position) / (2.0 * h), 2e-3 * fastest) << k;
    ASSERT_NEAR(m.acceleration, (b.velocity - a.velocity) / (2.0 * h), 0.015 * sharpest) << k;
  }
}

TEST(ReferencePlayer, PlaysTheReferenceToTheBit) {
  const auto reference = road(500, 1.0, 0.01);
  const Played played = play(reference, 600, [](ReferencePlayer&, int) {});
  ASSERT_EQ(played.motions.size(), 500U);
  for (std::size_t k = 0; k < 500; ++k) EXPECT_EQ(played.motions[k].position, reference[k].position);
}

// It slows down within a second, stands where it is, goes on from there within a second, and is the reference again to
// the bit, half a second later for each change and as much as it stood.
TEST(ReferencePlayer, StandsStillAndGoesOnWithoutAJump) {
  const auto reference = road(6000);
  const Played played = play(reference, 5000, [](ReferencePlayer& player, int k) {
    if (k == 1000) player.hold();
    if (k == 2500) player.resume();
    EXPECT_EQ(player.standing(), k >= 2000 && k <= 2500) << k;
  });
  expect_one_motion(played);
  for (std::size_t k = 2001; k <= 2500; ++k) {
    ASSERT_EQ(played.motions[k].position, reference[1500].position);
    ASSERT_EQ(played.motions[k].velocity, 0.0);
  }
  for (std::size_t k = 3500; k <= 5000; ++k) ASSERT_EQ(played.motions[k].position, reference[k - 1500].position) << k;
}

// A new level comes within a second, about the beginning of the reference, without a jump of the velocity.
TEST(ReferencePlayer, ChangesTheLevelWithoutAJump) {
  const auto reference = road(6000, 1.0, 0.5);
  const Played played = play(reference, 5000, [](ReferencePlayer& player, int k) {
    if (k == 1000) player.level(0.25);
    if (k == 1200) player.level(1.0);  // waits for the end of the first change
  });
  expect_one_motion(played);
  EXPECT_EQ(played.levels[999], 1.0);
  EXPECT_EQ(played.levels[1999], 0.25);
  EXPECT_EQ(played.levels[2999], 1.0);
  for (std::size_t k = 3001; k <= 5000; ++k) ASSERT_EQ(played.motions[k].position, reference[k].position) << k;
}

// A level that was asked for before the run holds from its beginning.
TEST(ReferencePlayer, BeginsWithTheLevelAskedFor) {
  const auto reference = road(100, 1.0, 0.02);
  TableReference table(reference);
  ReferencePlayer player(table, h);
  player.level(0.5);
  EXPECT_EQ(player.start()->position, 0.02);
  for (int k = 1; k < 100; ++k) {
    EXPECT_EQ(player.next()->position, 0.02 + 0.5 * (reference[static_cast<std::size_t>(k)].position - 0.02));
  }
  EXPECT_FALSE(player.next());
}

// In the loop, every kind: hold and resume are modes of their own, recorded, and the commands stay within every limit.
TEST(ControlLoop, HoldsAndGoesOn) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    Scene scene(kind, 4000);
    Journey run{scene};
    run.loop.arm();
    run.loop.start();
    run.periods(1000);
    run.loop.hold();
    run.periods(4000);
    EXPECT_EQ(run.loop.mode(), Mode::holding) << name(kind);
    const double there = run.rig.command().position;
    run.periods(100);
    EXPECT_NEAR(run.rig.command().position, there, 1e-5) << name(kind) << ": the car has come to rest";
    run.loop.resume();
    run.periods(10);
    EXPECT_EQ(run.loop.mode(), Mode::running);
    run.periods(10'000);
    EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << name(kind);
    EXPECT_EQ(run.loop.counters().limited_commands, 0U);
    const auto holding = run.rows(Mode::holding);
    EXPECT_EQ(holding.size(), 4100U);
    EXPECT_EQ(holding.front().sample, 1000U) << "samples of the run go on";
  }
}

TEST(ControlLoop, ScalesTheReferenceByTheLevel) {
  Scene scene(RigKind::component_bench, 3000);
  Journey run{scene};
  EXPECT_FALSE(run.loop.level(1.6));
  EXPECT_FALSE(run.loop.level(-0.1));
  EXPECT_FALSE(run.loop.level(std::nan("")));
  EXPECT_TRUE(run.loop.level(0.5));
  run.loop.arm();
  run.loop.start();
  run.periods(1000);
  EXPECT_EQ(run.records.back().level, 0.5);
  EXPECT_EQ(run.rig.command().position, 0.5 * scene.reference[1000].position);
  run.loop.level(1.0);
  run.periods(1001);
  EXPECT_EQ(run.rig.command().position, scene.reference[2001].position);
  EXPECT_EQ(run.records.back().level, 1.0);
}

}  // namespace
