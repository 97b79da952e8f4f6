// Property: what is written in any format reads back as it was, names and units of other columns included.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace round_trip_test {
namespace {

using firmware::Recording;
using model::Channel;

struct Format {
  std::string ending;
  double relative;  // what the format keeps of a value: 12 digits behind the first, or those of a float
};
// NaN for the names and units that hold letters of Latin-1, blanks and percent signs.
const std::vector<std::string> names{"Oil", "Öldruck", "Valve current", "Temp 2", "T_Gehäuse"};
const std::vector<std::string> units{"°C", "V", "Nm", "bar", "", "A"};

Recording random_recording(std::mt19937& random) {
  const auto pick = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
  constexpr std::array<double, 5> rates{50.0, 1000.0, 1024.0, 300.0, 25600.0};
  const double rate = rates[static_cast<std::size_t>(pick(5))];
  const auto rows = static_cast<std::size_t>(20 + pick(200));
  Recording recording;
  recording.sample_period = 1.0 / rate;
  recording.time = firmware::sample_times(rows, rate);
  const auto values = [&] {
    std::vector<double> column(rows);
    const double size = std::pow(10.0, pick(7) - 3);
    for (double& value : column) value = size * (static_cast<double>(random()) / 4294967296.0 - 0.5);
    for (int k = 0; k < pick(4); ++k)
      column[1 + static_cast<std::size_t>(pick(static_cast<int>(rows) - 2))] = std::nan("");
    return column;
  };
  recording[Channel::x_act] = values();
  recording[Channel::F] = values();
  const int first = pick(5);
  for (int e = 0; e < 2; ++e) {
    recording.extra.push_back(
        {names[static_cast<std::size_t>((first + e) % 5)], units[static_cast<std::size_t>(pick(6))], values()});
  }
  return recording;
}

void expect_equal(const std::vector<double>& read, const std::vector<double>& written, double relative, double scale) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    if (std::isnan(written[k])) {
      EXPECT_TRUE(std::isnan(read[k])) << k;
    } else {
      ASSERT_NEAR(read[k], scale * written[k], relative * std::abs(scale * written[k])) << k;
    }
  }
}

class FormatRoundTrip : public testing::TestWithParam<Format> {};

TEST_P(FormatRoundTrip, KeepsValuesNamesAndUnits) {
  const auto& [ending, relative] = GetParam();
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const Recording written = random_recording(random);
    const support::TemporaryFolder folder;
    const std::filesystem::path file = std::filesystem::path(folder / ("r" + ending));
    host_sim::write_recording(file, written);
    const host_sim::Import import = host_sim::import_file(file, {firmware::ChannelMap{}});
    const Recording& read = import.recording;
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t k = 0; k < read.size(); ++k)
      ASSERT_NEAR(read.time[k] - read.time[0], written.time[k], 1e-6 * written.sample_period) << k;
    expect_equal(read[Channel::x_act], written[Channel::x_act], relative, 1.0);
    expect_equal(read[Channel::F], written[Channel::F], relative, 1.0);
    ASSERT_EQ(read.extra.size(), written.extra.size());
    for (std::size_t e = 0; e < read.extra.size(); ++e) {
      EXPECT_EQ(read.extra[e].name, written.extra[e].name);
      // A unit of a channel's dimension comes back in SI.
      const bool bar = written.extra[e].unit == "bar";
      EXPECT_EQ(read.extra[e].unit, bar ? "Pa" : written.extra[e].unit);
      expect_equal(read.extra[e].values, written.extra[e].values, relative + 1e-15, bar ? 1e5 : 1.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(In, FormatRoundTrip,
                         testing::Values(Format{".csv", 0.0}, Format{".tsv", 0.0}, Format{".de.csv", 0.0},
                                         Format{".uff", 1e-12}, Format{".rsp", 6e-8}, Format{".mf4", 0.0},
                                         Format{".mat", 0.0}, Format{".mcap", 0.0}),
                         [](const auto& shape) {
                           std::string name = shape.param.ending;
                           std::erase(name, '.');
                           return name;
                         });

}  // namespace
}  // namespace round_trip_test
