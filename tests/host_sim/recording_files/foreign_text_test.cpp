// Text files of other measurement programs: each way of writing a table gives the numbers that were measured.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_preamble.hpp"
#include "host_sim/recording_files/text/text_table.hpp"
#include "host_sim/recording_files/text/text_values.hpp"
#include "tests/support/temporary_folder.hpp"

namespace foreign_text_test {
namespace {

using firmware::ChannelMap;
using firmware::Recording;
using model::Channel;
using support::TemporaryFolder;

constexpr int count = 200;
double stroke_mm(int k) { return 5.0 * std::sin(k / 20.0); }
double force_kn(int k) { return 2.0 * std::cos(k / 20.0); }

// printf of a number with a decimal comma, if asked for.
std::string number(double value, int decimals, bool comma = false) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  std::string result = text.data();
  if (comma) std::replace(result.begin(), result.end(), '.', ',');
  return result;
}

std::string rows(const std::function<std::string(int)>& row, const std::string& end = "\n") {
  std::string text;
  for (int k = 0; k < count; ++k) text += row(k) + end;
  return text;
}

// z_w and F_w, or x_act and F, as stroke_mm() and force_kn() have them: 5 decimals of mm and kN were printed.
void expect_measured(const Recording& recording, Channel stroke, Channel force, double step = 1e-3) {
  ASSERT_EQ(recording.size(), static_cast<std::size_t>(count));
  ASSERT_TRUE(recording.has(stroke) && recording.has(force));
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    ASSERT_NEAR(recording.time[i] - recording.time[0], k * step, 1e-12) << k;
    ASSERT_NEAR(recording[stroke][i], 1e-3 * stroke_mm(k), 0.51e-8) << k;
    ASSERT_NEAR(recording[force][i], 1e3 * force_kn(k), 0.51e-2) << k;
  }
}

Recording read_text(const std::string& text, std::optional<model::RigKind> kind = std::nullopt,
                    std::optional<double> rate = std::nullopt, const ChannelMap& map = {}) {
  const TemporaryFolder folder;
  return host_sim::read_parts(folder.write("rec.csv", text), map, rate, kind).front();
}

std::string error_of(const std::string& text, std::optional<double> rate = std::nullopt) {
  try {
    static_cast<void>(read_text(text, std::nullopt, rate));
  } catch (const firmware::InputError& error) {
    const std::string message = error.what();
    return message.substr(message.find("rec.csv") + 7);
  }
  return "no error";
}

// German and English spreadsheets, loggers, test machines.
TEST(ForeignText, ReadsSemicolonsWithDecimalCommasInLatin1) {
  const std::string text = "Zeit [s];Weg Rad [mm];Radlast [kN];Straße [mm]\r\n" +
                           rows(
                               [](int k) {
                                 return number(k * 1e-3, 3, true) + ";" + number(stroke_mm(k), 5, true) + ";" +
                                        number(force_kn(k), 5, true) + ";0,0";
                               },
                               "\r\n");
  std::string latin = text;
  latin.replace(latin.find("ß"), 2, "\xdf");
  expect_measured(read_text(text), Channel::z_w, Channel::F_w);
  const Recording recording = read_text(latin);
  expect_measured(recording, Channel::z_w, Channel::F_w);
  EXPECT_TRUE(recording.has(Channel::z_r));
  EXPECT_NE(recording.remark.find("'Weg Rad [mm]' looks like z_w in mm"), std::string::npos) << recording.remark;
}

TEST(ForeignText, ReadsTabsPreambleUnitRowAndMillisecondsInUtf16) {
  const std::string text =
      "Messung 17\nBearbeiter:\tMüller\nDatum:\t12.03.2024\n\nZeit\tKolbenweg\tKraft\nms\tmm\tkN\n" + rows([](int k) {
        return std::to_string(k) + "\t" + number(stroke_mm(k), 5, true) + "\t" + number(force_kn(k), 5, true);
      });
  for (const bool big : {false, true}) {
    for (const bool mark : {false, true}) {
      std::string bytes = mark ? (big ? "\xfe\xff" : "\xff\xfe") : "";
      for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned code = static_cast<unsigned char>(text[i]);
        if (code == 0xc3) code = static_cast<unsigned char>(text[++i]) + 0x40U;  // ü
        const char low = static_cast<char>(code & 0xffU);
        bytes += big ? std::string{'\0', low} : std::string{low, '\0'};
      }
      expect_measured(read_text(bytes), Channel::x_act, Channel::F);
    }
  }
}

TEST(ForeignText, ReadsClockTimesOverMidnightWithAndWithoutDates) {
  const auto clock = [](int k, const char* sign) {
    const int ms = 86399900 + k;
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%02d:%02d:%02d%s%03d", ms / 3600000 % 24, ms / 60000 % 60, ms / 1000 % 60,
                  sign, ms % 1000);
    return std::string(text.data());
  };
  const auto values = [](int k) { return number(stroke_mm(k), 5) + ";" + number(force_kn(k), 5); };
  const std::string header = ";Stroke (mm);Load (kN)\n";
  expect_measured(read_text("Time" + header + rows([&](int k) { return clock(k, ".") + ";" + values(k); })),
                  Channel::x_act, Channel::F);
  expect_measured(read_text("Date;Time" + header + rows([&](int k) {
                              return (k < 100 ? "12.03.2024;" : "13.03.2024;") + clock(k, ",") + ";" + values(k);
                            })),
                  Channel::x_act, Channel::F);
  expect_measured(read_text("Date/Time" + header + rows([&](int k) {
                              return (k < 100 ? "02/29/2024 " : "03/01/2024 ") + clock(k, ".") + ";" + values(k);
                            })),
                  Channel::x_act, Channel::F);
  expect_measured(read_text("Timestamp" + header + rows([&](int k) {
                              return (k < 100 ? "2024-02-29T" : "2024-03-01T") + clock(k, ".") + "Z;" + values(k);
                            })),
                  Channel::x_act, Channel::F);
}

// Twelve hours are two: 12:00 AM is midnight.
TEST(ForeignText, ReadsTimesOfDayWithAmAndPm) {
  EXPECT_EQ(host_sim::read_clock_time("06/29/2022 04:05:36.674 PM")->seconds, 16 * 3600 + 5 * 60 + 36.674);
  EXPECT_EQ(host_sim::read_clock_time("12:00:00 AM")->seconds, 0.0);
  EXPECT_EQ(host_sim::read_clock_time("12:30:00 PM")->seconds, 12.5 * 3600);
  EXPECT_EQ(host_sim::read_clock_time("1970-01-02")->day, 1);
  EXPECT_EQ(host_sim::read_clock_time("29.02.2000 00:00:00")->day, 11016);
  EXPECT_FALSE(host_sim::read_clock_time("13:00:00 PM"));
  EXPECT_FALSE(host_sim::read_clock_time("2024-03-12 25:00:00"));
  EXPECT_EQ(host_sim::read_clock_time("25:00:00")->seconds, 25 * 3600.0);  // since the start of a run
  EXPECT_EQ(host_sim::read_clock_time("00:55.250")->seconds, 55.25);
  EXPECT_EQ(host_sim::read_clock_time("00:00.250")->wraps, 3600.0);
  EXPECT_EQ(host_sim::read_clock_time("12:00:00.010 a.m.")->seconds, 0.010);
  EXPECT_EQ(host_sim::read_clock_time("12-Mar-2024 10:00:00")->day, host_sim::read_clock_time("2024-03-12")->day);
  EXPECT_FALSE(host_sim::read_clock_time("1:2:3:4:5"));
}

TEST(ForeignText, TakesTheRateOfThePreambleForSampleNumbersAndForRowsWithoutTime) {
  const auto values = [](int k) { return number(stroke_mm(k), 5) + "," + number(force_kn(k), 5); };
  for (const char* rate : {"Sample rate: 500 Hz", "Sampling Interval:  0.002", "Abtastrate = 0,5 kHz", "# dt = 2 ms",
                           "Abtastintervall [ms]: 2", "Sampling Rate\t500"}) {
    expect_measured(read_text(std::string("Device: X 12\n") + rate + "\nChannels: 3\n\nSample,Stroke mm,Load kN\n" +
                              rows([&](int k) { return std::to_string(k + 1) + "," + values(k); })),
                    Channel::x_act, Channel::F, 2e-3);
    expect_measured(read_text(std::string(rate) + "\nStroke mm,Load kN\n" + rows(values)), Channel::x_act, Channel::F,
                    2e-3);
  }
  EXPECT_EQ(error_of("Stroke mm;Load kN\n" +
                     rows([&](int k) { return number(stroke_mm(k), 5) + ";" + number(force_kn(k), 5); }))
                .substr(0, 29),
            ":1: no column is the time: 'S");
}

// MTS Station Manager writes a head and the names again before each block.
TEST(ForeignText, ReadsTheBlocksOfAStationManagerAsOneRecording) {
  const std::string head =
      "Data Header:\tTime:\t1.229\tSec\t1/17/2012 2:34:20 PM\nData Acquisition:\tTimed\nStation Name:\trig.cfg\n"
      "Running Time\tAxial Displacement\tAxial Displacement Command\tAxial Force\nSec\tmm\tmm\tkN\n";
  std::string text = "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\n";
  for (int k = 0; k < count; ++k) {
    if (k % 50 == 0) text += (k == 0 ? "" : "\n") + head;
    text += number(k * 1e-3, 6) + "\t" + number(stroke_mm(k), 5) + "\t" + number(stroke_mm(k + 3), 5) + "\t" +
            number(force_kn(k), 5) + "\n";
  }
  const Recording recording = read_text(text);
  expect_measured(recording, Channel::x_act, Channel::F);
  EXPECT_NEAR(recording[Channel::x_cmd][0], 1e-3 * stroke_mm(3), 0.51e-8);
}

TEST(ForeignText, ReadsQuotesThousandsBlanksTrailingSeparatorsAndRepeatedHeaders) {
  const auto grouped = [](int k) {
    const double newton = 1e3 * force_kn(k);
    std::string text = number(newton, 2, true);
    const std::size_t digits = text.find(',') - (text[0] == '-' ? 1 : 0);
    if (digits > 3) text.insert(text.find(',') - 3, ".");
    return text;
  };
  expect_measured(read_text("Zeit;Weg [mm];Kraft [N];\n" + rows([&](int k) {
                              return number(k * 1e-3, 3, true) + ";" + number(stroke_mm(k), 5, true) + ";" +
                                     grouped(k) + ";";
                            })),
                  Channel::x_act, Channel::F);
  const auto plain = [](int k) {
    return number(k * 1e-3, 3) + "," + number(stroke_mm(k), 5) + "," + number(force_kn(k), 5);
  };
  expect_measured(read_text("t,x_act [mm],F [kN]\n" + rows([&](int k) {
                              return (k % 60 == 59 ? "t,x_act [mm],F [kN]\n# pause\n\n" : "") + plain(k);
                            })),
                  Channel::x_act, Channel::F);
  expect_measured(read_text("\"Zeit\",\"Weg [mm]\",\"Kraft [kN]\"\n" + rows([&](int k) {
                              return "\"" + number(k * 1e-3, 3, true) + "\",\"" + number(stroke_mm(k), 5, true) +
                                     "\",\"" + number(force_kn(k), 5, true) + "\"";
                            })),
                  Channel::x_act, Channel::F);
  expect_measured(read_text("% time  disp_mm  force_kN\n" + rows([&](int k) {
                              std::string row = "  " + plain(k);
                              for (std::size_t i = row.find(','); i != std::string::npos; i = row.find(',', i))
                                row.replace(i, 1, "   ");
                              return row;
                            })),
                  Channel::x_act, Channel::F);
}

// LabVIEW's text files state the units in a line of their own, Dewesoft twice.
TEST(ForeignText, FindsUnitsBesideNamesBelowThemAndInThePreamble) {
  const auto tabs = [](int k) {
    return number(k * 1e-3, 6) + "\t" + number(stroke_mm(k), 5) + "\t" + number(force_kn(k), 5) + "\t";
  };
  expect_measured(
      read_text(
          "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t200\t200\t\n"
          "Y_Unit_Label\tmm\tkN\t\nDelta_X\t0.001\t0.001\t\n***End_of_Header***\t\t\t\nX_"
          "Value\tPosition\tLoad\tComment\n" +
          rows(tabs)),
      Channel::x_act, Channel::F);
  expect_measured(read_text("Time (s)\tz_w (mm)\tF_w (kN)\t\n-\tmm\tkN\t\n" + rows(tabs)), Channel::z_w, Channel::F_w);
}

// A file in the contract's form but for its units is converted by the workbench.
TEST(ForeignText, ConvertsKnownUnitsUnderTheChannelsOwnNames) {
  const std::string text = "t [s],x_act [mm],F [kN]\n" + rows([](int k) {
                             return number(k * 1e-3, 3) + "," + number(stroke_mm(k), 5) + "," + number(force_kn(k), 5);
                           });
  expect_measured(read_text(text), Channel::x_act, Channel::F);
  std::string wrong = text;
  wrong.replace(wrong.find("[kN]"), 4, "[mm]");
  EXPECT_EQ(
      error_of(wrong),
      ":1: 'F', taken as F, has the unit 'mm', expected a unit of N, or a scale in the rig description's [channels]");
}

// What is missing is counted and said with its line, never bridged in silence: a word, a NaN, a short row.
TEST(ForeignText, MarksWordsAndShortRowsAsMissingAndSaysTheirLine) {
  const std::string text = "t;x_act [mm];F [kN]\n" + rows([](int k) {
                             return number(k * 1e-3, 3) + ";" + (k == 20 ? "NaN" : number(stroke_mm(k), 5)) +
                                    (k == 33 ? "" : ";" + (k == 40 ? "off" : number(force_kn(k), 5)));
                           });
  const Recording recording = read_text(text);
  ASSERT_EQ(recording.filled.size(), static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    EXPECT_EQ(recording.filled[static_cast<std::size_t>(k)], k == 20 || k == 33 || k == 40) << k;
  EXPECT_NE(recording.remark.find("line 22: 'x_act' is 'NaN' and 2 more like it"), std::string::npos)
      << recording.remark;
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(host_sim::read_recording(folder.write("rec.csv", text))), firmware::InputError);
  std::string back = text;
  back.replace(back.find("0.100;"), 6, "0.050;");
  EXPECT_EQ(error_of(back), ":102: time runs backwards: 0.05 s follows 0.099 s, expected a later time in each sample");
}

// Stamps that jitter are no rounding: the samples come onto an even grid, and a pause stays a pause.
TEST(ForeignText, BringsUnevenSamplesOntoAnEvenGridAndKeepsTheGap) {
  std::string text = "time [ms];stroke [mm];force [kN]\n";
  double t = 0.0;
  for (int k = 0; k < 600; ++k) {
    t += k == 300 ? 0.2 : 0.010 + 0.002 * std::sin(7.0 * k);
    text += number(1e3 * t, 3) + ";" + number(std::sin(t), 6) + ";" + number(std::cos(t), 6) + "\n";
  }
  const TemporaryFolder folder;
  const ChannelMap none;
  const host_sim::Import import = host_sim::import_file(folder.write("rec.csv", text), {none});
  const Recording& recording = import.recording;
  double longest = 0.0;
  for (std::size_t k = 0; k < recording.size(); ++k) {
    // Linear between samples 12 ms apart: error of (h²/8) |sin| ≤ 1.8·10⁻⁵ mm, and the rounding of the stamps.
    ASSERT_NEAR(recording[Channel::x_act][k], 1e-3 * std::sin(recording.time[k]), 2e-8) << k;
    if (k > 0) longest = std::max(longest, recording.time[k] - recording.time[k - 1]);
  }
  EXPECT_GT(longest, 0.19);
  EXPECT_NE(import.notes.back().find("uneven"), std::string::npos);
}

// Any bytes are a table or one line that names the file.
TEST(ForeignText, RefusesWhatHoldsNoTable) {
  EXPECT_EQ(error_of(""), ": the file is empty, expected a header line such as t,z_r,F_w");
  EXPECT_NE(error_of("hello\nworld\n").find("expected"), std::string::npos);
  EXPECT_NE(error_of(std::string("\x01\x02\x03\x04\x00\x05", 6)).find("the file is no text"), std::string::npos);
  EXPECT_EQ(error_of("Zeit;Temperatur\n0;1\n1;2\n2;3\n").substr(0, 32), ":1: no column is a known channel");
}

// Every decimal sign and grouping that occurs, and none that does not.
TEST(ForeignText, ReadsNumbersWithSeparators) {
  const auto value = [](const char* text, char decimal) {
    const auto read = host_sim::read_text_number(text, decimal);
    return read ? read->value : -999.0;
  };
  EXPECT_EQ(value("1.234,5", ','), 1234.5);
  EXPECT_EQ(value("1,234.5", '.'), 1234.5);
  EXPECT_EQ(value("1 234 567", '.'), 1234567.0);
  EXPECT_EQ(value("1'234.5", '.'), 1234.5);
  EXPECT_EQ(value("-1.5e-3", '.'), -1.5e-3);
  EXPECT_EQ(value("1,5E+02", ','), 150.0);
  EXPECT_EQ(value("1.5D0", '.'), 1.5);
  EXPECT_EQ(value(".5", '.'), 0.5);
  EXPECT_EQ(value("-,5", ','), -0.5);
  EXPECT_EQ(value("\xe2\x88\x92"
                  "3",
                  '.'),
            -3.0);
  EXPECT_EQ(value("0,123", '.'), -999.0);
  EXPECT_EQ(value("12,34", '.'), -999.0);
  EXPECT_EQ(value("1,2345", '.'), -999.0);
  EXPECT_EQ(value("1.2.3", '.'), -999.0);
  EXPECT_EQ(value("e5", '.'), -999.0);
  EXPECT_EQ(value("0x10", '.'), -999.0);
  EXPECT_TRUE(host_sim::read_text_number("1,500", '.')->weak);
}

// Of all statements those with a word of sampling count; what moves the rig, how long it took and clocks are no rate.
TEST(ForeignText, TheRateIsWhatIsSaidOfSampling) {
  const auto rate = [](std::vector<std::string_view> lines, host_sim::RateHints hints = {}) {
    const auto found = host_sim::find_rate(lines, hints);
    return found ? found->rate : 0.0;
  };
  EXPECT_EQ(rate({"Messzeit: 10 s", "Abtastrate: 1000 Hz"}), 1000.0);
  EXPECT_EQ(rate({"Frequency: 1.5 Hz", "Sample rate: 1000 Hz"}), 1000.0);
  EXPECT_EQ(rate({"Period: 2 s", "Sampling interval: 1 ms"}), 1000.0);
  EXPECT_EQ(rate({"# Config: data_rate = 2000.0 Hz, filter = 488 Hz, acc_range = 4 g"}), 2000.0);
  EXPECT_EQ(rate({"Log time: 14:22:10"}), 0.0);
  EXPECT_EQ(rate({"Data rate: 500 kBit/s"}), 0.0);
  EXPECT_EQ(rate({"Rate: 5 mm/s"}), 0.0);
  EXPECT_EQ(rate({"Excitation frequency: 3 Hz"}), 0.0);
  EXPECT_EQ(rate({"Sample rate: 1,000 Hz"}, {'.', 0}), 1000.0);
  EXPECT_EQ(rate({"Abtastrate: 1.000 Hz"}, {',', 0}), 1000.0);
  EXPECT_EQ(rate({"SR=1000 Hz\tSR=1000 Hz"}), 1000.0);
  // Two that differ: the one that agrees with duration and number of samples, else both are named.
  EXPECT_EQ(rate({"Sample rate: 500 Hz", "Sample rate: 1000 Hz", "Duration: 0.2 s"}, {'.', 200}), 1000.0);
  const auto conflict = host_sim::find_rate({"Sample rate: 500 Hz", "Sampling rate: 1000 Hz"}, {});
  ASSERT_TRUE(conflict);
  EXPECT_EQ(conflict->conflict, "Sampling rate: 1000 Hz");
}

TEST(ForeignText, AFieldTellsItsDecimalSignOrLeavesItOpen) {
  using host_sim::decimal_evidence;
  using host_sim::DecimalEvidence;
  EXPECT_EQ(decimal_evidence("987"), DecimalEvidence::none);
  EXPECT_EQ(decimal_evidence("1,234"), DecimalEvidence::ambiguous);
  EXPECT_EQ(decimal_evidence("0,234"), DecimalEvidence::comma);
  EXPECT_EQ(decimal_evidence("-1.5"), DecimalEvidence::point);
  EXPECT_EQ(decimal_evidence("1,234.5"), DecimalEvidence::point);
  EXPECT_EQ(decimal_evidence("1,234,567"), DecimalEvidence::point);
  EXPECT_EQ(decimal_evidence("1.234,5"), DecimalEvidence::comma);
}

// The force has a time column of its own, at a tenth of the rate and 5 ms later.
TEST(ForeignText, EveryTimeColumnGovernsTheColumnsBehindIt) {
  std::string text = "Time1 [s],Weg [mm],Time2 [s],Kraft [kN]\n";
  for (int k = 0; k < count; ++k) {
    text += number(1e-3 * k, 3) + "," + number(stroke_mm(k), 5);
    text += k < 19 ? "," + number(5e-3 + 1e-2 * k, 3) + "," + number(force_kn(10 * k + 5), 5) + "\n" : ",,\n";
  }
  const Recording recording = read_text(text);
  ASSERT_EQ(recording.size(), 181U);  // 5 … 185 ms
  EXPECT_NEAR(recording.time[0], 0.005, 1e-12);
  for (std::size_t k = 0; k < 181; k += 10)
    ASSERT_NEAR(recording[Channel::F][k], 1e3 * force_kn(static_cast<int>(k) + 5), 1e-2) << k;
}

// A second header in other order and units, a block's key lines, statistics at the end: none is a sample.
TEST(ForeignText, HeadersAndStatisticsBetweenRowsAreNoSamples) {
  std::string text = "Zeit [s];Weg [mm];Kraft [kN]\n";
  for (int k = 0; k < 100; ++k)
    text += number(1e-3 * k, 3) + ";" + number(stroke_mm(k), 5) + ";" + number(force_kn(k), 5) + "\n";
  text += "\nPoints:;51;\nZeit [s];Kraft [N];Weg [mm]\n";
  for (int k = 100; k < count; ++k)
    text += number(1e-3 * k, 3) + ";" + number(1e3 * force_kn(k), 2) + ";" + number(stroke_mm(k), 5) + "\n";
  text += "\nMin;-2000;-5\nMax;2000;5\n";
  expect_measured(read_text(text), Channel::x_act, Channel::F);
}

TEST(ForeignText, UnitsOfNoChannelAreUnits) {
  std::string text = "Time,Disp,Force,Valve,Oil\ns,mm,kN,V,°C\n";
  text += rows([](int k) {
    return number(1e-3 * k, 3) + "," + number(stroke_mm(k), 5) + "," + number(force_kn(k), 5) + ",1.5,40";
  });
  expect_measured(read_text(text), Channel::x_act, Channel::F);
  EXPECT_FALSE(firmware::find_unit("Nm"));  // no nanometres
  EXPECT_TRUE(firmware::is_unit_of_no_channel("Nm"));
  EXPECT_FALSE(firmware::is_unit("Messung"));
}

TEST(ForeignText, ASlowChannelIsInterpolated) {
  std::string text = "Zeit [s];Weg [mm];Kraft [kN]\n";
  for (int k = 0; k < 191; ++k)
    text +=
        number(1e-3 * k, 3) + ";" + number(stroke_mm(k), 5) + ";" + (k % 10 == 0 ? number(force_kn(k), 5) : "") + "\n";
  const Recording recording = read_text(text);
  ASSERT_EQ(recording.size(), 191U);
  // Linear between 10 steps of 0.05 rad: 0.5²/8 of 2 kN.
  for (int k = 0; k < 191; ++k)
    ASSERT_NEAR(recording[Channel::F][static_cast<std::size_t>(k)], 1e3 * force_kn(k), 63.0) << k;
  EXPECT_NE(recording.remark.find("interpolated linearly"), std::string::npos) << recording.remark;
}

// Steps of 0.1 are 10 Hz or 10 kHz: the user is asked, in the words of a command.
TEST(ForeignText, ATimeWhoseUnitIsOpenIsAskedFor) {
  const std::string text = "Time,Weg [mm],Kraft [kN]\n" + rows([](int k) {
                             return number(0.1 * k, 1) + "," + number(stroke_mm(k), 5) + "," + number(force_kn(k), 5);
                           });
  try {
    static_cast<void>(read_text(text));
    FAIL();
  } catch (const firmware::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--time 'Time [ms]'"), std::string::npos) << error.what();
  }
  expect_measured(read_text(text, std::nullopt, 10000.0), Channel::x_act, Channel::F, 1e-4);
}

}  // namespace
}  // namespace foreign_text_test
