// MDF 4: files built by hand from the format's description (tests/fuzz/corpus/fuzz_mdf) have their values however their
// data are stored. Six rows at 1 kHz: Temp [°C] by a table, Kraft [N] = 10 + 0.5 × (0, 100 … 500), the third invalid.
#include "host_sim/recording_files/binary/mdf_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace mdf_file_test {
namespace {

std::string bytes_of(const std::string& name) {
  return support::TemporaryFolder::read((support::source / "tests" / "fuzz" / "corpus" / "fuzz_mdf" / name).string());
}

const host_sim::RawColumn& column(const host_sim::RawTable& table, std::string_view name) {
  return *std::find_if(table.columns.begin(), table.columns.end(), [&](const auto& one) { return one.name == name; });
}

void expect_run(const host_sim::RawTable& table) {
  const host_sim::RawColumn& force = column(table, "Kraft");
  const host_sim::RawColumn& temperature = column(table, "Temp");
  ASSERT_EQ(force.values.size(), 6U);
  EXPECT_EQ(force.unit, "N");
  EXPECT_EQ(temperature.unit, "°C");
  for (std::size_t k = 0; k < 6; ++k) {
    if (k == 2) {
      EXPECT_TRUE(std::isnan(force.values[k]));
    } else {
      EXPECT_EQ(force.values[k], 10.0 + 50.0 * static_cast<double>(k));
    }
    EXPECT_NEAR(temperature.values[k], 20.0 + 5.0 * static_cast<double>(k), 1e-12);
  }
}

TEST(MdfFile, IsReadHoweverItsDataAreStored) {
  for (const char* name : {"plain.mf4", "list.mf4", "transposed.mf4"}) {
    SCOPED_TRACE(name);
    const host_sim::RawTable table = host_sim::table_of_mdf(bytes_of(name), name);
    expect_run(table);
    EXPECT_EQ(column(table, "t").values[5], 0.005);
  }
}

// Records of two groups in turn, each with its own master; the second one's counts milliseconds.
TEST(MdfFile, UnsortedGroupsHaveTheirOwnTimes) {
  const host_sim::RawTable table = host_sim::table_of_mdf(bytes_of("unsorted.mf4"), "unsorted.mf4");
  expect_run(table);
  const host_sim::RawColumn& stroke = column(table, "Weg");
  ASSERT_EQ(stroke.own_time.size(), 3U);
  EXPECT_EQ(stroke.own_time[2], 0.004);
  EXPECT_EQ(stroke.values[2], 2.0);
  EXPECT_EQ(stroke.group, "Slow");
}

TEST(MdfFile, SaysWhichVersionItCannotRead) {
  std::string old = bytes_of("plain.mf4");
  old.replace(8, 8, "3.30    ");
  old[28] = 74;  // 330
  old[29] = 1;
  try {
    static_cast<void>(host_sim::table_of_mdf(old, "old.mdf"));
    FAIL();
  } catch (const firmware::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("MDF 3.30"), std::string::npos) << error.what();
  }
}

TEST(MdfFile, EveryCutIsRefusedOrListed) {
  const std::string whole = bytes_of("list.mf4");
  for (std::size_t size = 64; size < whole.size(); size += 7) {
    try {
      const host_sim::RawTable table = host_sim::table_of_mdf(std::string_view(whole).substr(0, size), "cut.mf4");
      EXPECT_FALSE(table.left_out.empty()) << size;
    } catch (const firmware::InputError&) {
    }
  }
}

}  // namespace
}  // namespace mdf_file_test
