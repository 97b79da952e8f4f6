// Time histories in universal files: the layout by its description, and that writing and reading give the recording.
#include "tests/support/universal_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::Recording;
using model::Channel;
using support::TemporaryFolder;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Recording a_recording(std::size_t samples, double rate) {
  Recording recording;
  recording.sample_period = 1.0 / rate;
  recording.time = firmware::sample_times(samples, rate);
  for (std::size_t k = 0; k < samples; ++k) {
    recording[Channel::z_w].push_back(1e-3 * std::sin(0.1 * static_cast<double>(k)));
    recording[Channel::F_w].push_back(-1e5 / (3.0 + static_cast<double>(k)));
  }
  recording.ducts[1].assign(samples, 1.0);
  recording.extra.push_back({"a_very_long_name", "m/s²", std::vector<double>(samples, 0.25)});
  return recording;
}

/// 4E20.12 keeps 13 digits: half a unit of the last is 5e-13 of the first digit.
void expect_near(const std::vector<double>& read, const std::vector<double>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    ASSERT_NEAR(read[k], written[k], 5.0001e-13 * std::abs(written[k])) << k;
  }
}

/// One dataset 58 as text; `kind`: type of the numbers, `even` or the pairs that stand in `numbers`.
std::string dataset(const std::string& name, int kind, std::size_t points, bool even, const std::string& numbers,
                    const std::string& unit = "N", int type = 9, int abscissa = 17) {
  std::array<char, 2048> text{};
  std::snprintf(text.data(), text.size(),
                "    -1\n%6d\n%s\nNONE\n25-Nov-26 10:00:00\nNONE\nNONE\n"
                "%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d\n%10d%10zu%10d%13.5E%13.5E%13.5E\n"
                "%10d%5d%5d%5d %-20s %-20s\n%10d%5d%5d%5d %-20s %-20s\n%10d%5d%5d%5d %-20s %-20s\n"
                "%10d%5d%5d%5d %-20s %-20s\n",
                58, name.c_str(), 1, 1, 0, 0, name.c_str(), 7, -3, "NONE", 0, 0, kind, points, even ? 1 : 0, 0.0,
                even ? 1e-3 : 0.0, 0.0, abscissa, 0, 0, 0, "Time", "s", type, 0, 0, 0, "NONE", unit.c_str(), 0, 0, 0, 0,
                "NONE", "NONE", 0, 0, 0, 0, "NONE", "NONE");
  return text.data() + numbers + "    -1\n";
}

Recording read(const std::string& bytes) {
  const TemporaryFolder folder;
  return host_sim::read_recording(folder.write("rec.uff", bytes));
}

std::string error_of(const std::string& bytes) {
  const TemporaryFolder folder;
  try {
    static_cast<void>(host_sim::read_recording(folder.write("rec.uff", bytes)));
  } catch (const firmware::InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("rec.uff"));
  }
  return "no error";
}

// Golden by the format's description: units, then one time response a column.
TEST(UniversalHistory, IsWrittenByTheDescriptionOfTheFormat) {
  const TemporaryFolder folder;
  const Recording recording = a_recording(1001, 1000.0);
  host_sim::write_recording(folder / "run.uff", recording);
  support::universal::File file(TemporaryFolder::read(folder / "run.uff"));
  ASSERT_EQ(file.dataset(), 164);
  for (int i = 0; i < 3; ++i) static_cast<void>(file.record());
  file.delimiter();
  struct Expected {
    std::string name;
    int node, type, length, force;
    std::string unit;
    const std::vector<double>* values;
  };
  const std::array<Expected, 4> columns{{{"z_w", 2, 8, 1, 0, "m", &recording[Channel::z_w]},
                                         {"F_w", 4, 9, 0, 1, "N", &recording[Channel::F_w]},
                                         {"duct_2", 0, 0, 0, 0, "NONE", &recording.ducts[1]},
                                         {"a_very_long_name", 0, 12, 1, 0, "m/s^2", &recording.extra[0].values}}};
  for (const Expected& expected : columns) {
    SCOPED_TRACE(expected.name);
    ASSERT_EQ(file.dataset(), 58);
    const support::universal::Function f = file.function();
    EXPECT_EQ(f.id[0], expected.name);
    EXPECT_EQ(f.response, expected.name.substr(0, 10));
    EXPECT_EQ(f.type, 1);
    EXPECT_EQ(f.data_type, 4);
    EXPECT_EQ(f.response_node, expected.node);
    EXPECT_EQ(f.response_direction, expected.node == 0 ? 0 : 3);
    EXPECT_EQ(f.spacing, 1);
    EXPECT_EQ(f.first, 0.0);
    EXPECT_EQ(f.increment, 0.001);
    EXPECT_EQ(f.axes[0].type, 17);
    EXPECT_EQ(f.axes[0].unit, "s");
    EXPECT_EQ(f.axes[1].type, expected.type);
    EXPECT_EQ(f.axes[1].length, expected.length);
    EXPECT_EQ(f.axes[1].force, expected.force);
    EXPECT_EQ(f.axes[1].unit, expected.unit);
    expect_near(f.numbers, *expected.values);
  }
  EXPECT_TRUE(file.at_end());
}

// The way there and back, at rates whose period six digits do not hold: the stamps are those of the recording.
TEST(UniversalHistory, ComesBackAsItWas) {
  for (const double rate : {1000.0, 97.0, 1024.0, 3.0, 48000.0}) {
    SCOPED_TRACE(rate);
    const TemporaryFolder folder;
    Recording recording = a_recording(500, rate);
    recording.extra.clear();
    host_sim::write_recording(folder / "run.uff", recording);
    const Recording read = host_sim::read_recording(folder / "run.uff", {}, rate);
    EXPECT_EQ(read.time, recording.time);
    expect_near(read[Channel::z_w], recording[Channel::z_w]);
    expect_near(read[Channel::F_w], recording[Channel::F_w]);
    EXPECT_EQ(read.ducts[1], recording.ducts[1]);
    const host_sim::Import import = host_sim::import_file(folder / "run.uff", {{}, rate, std::nullopt});
    EXPECT_EQ(import.format, "universal file");
    EXPECT_EQ(import.recording.time, recording.time);
  }
}

// Missing values and missing rows are NaN; stamps on no grid stand beside the values, as long as six digits tell them
// apart.
TEST(UniversalHistory, KeepsWhatIsMissingAndUnevenTimes) {
  const TemporaryFolder folder;
  Recording recording = a_recording(100, 1000.0);
  recording[Channel::F_w][3] = not_a_number;
  recording.extra.clear();
  recording.ducts[1].clear();
  for (auto* column : {&recording.time, &recording[Channel::F_w], &recording[Channel::z_w]}) {
    column->erase(column->begin() + 50, column->begin() + 53);
  }
  host_sim::write_recording(folder / "gap.uff", recording);
  const host_sim::Import gap = host_sim::import_file(folder / "gap.uff", {{}, 1000.0, std::nullopt});
  ASSERT_EQ(gap.recording.size(), 100U);
  for (const std::size_t k : {3U, 50U, 52U}) EXPECT_TRUE(std::isnan(gap.recording[Channel::F_w][k])) << k;
  EXPECT_EQ(gap.recording.time, firmware::sample_times(100, 1000.0));

  Recording uneven = a_recording(4, 1.0);
  uneven.time = {0.0, 0.25, 1.0, 1.5};
  host_sim::write_recording(folder / "uneven.unv", uneven);
  const std::string text = TemporaryFolder::read(folder / "uneven.unv");
  EXPECT_NE(text.find("\n  0.00000E+00  0.000000000000E+00  2.50000E-01"), std::string::npos) << text;
  uneven.time = {1000.0, 1000.001, 1000.0035, 1000.004};
  EXPECT_THROW(host_sim::write_recording(folder / "late.uff", uneven), firmware::OutputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "late.uff"));
}

// Other programs: single precision, uneven spacing, exponents with D and without a letter, fields that touch, units by
// kind, names by node, other datasets beside them, ends of lines of Windows.
TEST(UniversalFileReader, TakesWhatOtherProgramsWrite) {
  const std::string other = "    -1\n    15\n         1         0         0         0\n    -1\n";
  const Recording single = read(other + dataset("F_w", 2, 7, true,
                                                "  1.00000E+00-2.00000E+00  3.00000D+00  4.00000-101-5.00000E+00 6.0\n"
                                                "  7.00000E+00\n"));
  EXPECT_EQ(single[Channel::F_w], (std::vector<double>{1.0, -2.0, 3.0, 4e-101, -5.0, 6.0, 7.0}));
  EXPECT_EQ(single.time, firmware::sample_times(7, 1000.0));
  EXPECT_NE(single.remark.find("passed over: 1 × dataset 15"), std::string::npos) << single.remark;

  std::string windows = dataset(
      "F_w", 4, 3, false,
      "  0.00000E+00  1.000000000000E+00  1.00000E-03  2.000000000000E+00\n  2.00000E-03 -3.000000000000E+00\n", "kN");
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2) windows.insert(at, "\r");
  const Recording uneven = read(windows);
  EXPECT_EQ(uneven[Channel::F_w], (std::vector<double>{1e3, 2e3, -3e3}));
  EXPECT_EQ(uneven.time, (std::vector<double>{0.0, 0.001, 0.002}));

  // Dataset 164 with millimetres: 1000 of them are a metre.
  const std::string millimetres =
      "    -1\n   164\n         5mm (milli-newton)           2\n"
      "  1.00000000000000000D+03  1.00000000000000000D+03  1.00000000000000000D+00\n"
      "  2.73149999999999977D+02\n    -1\n";
  const Recording by_kind = read(millimetres + dataset("z_w", 2, 2, true, "  1.00000E+00  2.00000E+00\n", "NONE", 8));
  EXPECT_EQ(by_kind[Channel::z_w], (std::vector<double>{1e-3, 2e-3}));

  const TemporaryFolder folder;
  const auto file = folder.write("two.uff", dataset("NONE", 2, 2, true, "  1.00000E+00  2.00000E+00\n") +
                                                dataset("ACC", 2, 2, true, "  1.00000E+00  2.00000E+00\n", "g", 12));
  const firmware::ChannelMap map{{"F", {"node 7", std::nullopt}}, {"zdd_b", {"ACC", 2.0}}};
  const Recording named = host_sim::read_recording(file, map);
  EXPECT_EQ(named[Channel::F], (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(named[Channel::zdd_b], (std::vector<double>{2.0, 4.0}));
}

// Dataset 58b: the same header, then the bytes of the numbers, of either order.
TEST(UniversalFileReader, TakesBinaryNumbers) {
  for (const bool little : {true, false}) {
    for (const bool even : {true, false}) {
      std::string bytes;
      const auto put = [&](auto value) {
        std::array<char, sizeof value> raw{};
        std::memcpy(raw.data(), &value, sizeof value);
        if (little != (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
        bytes.append(raw.data(), raw.size());
      };
      for (int k = 0; k < 3; ++k) {
        if (!even) put(static_cast<float>(k) * 0.25F);
        put(10.0 + 0.1 * k);
      }
      std::array<char, 128> header{};
      std::snprintf(header.data(), header.size(), "%6d%c%6d%6d%12d%12zu%6d%6d%12d%12d\n", 58, 'b', little ? 1 : 2, 2,
                    11, bytes.size(), 0, 0, 0, 0);
      std::string text = dataset("F_w", 4, 3, even, bytes);
      const std::string identifier = "    58\n";
      text.replace(text.find(identifier), identifier.size(), header.data());
      const TemporaryFolder folder;
      const host_sim::Import import =
          host_sim::import_file(folder.write("rec.uff", text), {{}, std::nullopt, std::nullopt});
      EXPECT_EQ(import.recording[Channel::F_w], (std::vector<double>{10.0, 10.1, 10.2})) << little << even;
      EXPECT_EQ(import.recording.time[1], even ? 0.001 : 0.25);
      text.resize(text.size() - 20);
      EXPECT_NE(error_of(text).find(" bytes a point"), std::string::npos) << error_of(text);
    }
  }
}

// What is no time history is told in one line with the place.
TEST(UniversalFileReader, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_of("    -1\n    15\n    -1\n"),
            "rec.uff: no time history is found; it holds 1 × dataset 15, expected a dataset 58 with the time as "
            "abscissa");
  EXPECT_EQ(error_of(dataset("F_w", 4, 2, true, "  1.0 2.0\n", "N", 9, 18)),
            "rec.uff: no time history is found; it holds 1 × function of type 1, expected a dataset 58 with the time "
            "as abscissa");
  EXPECT_EQ(error_of(dataset("F_w", 4, 5, true, "  1.0 2.0\n")),
            "rec.uff:15: a dataset ends after 2 numbers, expected 5");
  EXPECT_EQ(error_of(dataset("F_w", 4, 1, true, "  1.0 2.0\n")),
            "rec.uff:14: more follows the 1 points of a dataset, expected a line with -1");
  EXPECT_EQ(error_of(dataset("F_w", 4, 2, true, "  1.0 off\n")),
            "rec.uff:14: 'off' is no number, expected a number of dataset 58");
  EXPECT_EQ(error_of(dataset("F_w", 3, 2, true, "  1.0 2.0\n")),
            "rec.uff:9: the type of the numbers is 3, expected 2, 4, 5 or 6");
  const std::string whole = dataset("F_w", 4, 2, true, "  1.0 2.0\n");
  EXPECT_EQ(error_of(whole.substr(0, whole.find("NONE"))),
            "rec.uff:3: the file ends within a dataset, expected an ID line");
  EXPECT_EQ(error_of(support::with(whole, "  1.00000E-03", "  0.00000E+00")),
            "rec.uff:13: the increment of the time is 0, expected seconds above 0");
}

}  // namespace
