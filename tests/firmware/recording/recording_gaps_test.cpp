// Recordings that rig_controller wrote while it was late now and then: read onto an even grid, what is not known
// marked.
#include "firmware/recording/recording_gaps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"

namespace {

using firmware::parse_recording_csv;
using firmware::Recording;
using model::Channel;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// At 1 kHz; the last column is how late each period began.
std::string controller_rows(const std::string& rows) {
  return "# rigtwin recording: SI units\nt,z_r [m],duct_1,late [s],age [s]\n" + rows;
}

Recording read(const std::string& rows) { return parse_recording_csv(controller_rows(rows), "REC.csv", {}, 1000.0); }

std::string refusal(const std::string& rows) {
  try {
    static_cast<void>(read(rows));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return {};
}

// Jitter below a quarter of a period does not move the grid: nothing is filled, nothing said.
TEST(RecordingGaps, LeavesAnEvenRecordingAlone) {
  const Recording recording = read("0,1,0,0,0\n0.001,2,0,2e-4,0\n0.002,4,0,1e-5,0\n");
  EXPECT_THAT(recording[Channel::z_r], ElementsAre(1, 2, 4));
  EXPECT_THAT(recording.filled, IsEmpty());
  EXPECT_EQ(recording.remark, "");
}

// A period that began 2.3 ms late ends a step of 3.3 ms: two rows were never recorded. Between 2 and 8 a straight line
// passes 4 and 6; the duct stands as it stood. The rest, 0.3 ms, moves all that follows alike.
TEST(RecordingGaps, FillsWhatALatePeriodLeftOut) {
  const Recording recording = read("0,1,0,0,0\n0.001,2,0,0,0\n0.0043,8,1,0.0023,0\n0.0053,9,1,0,0\n");
  EXPECT_THAT(recording[Channel::z_r], ElementsAre(1, 2, 4, 6, 8, 9));
  EXPECT_THAT(recording.ducts[0], ElementsAre(0, 0, 0, 0, 1, 1));
  EXPECT_THAT(recording.filled, ElementsAre(false, false, true, true, false, false));
  ASSERT_EQ(recording.time.size(), 6U);
  EXPECT_DOUBLE_EQ(recording.time[5], 0.005);
  EXPECT_EQ(
      recording.remark,
      "REC.csv: 1 period of 4 began late, by 2.3 ms in total and 2.3 ms at most; 2 rows are missing or incomplete "
      "and not used");
}

// Less than half a period late: no row is missing, but the reader of the result is told.
TEST(RecordingGaps, CountsLatePeriodsThatLeaveNothingOut) {
  const Recording recording =
      read("0,1,0,0,0\n0.0013,2,0,3e-4,0\n0.0027,4,0,4e-4,0\n0.0037,5,0,0,0\n0.0047,6,0,0,0\n0.0057,7,0,0,0\n");
  EXPECT_THAT(recording[Channel::z_r], ElementsAre(1, 2, 4, 5, 6, 7));
  EXPECT_EQ(recording.remark, "REC.csv: 2 periods of 6 began late, by 0.7 ms in total and 0.4 ms at most");
}

// Rows that the disk was too slow for leave whole steps; a sample that did not come is on record as nan.
TEST(RecordingGaps, FillsLostRowsAndLostSamples) {
  const Recording recording = read("0,1,0,0,0\n0.002,3,0,0,0\n0.003,nan,0,0,0\n0.004,5,0,0,0\n0.005,nan,0,0,0\n");
  EXPECT_THAT(recording[Channel::z_r], ElementsAre(1, 2, 3, 4, 5, 5));
  EXPECT_THAT(recording.filled, ElementsAre(false, true, false, true, false, true));
  EXPECT_EQ(recording.remark, "REC.csv: 3 rows are missing or incomplete and not used");
}

// The power went while a row was being written: 0.00 might have become 0.0031.
TEST(RecordingGaps, LeavesATornLastRowOut) {
  const Recording recording = read("0,1,0,0,0\n0.001,2,0,0,0\n0.002,4,0,0,0\n0.00");
  EXPECT_EQ(recording.size(), 3U);
  EXPECT_EQ(recording.remark, "REC.csv: the last row is torn");
}

// What `late` does not explain is wrong as in any recording; what is longer than a straight line may be is refused too.
TEST(RecordingGaps, RefusesWhatTheControllerDoesNotExplain) {
  EXPECT_EQ(
      refusal("0,1,0,0,0\n0.001,2,0,0,0\n0.0026,3,0,5e-4,0\n0.0036,3,0,0,0\n0.0046,3,0,0,0\n"),
      "REC.csv:5: gap in time: 0.0026 follows 0.001, expected whole steps of 0.001 s plus the value in column late");
  EXPECT_EQ(refusal("0,1,0,0,0\n0.001,2,0,0,0\n0.0005,3,0,5e-4,0\n"),
            "REC.csv:5: time runs backwards: 5e-04 follows 0.001, expected a later time in each sample");
  EXPECT_EQ(
      refusal("0,1,0,0,0\n0.001,2,0,0,0\n0.0015,3,0,5e-4,0\n0.0025,3,0,0,0\n0.0035,3,0,0,0\n"),
      "REC.csv:5: gap in time: 0.0015 follows 0.001, expected whole steps of 0.001 s plus the value in column late");
  EXPECT_EQ(refusal("0,1,0,0,0\n0.001,2,0,0,0\n0.032,3,0,0.03,0\n0.033,3,0,0,0\n"),
            "REC.csv:5: a gap of 31 ms, expected gaps up to 20 ms, or the parts before and after as two recordings");
  EXPECT_EQ(refusal("0,nan,0,0,0\n0.001,nan,0,0,0\n0.002,nan,0,0,0\n"),
            "REC.csv:3: z_r: nothing was measured for 3 ms, expected samples that are missing for 20 ms at most");
  EXPECT_NE(refusal("0,inf,0,0,0\n0.001,2,0,0,0\n0.002,2,0,0,0\n"), "");
  EXPECT_NE(refusal("nan,1,0,0,0\n0.001,2,0,0,0\n0.002,2,0,0,0\n"), "");
}

// Anybody else's column of that name is one that is not understood: a gap is a gap, NaN is no sample.
TEST(RecordingGaps, BelievesNobodyElse) {
  for (const char* rows : {"0,1,0\n0.001,2,0\n0.0043,8,0.0023\n0.0053,9,0\n", "0,1,0\n0.001,nan,0\n0.002,8,0\n"}) {
    EXPECT_THROW(
        static_cast<void>(parse_recording_csv(std::string("t,z_r [m],late [s]\n") + rows, "REC.csv", {}, 1000.0)),
        firmware::InputError);
  }
}

// 12 s at 100 Hz, z_r = k; a row for which `text` gives something else, or "" for none.
template <class Text>
std::string ramp(const Text& text) {
  std::string csv = "t,z_r,F_w\n";
  for (int k = 0; k < 1200; ++k) {
    const std::string row = text(k);
    if (!row.empty()) csv += row + "\n";
  }
  return csv;
}
std::string whole_row(int k) { return std::to_string(0.01 * k).substr(0, 6) + "," + std::to_string(k) + ",1"; }

std::vector<Recording> parts(const std::string& csv) {
  return firmware::pieces_of(parse_recording_csv(csv, "REC.csv", {}, 100.0, firmware::Missing::mark));
}

// A recording of anybody: a NaN and a missing row are bridged by a straight line, marked and said.
TEST(RecordingGaps, MarksSingleSamplesOfAnyRecording) {
  const auto one = parts(ramp([](int k) {
    if (k == 300) return std::string("3.00,nan,1");
    return k == 500 ? std::string() : whole_row(k);
  }));
  ASSERT_EQ(one.size(), 1U);
  ASSERT_EQ(one[0].size(), 1200U);
  EXPECT_EQ(one[0][Channel::z_r][300], 300.0);
  EXPECT_EQ(one[0][Channel::z_r][500], 500.0);
  EXPECT_EQ(std::count(one[0].filled.begin(), one[0].filled.end(), true), 2);
  EXPECT_TRUE(one[0].filled[300] && one[0].filled[500]);
  EXPECT_EQ(one[0].remark, "REC.csv: 2 rows are missing or incomplete and not used, the first at line 302");
}

// A gap of half a second is not bridged: before and after it are recordings of their own, and the marked sample stays
// where it was.
TEST(RecordingGaps, PartsARecordingAtALongGap) {
  const auto two = parts(ramp([](int k) {
    if (k == 700) return std::string("7.00,700,nan");
    return k >= 450 && k < 500 ? std::string() : whole_row(k);
  }));
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].size(), 450U);
  EXPECT_EQ(two[0][Channel::z_r].back(), 449.0);
  EXPECT_THAT(two[0].filled, IsEmpty());
  EXPECT_EQ(two[1].size(), 700U);
  EXPECT_EQ(two[1][Channel::z_r].front(), 500.0);
  EXPECT_NEAR(two[1].time.front(), 5.0, 1e-9);
  EXPECT_TRUE(two[1].filled[200]);
  EXPECT_EQ(two[1].source, "REC.csv from 5 s");
  EXPECT_EQ(two[0].remark,
            "REC.csv: 51 rows are missing or incomplete and not used, the first at line 452; 1 gap beyond 20 ms, 2 "
            "parts between them used, 11.5 "
            "of 12 s");
}

// A part of 1 s is too short to be used.
TEST(RecordingGaps, LeavesShortPartsOut) {
  const auto one = parts(ramp([](int k) { return k >= 100 && k < 150 ? std::string() : whole_row(k); }));
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0][Channel::z_r].front(), 150.0);
}

// Where every tenth sample is missing, or an eighth of the record in one gap, nothing is analysed; the line of the
// first missing row is said. An infinite value is none that is missing.
TEST(RecordingGaps, RefusesWhereTooMuchIsMissing) {
  const auto refused = [](const std::string& csv) -> std::string {
    try {
      static_cast<void>(parts(csv));
    } catch (const firmware::InputError& error) {
      return error.what();
    }
    return {};
  };
  const std::string expected =
      " of 1200 rows are missing or incomplete, the first one here, expected at most 5 %, and 10 % "
      "with gaps beyond 20 ms";
  EXPECT_EQ(refused(ramp([](int k) { return k % 10 == 7 ? std::string() : whole_row(k); })),
            "REC.csv:9: 120" + expected);
  EXPECT_EQ(refused(ramp([](int k) { return k >= 600 && k < 750 ? std::string() : whole_row(k); })),
            "REC.csv:602: 150" + expected);
  EXPECT_EQ(refused(ramp([](int k) { return k == 10 ? std::string("0.10,inf,1") : whole_row(k); })),
            "REC.csv:12: z_r is inf, expected a finite number");
}

}  // namespace
