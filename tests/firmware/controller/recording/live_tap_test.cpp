#include "firmware/controller/recording/live_tap.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace {

using firmware::Mode;
using firmware::Reason;
using firmware::Record;
using firmware::controller::LiveTap;

std::vector<std::uint64_t> periods_in(LiveTap& tap) {
  std::vector<std::uint64_t> periods;
  for (auto record = tap.pop(); record; record = tap.pop()) periods.push_back(record->period);
  return periods;
}

TEST(LiveTap, HandsOnOneRecordOfN) {
  LiveTap tap(4);
  for (std::uint64_t k = 0; k < 13; ++k) {
    Record record;
    record.period = k;
    tap.offer(record);
  }
  EXPECT_EQ(periods_in(tap), (std::vector<std::uint64_t>{0, 4, 8, 12}));
  EXPECT_EQ(tap.lost(), 0U);
}

// The period that trips may be any one: a decimation must not hide for how long the rig has been in safe, nor why.
TEST(LiveTap, HandsOnEachChangeOfStateAndReason) {
  LiveTap tap(1000);
  for (std::uint64_t k = 0; k < 50; ++k) {
    Record record;
    record.period = k;
    record.mode = k < 7 ? Mode::running : Mode::safe;
    if (k >= 6) record.trip.reason = Reason::force;
    if (k >= 9) record.second = Reason::stop_button;
    tap.offer(record);
  }
  EXPECT_EQ(periods_in(tap), (std::vector<std::uint64_t>{0, 6, 7, 9}));
}

TEST(LiveTap, CountsWhatItHasNoRoomFor) {
  LiveTap tap(1, 8);
  for (std::uint64_t k = 0; k < 20; ++k) {
    Record record;
    record.period = k;
    tap.offer(record);
  }
  EXPECT_EQ(tap.lost(), 12U);
  EXPECT_EQ(periods_in(tap), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  tap.offer(Record{});
  EXPECT_TRUE(tap.pop().has_value()) << "there is room again";
  EXPECT_EQ(tap.lost(), 12U);
}

}  // namespace
