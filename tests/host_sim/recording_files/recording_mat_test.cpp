// Recordings as MATLAB files: versions, number types and shapes that occur; damage never gets further than a message.
#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace recording_mat_test {
namespace {

using firmware::ChannelMap;
using firmware::InputError;
using firmware::Recording;
using host_sim::read_recording;
using model::Channel;
using support::TemporaryFolder;

// Makes MATLAB files the way MATLAB does, through matio.
class MatFile {
 public:
  MatFile(const std::filesystem::path& file, mat_ft version, matio_compression compression = MAT_COMPRESSION_NONE)
      : file_(Mat_CreateVer(file.c_str(), nullptr, version)), compression_(compression) {}
  ~MatFile() { Mat_Close(file_); }
  MatFile(const MatFile&) = delete;
  MatFile& operator=(const MatFile&) = delete;

  template <class Number>
  static matvar_t* variable(const char* name, matio_classes kind, matio_types type, std::vector<Number> numbers,
                            std::size_t rows, int options = 0) {
    std::array<std::size_t, 2> size{rows, rows == 0 ? 0 : numbers.size() / rows};
    return Mat_VarCreate(name, kind, type, 2, size.data(), numbers.data(), options);
  }
  static matvar_t* column(const char* name, const std::vector<double>& numbers) {
    return variable(name, MAT_C_DOUBLE, MAT_T_DOUBLE, numbers, numbers.size());
  }
  MatFile& add(matvar_t* variable) {
    EXPECT_EQ(Mat_VarWrite(file_, variable, compression_), 0);
    Mat_VarFree(variable);
    return *this;
  }

 private:
  mat_t* file_;
  matio_compression compression_;
};

std::string message_of(const std::filesystem::path& file, const ChannelMap& map = {},
                       std::optional<double> rate = std::nullopt) {
  try {
    static_cast<void>(read_recording(file, map, rate));
  } catch (const InputError& error) {
    const std::string message = error.what();
    return message.substr(message.find(".mat") + 4);
  }
  return "no error";
}

struct Version {
  const char* name;
  mat_ft version;
  matio_compression compression;
};
constexpr std::array<Version, 3> versions{{{"5", MAT_FT_MAT5, MAT_COMPRESSION_NONE},
                                           {"5 compressed", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
                                           {"7.3", MAT_FT_MAT73, MAT_COMPRESSION_NONE}}};

// Every version holds the same vectors, as rows or columns, of any number type; what is not known is listed.
TEST(RecordingMat, ReadsVersions5And73AndAllNumberTypes) {
  for (const Version& v : versions) {
    const TemporaryFolder folder;
    {
      MatFile file(folder / "rec.mat", v.version, v.compression);
      file.add(MatFile::column("t", {1.0, 1.5, 2.0}));
      file.add(MatFile::variable<double>("z_r", MAT_C_DOUBLE, MAT_T_DOUBLE, {0.1, -0.0, 1e-300}, 1));
      file.add(MatFile::variable<float>("F", MAT_C_SINGLE, MAT_T_SINGLE, {0.5F, -3.0F, 2.0F}, 3));
      file.add(MatFile::variable<std::int16_t>("F_w", MAT_C_INT16, MAT_T_INT16, {-300, 20, 32767}, 3));
      file.add(MatFile::variable<std::uint8_t>("duct_1", MAT_C_UINT8, MAT_T_UINT8, {1, 0, 1}, 3, MAT_F_LOGICAL));
      file.add(MatFile::variable<std::int32_t>("z_w", MAT_C_INT32, MAT_T_INT32, {1, 2, -3}, 3));
      file.add(MatFile::variable<std::uint32_t>("z_b", MAT_C_UINT32, MAT_T_UINT32, {1, 2, 4000000000U}, 3));
      file.add(MatFile::variable<double>("table", MAT_C_DOUBLE, MAT_T_DOUBLE, {1.0, 2.0, 3.0, 4.0}, 2));
      file.add(MatFile::variable<std::uint8_t>("operator", MAT_C_CHAR, MAT_T_UTF8, {'a', 'n', 'n', 'a'}, 1));
    }
    const Recording rec = read_recording(folder / "rec.mat", {}, 2.0);
    EXPECT_EQ(rec.time, (std::vector<double>{1.0, 1.5, 2.0})) << v.name;
    EXPECT_EQ(rec[Channel::z_r], (std::vector<double>{0.1, -0.0, 1e-300})) << v.name;
    EXPECT_TRUE(std::signbit(rec[Channel::z_r][1])) << v.name;
    EXPECT_EQ(rec[Channel::F], (std::vector<double>{0.5, -3.0, 2.0})) << v.name;
    EXPECT_EQ(rec[Channel::F_w], (std::vector<double>{-300.0, 20.0, 32767.0})) << v.name;
    EXPECT_EQ(rec[Channel::z_w], (std::vector<double>{1.0, 2.0, -3.0})) << v.name;
    EXPECT_EQ(rec[Channel::z_b], (std::vector<double>{1.0, 2.0, 4e9})) << v.name;
    EXPECT_EQ(rec.ducts[0], (std::vector<double>{1.0, 0.0, 1.0})) << v.name;
    std::vector<std::string> ignored = rec.ignored_columns;
    std::sort(ignored.begin(), ignored.end());  // 7.3 keeps them by name
    EXPECT_EQ(ignored, (std::vector<std::string>{"operator", "table"})) << v.name;
    EXPECT_EQ(rec.sample_period, 0.5);
  }
}

// A structure of vectors, as test-bench programs save a measurement, is read like the vectors themselves.
TEST(RecordingMat, ReadsAStructureOfVectors) {
  for (const Version& v : versions) {
    const TemporaryFolder folder;
    {
      MatFile file(folder / "rec.mat", v.version, v.compression);
      std::array<const char*, 3> fields{"t", "F", "note"};
      std::array<std::size_t, 2> one{1, 1};
      matvar_t* rec = Mat_VarCreateStruct("rec", 2, one.data(), fields.data(), 3);
      Mat_VarSetStructFieldByName(rec, "t", 0, MatFile::column("t", {0.0, 1.0}));
      Mat_VarSetStructFieldByName(rec, "F", 0, MatFile::column("F", {5.0, 6.0}));
      Mat_VarSetStructFieldByName(rec, "note", 0, MatFile::column("note", {5.0}));
      file.add(rec);
    }
    const Recording rec = read_recording(folder / "rec.mat");
    EXPECT_EQ(rec[Channel::F], (std::vector<double>{5.0, 6.0})) << v.name;
    EXPECT_EQ(rec.ignored_columns, std::vector<std::string>{"rec.note"}) << v.name;
    EXPECT_EQ(read_recording(folder / "rec.mat", {{"F_w", {"rec.F", 2.0, 1.0}}})[Channel::F_w],
              (std::vector<double>{11.0, 13.0}))
        << v.name;
  }
}

// Beside a vector t a structure is something else – settings, say – and its fields are no second set of channels.
TEST(RecordingMat, LeavesAStructureBesideTheVectorsAlone) {
  const TemporaryFolder folder;
  {
    MatFile file(folder / "rec.mat", MAT_FT_MAT5);
    std::array<const char*, 2> fields{"t", "F_w"};
    std::array<std::size_t, 2> one{1, 1};
    matvar_t* start = Mat_VarCreateStruct("start", 2, one.data(), fields.data(), 2);
    Mat_VarSetStructFieldByName(start, "t", 0, MatFile::column("t", {0.0}));
    Mat_VarSetStructFieldByName(start, "F_w", 0, MatFile::column("F_w", {5.0}));
    file.add(start).add(MatFile::column("t", {0.0, 1.0})).add(MatFile::column("F", {5.0, 6.0}));
  }
  const Recording rec = read_recording(folder / "rec.mat");
  EXPECT_FALSE(rec.has(Channel::F_w));
  EXPECT_EQ(rec.ignored_columns, (std::vector<std::string>{"start.t", "start.F_w"}));
}

// [channels] names variables as it names columns.
TEST(RecordingMat, ScalesTheVariablesThatTheRigDescriptionNames) {
  const TemporaryFolder folder;
  MatFile(folder / "rec.mat", MAT_FT_MAT5)
      .add(MatFile::column("ms", {0.0, 2.0}))
      .add(MatFile::column("Road_mm", {10.0, 20.0}));
  const Recording rec =
      read_recording(folder / "rec.mat", {{"t", {"ms", 1e-3, 0.0}}, {"z_r", {"Road_mm", 1e-3, 0.0}}}, 500.0);
  EXPECT_EQ(rec[Channel::z_r], (std::vector<double>{0.01, 0.02}));
}

// What does not fit is refused with the variable or the sample, in one line.
TEST(RecordingMat, RefusesWhatIsNoRecording) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Version& v : versions) {
    const TemporaryFolder folder;
    const auto message = [&](const std::vector<matvar_t*>& variables, std::optional<double> rate = 1.0) {
      {
        MatFile file(folder / "rec.mat", v.version, v.compression);
        for (matvar_t* variable : variables) file.add(variable);
      }
      return message_of(folder / "rec.mat", {}, rate);
    };
    const auto t = [] { return MatFile::column("t", {0.0, 1.0, 2.0}); };
    const auto F = [] { return MatFile::column("F", {1.0, 2.0, 3.0}); };
    EXPECT_EQ(message({t(), F()}), "no error") << v.name;
    EXPECT_TRUE(message({F()}).starts_with(": no column is the time: 'F', expected a column such as t"))
        << message({F()});
    EXPECT_EQ(message({t(), MatFile::column("F", {1.0, 2.0})}), ": F has 2 samples, expected 3 as in t");
    EXPECT_EQ(message({t(), MatFile::column("F", {1.0, nan, 2.0})}), ": sample 2: F is nan, expected a finite number");
    EXPECT_EQ(message({t(), F(), MatFile::column("duct_1", {1.0, 0.0, 2.0})}),
              ": sample 3: duct_1 is 2, expected 1 (open) or 0 (closed)");
    EXPECT_EQ(message({MatFile::column("t", {0.0, 1.0, 0.5}), F()}),
              ": sample 3: time runs backwards: 0.5 follows 1, expected a later time in each sample");
    EXPECT_EQ(message({t(), F()}, 2.0),
              ": sample 2: the recording's rate is 1 Hz (steps of 1 s), expected 2 Hz as in the rig description");
    EXPECT_EQ(message({t(), MatFile::variable<double>("F", MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 2, 3, 4}, 2)}),
              ": F is not a vector, expected a vector of real numbers");
    EXPECT_EQ(message({t(), MatFile::variable<std::uint8_t>("F", MAT_C_CHAR, MAT_T_UTF8, {'a', 'b', 'c'}, 1)}),
              ": F is not numeric, expected a vector of real numbers");
    std::vector<double> re{1, 2, 3};
    std::vector<double> im{1, 2, 3};
    mat_complex_split_t parts{re.data(), im.data()};
    std::array<std::size_t, 2> size{3, 1};
    EXPECT_EQ(message({t(), Mat_VarCreate("F", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), &parts, MAT_F_COMPLEX)}),
              ": F is complex, expected a vector of real numbers");
  }
}

// Same bits: what was written comes back, all channels, ducts and extra columns.
TEST(RecordingMat, GivesBackTheSameBits) {
  const TemporaryFolder folder;
  Recording run;
  run.time = firmware::sample_times(500, 1000.0, 17);
  std::mt19937_64 random(3);
  const auto any = [&] {
    std::vector<double> numbers;
    while (numbers.size() < run.size()) {
      const double x = std::bit_cast<double>(static_cast<std::uint64_t>(random()));
      if (std::isfinite(x)) numbers.push_back(x);
    }
    return numbers;
  };
  for (auto& channel : run.channels) channel = any();
  run.ducts[5].assign(run.size(), 1.0);
  run.extra.push_back({"F_w_c", "N", any()});
  host_sim::write_recording(folder / "run.mat", run);
  // The map does not apply to what rigtwin wrote (recording_test.cpp says why).
  const Recording back = read_recording(folder / "run.mat", {{"F", {"F", -1.0, 0.0}}}, 1000.0);
  const auto bits = [](const std::vector<double>& numbers) {
    std::vector<std::uint64_t> all;
    all.reserve(numbers.size());
    for (const double x : numbers) all.push_back(std::bit_cast<std::uint64_t>(x));
    return all;
  };
  EXPECT_EQ(bits(back.time), bits(run.time));
  for (std::size_t i = 0; i < model::channel_count; ++i) EXPECT_EQ(bits(back.channels[i]), bits(run.channels[i])) << i;
  EXPECT_EQ(back.ducts, run.ducts);
  EXPECT_EQ(back.ignored_columns, std::vector<std::string>{"F_w_c"});
  EXPECT_EQ(folder.count(), 1U);
  // No date, no library version: the same run gives the same file.
  const std::string first = TemporaryFolder::read(folder / "run.mat");
  host_sim::write_recording(folder / "run.mat", run);
  EXPECT_EQ(TemporaryFolder::read(folder / "run.mat"), first);
}

// A copy that broke off is told as that, wherever it did, and never read as a shorter recording.
TEST(RecordingMat, RefusesAFileThatBreaksOff) {
  for (const Version& v : versions) {
    const TemporaryFolder folder;
    MatFile(folder / "rec.mat", v.version, v.compression)
        .add(MatFile::column("t", {0.0, 1.0, 2.0}))
        .add(MatFile::column("F", {0.0, 1.0, 2.0}))
        .add(MatFile::column("z_r", {0.0, 1.0, 2.0}));
    const std::string whole = TemporaryFolder::read(folder / "rec.mat");
    const std::size_t step = whole.size() > 2000 ? 97 : 7;
    for (std::size_t size = 128; size < whole.size(); size += step) {
      if (size == 128 && v.version == MAT_FT_MAT5) continue;  // a file without variables
      const std::string message = message_of(folder.write("cut.mat", whole.substr(0, size)));
      // Between two variables the file is a whole one with fewer: then a channel is missing, and only the last may be.
      const bool told = message.find("the file breaks off") != std::string::npos ||
                        message.find("the file is damaged") != std::string::npos ||
                        message.find("no variable can be read") != std::string::npos ||
                        message.find("there is no column t") != std::string::npos ||
                        message.find("no column is a known channel") != std::string::npos;
      EXPECT_TRUE(told) << v.name << " cut at " << size << " of " << whole.size() << ": " << message;
    }
  }
}

// Where a MATLAB 5 file breaks off or loses its thread is said.
TEST(RecordingMat, NamesTheDamagedVariable) {
  const TemporaryFolder folder;
  MatFile(folder / "rec.mat", MAT_FT_MAT5).add(MatFile::column("t", {0.0, 1.0})).add(MatFile::column("F", {0.0, 1.0}));
  std::string bytes = TemporaryFolder::read(folder / "rec.mat");  // 128 bytes of header, then twice 72
  ASSERT_EQ(bytes.size(), 272U);
  const std::string whole = ", expected a whole MATLAB 5 or 7.3 file";
  EXPECT_EQ(message_of(folder.write("cut.mat", bytes.substr(0, 271))), ": the file breaks off in variable 2" + whole);
  EXPECT_EQ(message_of(folder.write("cut.mat", bytes.substr(0, 203))), ": the file breaks off in variable 2" + whole);
  EXPECT_EQ(message_of(folder.write("cut.mat", bytes.substr(0, 199))), ": the file breaks off in variable 1" + whole);
  std::string bad = bytes;
  bad[230] = 8;  // the length of the second element's shape, in its third byte: matio stops as if the file ended there
  EXPECT_EQ(message_of(folder.write("bad.mat", bad)), ": the file is damaged after variable 1" + whole);
  bytes[200] = 0x20;  // the type of the second element
  EXPECT_EQ(message_of(folder.write("bad.mat", bytes)), ": the file is damaged at variable 2" + whole);
}

// A variable that cannot be read is not one that was never there: a damaged 7.3 file never loses one quietly. The bytes
// changed are those where HDF5 keeps what it has to know of the vectors.
TEST(RecordingMat, LosesNoVariableOfADamagedFile) {
  const TemporaryFolder folder;
  MatFile(folder / "rec.mat", MAT_FT_MAT73)
      .add(MatFile::column("t", {0.0, 1.0, 2.0}))
      .add(MatFile::column("F", {0.0, 1.0, 2.0}))
      .add(MatFile::column("z_r", {0.0, 1.0, 2.0}));
  const std::string whole = TemporaryFolder::read(folder / "rec.mat");
  int told = 0;
  for (std::size_t at = 1300; at < 1500; at += 3) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(~bytes[at]);
    folder.write("bad.mat", bytes);
    try {
      const Recording rec = read_recording(folder / "bad.mat");
      const std::size_t found = (rec.has(Channel::F) ? 1U : 0U) + (rec.has(Channel::z_r) ? 1U : 0U);
      EXPECT_EQ(found + rec.ignored_columns.size(), 2U) << "byte " << at;
    } catch (const InputError&) {
      ++told;
    }
  }
  EXPECT_GT(told, 0);
}

// A file from a machine of the other byte order, by hand: header, then one element of 72 bytes for each vector.
TEST(RecordingMat, ReadsTheOtherByteOrder) {
  std::string bytes(124, ' ');
  bytes += std::string("\x01\x00MI", 4);
  const auto number = [&](std::uint64_t value, int size) {
    for (int i = size - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i));
  };
  const auto vector = [&](char name, double a, double b) {
    for (const unsigned word : {14U, 64U, 6U, 8U, 6U, 0U, 5U, 8U, 2U, 1U}) number(word, 4);
    number(1, 2);  // a name of one byte, in the tag
    number(1, 2);
    bytes += std::string{name, '\0', '\0', '\0'};
    number(9, 4);
    number(16, 4);
    for (const double x : {a, b}) number(std::bit_cast<std::uint64_t>(x), 8);
  };
  vector('t', 0.0, 0.5);
  vector('F', -2.0, 0.1);
  const TemporaryFolder folder;
  const Recording rec = read_recording(folder.write("rec.mat", bytes));
  EXPECT_EQ(rec.sample_period, 0.5);
  EXPECT_EQ(rec[Channel::F], (std::vector<double>{-2.0, 0.1}));
  EXPECT_EQ(message_of(folder.write("cut.mat", bytes.substr(0, bytes.size() - 1))),
            ": the file breaks off in variable 2, expected a whole MATLAB 5 or 7.3 file");
}

// A file of any bytes gives a recording or an InputError: what damage does to the libraries stays in their process.
TEST(RecordingMat, SurvivesDamagedFiles) {
  std::mt19937_64 random(11);
  for (const Version& v : versions) {
    const TemporaryFolder folder;
    MatFile(folder / "rec.mat", v.version, v.compression)
        .add(MatFile::column("t", {0.0, 1.0, 2.0}))
        .add(MatFile::column("F", {0.0, 1.0, 2.0}));
    const std::string whole = TemporaryFolder::read(folder / "rec.mat");
    for (int trial = 0; trial < 150; ++trial) {
      std::string bytes = whole;
      for (int flips = 0; flips < 4; ++flips) {
        bytes[128 + random() % (bytes.size() - 128)] = static_cast<char>(random());
      }
      EXPECT_NO_THROW(static_cast<void>(message_of(folder.write("bad.mat", bytes)))) << v.name << ' ' << trial;
    }
  }
}

// MATLAB 4 has no header to be known by, but its first matrix.
TEST(RecordingMat, ReadsVersion4) {
  const TemporaryFolder folder;
  MatFile(folder / "rec.mat", MAT_FT_MAT4)
      .add(MatFile::column("t", {0.0, 1.0, 2.0}))
      .add(MatFile::column("F", {5.0, 6.0, 7.0}));
  const Recording rec = read_recording(folder / "rec.mat", {}, 1.0);
  EXPECT_EQ(rec[Channel::F], (std::vector<double>{5.0, 6.0, 7.0}));
  const std::string bytes = TemporaryFolder::read(folder / "rec.mat");
  EXPECT_TRUE(message_of(folder.write("cut.mat", bytes.substr(0, bytes.size() - 1)))
                  .starts_with(": the file breaks off in variable 2"));
}

}  // namespace
}  // namespace recording_mat_test
