// The two ends of a long recording, read without what is between.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>

#include "firmware/loop/common/mode.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/recording/recording_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace recording_ends_test {
namespace {

using firmware::Recording;
using firmware::RecordingEnds;
using model::Channel;

constexpr double rate = 100.0;  // [Hz]

double value(std::size_t k) { return std::sin(0.1 * static_cast<double>(k)); }

/// Row k is at k / rate; `more` adds columns.
std::string rows(std::size_t count, const std::function<std::string(std::size_t)>& more = {}) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) {
    char row[64];
    std::snprintf(row, sizeof row, "%.2f,%.9f", static_cast<double>(k) / rate, value(k));
    text += row + (more ? more(k) : "") + "\n";
  }
  return text;
}

std::optional<RecordingEnds> ends_of(const std::string& text, double first, double last) {
  const support::TemporaryFolder folder;
  const firmware::RecordingFile file(folder.write("long.csv", text));
  return firmware::read_recording_ends(file.descriptor(), "long.csv", {}, rate, first, last, 0);
}

void expect_rows(const Recording& recording, std::size_t from, std::size_t to) {
  ASSERT_EQ(recording.size(), to - from);
  for (std::size_t k = from; k < to; ++k) {
    ASSERT_NEAR(recording[Channel::z_r][k - from], value(k), 1e-9) << k;
    ASSERT_NEAR(recording.time[k - from] - recording.time.front(), static_cast<double>(k - from) / rate, 1e-9) << k;
  }
}

// Law. Of 100 s the first 20 s and the last 10 s, as the whole reading has them; what is between is not looked at.
TEST(RecordingEnds, AreThoseOfTheWholeRecording) {
  std::string text = "# a comment\nt,z_r [m]\n" + rows(10'000);
  text.replace(text.find("\n50.00,") + 1, 5, "spoil");
  const auto ends = ends_of(text, 20.0, 10.0);
  ASSERT_TRUE(ends);
  expect_rows(ends->first, 0, 2000);
  expect_rows(ends->last, 9000, 10'000);
  EXPECT_NEAR(ends->seconds, 99.99, 1e-9);
  EXPECT_EQ(ends->first.source, "long.csv");
}

// Point. A controller's recording: the first seconds of the run, and its last ones, not those of the way back.
TEST(RecordingEnds, AreThoseOfTheRun) {
  using firmware::Mode;
  const auto mode = [](std::size_t k) {
    return "," + std::to_string(static_cast<int>(k < 500 ? Mode::idle : k < 11'000 ? Mode::running : Mode::safe));
  };
  const std::string text = "# rigtwin recording: SI units\nt,z_r [m],mode,late [s]\n" +
                           rows(12'000, [&](std::size_t k) { return mode(k) + ",0"; });
  const auto ends = ends_of(text, 20.0, 10.0);
  ASSERT_TRUE(ends);
  expect_rows(ends->first, 500, 2500);
  expect_rows(ends->last, 10'000, 11'000);
  EXPECT_EQ(ends->first.time.front(), 0.0);
  EXPECT_NEAR(ends->seconds, 104.99, 1e-9);
}

// Short ones, and those in which something is wrong, are left to the whole reading, which says what.
TEST(RecordingEnds, LeaveOthersToTheWholeReading) {
  const std::string good = "t,z_r [m]\n" + rows(10'000);
  EXPECT_TRUE(ends_of(good, 20.0, 10.0));
  EXPECT_FALSE(ends_of("t,z_r [m]\n" + rows(6000), 20.0, 10.0)) << "with 41 s for the end less than 20 s are left";
  EXPECT_FALSE(ends_of("", 20.0, 10.0));
  EXPECT_FALSE(ends_of(rows(10'000), 20.0, 10.0)) << "no header";
  for (const std::string row : {"\n10.00,", "\n95.00,"}) {
    std::string spoilt = good;
    spoilt.replace(spoilt.find(row) + 1, 5, "spoil");
    EXPECT_FALSE(ends_of(spoilt, 20.0, 10.0)) << row;
  }
  const support::TemporaryFolder folder;
  const firmware::RecordingFile file(folder.write("long.csv", good));
  EXPECT_FALSE(firmware::read_recording_ends(file.descriptor(), "long.csv", {}, rate, 20.0, 10.0, good.size() + 1));
}

}  // namespace
}  // namespace recording_ends_test
