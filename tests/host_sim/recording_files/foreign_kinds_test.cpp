// Kinds of files that programs and instruments write, each as short as it can be: the same 40 samples at 1 kHz, whose
// stroke is k µm and whose force is 10 k N.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace foreign_kinds_test {
namespace {

using model::Channel;

constexpr int count = 40;

std::string printed(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

// A file of a head and of rows "time;stroke in mm;force in N".
std::string file_of(const std::string& head, const std::function<std::string(int)>& time) {
  std::string text = head + "\n";
  for (int k = 0; k < count; ++k) {
    const std::string stamp = time(k);
    text += stamp + (stamp.empty() ? "" : ";") + printed("%.3f", 1e-3 * k) + ";" + printed("%.1f", 10.0 * k) + "\n";
  }
  return text;
}

host_sim::Import import_of_text(const std::string& text, const host_sim::ImportChoices& choices = {}) {
  const support::TemporaryFolder folder;
  return host_sim::import_file(folder.write("run.csv", text), {firmware::ChannelMap{}}, choices);
}

// `resolution` [s]: of the stamps as doubles.
void expect_run(const host_sim::Import& import, double step = 1e-3, double resolution = 1e-9) {
  ASSERT_EQ(import.recording.size(), static_cast<std::size_t>(count));
  ASSERT_TRUE(import.recording.has(Channel::x_act));
  ASSERT_TRUE(import.recording.has(Channel::F));
  for (int k = 0; k < count; ++k) {
    const auto row = static_cast<std::size_t>(k);
    ASSERT_NEAR(import.recording.time[row] - import.recording.time[0], step * k, resolution) << k;
    ASSERT_NEAR(import.recording[Channel::x_act][row], 1e-6 * k, 1e-12) << k;
    ASSERT_NEAR(import.recording[Channel::F][row], 10.0 * k, 1e-9) << k;
  }
}

class StatedRates : public testing::TestWithParam<std::string_view> {};
TEST_P(StatedRates, AreOneKilohertz) {
  expect_run(
      import_of_text(file_of(std::string(GetParam()) + "\n\nWeg [mm];Kraft [N]", [](int) { return std::string(); })));
}
INSTANTIATE_TEST_SUITE_P(InWords, StatedRates,
                         testing::Values("Tastrate: 1 kHz", "Aufnahmerate 1000 Hz", "Erfassungsrate: 1000 1/s",
                                         "Samples/s: 1000", "DAQ rate: 1000 S/s", "Takt: 1 ms", "Sampling: 1000 Hz",
                                         "Rate 1000/s", "Abtastschritt: 0,001 s", "Messzeit: 0,04 s",
                                         "Display rate: 25 Hz\nRecording rate: 1000 Hz"));

struct Stamps {
  std::string_view heading;
  std::function<std::string(int)> of;
  double step = 1e-3, resolution = 1e-9;
};
class TimeStamps : public testing::TestWithParam<Stamps> {};
TEST_P(TimeStamps, AreRead) {
  const Stamps& stamps = GetParam();
  expect_run(import_of_text(file_of(std::string(stamps.heading) + ";Weg [mm];Kraft [N]", stamps.of)), stamps.step,
             stamps.resolution);
}
// Resolutions: half a unit in the last place of 60 381, of 2 460 381 days and of 1.3e11 s, and of the digits printed.
INSTANTIATE_TEST_SUITE_P(
    InManyForms, TimeStamps,
    testing::Values(
        Stamps{"Time", [](int k) { return "20240312100000." + printed("%03.0f", k); }},
        Stamps{"Time", [](int k) { return "20240312T100000." + printed("%03.0f", k) + "Z"; }},
        Stamps{"Elapsed", [](int k) { return "0 days 00:00:00." + printed("%03.0f", k) + "000"; }},
        Stamps{"Timestamp", [](int k) { return printed("%.12f", 60381.5 + k / 86400e3); }, 1e-3, 1.3e-6},
        Stamps{"Timestamp", [](int k) { return printed("%.9f", 2460381.5 + k / 86400.0 * 0.1); }, 0.1, 9e-5},
        Stamps{"Timestamp", [](int k) { return printed("%.0f", 133500000000000000.0 + 10000.0 * k); }, 1e-3, 1.6e-5}));

TEST(ForeignKinds, NumberedRowsNeedNoNameForTheirNumbers) {
  expect_run(import_of_text(file_of("t [s];Weg [mm];Kraft [N]", [](int k) {
    return "\"" + std::to_string(k + 1) + "\";" + printed("%.3f", 1e-3 * k);
  })));
}

TEST(ForeignKinds, RulersBelowAHeaderAreNoNames) {
  expect_run(import_of_text(
      file_of("t [s];Weg [mm];Kraft [N]\n------;------;------", [](int k) { return printed("%.3f", 1e-3 * k); })));
}

TEST(ForeignKinds, ScpisNumberForNoValueIsNone) {
  std::string text = file_of("t [s];Weg [mm];Kraft [N]", [](int k) { return printed("%.3f", 1e-3 * k); });
  text.replace(text.find(";50.0"), 5, ";9.91E37");
  EXPECT_TRUE(std::isnan(import_of_text(text).recording[Channel::F][5]));
}

TEST(ForeignKinds, OneColumnMayHaveDecimalCommas) {
  std::string text = "Kraft [N]\n";
  for (int k = 0; k < count; ++k) text += std::to_string(k) + ",0" + std::to_string(k % 10) + "\n";
  host_sim::ImportChoices choices;
  choices.rate = 1000.0;
  const host_sim::Import import = import_of_text(text, choices);
  EXPECT_NEAR(import.recording[Channel::F][13], 13.03, 1e-12);
}

TEST(ForeignKinds, StepsOfNoRateAreAskedFor) {
  EXPECT_THROW(import_of_text(file_of("Time;Weg [mm];Kraft [N]", [](int k) { return printed("%.12f", 3e-9 * k); })),
               firmware::InputError);
}

// What --rate and --skip said is in the description afterwards: other commands read the file alike.
TEST(ForeignKinds, ADescriptionKeepsRateAndSkippedLines) {
  const std::string text = "7;8\n9;1\n" + file_of("A;B", [](int) { return std::string(); });
  const support::TemporaryFolder folder;
  const std::string file = folder.write("run.csv", text);
  host_sim::ImportChoices choices;
  choices.rate = 1000.0;
  choices.skip = 2;
  choices.maps = {"x_act=A [mm]", "F=B [N]"};
  const host_sim::Import import = host_sim::import_file(file, {firmware::ChannelMap{}}, choices);
  expect_run(import);
  EXPECT_EQ(import.channels.at("t").column, "row number at 1000 Hz, 2 lines skipped");
  const firmware::Recording again = host_sim::read_parts(file, import.channels, 1000.0).front();
  EXPECT_EQ(again.time, import.recording.time);
  EXPECT_EQ(again[Channel::F], import.recording[Channel::F]);
  expect_run(host_sim::import_file(file, {import.channels}));
}

TEST(ForeignKinds, RecordingsAreWrittenUnderKnownEndingsAlone) {
  const support::TemporaryFolder folder;
  firmware::Recording recording;
  recording.time = {0.0, 1e-3};
  recording[Channel::F] = {1.0, 2.0};
  for (const char* name : {"x.h5", "x.xlsx", "x.tdms"}) {
    try {
      host_sim::write_recording(folder / name, recording);
      FAIL() << name;
    } catch (const firmware::OutputError& error) {
      EXPECT_NE(std::string(error.what()).find(".csv, .txt, .tsv, .mat"), std::string::npos) << error.what();
    }
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
  for (const char* name : {"x", "x.txt", "x.2024", "X.CSV"}) host_sim::write_recording(folder / name, recording);
}

}  // namespace
}  // namespace foreign_kinds_test
