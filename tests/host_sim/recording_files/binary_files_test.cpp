// Binary files of other measurement programs: TDMS, HDF5, structures in MATLAB files.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <matio.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/recording_files/binary/tdms_file.hpp"
#include "host_sim/recording_files/binary/tdms_table.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/host_sim/recording_files/tdms_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::ChannelMap;
using firmware::Recording;
using model::Channel;
using support::TdmsBytes;
using support::TemporaryFolder;

std::vector<double> wave(std::size_t n, double step) {
  std::vector<double> values(n);
  for (std::size_t k = 0; k < n; ++k) values[k] = std::sin(step * static_cast<double>(k));
  return values;
}

std::vector<double> stamps(std::size_t n, double step) {
  std::vector<double> values(n);
  for (std::size_t k = 0; k < n; ++k) values[k] = step * static_cast<double>(k);
  return values;
}

host_sim::Import import_of(const std::filesystem::path& file, std::optional<double> rate = std::nullopt) {
  const ChannelMap none;
  return host_sim::import_file(file, {none, rate});
}

// --- TDMS --------------------------------------------------------------------------------------------------------

// Contiguous and interleaved data, both byte orders, several chunks and segments give the same samples.
TEST(Tdms, ReadsEveryArrangementOfTheSameSamples) {
  const std::vector<double> stroke = wave(120, 0.05);
  const std::vector<double> force = wave(120, 0.11);
  for (const bool big : {false, true}) {
    for (const bool interleaved : {false, true}) {
      for (const std::size_t segments : {1U, 3U}) {
        for (const std::size_t chunks : {1U, 4U}) {
          TdmsBytes bytes(big);
          bytes.add_run(stroke, force, interleaved, segments, chunks);
          const host_sim::TdmsFile file = host_sim::parse_tdms(bytes.text(), "REC.tdms");
          ASSERT_EQ(file.channels.size(), 2U);
          EXPECT_EQ(file.channels[0].group, "Run 'A'");
          EXPECT_EQ(file.channels[0].name, "Stroke");
          EXPECT_EQ(file.channels[0].values, stroke);
          EXPECT_EQ(file.channels[1].values, force);
          EXPECT_EQ(file.channels[1].properties.at("unit_string").text, "kN");
          EXPECT_FALSE(file.cut_off);
        }
      }
    }
  }
}

TEST(Tdms, BecomesARecordingInSiUnits) {
  const TemporaryFolder folder;
  TdmsBytes bytes(false);
  bytes.add_run(wave(400, 0.05), wave(400, 0.11), false, 1, 1);
  const Recording recording = host_sim::read_parts(folder.write("rec.tdms", bytes.text())).front();
  EXPECT_NEAR(recording.sample_period, 1e-3, 1e-12);
  EXPECT_NEAR(recording[Channel::x_act][100], 1e-3 * std::sin(5.0), 1e-15);
  EXPECT_NEAR(recording[Channel::F][100], 1e3 * std::sin(11.0), 1e-9);
}

// A crash of the logger leaves the last segment without its length; what came before is kept and it is said.
TEST(Tdms, KeepsTheWholeChunksOfAFileThatWasCutOff) {
  TdmsBytes bytes(false);
  bytes.add_run(wave(100, 0.05), wave(100, 0.11), true, 1, 1);
  const std::string whole = bytes.text();
  for (std::size_t size = 0; size < whole.size(); size += 13) {
    try {
      const host_sim::TdmsFile file = host_sim::parse_tdms(std::string_view(whole).substr(0, size), "REC.tdms");
      EXPECT_TRUE(file.cut_off) << size;
    } catch (const firmware::InputError& error) {
      EXPECT_EQ(std::string(error.what()).find("REC.tdms: the file "), 0U) << error.what();
    }
  }
}

// Damage anywhere is a message or other numbers, never a crash.
TEST(Tdms, SurvivesDamage) {
  TdmsBytes bytes(false);
  bytes.add_run(wave(40, 0.05), wave(40, 0.11), true, 2, 1);
  const std::string whole = bytes.text();
  std::mt19937 random(7);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bad = whole;
    for (int i = 0; i < 3; ++i) bad[random() % bad.size()] = static_cast<char>(random());
    try {
      static_cast<void>(host_sim::parse_tdms(bad, "REC.tdms"));
    } catch (const firmware::InputError&) {
    }
  }
}

// --- HDF5 --------------------------------------------------------------------------------------------------------

class Hdf5File {
 public:
  explicit Hdf5File(const std::filesystem::path& file)
      : file_(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~Hdf5File() { H5Fclose(file_); }
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void add(const char* name, const std::vector<double>& values, const char* unit = nullptr, std::size_t columns = 1) {
    const std::array<hsize_t, 2> shape{values.size() / columns, columns};
    const hid_t space = H5Screate_simple(columns == 1 ? 1 : 2, shape.data(), nullptr);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t set = H5Dcreate2(file_, name, H5T_NATIVE_DOUBLE, space, links, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (unit != nullptr) add_text(set, "unit", unit);
    H5Dclose(set);
    H5Pclose(links);
    H5Sclose(space);
  }
  void add_rate(double rate) {
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(file_, "sample_rate", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, &rate);
    H5Aclose(attribute);
    H5Sclose(space);
  }

 private:
  static void add_text(hid_t object, const char* name, const char* text) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, std::strlen(text) + 1);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, text);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
  }

  hid_t file_;
};

TEST(Hdf5, ReadsDataSetsBesideTheirTime) {
  const TemporaryFolder folder;
  {
    Hdf5File file(folder / "rec.h5");
    file.add("/run1/time", stamps(300, 1e-3), "s");
    file.add("/run1/Weg Rad", wave(300, 0.05), "mm");
    file.add("/run1/Radlast", wave(300, 0.11), "kN");
    file.add("/other/counts", wave(7, 1.0));
  }
  const Recording recording = host_sim::read_parts(folder / "rec.h5").front();
  EXPECT_NEAR(recording[Channel::z_w][100], 1e-3 * std::sin(5.0), 1e-15);
  EXPECT_NEAR(recording[Channel::F_w][100], 1e3 * std::sin(11.0), 1e-9);
}

TEST(Hdf5, TakesTheRateFromAnAttributeAndTheColumnsOfAMatrix) {
  const TemporaryFolder folder;
  std::vector<double> both;
  for (int k = 0; k < 200; ++k) both.insert(both.end(), {0.1 * k, 0.2 * k});
  {
    Hdf5File file(folder / "rec.h5");
    file.add_rate(500.0);
    file.add("/x_act", wave(200, 0.05), "mm");
    file.add("/F", wave(200, 0.11), "N");
    file.add("/data", both, nullptr, 2);
  }
  const host_sim::Import import = import_of(folder / "rec.h5");
  EXPECT_NEAR(import.recording.time[199], 199 / 500.0, 1e-12);
  EXPECT_NEAR(import.recording[Channel::x_act][100], 1e-3 * std::sin(5.0), 1e-15);
  ASSERT_EQ(import.recording.extra.size(), 2U);
  EXPECT_NEAR(import.recording.extra[1].values[10], 2.0, 1e-12);
}

TEST(Hdf5, RefusesADamagedFileInOneLine) {
  const TemporaryFolder folder;
  { Hdf5File(folder / "rec.h5").add("/t", stamps(300, 1e-3)); }
  std::string bytes = TemporaryFolder::read(folder / "rec.h5");
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    std::string bad = bytes.substr(0, bytes.size() - (trial % 2 == 0 ? 0 : 1 + random() % bytes.size()));
    for (int i = 0; i < 4 && bad.size() > 8; ++i) bad[8 + random() % (bad.size() - 8)] = static_cast<char>(random());
    try {
      static_cast<void>(host_sim::read_parts(folder.write("bad.h5", bad)));
    } catch (const firmware::InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

// --- MATLAB structures -------------------------------------------------------------------------------------------

matvar_t* numbers(std::vector<double> values) {
  std::array<std::size_t, 2> shape{1, values.size()};
  return Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(), values.data(), 0);
}

matvar_t* text(std::string value) {
  std::array<std::size_t, 2> shape{1, value.size()};
  return Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, shape.data(), value.data(), 0);
}

matvar_t* structure(const char* name, std::vector<const char*> fields, std::size_t elements = 1) {
  std::array<std::size_t, 2> shape{1, elements};
  return Mat_VarCreateStruct(name, 2, shape.data(), fields.data(), static_cast<unsigned>(fields.size()));
}

matvar_t* cells(const std::vector<std::string>& texts) {
  std::array<std::size_t, 2> shape{1, texts.size()};
  std::vector<matvar_t*> elements;
  for (const std::string& one : texts) elements.push_back(text(one));
  return Mat_VarCreate(nullptr, MAT_C_CELL, MAT_T_CELL, 2, shape.data(), elements.data(), 0);
}

void save(const std::filesystem::path& file, std::vector<matvar_t*> variables, mat_ft version = MAT_FT_MAT5) {
  mat_t* mat = Mat_CreateVer(file.c_str(), nullptr, version);
  for (matvar_t* variable : variables) {
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

struct DspaceSignal {
  const char* name;
  const char* unit;
  std::vector<double> values;
  double raster;  // index of X, from 1
};

void save_dspace(const std::filesystem::path& file, const std::vector<std::vector<double>>& axes,
                 const std::vector<DspaceSignal>& signals) {
  matvar_t* x = structure("X", {"Name", "Type", "Data", "Unit"}, axes.size());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    Mat_VarSetStructFieldByName(x, "Name", i, text("Time"));
    Mat_VarSetStructFieldByName(x, "Type", i, text("Float"));
    Mat_VarSetStructFieldByName(x, "Data", i, numbers(axes[i]));
    Mat_VarSetStructFieldByName(x, "Unit", i, text("s"));
  }
  matvar_t* y = structure("Y", {"Name", "Type", "Data", "Unit", "XIndex"}, signals.size());
  for (std::size_t i = 0; i < signals.size(); ++i) {
    Mat_VarSetStructFieldByName(y, "Name", i, text(signals[i].name));
    Mat_VarSetStructFieldByName(y, "Type", i, text("Float"));
    Mat_VarSetStructFieldByName(y, "Data", i, numbers(signals[i].values));
    Mat_VarSetStructFieldByName(y, "Unit", i, text(signals[i].unit));
    Mat_VarSetStructFieldByName(y, "XIndex", i, numbers({signals[i].raster}));
  }
  matvar_t* all = structure("exp_001", {"X", "Y", "Description"});
  Mat_VarSetStructFieldByName(all, "X", 0, x);
  Mat_VarSetStructFieldByName(all, "Y", 0, y);
  Mat_VarSetStructFieldByName(all, "Description", 0, text("a run"));
  save(file, {all});
}

TEST(MatlabStructures, ReadsDspaceControlDesk) {
  const TemporaryFolder folder;
  save_dspace(
      folder / "rec.mat", {stamps(400, 1e-3)},
      {{"Model Root/Plant/Weg Rad", "mm", wave(400, 0.05), 1}, {"Model Root/Radlast", "kN", wave(400, 0.11), 1}});
  const Recording recording = host_sim::read_parts(folder / "rec.mat", {}, 1000.0, model::RigKind::quarter_car).front();
  EXPECT_NEAR(recording[Channel::z_w][100], 1e-3 * std::sin(5.0), 1e-15);
  EXPECT_NEAR(recording[Channel::F_w][100], 1e3 * std::sin(11.0), 1e-9);
  // An entry of [channels] may name the last part of the path.
  const ChannelMap map{{"z_b", {"Weg Rad", -1e-3, 0.0}}};
  EXPECT_NEAR(host_sim::read_parts(folder / "rec.mat", map, 1000.0).front()[Channel::z_b][100], -1e-3 * std::sin(5.0),
              1e-15);
}

// Two rasters: the slow signal comes to the fast axis, linearly; with the rig's rate the fast one is averaged.
TEST(MatlabStructures, BringsSeveralRatesOntoOneAxisAndSaysHow) {
  const TemporaryFolder folder;
  save_dspace(folder / "rec.mat", {stamps(4000, 1e-3), stamps(400, 1e-2)},
              {{"Sollweg", "mm", wave(4000, 0.01), 1}, {"Kraft", "N", wave(400, 0.1), 2}});
  const host_sim::Import fast = import_of(folder / "rec.mat");
  ASSERT_EQ(fast.recording.size(), 3991U);  // the slow axis ends at 3.99 s
  // Linear between samples 0.1 rad apart: h²/8 = 1.25·10⁻³ at most.
  EXPECT_NEAR(fast.recording[Channel::F][1005], std::sin(10.05), 1.3e-3);
  EXPECT_NEAR(fast.recording[Channel::F][1000], std::sin(10.0), 1e-9);
  EXPECT_NE(fast.notes.back().find("interpolated linearly to 1000 Hz"), std::string::npos) << fast.notes.back();
  const host_sim::Import slow = import_of(folder / "rec.mat", 100.0);
  EXPECT_EQ(slow.recording.size(), 400U);
  // The mean over ±0.05 rad is lower by (0.05)²/6 = 4·10⁻⁴ of the value.
  EXPECT_NEAR(slow.recording[Channel::x_cmd][100], 1e-3 * std::sin(10.0), 1e-3 * 6e-4);
}

TEST(MatlabStructures, ReadsTimetablesSimulinkAndTimeSeries) {
  const TemporaryFolder folder;
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    matvar_t* properties = structure("Properties", {"VariableNames", "VariableUnits"});
    Mat_VarSetStructFieldByName(properties, "VariableNames", 0, cells({"Weg", "Kraft"}));
    Mat_VarSetStructFieldByName(properties, "VariableUnits", 0, cells({"mm", "kN"}));
    matvar_t* table = structure("messung", {"Time", "Weg", "Kraft", "Properties"});
    Mat_VarSetStructFieldByName(table, "Time", 0, numbers(stamps(300, 1e-3)));
    Mat_VarSetStructFieldByName(table, "Weg", 0, numbers(wave(300, 0.05)));
    Mat_VarSetStructFieldByName(table, "Kraft", 0, numbers(wave(300, 0.11)));
    Mat_VarSetStructFieldByName(table, "Properties", 0, properties);
    save(folder / "table.mat", {table}, version);

    matvar_t* signals = structure("signals", {"values", "label"}, 2);
    Mat_VarSetStructFieldByName(signals, "values", 0, numbers(wave(300, 0.05)));
    Mat_VarSetStructFieldByName(signals, "label", 0, text("Weg [mm]"));
    Mat_VarSetStructFieldByName(signals, "values", 1, numbers(wave(300, 0.11)));
    Mat_VarSetStructFieldByName(signals, "label", 1, text("Kraft [kN]"));
    matvar_t* simulink = structure("logsout", {"time", "signals"});
    Mat_VarSetStructFieldByName(simulink, "time", 0, numbers(stamps(300, 1e-3)));
    Mat_VarSetStructFieldByName(simulink, "signals", 0, signals);
    save(folder / "simulink.mat", {simulink}, version);

    std::vector<matvar_t*> series;
    for (const auto& [name, unit, step] : {std::tuple{"Weg", "mm", 0.05}, std::tuple{"Kraft", "kN", 0.11}}) {
      matvar_t* info = structure("DataInfo", {"Units"});
      Mat_VarSetStructFieldByName(info, "Units", 0, text(unit));
      matvar_t* one = structure(name, {"Name", "Time", "Data", "DataInfo"});
      Mat_VarSetStructFieldByName(one, "Name", 0, text(name));
      Mat_VarSetStructFieldByName(one, "Time", 0, numbers(stamps(300, 1e-3)));
      Mat_VarSetStructFieldByName(one, "Data", 0, numbers(wave(300, step)));
      Mat_VarSetStructFieldByName(one, "DataInfo", 0, info);
      series.push_back(one);
    }
    save(folder / "series.mat", series, version);
    for (const char* name : {"table.mat", "simulink.mat", "series.mat"}) {
      const Recording recording =
          host_sim::read_parts(folder / name, {}, 1000.0, model::RigKind::component_bench).front();
      ASSERT_TRUE(recording.has(Channel::x_act) && recording.has(Channel::F)) << name;
      EXPECT_NEAR(recording[Channel::x_act][100], 1e-3 * std::sin(5.0), 1e-15) << name;
      EXPECT_NEAR(recording[Channel::F][100], 1e3 * std::sin(11.0), 1e-9) << name;
    }
  }
}

// DAQmx raw data: samples of two channels side by side in one raw buffer, 16 bits each; value = 1 + 0.5 × count.
TEST(BinaryFiles, DaqmxRawDataAreReadByTheirScalers) {
  const auto put = [](std::string& bytes, std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffU);
  };
  const auto put_text = [&](std::string& bytes, std::string_view text) {
    put(bytes, text.size(), 4);
    bytes += text;
  };
  const auto put_double = [&](std::string& bytes, std::string_view name, double value) {
    put_text(bytes, name);
    put(bytes, 10, 4);
    put(bytes, std::bit_cast<std::uint64_t>(value), 8);
  };
  std::string meta;
  put(meta, 2, 4);
  for (const unsigned channel : {0U, 1U}) {
    put_text(meta, channel == 0 ? "/'Run'/'Weg'" : "/'Run'/'Kraft'");
    put(meta, 0x1269, 4);
    put(meta, 0xffffffff, 4);
    put(meta, 1, 4);
    put(meta, 3, 8);                                                                // samples of a chunk
    put(meta, 1, 4);                                                                // scalers
    for (const unsigned part : {3U, 0U, 2U * channel, 0U, 0U}) put(meta, part, 4);  // i16, buffer, offset, format, id
    put(meta, 1, 4);
    put(meta, 4, 4);  // bytes of a sample of all channels
    put(meta, 6, 4);  // properties
    put_double(meta, "wf_increment", 1e-3);
    put_text(meta, "NI_Number_Of_Scales");
    put(meta, 7, 4);
    put(meta, 2, 4);
    put_text(meta, "NI_Scale[1]_Scale_Type");
    put(meta, 0x20, 4);
    put_text(meta, "Linear");
    put_double(meta, "NI_Scale[1]_Linear_Slope", 0.5);
    put_double(meta, "NI_Scale[1]_Linear_Y_Intercept", 1.0);
    put_text(meta, "NI_Scale[1]_Linear_Input_Source");
    put(meta, 7, 4);
    put(meta, 0, 4);
  }
  std::string raw;
  for (const int count : {10, -20, 11, -21, 12, -22}) put(raw, static_cast<std::uint16_t>(count), 2);
  std::string file = "TDSm";
  put(file, 2 + 4 + 8 + 128, 4);
  put(file, 4713, 4);
  put(file, meta.size() + raw.size(), 8);
  put(file, meta.size(), 8);
  const host_sim::RawTable table = host_sim::table_of_tdms(file + meta + raw, "daqmx.tdms");
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[1].values, (std::vector<double>{6.0, 6.5, 7.0}));
  EXPECT_EQ(table.columns[2].values, (std::vector<double>{-9.0, -9.5, -10.0}));
}

}  // namespace
