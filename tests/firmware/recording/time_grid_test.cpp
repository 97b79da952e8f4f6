// Recordings at a rate of their own, with stamps as a logger prints them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording_csv.hpp"

namespace {

using firmware::Missing;
using firmware::parse_recording_csv;
using firmware::Recording;
using model::Channel;

/// z_r = row number, at `rate`, with the stamps in whole milliseconds; `lost`: this row is missing.
std::string in_milliseconds(double rate, int count, int lost = -1) {
  std::string text = "t,z_r\n";
  for (int k = 0; k < count; ++k) {
    if (k == lost) continue;
    char row[64];
    std::snprintf(row, sizeof row, "%.3f,%d\n", 5.0 + std::round(1e3 * k / rate) * 1e-3, k);
    text += row;
  }
  return text;
}

// Law. Stamps in whole milliseconds at 97 Hz step by 10 and 11: all of them together show the grid to 1e-6, and a row
// that was lost is marked where it was.
TEST(TimeGrid, IsRecoveredFromRoundedStamps) {
  const Recording whole = parse_recording_csv(in_milliseconds(97.0, 2000), "REC.csv", {}, 1000.0, Missing::mark);
  ASSERT_EQ(whole.size(), 2000U);
  EXPECT_NEAR(whole.sample_period * 97.0, 1.0, 1e-6);
  EXPECT_TRUE(whole.filled.empty());
  EXPECT_NE(whole.remark.find("the times are rounded to 1 ms; the rows lie on a grid of 97 Hz, up to 0.49"),
            std::string::npos)
      << whole.remark;

  const Recording lost = parse_recording_csv(in_milliseconds(97.0, 2000, 700), "REC.csv", {}, 1000.0, Missing::mark);
  ASSERT_EQ(lost.size(), 2000U);
  EXPECT_NEAR(lost.sample_period * 97.0, 1.0, 1e-6);
  ASSERT_EQ(lost.filled.size(), 2000U);
  EXPECT_TRUE(lost.filled[700]);
  EXPECT_NEAR(lost[Channel::z_r][700], 700.0, 1e-9);
  EXPECT_NE(lost.remark.find("1 row is missing"), std::string::npos) << lost.remark;
}

// Point. At 333 Hz one step in 333 is another: that is no gap.
TEST(TimeGrid, IsRecoveredWhereFewStampsShowIt) {
  const Recording recording = parse_recording_csv(in_milliseconds(333.0, 2000), "REC.csv", {}, 1000.0, Missing::mark);
  ASSERT_EQ(recording.size(), 2000U);
  EXPECT_NEAR(recording.sample_period * 333.0, 1.0, 3e-5);
  EXPECT_TRUE(recording.filled.empty());
}

// Point. At 512 Hz a millisecond is half a period: steps of one and two places are one period, of three and four two.
TEST(TimeGrid, IsRecoveredFromStampsOfHalfAPeriod) {
  for (const int lost : {-1, 700, 757}) {
    const Recording recording =
        parse_recording_csv(in_milliseconds(512.0, 6000, lost), "REC.csv", {}, 1000.0, Missing::mark);
    ASSERT_EQ(recording.size(), 6000U) << lost;
    EXPECT_NEAR(recording.sample_period * 512.0, 1.0, 1e-6);
    EXPECT_EQ(recording.lost_rows, lost < 0 ? 0U : 1U);
    EXPECT_NEAR(recording[Channel::z_r][5000], 5000.0, 1e-9);
    if (lost > 0) {
      EXPECT_TRUE(recording.filled[static_cast<std::size_t>(lost)]);
    }
  }
}

// Point. A clock that is off by 50 ppm is the rig's clock; a rate of its own is the recording's rate. Where every
// sample counts (a replay) the rig's rate is still asked for.
TEST(TimeGrid, TakesTheRecordingsOwnRate) {
  const auto period = [](double rate, std::optional<double> usual, Missing missing) {
    std::string text = "t,z_r\n";
    for (int k = 0; k < 500; ++k) text += std::to_string(k / rate) + "0,1\n";
    return parse_recording_csv(text, "REC.csv", {}, usual, missing).sample_period;
  };
  EXPECT_EQ(period(1000.0, 1000.0, Missing::mark), 1e-3);
  EXPECT_EQ(period(500.0, 1000.0, Missing::mark), 2e-3);
  EXPECT_EQ(period(10e3, 1000.0, Missing::mark), 1e-4);
  EXPECT_THROW((void)period(500.0, 1000.0, Missing::refuse), firmware::InputError);
}

}  // namespace
