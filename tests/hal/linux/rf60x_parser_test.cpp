#include "hal/linux/rf60x_parser.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "tests/support/without_heap.hpp"

namespace {

using hal::Time;
using hal::linux::Rf60xParser;

/// The four bytes that a sensor sends for D.
std::vector<std::uint8_t> frame(unsigned d, unsigned count, bool renewed = true) {
  std::vector<std::uint8_t> bytes;
  for (unsigned i = 0; i < 4; ++i) {
    bytes.push_back(
        static_cast<std::uint8_t>(0x80U | (renewed ? 0x40U : 0U) | (count & 3U) << 4U | (d >> (4U * i) & 0xfU)));
  }
  return bytes;
}

struct Line {
  Rf60xParser parser{};
  Time now{};
  std::vector<Rf60xParser::Frame> frames{};

  void send(const std::vector<std::uint8_t>& bytes, Time each = hal::microseconds(12)) {
    for (const std::uint8_t byte : bytes) {
      if (const auto result = parser.take(byte, now)) frames.push_back(*result);
      now += each;
    }
  }
};

// The manual's own example of a result: 677 = 02A5h; the first frame tells where the second begins.
TEST(Rf60xParser, ReadsTheExampleOfTheManual) {
  Line line;
  line.send(frame(0, 0));
  line.send({0xD5, 0xDA, 0xD2, 0xD0});  // 02A5h, CNT 1, renewed
  ASSERT_EQ(line.frames.size(), 1U);
  EXPECT_EQ(line.frames[0].counts, 677);
  EXPECT_TRUE(line.frames[0].renewed);
  EXPECT_EQ(line.frames[0].begun, hal::microseconds(48)) << "the stamp is that of the first byte";
}

// Every value, every number of a frame, nothing lost between.
TEST(Rf60xParser, ReadsEveryResult) {
  Line line;
  line.send(frame(1, 3));
  for (unsigned d = 0; d <= Rf60xParser::full_scale; ++d) line.send(frame(d, d, d % 3 != 0));
  ASSERT_EQ(line.frames.size(), 0x4001U);
  for (unsigned d = 0; d <= Rf60xParser::full_scale; ++d) {
    ASSERT_EQ(line.frames[d].counts, d);
    ASSERT_EQ(line.frames[d].renewed, d % 3 != 0);
  }
  const auto& counts = line.parser.counts();
  EXPECT_EQ(counts.frames, 0x4001U);
  EXPECT_EQ(counts.not_renewed, 0x4001U / 3 + 1);
  EXPECT_EQ(counts.torn + counts.garbage + counts.lost + counts.out_of_range, 0U);
}

// Nobody knows where in a frame the first byte is: from each place on, the first whole frame after it is right.
TEST(Rf60xParser, JoinsAStreamAnywhere) {
  std::vector<std::uint8_t> stream;
  for (unsigned k = 0; k < 5; ++k) {
    for (const auto byte : frame(0x1234, k)) stream.push_back(byte);
  }
  for (std::size_t skip = 0; skip < 4; ++skip) {
    Line line;
    line.send({stream.begin() + static_cast<std::ptrdiff_t>(skip), stream.end()});
    ASSERT_EQ(line.frames.size(), 4U) << skip;
    for (const auto& f : line.frames) EXPECT_EQ(f.counts, 0x1234);
    EXPECT_EQ(line.parser.counts().torn, 0U) << skip;
  }
}

// Fault. A byte that is missing, doubled or foreign costs its own frame and is counted; never a wrong distance.
TEST(Rf60xParser, DropsWhatIsTornAndFindsBack) {
  enum class Damage { lost, doubled, foreign, flag };
  for (const Damage damage : {Damage::lost, Damage::doubled, Damage::foreign, Damage::flag}) {
    for (std::ptrdiff_t at = 0; at < 4; ++at) {
      Line line;
      line.send(frame(7, 0));
      line.send(frame(0x2345, 1));
      auto broken = frame(0x3abc, 2);
      const auto place = broken.begin() + at;
      if (damage == Damage::lost) broken.erase(place);
      if (damage == Damage::doubled) broken.insert(place, *place);
      if (damage == Damage::foreign) *place = 0x31;
      if (damage == Damage::flag) *place = static_cast<std::uint8_t>(*place ^ 0x40U);
      line.send(broken);
      for (unsigned k = 3; k < 6; ++k) line.send(frame(0x2345, k));
      ASSERT_GE(line.frames.size(), 3U) << at;
      for (const auto& f : line.frames) EXPECT_TRUE(f.counts == 0x2345 || damage == Damage::doubled) << at;
      const auto& counts = line.parser.counts();
      EXPECT_GE(counts.torn + counts.garbage, 1U) << at;
      EXPECT_EQ(line.frames.back().counts, 0x2345);
    }
  }
}

TEST(Rf60xParser, CountsFramesThatNeverCame) {
  Line line;
  for (const unsigned k : {0U, 1U, 2U, 4U, 7U}) line.send(frame(5, k));
  EXPECT_EQ(line.parser.counts().lost, 1U + 2U);
}

TEST(Rf60xParser, RefusesMoreThanFullScale) {
  Line line;
  line.send(frame(0, 0));
  line.send(frame(0x4000, 1));
  line.send(frame(0x4001, 2));
  ASSERT_EQ(line.frames.size(), 1U);
  EXPECT_EQ(line.frames[0].counts, 0x4000);
  EXPECT_EQ(line.parser.counts().out_of_range, 1U);
}

// A cable pulled in the middle of a frame and put back four frames later: same CNT, but the two halves are none.
TEST(Rf60xParser, JoinsNoHalvesAcrossAPause) {
  Line line;
  line.send(frame(0x1111, 0));
  line.send({0xD1, 0xD1});
  line.now += hal::milliseconds(20);
  line.send({0xD2, 0xD2});
  line.send(frame(0x1111, 2));
  line.send(frame(0x1111, 3));
  for (const auto& f : line.frames) EXPECT_EQ(f.counts, 0x1111);
  EXPECT_EQ(line.frames.size(), 2U);
  EXPECT_EQ(line.parser.counts().torn, 1U);
}

// Any bytes at all: no frame without its four bytes, and the parser is in step again after two good frames.
TEST(Rf60xParser, SurvivesNoise) {
  std::mt19937 random(7);
  Line line;
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint8_t> noise;
    for (auto n = random() % 12; n > 0; --n) noise.push_back(static_cast<std::uint8_t>(random()));
    line.send(noise);
    const auto k = static_cast<unsigned>(random());
    line.send(frame(1, k));
    line.send(frame(2, k + 1));
    const std::size_t before = line.frames.size();
    line.send(frame(3, k + 2));
    ASSERT_EQ(line.frames.size(), before + 1) << round;
    ASSERT_EQ(line.frames.back().counts, 3) << round;
  }
}

TEST(Rf60xParser, TakesNoHeap) {
  Rf60xParser parser;
  const auto bytes = frame(9, 1);
  support::without_heap([&] {
    for (const auto byte : bytes) static_cast<void>(parser.take(byte, {}));
  });
}

}  // namespace
