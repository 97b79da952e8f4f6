// Programmes of blocks, and the levels that a replay takes from a recording.
#include "firmware/description/programme.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/reference/programme_reference.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/reference/reference_player.hpp"

namespace {

using firmware::Motion;
using firmware::parse_programme;
using firmware::controller::ProgrammeReference;
using testing::HasSubstr;

constexpr double h = 1e-3;

std::vector<Motion> wave(std::size_t n, double w, double begin) {
  std::vector<Motion> motion(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = h * static_cast<double>(k);
    motion[k] = {begin + 0.01 * std::sin(w * t), 0.01 * w * std::cos(w * t), -0.01 * w * w * std::sin(w * t)};
  }
  return motion;
}

TEST(Programme, ReadsItsBlocks) {
  const auto programme = parse_programme(
      "[[blocks]]\nroad = 'iso8608:A'\nduration = 10\nrepetitions = 3\npause = 2.5\n"
      "[[blocks]]\nroad = 'kerb.csv'\nspeed = 5\nlevel = 0.5\nseed = 7\n",
      "tests/day.toml");
  ASSERT_EQ(programme.blocks.size(), 2U);
  EXPECT_EQ(programme.blocks[0].repetitions, 3);
  EXPECT_EQ(programme.blocks[0].pause, 2.5);
  EXPECT_EQ(programme.blocks[1].road, "tests/kerb.csv") << "beside the programme";
  EXPECT_EQ(programme.blocks[1].level, 0.5);
  EXPECT_EQ(programme.blocks[1].seed, 7U);
  EXPECT_EQ(programme.blocks[1].line, 6U);
}

TEST(Programme, RefusesWithTheLine) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_programme(text, "day.toml"));
    } catch (const firmware::InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string block = "[[blocks]]\nroad = 'iso8608:A'\n";
  EXPECT_EQ(refusal(block), "accepted");
  EXPECT_THAT(refusal(block + "level = 1.6\n"), HasSubstr("day.toml:3: blocks.level = 1.6 does not fit"));
  EXPECT_THAT(refusal(block + "repetitions = 0\n"), HasSubstr("day.toml:3: "));
  EXPECT_THAT(refusal(block + "repetition = 2\n"), HasSubstr("blocks.repetitions"));
  EXPECT_THAT(refusal("[[blocks]]\nlevel = 1\n"), HasSubstr("[blocks] has no 'road'"));
  EXPECT_THAT(refusal("blocks = []\n"), HasSubstr("day.toml:1: blocks is empty"));
  EXPECT_THAT(refusal(""), HasSubstr("no 'blocks'"));
  EXPECT_THAT(refusal("[[blocks\n"), HasSubstr("TOML syntax"));
}

// Law. No joint has a jump: between blocks, between repetitions, into a pause and out of it position, velocity and
// acceleration belong together as elsewhere. Third derivatives are at most 0.01 · 9³ = 7.3 m/s³ and that of the joints
// below 3, so 1 ms changes the acceleration by less than 0.012 m/s².
TEST(ProgrammeReference, JoinsWithoutAJump) {
  const auto first = wave(8000, 7.0, 0.0), second = wave(6000, 9.0, 0.02);
  const std::vector<ProgrammeReference::Block> blocks{{first, 1.0, 2, 1000}, {second, 0.5, 3, 500}};
  ProgrammeReference programme(blocks, h);
  Motion before = *programme.at(0);
  std::uint64_t k = 1;
  for (; const auto there = programme.at(k); ++k) {
    const Motion& now = *there;
    ASSERT_NEAR(now.position, before.position + 0.5 * h * (before.velocity + now.velocity), 1e-9) << k;
    ASSERT_NEAR(now.velocity, before.velocity + 0.5 * h * (before.acceleration + now.acceleration), 2e-6) << k;
    ASSERT_NEAR(now.acceleration, before.acceleration, 0.012) << k;
    before = now;
  }
  EXPECT_EQ(k, programme.samples());
  // Two of 8 s with a joint of 2 s, the pause of 1 s between joints of 2 and 1.5 s, three of 6 s with joints of 1.5 s,
  // and 0.5 s after a last joint.
  EXPECT_EQ(k, 8000U + 6000U + 1000U + 1500U + 3U * 4500U + 500U);
  EXPECT_EQ(before.velocity, 0.0);
}

TEST(ProgrammeReference, PlaysRoadsAtTheirLevelAndStandsInPauses) {
  const auto first = wave(8000, 7.0, 0.0), second = wave(6000, 9.0, 0.02);
  const std::vector<ProgrammeReference::Block> blocks{{first, 1.0, 2, 1000}, {second, 0.5, 1, 0}};
  ProgrammeReference programme(blocks, h);
  EXPECT_EQ(programme.at(5000)->position, first[5000].position) << "to the bit";
  EXPECT_EQ(programme.at(6000 + 3000)->position, first[3000].position);
  const std::uint64_t pause = 6000 + 8000;  // after the joint
  for (const std::uint64_t k : {pause, pause + 999}) {
    EXPECT_EQ(programme.at(k)->position, first.back().position);
    EXPECT_EQ(programme.at(k)->velocity, 0.0);
  }
  const std::uint64_t other = pause + 1000;  // begins with its joint
  EXPECT_EQ(programme.at(other + 3000)->position, 0.02 + 0.5 * (second[3000].position - 0.02));
  EXPECT_EQ(programme.place(0).block, 1U);
  EXPECT_EQ(programme.place(5999).cycle, 1U);
  EXPECT_EQ(programme.place(6000).cycle, 2U);
  EXPECT_EQ(programme.place(pause).block, 1U);
  EXPECT_EQ(programme.place(other).block, 2U);
  EXPECT_EQ(programme.at(5000)->position, first[5000].position) << "from the beginning again";
}

// A look at two repetitions holds every kind of joint of a hundred.
TEST(ProgrammeReference, PlaysFewerRepetitionsForALook) {
  const auto road = wave(8000, 7.0, 0.0);
  const std::vector<ProgrammeReference::Block> blocks{{road, 1.0, 100, 0}};
  EXPECT_EQ(ProgrammeReference(blocks, h).samples(), 99U * 6000U + 8000U);
  EXPECT_EQ(ProgrammeReference(blocks, h, 2).samples(), 6000U + 8000U);
}

// The levels that were asked for are those that a replay finds, in their periods: changes up to 1 and beyond, one that
// waited for another, one that the end of the run cut short, and one before the run.
TEST(LevelChanges, AreFoundInARecording) {
  const auto road = wave(20'000, 7.0, 0.0);
  firmware::TableReference table(road);
  firmware::ReferencePlayer player(table, h);
  player.level(0.9);
  ASSERT_TRUE(player.start());
  std::vector<double> recorded{1.0, 1.0};
  for (int k = 0; k < 9000; ++k) {
    if (k == 10) player.level(0.123457);
    if (k == 2000) player.level(1.5);
    if (k == 2500) player.level(0.7);  // waits until 1377 periods are over
    if (k == 8700) player.level(0.25);
    if (k > 0) {
      ASSERT_TRUE(player.next());
    }
    recorded.push_back(player.level());
  }
  recorded.insert(recorded.end(), 500, recorded.back());
  const auto changes = firmware::controller::level_changes(recorded, h);
  ASSERT_EQ(changes.size(), 5U);
  EXPECT_EQ(changes[0].row, 2U);
  EXPECT_EQ(changes[0].level, 0.9);
  EXPECT_EQ(changes[1].row, 12U);
  EXPECT_EQ(changes[1].level, 0.123457);
  EXPECT_EQ(changes[2].row, 2002U);
  EXPECT_EQ(changes[2].level, 1.5);
  EXPECT_EQ(changes[3].row, 2002U + 1377U);
  EXPECT_EQ(changes[3].level, 0.7);
  EXPECT_EQ(changes[4].row, 8702U);
  EXPECT_EQ(changes[4].level, 0.25);
}

}  // namespace
