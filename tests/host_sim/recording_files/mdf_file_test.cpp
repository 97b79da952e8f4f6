// MDF 4: files built by hand from the format's description (tests/fuzz/corpus/fuzz_mdf) have their values however their
// data are stored. Six rows at 1 kHz: Temp [°C] by a table, Kraft [N] = 10 + 0.5 × (0, 100 … 500), the third invalid.
#include "host_sim/recording_files/binary/mdf_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

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

// Blocks of MDF 4 by ASAM's description, one behind the other; links are places.
class MdfBytes {
 public:
  MdfBytes() {
    bytes_ = "MDF     4.20    rigtwin ";
    bytes_.resize(64, '\0');
    put(28, 420, 2);
    head_ = add("HD", 6, std::string(32, '\0'));
  }

  std::uint64_t add(const std::string& id, std::size_t links, const std::string& data) {
    bytes_.resize((bytes_.size() + 7) / 8 * 8, '\0');
    const std::uint64_t at = bytes_.size();
    bytes_ += "##" + id + std::string(4, '\0') + number(24 + 8 * links + data.size(), 8) + number(links, 8) +
              std::string(8 * links, '\0') + data;
    return at;
  }
  void link(std::uint64_t block, std::size_t k, std::uint64_t to) {
    put(static_cast<std::size_t>(block) + 24 + 8 * k, to, 8);
  }
  std::uint64_t text(const std::string& words) { return add("TX", 0, words + std::string(1, '\0')); }

  // A data group with one channel group of `rows` records; the channel group.
  std::uint64_t group(std::uint64_t data, std::uint64_t rows, std::uint32_t size, std::uint32_t invalid,
                      std::uint64_t master) {
    const std::uint64_t flags = master == 0 ? 0 : 8;
    const std::uint64_t cg = add("CG", master == 0 ? 6 : 7,
                                 number(0, 8) + number(rows, 8) + number(flags, 2) + std::string(6, '\0') +
                                     number(size, 4) + number(invalid, 4));
    if (master != 0) link(cg, 6, master);
    const std::uint64_t dg = add("DG", 4, std::string(8, '\0'));
    link(dg, 1, cg);
    link(dg, 2, data);
    link(last_group_ == 0 ? head_ : last_group_, 0, dg);
    last_group_ = dg;
    return cg;
  }

  struct Kind {
    unsigned type = 0, sync = 0, data_type = 4, bits = 64, flags = 0;  // a 64-bit float
  };
  void channel(std::uint64_t cg, const std::string& name, Kind kind, std::uint64_t conversion = 0) {
    const std::uint64_t cn =
        add("CN", 8,
            number(kind.type, 1) + number(kind.sync, 1) + number(kind.data_type, 1) + number(0, 1) + number(0, 4) +
                number(kind.bits, 4) + number(kind.flags, 4) + number(0, 4) + std::string(52, '\0'));
    link(cn, 2, text(name));
    link(cn, 4, conversion);
    link(cg, 1, cn);
  }
  std::uint64_t conversion(unsigned type, const std::vector<double>& values) {
    std::string data = number(type, 1) + std::string(5, '\0') + number(values.size(), 2) + std::string(16, '\0');
    for (const double value : values) data += number(std::bit_cast<std::uint64_t>(value), 8);
    return add("CC", 4, data);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

  static std::string number(std::uint64_t value, std::size_t size) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i) text += static_cast<char>(value >> (8 * i) & 0xffU);
    return text;
  }
  static std::string doubles(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += number(std::bit_cast<std::uint64_t>(value), 8);
    return text;
  }

 private:
  void put(std::size_t at, std::uint64_t value, std::size_t size) { bytes_.replace(at, size, number(value, size)); }

  std::string bytes_;
  std::uint64_t head_ = 0, last_group_ = 0;
};

// Columns in groups of their own: values and invalidation bits in an LD list of two blocks each, the time in another
// group behind it. y = (x² + 2x + 3)/(x + 1) by a rational conversion.
TEST(MdfFile, ColumnsOfTheirOwnGroupsHaveTheTimeOfAnother) {
  MdfBytes file;
  const auto list =
      file.add("LD", 5, MdfBytes::number(0x80000000U, 4) + MdfBytes::number(2, 4) + std::string(16, '\0'));
  file.link(list, 1, file.add("DV", 0, MdfBytes::doubles({0.0, 1.0})));
  file.link(list, 2, file.add("DV", 0, MdfBytes::doubles({2.0, 3.0})));
  file.link(list, 3, file.add("DI", 0, std::string("\0\1", 2)));
  file.link(list, 4, file.add("DI", 0, std::string("\0\0", 2)));
  // The master's group is linked behind the value's.
  const auto values = file.group(list, 4, 8, 1, 1);
  file.channel(values, "Kraft", {.flags = 2}, file.conversion(2, {1.0, 2.0, 3.0, 0.0, 1.0, 1.0}));
  const auto master = file.group(file.add("DT", 0, MdfBytes::doubles({0.5, 0.6, 0.7, 0.8})), 4, 8, 0, 0);
  file.channel(master, "time", {.type = 2, .sync = 1});
  file.link(values, 6, master);
  const host_sim::RawTable table = host_sim::table_of_mdf(file.bytes(), "columns.mf4");
  const host_sim::RawColumn& force = column(table, "Kraft");
  ASSERT_EQ(force.values.size(), 4U);
  EXPECT_EQ(force.values[0], 3.0);
  EXPECT_TRUE(std::isnan(force.values[1]));
  EXPECT_EQ(force.values[2], 11.0 / 3.0);
  EXPECT_EQ(force.values[3], 18.0 / 4.0);
  EXPECT_EQ(column(table, "t").values[3], 0.8);
}

// Point. The other conversions of ASAM MDF 4.1, table 34: linear, tables with and without interpolation, of ranges.
TEST(MdfFile, ConversionsAreThoseOfTheFormat) {
  struct Conversion {
    unsigned type;
    std::vector<double> numbers, expected;  // of x = 0, 1, 2.5
  };
  for (const Conversion& one : {Conversion{1, {10.0, 2.0}, {10.0, 12.0, 15.0}},
                                Conversion{4, {0.0, 0.0, 2.0, 20.0, 3.0, 40.0}, {0.0, 10.0, 30.0}},
                                Conversion{5, {0.0, 1.0, 2.0, 20.0, 4.0, 40.0}, {1.0, 1.0, 20.0}},
                                Conversion{6, {0.0, 0.5, 7.0, 0.6, 2.0, 8.0, 9.0}, {7.0, 8.0, 9.0}}}) {
    SCOPED_TRACE(one.type);
    MdfBytes file;
    const auto values = file.group(file.add("DT", 0, MdfBytes::doubles({0.0, 1.0, 2.5})), 3, 8, 0, 1);
    file.channel(values, "F", {}, file.conversion(one.type, one.numbers));
    const auto master = file.group(file.add("DT", 0, MdfBytes::doubles({0.0, 1.0, 2.0})), 3, 8, 0, 0);
    file.channel(master, "t", {.type = 2, .sync = 1});
    file.link(values, 6, master);
    const host_sim::RawTable table = host_sim::table_of_mdf(file.bytes(), "run.mf4");
    EXPECT_EQ(column(table, "F").values, one.expected);
  }
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
