// Recordings as CSV: what is read, what is refused and with which words, and that writing and reading give the same
// bits.
#include "firmware/recording/recording.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <random>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::ChannelMap;
using firmware::InputError;
using firmware::parse_recording_csv;
using firmware::Recording;
using host_sim::read_recording;
using model::Channel;

std::string message_of(const std::string& text, const ChannelMap& map = {}, std::optional<double> rate = std::nullopt) {
  try {
    static_cast<void>(parse_recording_csv(text, "REC.csv", map, rate));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b, std::string_view what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a[k]), std::bit_cast<std::uint64_t>(b[k])) << what << ", sample " << k;
  }
}

// Every double a channel can hold is as likely as any other: random bits, those of NaN and infinity left out.
std::vector<double> any_doubles(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> numbers;
  while (numbers.size() < count) {
    const double x = std::bit_cast<double>(static_cast<std::uint64_t>(random()));
    if (std::isfinite(x)) numbers.push_back(x);
  }
  return numbers;
}

Recording a_run(std::size_t samples, std::uint64_t seed) {
  Recording run;
  run.sample_period = 1e-3;
  run.time = firmware::sample_times(samples, 1000.0);
  for (auto& channel : run.channels) channel = any_doubles(samples, seed++);
  for (auto& duct : run.ducts) {
    duct.resize(samples);
    for (std::size_t k = 0; k < samples; ++k) duct[k] = static_cast<double>((k / 7 + seed) % 2);
  }
  return run;
}

// The contract's example: comments, a header with units, one row a sample.
TEST(RecordingCsv, ReadsChannelsUnitsAndDuctsAndListsWhatItDoesNotKnow) {
  const Recording rec = parse_recording_csv(
      "# a rig\n# noon\nt,z_r [m],zdd_b [m/s²],operator,F_w [N],duct_2,F [N] raw\n"
      "5.0,0.1,1e-3,anna,-12,1,7\n5.5,0.2,-0,nan,+3.5,0,8\n",
      "REC.csv", {}, 2.0);
  EXPECT_EQ(rec.size(), 2U);
  EXPECT_EQ(rec.sample_period, 0.5);
  EXPECT_EQ(rec.time, (std::vector<double>{5.0, 5.5}));
  EXPECT_EQ(rec[Channel::z_r], (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(rec[Channel::zdd_b], (std::vector<double>{1e-3, -0.0}));
  EXPECT_TRUE(std::signbit(rec[Channel::zdd_b][1]));
  EXPECT_EQ(rec[Channel::F_w], (std::vector<double>{-12.0, 3.5}));
  EXPECT_EQ(rec.ducts[1], (std::vector<double>{1.0, 0.0}));
  EXPECT_TRUE(rec.ducts[0].empty());
  EXPECT_EQ(rec.ignored_columns, (std::vector<std::string>{"operator", "F [N] raw"}));
  EXPECT_FALSE(rec.has(Channel::F));
  EXPECT_EQ(rec.source, "REC.csv");
}

// What spreadsheets and loggers do to a file does not change what it says.
TEST(RecordingCsv, TakesByteOrderMarkCarriageReturnsBlanksQuotesAndAMissingLastLineEnd) {
  const Recording rec = parse_recording_csv(
      "\xef\xbb\xbf# x\r\n\r\n\"t\" , \"F [N]\" \r\n 0 , 1.5 \r\n\t1\t,\t-2e0\t\r\n2 ,3", "REC.csv", {}, 1.0);
  EXPECT_EQ(rec.time, (std::vector<double>{0.0, 1.0, 2.0}));
  EXPECT_EQ(rec[Channel::F], (std::vector<double>{1.5, -2.0, 3.0}));
  const Recording trailing = parse_recording_csv("t,F\n0,1\n1,2\n\n \r\n\n", "REC.csv", {}, 1.0);
  EXPECT_EQ(trailing.size(), 2U);
}

// Every way of writing m/s² that is about, Latin-1 among them; other units of a dimension are converted, those of
// another one refused.
TEST(RecordingCsv, ConvertsUnitsAndRefusesThoseOfAnotherDimension) {
  for (const char* unit : {"m/s²", "m/s^2", "m/s2", "m/s\xb2", " m/s^2 "}) {
    const std::string text = std::string("t [s],zdd_w [") + unit + "]\n0,1\n1,2\n";
    EXPECT_EQ(parse_recording_csv(text, "REC.csv").has(Channel::zdd_w), true) << unit;
  }
  const Recording converted =
      parse_recording_csv("t [ms],zdd_w [g],F [kN],duct_1 [%]\n0,1,2,100\n3,2,3,0\n", "REC.csv", {}, 1000.0 / 3.0);
  EXPECT_EQ(converted.time, (std::vector<double>{0.0, 0.003}));
  EXPECT_EQ(converted[Channel::zdd_w], (std::vector<double>{9.80665, 2.0 * 9.80665}));
  EXPECT_EQ(converted[Channel::F], (std::vector<double>{2000.0, 3000.0}));
  EXPECT_EQ(converted.ducts[0], (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(message_of("t,zdd_w [mm]\n0,1\n1,2\n"),
            "REC.csv:1: 'zdd_w', taken as zdd_w, has the unit 'mm', expected a unit of m/s², or a scale in the rig "
            "description's [channels]");
  EXPECT_EQ(message_of("t [furlong],F [N]\n0,1\n1,2\n"),
            "REC.csv:1: 't', taken as t, has the unit 'furlong', expected a unit of s, or a scale in the rig "
            "description's [channels]");
  EXPECT_EQ(message_of("t,F [N],duct_1 [V]\n0,1,0\n1,2,0\n"),
            "REC.csv:1: 'duct_1', taken as duct_1, has the unit 'V', expected none (1 open, 0 closed), or a scale in "
            "the rig description's [channels]");
}

// One rule for an entry of [channels]: without a scale the unit of the column decides, in the reader that a controller
// shares and in that of other programs' files; a scale that is written is taken as it stands. Both give the same bits.
TEST(RecordingCsv, EntriesWithoutAScaleAreReadAlikeByBothReaders) {
  const std::string header = "clock [ms],Road [mm],load [kN],plain\n",
                    rows = "0,0.7,0.3,5\n3,-1.1,0.7,6\n6,2.3,-0.9,7\n";
  std::string semicolons = header + rows;
  std::replace(semicolons.begin(), semicolons.end(), ',', ';');
  const support::TemporaryFolder folder;
  const auto comma_file = folder.write("comma.csv", header + rows), other_file = folder.write("other.csv", semicolons);
  for (const std::optional<double> scale : {std::optional<double>{}, std::optional<double>{0.25}}) {
    const ChannelMap map{
        {"t", {"clock"}}, {"z_r", {"Road", scale, 0.5}}, {"F", {"load [kN]", scale}}, {"z_w", {"plain"}}};
    const Recording strict = parse_recording_csv(header + rows, "REC.csv", map, 1000.0 / 3.0);
    EXPECT_EQ(strict.time, (std::vector<double>{0.0, 0.003, 0.006}));
    EXPECT_EQ(strict[Channel::z_r].front(), scale.value_or(1e-3) * 0.7 + 0.5);
    EXPECT_EQ(strict[Channel::F].front(), scale.value_or(1e3) * 0.3);
    EXPECT_EQ(strict[Channel::z_w].front(), 5.0) << "no unit: SI";
    for (const auto& file : {comma_file, other_file}) {
      const Recording read = host_sim::read_recording(file, map, 1000.0 / 3.0);
      EXPECT_EQ(read.time, strict.time) << file;
      for (const Channel channel : {Channel::z_r, Channel::F, Channel::z_w}) EXPECT_EQ(read[channel], strict[channel]);
    }
  }
}

// [channels]: SI = scale × column + offset, the column named in full or without its unit, t and ducts included.
TEST(RecordingCsv, ScalesTheColumnsThatTheRigDescriptionNames) {
  const ChannelMap map{{"t", {"clock", 1e-3, 0.0}},
                       {"z_r", {"Road [mm]", 1e-3, 0.5}},
                       {"F", {"load", -1.0, 0.0}},
                       {"duct_1", {"shut", -1.0, 1.0}}};
  const Recording rec =
      parse_recording_csv("load [N],clock [ms],Road [mm],shut,z_w\n4,0,10,0,7\n-5,20,20,1,8\n", "REC.csv", map, 50.0);
  EXPECT_EQ(rec.time, (std::vector<double>{0.0, 0.02}));
  EXPECT_EQ(rec[Channel::z_r], (std::vector<double>{0.51, 0.52}));
  EXPECT_EQ(rec[Channel::F], (std::vector<double>{-4.0, 5.0}));
  EXPECT_EQ(rec[Channel::z_w], (std::vector<double>{7.0, 8.0}));
  EXPECT_EQ(rec.ducts[0], (std::vector<double>{1.0, 0.0}));
}

// An entry of [channels] takes the place of a column that happens to have the channel's name, …
TEST(RecordingCsv, PrefersTheNamedColumnToOneOfTheChannelsOwnName) {
  const ChannelMap map{{"F", {"load", 1.0, 0.0}}};
  const Recording rec = parse_recording_csv("t,F,load\n0,1,5\n1,2,6\n", "REC.csv", map);
  EXPECT_EQ(rec[Channel::F], (std::vector<double>{5.0, 6.0}));
  EXPECT_EQ(rec.ignored_columns, std::vector<std::string>{"F"});
}

// … but where the recording has no such column, its own name holds: the rig's other recordings may be in our names.
TEST(RecordingCsv, FallsBackToTheOwnNameWhereTheNamedColumnIsAbsent) {
  const ChannelMap map{{"F", {"load", -1.0, 0.0}}};
  EXPECT_EQ(parse_recording_csv("t,F\n0,1\n1,2\n", "REC.csv", map)[Channel::F], (std::vector<double>{1.0, 2.0}));
}

// A simulated run read with the description of a rig whose force sensor counts the other way must not change sign.
TEST(RecordingCsv, ReadsItsOwnFilesWithoutTheMapOfOtherPrograms) {
  Recording run;
  run.time = {0.0, 1.0};
  run[Channel::F] = {1.0, 2.0};
  const ChannelMap map{{"F", {"F", -1.0, 0.0}}};
  const std::string text = format_recording_csv(run);
  EXPECT_EQ(parse_recording_csv(text, "REC.csv", map)[Channel::F], run[Channel::F]);
  EXPECT_EQ(parse_recording_csv("t,F\n0,1\n1,2\n", "REC.csv", map)[Channel::F], (std::vector<double>{-1.0, -2.0}));
}

struct BadFile {
  const char* text;
  const char* message;
};
std::ostream& operator<<(std::ostream& out, const BadFile& bad) { return out << bad.message; }
class BadRecording : public testing::TestWithParam<BadFile> {};

// Each kind of damage is one line that names the file, the line, the fault and what should be there.
TEST_P(BadRecording, IsRefusedInOneLine) { EXPECT_EQ(message_of(GetParam().text, {}, 1.0), GetParam().message); }

INSTANTIATE_TEST_SUITE_P(
    Csv, BadRecording,
    testing::Values(
        BadFile{"", "REC.csv: the file is empty, expected a header line such as t,z_r,F_w"},
        BadFile{"# only\n# comments\n", "REC.csv:2: there is no header line, expected one such as t,z_r,F_w"},
        BadFile{"\n", "REC.csv:1: there is no header line, expected one such as t,z_r,F_w"},
        BadFile{"t,F\n", "REC.csv:1: no samples follow the header, expected one row a sample"},
        BadFile{"t,F\n0,1\n", "REC.csv:2: there is only one sample, expected at least two"},
        BadFile{"0,1\n1,2\n", "REC.csv:1: numbers stand where names should, expected a header line such as t,z_r,F_w"},
        BadFile{"t,F,x\n0,1,2\n1,2\n2,3,4\n", "REC.csv:3: the row has 2 values, expected 3 as in the header"},
        BadFile{"t,F\n0,1\n1\n", "REC.csv:3: the row has 1 value, expected 2 as in the header"},
        BadFile{"t,F,x\n0,1,2\n1,2,3,4\n", "REC.csv:3: the row has 4 values, expected 3 as in the header"},
        BadFile{"t,F,x\n0,1,2\n1,2,3,\n", "REC.csv:3: the row has 4 values, expected 3 as in the header"},
        BadFile{"t,F\n0,0,5\n1,0,6\n",
                "REC.csv:2: the row has 3 values (decimal commas?), expected 2 as in the header"},
        BadFile{"t,F\n0;5\n1;6\n",
                "REC.csv:2: the row has 1 value (separated by semicolons?), expected 2 as in the header"},
        BadFile{
            "t;F\n0;5\n1;6\n",
            "REC.csv:1: the columns are separated by semicolons, expected commas between columns and '.' as decimal "
            "point"},
        BadFile{
            "t\tF\n0\t5\n1\t6\n",
            "REC.csv:1: the columns are separated by tabs, expected commas between columns and '.' as decimal point"},
        BadFile{"t,F\n0,nan\n1,2\n", "REC.csv:2: F is nan, expected a finite number"},
        BadFile{"t,F\n0,1\n1,-inf\n", "REC.csv:3: F is -inf, expected a finite number"},
        BadFile{"t,F\n0,1\n1,1e999\n", "REC.csv:3: F is inf, expected a finite number"},
        BadFile{"t,F\nnan,1\n1,2\n", "REC.csv:2: t is nan, expected a finite number"},
        BadFile{"t,F,z_w\n0,,1\n1,2,1\n", "REC.csv:2: F is missing, expected a number"},
        BadFile{"t,F\n0, \n1,2\n", "REC.csv:2: F is missing, expected a number"},
        BadFile{"t,F\n0,1\n1,off\n", "REC.csv:3: F is 'off', expected a number"},
        BadFile{"t,F\n0,1\n1,2 N\n", "REC.csv:3: F is '2 N', expected a number"},
        BadFile{"t,F\n0,1\n1,+-2\n", "REC.csv:3: F is '+-2', expected a number"},
        BadFile{"t,F\n0,1\n1,0x10\n", "REC.csv:3: F is '0x10', expected a number"},
        BadFile{"t,F\n0,1\n# pause,2\n1,2\n", "REC.csv:3: t is '# pause', expected a number"},
        BadFile{"t,F\n0,1\n\n1,2\n", "REC.csv:3: an empty line stands between samples, expected one row a sample"},
        BadFile{"t,F\n0,1\n\n\n1,2\n", "REC.csv:3: an empty line stands between samples, expected one row a sample"},
        BadFile{"t,F,x\n0,nan\n", "REC.csv:2: the row has 2 values, expected 3 as in the header"},
        BadFile{"t,F\n0,1\n1,2\n1,3\n",
                "REC.csv:4: time does not increase: 1 follows 1, expected a later time in each sample"},
        BadFile{"t,F\n0,1\n1,2\n0.5,3\n",
                "REC.csv:4: time runs backwards: 0.5 follows 1, expected a later time in each sample"},
        BadFile{"t,F\n0,1\n1,2\n2,1\n4,3\n5,3\n",
                "REC.csv:5: gap in time: 4 follows 2, expected steps of 1 s ± 0.001 s"},
        BadFile{"t,F\n0,1\n1,2\n2,1\n2.5,3\n3.5,3\n",
                "REC.csv:5: irregular time: 2.5 follows 2, expected steps of 1 s ± 0.001 s"},
        BadFile{"t,F\n0,1\n0.5,2\n1,1\n1.5,1\n",
                "REC.csv:3: the recording's rate is 2 Hz (steps of 0.5 s), expected 1 Hz as in the rig description"},
        BadFile{"z_r,F\n0,1\n1,2\n", "REC.csv:1: there is no column t, expected a first column t, in seconds"},
        BadFile{"t,force\n0,1\n1,2\n",
                "REC.csv:1: no column is a known channel, expected one or more of z_r, z_w, z_b, zdd_r, zdd_w, zdd_b, "
                "dz_w, dz_b, F_w, x_cmd, x_act, F, F_act, z_cmd, duct_1 … duct_6"},
        BadFile{"t,F,F\n0,1,2\n1,2,3\n", "REC.csv:1: two columns are called 'F', expected one"},
        BadFile{"t,F,F [N]\n0,1,2\n1,2,3\n", "REC.csv:1: two columns are called 'F', expected one"},
        BadFile{"t,F,duct_1\n0,1,0.5\n1,2,1\n", "REC.csv:2: duct_1 is 0.5, expected 1 (open) or 0 (closed)"},
        BadFile{"\xff\xfet", "REC.csv:1: the text is UTF-16, expected UTF-8"},
        BadFile{"PK\x03\x04,\x01", "REC.csv:1: the file is no text, expected CSV, or MATLAB 5 or 7.3"}));

// One column cannot be two channels, and a mapped column must be found without doubt.
TEST(RecordingCsv, RefusesAnAmbiguousMap) {
  const ChannelMap twice{{"F", {"load", 1.0, 0.0}}, {"F_w", {"load", 1.0, 0.0}}};
  EXPECT_EQ(message_of("t,load\n0,1\n1,2\n", twice),
            "REC.csv:1: column 'load' is both F and F_w in [channels], expected one channel for each column");
  const ChannelMap one{{"F", {"load", 1.0, 0.0}}};
  EXPECT_EQ(message_of("t,load,load [kN]\n0,1,1\n1,2,2\n", {{"F", {"load", 1.0, 0.0}}}), "no error");  // full text wins
  EXPECT_EQ(message_of("t,load [N],load [kN]\n0,1,1\n1,2,2\n", one),
            "REC.csv:1: two columns are called 'load', expected one");
}

// A message is one line whatever bytes the file holds.
TEST(RecordingCsv, ShowsControlCharactersEscapedAndCutsLongText) {
  EXPECT_EQ(message_of("t,F\n0,1\n1,a\x1b[2J\x07\n"), "REC.csv:3: F is 'a\\x1b[2J\\x07', expected a number");
  EXPECT_EQ(message_of("t,F\n0,1\n1," + std::string(100, 'x') + "\n"),
            "REC.csv:3: F is '" + std::string(60, 'x') + "…', expected a number");
}

// Law. Time printed with d decimals at a rate whose period is no multiple of 10⁻ᵈ has uneven steps of up to 10⁻ᵈ more
// or less, and is evenly sampled all the same; one sample taken out of it is a gap.
TEST(RecordingTime, AllowsForTheRoundingOfPrintedStampsAndStillFindsOneMissingSample) {
  for (const double rate : {50.0, 60.0, 128.0, 300.0, 441.0, 999.0, 1000.0, 1024.0, 7000.0}) {
    for (const int decimals : {4, 5, 6, 9}) {
      const double period = 1.0 / rate;
      if (std::pow(10.0, -decimals) > 0.5 * period) continue;
      for (const std::size_t missing : {std::size_t{0}, std::size_t{1234}}) {
        std::string text = "t,F\n";
        for (std::size_t k = 0; k < 3000; ++k) {
          if (k == missing && missing != 0) continue;
          std::array<char, 64> row{};
          std::snprintf(row.data(), row.size(), "%.*f,1\n", decimals, 700.0 + static_cast<double>(k) / rate);
          text += row.data();
        }
        const std::string message = message_of(text, {}, rate);
        const std::string without_rate = message_of(text);
        const auto where = testing::Message() << rate << " Hz, " << decimals << " decimals, " << message;
        if (missing == 0) {
          EXPECT_EQ(message, "no error") << where;
          EXPECT_EQ(without_rate, "no error") << where;
        } else {
          EXPECT_EQ(message.find("REC.csv:1236: gap in time"), 0U) << where;  // header, then 1234 rows
          EXPECT_EQ(without_rate.find("REC.csv:1236: gap in time"), 0U) << where << without_rate;
        }
      }
    }
  }
}

// Stamps, as printf prints them.
std::string printed_stamps(const char* format, double start, double rate, double unit = 1.0, int count = 1000) {
  std::string rows = "t,F\n";
  for (int k = 0; k < count; ++k) {
    std::array<char, 64> row{};
    std::snprintf(row.data(), row.size(), format, (start + k / rate) / unit);
    rows += std::string(row.data()) + ",1\n";
  }
  return rows;
}

// "%g" keeps six digits, so stamps grow coarser as time passes 10 or 100 s, in seconds or in milliseconds, before or
// after zero: fine while a gap can be told, refused from then on.
TEST(RecordingTime, RefusesStampsTooCoarseToTellAGapFromAStep) {
  for (const double start : {0.0, 6.0, 98.0, -102.0, -12.0, 500.0}) {
    EXPECT_EQ(message_of(printed_stamps("%g", start, 60.0), {}, 60.0), "no error") << start;
    EXPECT_EQ(message_of(printed_stamps("%g", start, 60.0, 1e-3), {{"t", {"t", 1e-3, 0.0}}}, 60.0), "no error")
        << start;
  }
  EXPECT_EQ(message_of(printed_stamps("%g", 5000.0, 60.0), {}, 60.0),
            "REC.csv:3: time is rounded to 0.01 s, expected stamps that tell a gap from a step of 0.0166667 s");
}

// "%g" writes 10 behind 9.99: the last stamp has fewer digits than the steps need, and is no stamp of tenths.
TEST(RecordingTime, ReadsStampsThatEndAtAPowerOfTen) {
  for (const double end : {1.0, 10.0, 100.0, 1000.0}) {
    for (const double rate : {100.0, 128.0, 250.0}) {
      const int count = static_cast<int>(std::min(3.0, end) * rate) + 1;
      const double start = end - (count - 1) / rate;
      EXPECT_EQ(message_of(printed_stamps("%.10g", start, rate, 1.0, count), {}, rate), "no error") << end << rate;
    }
  }
  // Where rows are missing before it, it is refused all the same.
  const std::string rows = printed_stamps("%g", 9.0, 100.0, 1.0, 96);
  EXPECT_NE(message_of(rows + "10,1\n", {}, 100.0), "no error");
}

// Exponents count: 1.111e-03 has six decimals.
TEST(RecordingTime, ReadsTheRoundingOfStampsWithExponents) {
  EXPECT_EQ(message_of(printed_stamps("%.3e", 0.0, 900.0, 1.0, 30), {}, 900.0), "no error");
}

// Seconds since 1970 at 10 kHz: neighbouring doubles are 2.4e-7 s apart there, more than 10⁻³ of a step.
TEST(RecordingTime, AllowsForTheRoundingOfLargeTimes) {
  std::string text = "t,F\n";
  for (int k = 0; k < 300; ++k) text += firmware::shortest(1.7e9 + k / 1e4) + ",1\n";
  EXPECT_EQ(message_of(text, {}, 10000.0), "no error");
}

// Stamps kept in single precision, as a logger without a double does, are off by up to 3e-5 s after 754 s.
TEST(RecordingTime, AllowsForSinglePrecisionStamps) {
  std::string text = "t,F\n";
  for (int k = 0; k < 2000; ++k) {
    text += firmware::shortest(static_cast<double>(static_cast<float>(754.67 + k * 1e-3))) + ",1\n";
  }
  EXPECT_EQ(message_of(text, {}, 1000.0), "no error");
  EXPECT_EQ(message_of(text), "no error");
}

// Jitter beyond 10⁻³ of the step is no even sampling; below it costs no more than the simulator's own error.
TEST(RecordingTime, AllowsOneThousandthOfJitter) {
  EXPECT_EQ(message_of("t,F\n0,1\n1.0009,2\n2.00000000001,3\n3,4\n4,5\n", {}, 1.0), "no error");
  EXPECT_EQ(message_of("t,F\n0,1\n1.0011,2\n2.00000000001,3\n3,4\n4,5\n", {}, 1.0),
            "REC.csv:3: gap in time: 1.0011 follows 0, expected steps of 1 s ± 0.001 s");
}

// A clock may be off by 100 parts in a million, as quartz is; beyond that the rate is another one. 10⁶ samples, so that
// jitter of the first and the last stamp does not matter.
TEST(RecordingTime, AllowsTheClockErrorOfQuartzAndNoMore) {
  const auto text = [](double stretch) {
    std::string rows = "t,F\n";
    for (int k = 0; k < 100000; ++k) rows += firmware::shortest(k * 1e-3 * stretch) + ",1\n";
    return rows;
  };
  EXPECT_EQ(message_of(text(1.0 + 9e-5), {}, 1000.0), "no error");
  EXPECT_EQ(message_of(text(1.0 - 9e-5), {}, 1000.0), "no error");
  EXPECT_EQ(message_of(text(1.0 + 2e-4), {}, 1000.0),
            "REC.csv:3: the recording's rate is 999.8 Hz (steps of 0.0010002 s), expected 1000 Hz as in the rig "
            "description");
}

// Without a rig description the recording's own clock counts: a whole rate where the stamps allow it, else the mean.
TEST(RecordingTime, FindsTheRateOfARecordingByItself) {
  EXPECT_EQ(parse_recording_csv("t,F\n10.002,1\n10.004,1\n10.006,1\n", "REC.csv").sample_period, 1.0 / 500.0);
  EXPECT_EQ(parse_recording_csv("t,F\n0,1\n0.003333,1\n0.006667,1\n0.010000,1\n", "REC.csv").sample_period,
            1.0 / 300.0);
  EXPECT_EQ(parse_recording_csv("t,F\n0,1\n2.5,1\n5,1\n", "REC.csv").sample_period, 2.5);
  EXPECT_EQ(parse_recording_csv("t,F\n0.01,1\n1.1,1\n", "REC.csv").sample_period, 1.1 - 0.01);
  EXPECT_NEAR(parse_recording_csv(printed_stamps("%.9f", 0.0, 300.2), "REC.csv").sample_period, 1.0 / 300.2, 1e-11);
  // A gap is no reason to believe in longer steps.
  EXPECT_EQ(message_of("t,F\n0,1\n1,1\n2,1\n10,1\n11,1\n12,1\n"),
            "REC.csv:5: gap in time: 10 follows 2, expected steps of 1 s ± 0.001 s");
}

// The doubles nearest to k/rate print as short decimals, which sums of 0.001 do not.
TEST(RecordingTime, StampsAreExactDecimals) {
  const std::vector<double> times = firmware::sample_times(100000, 1000.0, 3);
  EXPECT_EQ(firmware::shortest(times[0]), "0.003");
  for (std::size_t k = 0; k < times.size(); ++k) ASSERT_LE(firmware::shortest(times[k]).size(), 7U) << k;
}

// Same bits: every finite double, denormal and −0 too, comes back as it was, with all channels, ducts and extra
// columns.
TEST(RecordingCsv, GivesBackTheSameBits) {
  const support::TemporaryFolder folder;
  Recording run = a_run(2000, 1);
  run[Channel::F][0] = -0.0;
  run[Channel::F][1] = std::numeric_limits<double>::denorm_min();
  run[Channel::F][2] = std::numeric_limits<double>::max();
  run.extra.push_back({"F_w_c", "N", any_doubles(2000, 99)});
  run.comments = {"rig 12ab", "two\nlines"};
  host_sim::write_recording(folder / "run.csv", run);
  const Recording back = read_recording(folder / "run.csv", {}, 1000.0);
  expect_same_bits(back.time, run.time, "t");
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    expect_same_bits(back.channels[i], run.channels[i], model::channel_names[i].name);
  }
  for (std::size_t i = 0; i < firmware::recorded_ducts; ++i) expect_same_bits(back.ducts[i], run.ducts[i], "duct");
  EXPECT_EQ(back.ignored_columns, std::vector<std::string>{"F_w_c [N]"});
  EXPECT_EQ(folder.count(), 1U);
}

// The layout that other people's scripts read: t first, units after names, comments above.
TEST(RecordingCsv, WritesTheContractsLayout) {
  Recording run;
  run.time = {0.0, 0.001};
  run[Channel::F_w] = {-1.5, 1e-7};
  run[Channel::zdd_b] = {100000.0, 0.1};
  run.ducts[0] = {1.0, 0.0};
  run.extra = {{"F_w_c", "N", {2.0, 3.0}}, {"state", "", {0.0, 4.0}}};
  run.comments = {"rigtwin 1.0"};
  EXPECT_EQ(format_recording_csv(run),
            "# rigtwin recording: SI units\n# rigtwin 1.0\n"
            "t,zdd_b [m/s²],F_w [N],duct_1,F_w_c [N],state\n"
            "0,1e+05,-1.5,1,2,0\n0.001,0.1,1e-07,0,3,4\n");
}

// Columns of different length are our own mistake, not the user's.
TEST(RecordingCsv, RefusesToWriteColumnsOfDifferentLength) {
  const support::TemporaryFolder folder;
  Recording run;
  run.time = {0.0, 0.001};
  run[Channel::F] = {1.0};
  EXPECT_THROW(host_sim::write_recording(folder / "run.csv", run), std::logic_error);
  EXPECT_EQ(folder.count(), 0U);
}

// Where the blocks of a file end does not matter: every block length up to the whole file gives the same recording.
TEST(RecordingCsv, ReadsBlocksOfAnyLengthAlike) {
  const support::TemporaryFolder folder;
  const std::string text = "\xef\xbb\xbf# c\r\nt,F [N],x\r\n0,1.25,a\r\n1,-2,b\r\n2,3e-5,c";
  const std::filesystem::path file = folder.write("rec.csv", text);
  const Recording whole = parse_recording_csv(text, "REC.csv", {}, 1.0);
  for (std::size_t head = 0; head < text.size(); ++head) {
    for (std::size_t block = 1; block < text.size(); ++block) {
      const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
      ASSERT_EQ(::lseek(descriptor, static_cast<off_t>(head), SEEK_SET), static_cast<off_t>(head));
      const Recording rec = firmware::read_recording_csv(descriptor, text.substr(0, head), "REC.csv", {}, 1.0,
                                                         firmware::Missing::refuse, block);
      ::close(descriptor);
      ASSERT_EQ(rec.time, whole.time) << head << ' ' << block;
      ASSERT_EQ(rec[Channel::F], whole[Channel::F]) << head << ' ' << block;
    }
  }
}

// A file without line ends (a disk image called .csv) is given up early, not swallowed whole.
TEST(RecordingCsv, GivesUpOnAnEndlessLine) {
  const support::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("rec.csv", "t,F\n0,1\n" + std::string(5U << 20U, '7'));
  try {
    static_cast<void>(read_recording(file));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(),
              file.string() + ":3: the line is longer than 1 MiB, expected a text file, one row a sample");
  }
}

TEST(RecordingCsv, GivesUpOnAnEndlessFile) { EXPECT_THROW(static_cast<void>(read_recording("/dev/zero")), InputError); }

// What is no readable file is an InputError as well, without a line.
TEST(RecordingFile, RefusesAFolderAMissingFileAndAnEmptyOne) {
  const support::TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& file) -> std::string {
    try {
      static_cast<void>(read_recording(file));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string recording = "expected a recording, CSV or MATLAB 5 or 7.3";
  EXPECT_EQ(message(folder.path()), folder.path().string() + ": is a directory, " + recording);
  EXPECT_EQ(message(folder / "none.csv"),
            (folder / "none.csv").string() + ": cannot be opened: No such file or directory, " + recording);
  for (const char* name : {"empty.csv", "empty.mat"}) {
    EXPECT_EQ(message(folder.write(name, "")),
              (folder / name).string() + ": the file is empty, expected a header line such as t,z_r,F_w");
  }
  EXPECT_EQ(
      message(folder.write("text.mat", "t,F\n0,1\n1,2\n")),
      (folder / "text.mat").string() + ": is not a MATLAB 5 or 7.3 file, expected one saved with -v6, -v7 or -v7.3");
  EXPECT_EQ(message(folder.write("two\nlines.csv", "")).find('\n'), std::string::npos);
}

// A channel that a computation cannot do without is asked for with the reason.
TEST(RecordingFile, SaysWhatAMissingChannelIsNeededFor) {
  const Recording rec = parse_recording_csv("t,F\n0,1\n1,2\n", "REC.csv");
  EXPECT_EQ(rec.required(Channel::F, "to compare").size(), 2U);
  try {
    static_cast<void>(rec.required(Channel::z_r, "drives the simulation"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "REC.csv: there is no channel z_r, expected that channel: it drives the simulation");
  }
  // Columns that nobody could name: with the line that would.
  const Recording unread = parse_recording_csv("t,F,Road mm,a,b,c,d\n0,1,2,3,4,5,6\n1,2,3,4,5,6,7\n", "REC.csv");
  try {
    static_cast<void>(unread.required(Channel::z_r, "drives the simulation"));
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("no channel: Road mm, a, b, c and 1 more; under [channels] z_r = { column = \"Road mm\""),
              std::string::npos)
        << text;
  }
}

// Law. The ends of a long recording come in parts, as the whole does; text of other programs is read whole.
TEST(RecordingFile, ReadsTheEndsOfALongOne) {
  std::string text = "t,z_r [m]\n", semicolons = "t;z_r [m]\n";
  for (int k = 0; k < 8000; ++k) {
    if (k >= 800 && k < 850) continue;  // a gap of half a second
    const std::string row = std::to_string(k / 100) + (k % 100 < 10 ? ".0" : ".") + std::to_string(k % 100);
    text += row + "," + std::to_string(k % 7) + "\n";
    semicolons += row + ";" + std::to_string(k % 7) + "\n";
  }
  const support::TemporaryFolder folder;
  const auto ends = host_sim::read_parts_of_ends(folder.write("long.csv", text), {}, 100.0, 20.0, 10.0, 0);
  ASSERT_TRUE(ends);
  ASSERT_EQ(ends->first.size(), 2U);
  EXPECT_EQ(ends->first[0].size(), 800U);
  EXPECT_EQ(ends->first[1].size(), 1150U);
  ASSERT_EQ(ends->last.size(), 1U);
  EXPECT_EQ(ends->last[0][Channel::z_r][0], 7000 % 7);
  EXPECT_NEAR(ends->seconds, 79.99, 1e-9);
  EXPECT_FALSE(host_sim::read_parts_of_ends(folder.write("long.txt", semicolons), {}, 100.0, 20.0, 10.0, 0));
  EXPECT_FALSE(host_sim::read_parts_of_ends(folder / "long.csv", {}, 100.0, 20.0, 10.0)) << "short";
}

// Real measurements of others are read as they are.
TEST(RecordingFile, ReadsTheRealRecordings) {
  const std::filesystem::path real = std::filesystem::path(RIGTWIN_SOURCE_DIR) / ".." / "shared" / "real";
  if (!std::filesystem::exists(real)) GTEST_SKIP() << real << " is missing";
  const Recording quanser = read_recording(real / "quanser_1.csv", {}, 500.0);
  EXPECT_EQ(quanser.size(), 14951U);
  EXPECT_TRUE(quanser.has(Channel::F_act));
  EXPECT_EQ(read_recording(real / "quanser_3.csv").sample_period, 1.0 / 500.0);
  EXPECT_EQ(read_recording(real / "mr_damper_A1.csv", {}, 100.0).size(), 1501U);
}

}  // namespace
