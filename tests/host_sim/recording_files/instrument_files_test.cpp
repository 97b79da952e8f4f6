// Files as instruments write them: each of a set of shapes that once came out wrong has its right values, or the
// message that helps its user on. The files are read in place; most hold 200 samples at 1000 Hz of
//
//   x = 0.010 m · sin(2π·3t),   F = 500 N · sin(2π·5t) + 20 N · cos(2π·31t).
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/recording_files/import.hpp"
#include "tests/support/rig_texts.hpp"

namespace instrument_files_test {
namespace {

using firmware::ChannelMap;
using model::Channel;

constexpr double pi = 3.14159265358979323846;
double stroke_of(double t) { return 0.010 * std::sin(2.0 * pi * 3.0 * t); }
double force_of(double t) { return 500.0 * std::sin(2.0 * pi * 5.0 * t) + 20.0 * std::cos(2.0 * pi * 31.0 * t); }

std::filesystem::path file_of(std::string_view name) { return support::shared / "files" / name; }

host_sim::Import import_of(std::string_view name, const ChannelMap& map = {}, std::optional<double> rate = std::nullopt,
                           std::optional<model::RigKind> kind = std::nullopt,
                           const host_sim::ImportChoices& choices = {}) {
  return host_sim::import_file(file_of(name), {map, rate, kind}, choices);
}

// The tolerances are half of the last printed digit, times the slope of what a coarse stamp moves.
struct Expected {
  std::string_view file;
  std::size_t rows = 200;
  double step = 1e-3;  // [s] between rows
  bool stroke = true, force = true;
  double stretch = 1.0;  // the signals' time runs at 1 ms a row whatever the clock says: step ÷ 1 ms
  double stroke_tolerance = 0.6e-8, force_tolerance = 0.6e-4;
};

class SoundFile : public testing::TestWithParam<Expected> {};

TEST_P(SoundFile, HasItsValues) {
  const Expected& expected = GetParam();
  if (!std::filesystem::exists(file_of(expected.file))) GTEST_SKIP() << file_of(expected.file) << " is missing";
  const host_sim::Import import = import_of(expected.file);
  const firmware::Recording& recording = import.recording;
  ASSERT_EQ(recording.size(), expected.rows);
  ASSERT_EQ(recording.has(Channel::x_act), expected.stroke);
  ASSERT_EQ(recording.has(Channel::F), expected.force);
  for (std::size_t k = 0; k < recording.size(); ++k) {
    const double since = recording.time[k] - recording.time[0];
    // A stamp of a spreadsheet's days is 0.6 µs coarse; the rows of others are exact.
    ASSERT_NEAR(since, expected.step * static_cast<double>(k), 2e-6) << k;
    const double t = 1e-3 * static_cast<double>(k) * expected.stretch;
    if (expected.stroke && !std::isnan(recording[Channel::x_act][k])) {
      ASSERT_NEAR(recording[Channel::x_act][k], stroke_of(t), expected.stroke_tolerance) << k;
    }
    if (expected.force && !std::isnan(recording[Channel::F][k])) {
      ASSERT_NEAR(recording[Channel::F][k], force_of(t), expected.force_tolerance) << k;
    }
  }
}

// Linear interpolation of a sine between samples 10 ms apart errs by (ω h)²/8 of it: 4.4e-5 m of the stroke at 3 Hz; of
// the force 6.2 N at 5 Hz and 9.5 N at 31 Hz.
constexpr double between_strokes = 4.6e-5, between_forces = 16.0;
INSTANTIATE_TEST_SUITE_P(
    Of, SoundFile,
    testing::Values(
        Expected{.file = "two_seg_restart.lvm"}, Expected{.file = "units_unknown.csv", .force_tolerance = 0.051},
        Expected{.file = "torque.csv", .stroke = false, .force_tolerance = 0.6e-3}, Expected{.file = "pre1.csv"},
        Expected{.file = "pre2.csv"}, Expected{.file = "excel_serial.csv"},
        Expected{.file = "epoch_ms_10Hz.csv", .step = 0.1}, Expected{.file = "badwords2.csv"},
        Expected{.file = "header_commas_unquoted.csv", .stroke_tolerance = 0.6e-7}, Expected{.file = "catman_rows.txt"},
        Expected{.file = "cell_units.csv"}, Expected{.file = "matlab_duration.csv"},
        Expected{.file = "min_max_rows.csv"}, Expected{.file = "clock_mmss.csv", .step = 0.05},
        Expected{.file = "clock_hms_elapsed.csv", .step = 0.05},
        Expected{.file = "clock_12h_ampm_dots.csv", .step = 0.01}, Expected{.file = "dup_pairs.csv"},
        Expected{.file = "one_column_rate.txt", .stroke = false},
        Expected{.file = "scale_loop.tdms", .force_tolerance = 0.026}, Expected{.file = "rate_property.tdms"},
        Expected{.file = "netcdf_fill.nc", .stroke = false}, Expected{.file = "matrix_attr.h5"},
        Expected{.file = "v4.mat"}, Expected{.file = "v73p.mat"}, Expected{.file = "ws_test_string_v7.mat"},
        Expected{.file = "catman.mat"}, Expected{.file = "testlab.mat"},
        Expected{.file = "different_len.mat", .force = false}, Expected{.file = "odd_pad.uff", .rows = 199},
        Expected{.file = "odd_pad_single.uff", .rows = 199, .stroke_tolerance = 0.6e-7, .force_tolerance = 0.6e-2},
        Expected{.file = "multirate_cells.csv", .rows = 191, .stroke_tolerance = between_strokes},
        Expected{.file = "racecapture.csv", .rows = 191, .force_tolerance = between_forces},
        Expected{.file = "two_time_columns.csv", .rows = 191, .force_tolerance = between_forces}),
    [](const auto& shape) {
      std::string name(shape.param.file);
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
      return name;
    });

#define NEEDS(file) \
  if (!std::filesystem::exists(file_of(file))) GTEST_SKIP() << file_of(file) << " is missing"

// Whole milliseconds at 1024 Hz: the grid that all stamps together show.
TEST(InstrumentFiles, StampsCoarserThanThePeriodLieOnTheirGrid) {
  NEEDS("ms1024.csv");
  for (const auto& [file, rows] : {std::pair{"ms1024.csv", 3000U}, std::pair{"round_1024.csv", 200U}}) {
    const host_sim::Import import = import_of(file);
    ASSERT_EQ(import.recording.size(), rows);
    for (std::size_t k = 0; k < rows; ++k)
      ASSERT_NEAR(import.recording.time[k], static_cast<double>(k) / 1024.0, 1e-9) << file << k;
  }
}

// Zeros for 2.2 s leave the decimal sign open; a thousands separator shows beside whole numbers.
TEST(InstrumentFiles, TheDecimalSignIsFoundInTheWholeColumn) {
  NEEDS("idle_semicolon_point.csv");
  const host_sim::Import idle = import_of("idle_semicolon_point.csv");
  ASSERT_EQ(idle.recording.size(), 2600U);
  EXPECT_NEAR(idle.recording[Channel::x_act][2201], 0.1e-3, 1e-12);
  EXPECT_NEAR(idle.recording[Channel::F][2202], 280.0, 1e-9);
  double largest = 0.0;
  for (const double x : idle.recording[Channel::x_act]) largest = std::max(largest, std::abs(x));
  EXPECT_LT(largest, 0.0101);
  const host_sim::Import thousands = import_of("thousands_int.csv");
  EXPECT_EQ(thousands.recording[Channel::F][5], 895.0);
  EXPECT_EQ(thousands.recording[Channel::F][6], 1015.0);
  EXPECT_NEAR(thousands.recording[Channel::x_act][6], 1.129, 1e-12);
}

// Below the second header the force is in kN.
TEST(InstrumentFiles, ASecondHeaderGovernsTheRowsBelowIt) {
  NEEDS("concat_units.csv");
  const host_sim::Import import = import_of("concat_units.csv");
  ASSERT_EQ(import.recording.size(), 400U);
  for (std::size_t k = 0; k < 200; ++k)
    ASSERT_NEAR(import.recording[Channel::F][200 + k], import.recording[Channel::F][k], 0.6e-3) << k;
}

// A block of 51 rows every ten seconds; "Points: 51" is none of them.
TEST(InstrumentFiles, CyclicBlocksAreRowsAlone) {
  NEEDS("mts_cyclic_51_10.dat");
  const host_sim::Import import = import_of("mts_cyclic_51_10.dat");
  ASSERT_EQ(import.recording.size(), 510U);
  for (std::size_t k = 0; k < 510; ++k) {
    const std::size_t in_block = k % 51;
    ASSERT_NEAR(import.recording.time[k], 10.0 * static_cast<double>(k / 51) + static_cast<double>(in_block) / 512.0,
                1e-6);
    ASSERT_NEAR(import.recording[Channel::x_act][k], stroke_of(static_cast<double>(in_block) / 512.0), 2e-7) << k;
  }
}

TEST(InstrumentFiles, TheRateOfACommentCountsBeforeTheRigs) {
  NEEDS("imu_rate_in_comment.csv");
  const host_sim::Import import = import_of("imu_rate_in_comment.csv", {{"zdd_b", {"a_z", 9.80665, 0.0}}}, 1000.0);
  EXPECT_NEAR(import.recording.time[1], 0.5e-3, 1e-12);
}

TEST(InstrumentFiles, UnitsOfAnLvmSegmentBelongToItsChannels) {
  NEEDS("lvm_units_volts.lvm");
  const host_sim::Import import = import_of("lvm_units_volts.lvm", {{"zdd_b", {"Acceleration", std::nullopt, 0.0}}},
                                            std::nullopt, model::RigKind::quarter_car);
  EXPECT_NEAR(import.recording[Channel::zdd_b][0], 0.532608 * 9.80665, 1e-9);
  EXPECT_NEAR(import.recording.time[1], 1.953125e-5, 1e-12);
  const host_sim::Import without_x =
      import_of("lvm_no_x_column.lvm", {{"zdd_b", {"Response (Trigger)", std::nullopt, 0.0}}});
  EXPECT_EQ(without_x.recording.size(), 10U);
  EXPECT_NEAR(without_x.recording.time[9], 9.0 / 25600.0, 1e-12);
}

TEST(InstrumentFiles, VoltsBesideNewtonsAreNoRival) {
  NEEDS("volts_beside_newtons.csv");
  const host_sim::Import import = import_of("volts_beside_newtons.csv");
  EXPECT_NEAR(import.recording[Channel::F][1], 3.99973, 1e-9);
  EXPECT_NEAR(import.recording[Channel::x_act][0], 0.01, 1e-12);
}

TEST(InstrumentFiles, TheSprungMassHasAnAcceleration) {
  NEEDS("acc_s.csv");
  const host_sim::Import import =
      import_of("acc_s.csv", {{"zdd_b", {"acc_s", std::nullopt, 0.0}}}, 1000.0, model::RigKind::quarter_car);
  EXPECT_NEAR(import.recording[Channel::zdd_b][1], 0.70654, 1e-12);
}

// Of the chunk that was cut off each channel has what is there.
TEST(InstrumentFiles, ACutChunkKeepsItsBeginning) {
  NEEDS("partial_contig.tdms");
  const host_sim::Import import = import_of("partial_contig.tdms");
  EXPECT_GE(import.recording.size(), 170U);
  EXPECT_NEAR(import.recording[Channel::x_act][169], stroke_of(0.169), 1e-9);
}

// Two time vectors, 50 ms apart: the force is read at its own.
TEST(InstrumentFiles, EveryTimeVectorGovernsItsOwn) {
  NEEDS("two_times.mat");
  const host_sim::Import import = import_of("two_times.mat");
  ASSERT_EQ(import.recording.size(), 150U);
  EXPECT_NEAR(import.recording.time[0], 0.05, 1e-9);
  EXPECT_NEAR(import.recording[Channel::x_act][0], stroke_of(0.05), 1e-9);
  EXPECT_NEAR(import.recording[Channel::F][0], force_of(0.0), 1e-6);
}

TEST(InstrumentFiles, GroupsAreChosenByTheirName) {
  NEEDS("two_groups.tdms");
  host_sim::ImportChoices choices;
  choices.maps = {"x_act=Run 2/Weg", "F=Run 2/Kraft"};
  const host_sim::Import import = import_of("two_groups.tdms", {}, std::nullopt, std::nullopt, choices);
  EXPECT_TRUE(import.recording.has(Channel::F));
  const host_sim::Import by_rig = import_of("two_groups.tdms", {{"x_act", {"Run 1/Weg", std::nullopt, 0.0}}});
  EXPECT_NEAR(by_rig.recording[Channel::x_act][1], stroke_of(1e-3), 1e-9);
}

TEST(InstrumentFiles, MissingTimesCanBeGiven) {
  NEEDS("no_time.tdms");
  host_sim::ImportChoices choices;
  choices.rate = 1000.0;
  const host_sim::Import tdms = import_of("no_time.tdms", {}, std::nullopt, std::nullopt, choices);
  EXPECT_NEAR(tdms.recording[Channel::x_act][1], stroke_of(1e-3), 1e-9);
  choices.maps = {"x_act=column 1 [mm]", "F=column 2 [N]"};
  const host_sim::Import text = import_of("no_header_notime.txt", {}, std::nullopt, std::nullopt, choices);
  EXPECT_NEAR(text.recording[Channel::F][1], force_of(1e-3), 1e-3);
  EXPECT_EQ(text.recording.size(), 200U);
}

// The other program's statistics of each channel (NCODE_STAT1: max, min, mean, standard deviation, rms), each to one
// count.
TEST(InstrumentFiles, RpcAgreesWithTheStatisticsOfAnotherProgram) {
  NEEDS("example.rsp");
  struct Statistics {
    double high, low, rms, count;
  };
  constexpr Statistics stated[] = {{232.29092, -197.9693, 69.783257, 7.088956e-3},
                                   {114.32828, 85.870819, 99.851273, 3.489022e-3},
                                   {126.16989, 90.330956, 107.98609, 3.850400e-3},
                                   {153.35783, 98.112534, 125.67398, 4.680110e-3},
                                   {955.18372, -159.6881, 437.45679, 2.914989e-2}};
  const host_sim::FileListing listing = host_sim::list_file(file_of("example.rsp"), {ChannelMap{}});
  ASSERT_EQ(listing.columns.size(), 6U);
  for (std::size_t c = 0; c < 5; ++c) {
    const host_sim::ListedColumn& column = listing.columns[c + 1];
    EXPECT_EQ(column.count, 2048U);
    EXPECT_NEAR(column.rate.value_or(0.0), 250.0, 1e-9);
    EXPECT_NEAR(column.high, stated[c].high, 1.005 * stated[c].count) << column.name;
    EXPECT_NEAR(column.low, stated[c].low, 1.005 * stated[c].count) << column.name;
    EXPECT_NEAR(column.rms, stated[c].rms, 1.005 * stated[c].count) << column.name;
  }
}

struct Refused {
  std::string_view file, says;
};
class RefusedFile : public testing::TestWithParam<Refused> {};
TEST_P(RefusedFile, SaysWhatHelps) {
  const auto& [file, says] = GetParam();
  if (!std::filesystem::exists(file_of(file))) GTEST_SKIP() << file_of(file) << " is missing";
  try {
    static_cast<void>(import_of(file));
    FAIL() << file << " was imported";
  } catch (const firmware::InputError& error) {
    EXPECT_NE(std::string_view(error.what()).find(says), std::string_view::npos) << error.what();
  }
}
INSTANTIATE_TEST_SUITE_P(Of, RefusedFile,
                         testing::Values(Refused{"time_ms_10kHz.csv", "10 Hz in s or 10000 Hz in ms"},
                                         Refused{"time_ms_10kHz.csv", "--time 'Time [ms]'"},
                                         Refused{"slow_rain_fast_acc.tdms", "--map"},
                                         Refused{"two_groups.tdms", "Run 1/Weg"}, Refused{"x.tdms_index", "the .tdms"},
                                         Refused{"no_header_notime.txt", "--rate"}, Refused{"no_time.tdms", "--rate"}));

TEST(InstrumentFiles, WhatIsNotInTheRecordingIsListed) {
  NEEDS("different_len.mat");
  const auto lists = [](const host_sim::Import& import, std::string_view name, std::string_view reason) {
    for (const host_sim::LeftOut& one : import.left_out) {
      if (one.name.find(name) != std::string::npos && one.reason.find(reason) != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(lists(import_of("different_len.mat"), "Kraft", "150"));
  EXPECT_TRUE(lists(import_of("ws_test_string_v7.mat"), "", "class string"));
}

}  // namespace
}  // namespace instrument_files_test
