// [recording]: what explains a recording stands in the rig description.
#include "firmware/description/recorder_reader.hpp"

#include <gtest/gtest.h>

#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"

namespace recorder_reader_test {
namespace {

using firmware::parse_rig;
using firmware::RecorderDescription;
using model::Channel;

const std::string bench =
    "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 30000.0\ndamping = "
    "1000.0\n[recording]\n";

std::string error_of(const std::string& lines) {
  try {
    static_cast<void>(parse_rig(bench + lines, "rig.toml"));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "no error";
}

// What is written reads back to the same bits.
TEST(RecorderReader, ReadsWhatTheWriterWrites) {
  const auto first = parse_rig(bench +
                                   "common_filter = [{ channels = ['F', 'x_act'], corner_hz = 50.8, order = 2 }, { "
                                   "channels = ['F'], corner_hz = "
                                   "90.0, digital = true }]\n"
                                   "clock = [{ channels = ['F'], offset = 0.004, ppm = -12.5 }]\n"
                                   "hum = [{ channels = ['F', 'x_act'], hz = 50.02, amplitude = [1.5, 2e-6] }]\n"
                                   "drift = [{ path = 'suspension.damping', per_cent = -11.0, bend = 2.0 }]\n"
                                   "hold = [{ channels = ['F'], period = 0.002 }]\n",
                               "rig.toml");
  const auto again = parse_rig(firmware::format_rig(first), "again.toml");
  for (const auto* description : {&first, &again}) {
    const RecorderDescription& recorder = description->recorder;
    ASSERT_EQ(recorder.common_filter.size(), 2U);
    EXPECT_EQ(recorder.common_filter[0].channels, (std::vector{Channel::F, Channel::x_act}));
    EXPECT_EQ(recorder.common_filter[0].corner, 50.8);
    EXPECT_EQ(recorder.common_filter[0].order, 2);
    EXPECT_EQ(recorder.common_filter[1].order, 1);
    EXPECT_TRUE(recorder.common_filter[1].digital);
    ASSERT_EQ(recorder.clock.size(), 1U);
    EXPECT_EQ(recorder.clock[0].offset, 0.004);
    EXPECT_EQ(recorder.clock[0].ppm, -12.5);
    ASSERT_EQ(recorder.hum.size(), 1U);
    EXPECT_EQ(recorder.hum[0].amplitude, (std::vector{1.5, 2e-6}));
    ASSERT_EQ(recorder.drift.size(), 1U);
    EXPECT_EQ(recorder.drift[0].path, "suspension.damping");
    EXPECT_EQ(recorder.drift[0].bend, 2.0);
    EXPECT_EQ(description->rig.effects.sensor_paths()[index(Channel::F)].hold, 0.002);
  }
  EXPECT_FALSE(parse_rig(bench, "rig.toml").recorder.any());
}

// Each wrong entry is an error in one line that says where.
TEST(RecorderReader, RefusesWhatDoesNotFit) {
  EXPECT_EQ(error_of("common_filter = 3"),
            "rig.toml:7: recording.common_filter is not a list, expected a list of "
            "tables, such as [{ channels = [\"F\"], … }]");
  EXPECT_NE(error_of("common_filter = [{ channels = ['F'], order = 2 }]").find("rig.toml:7"), std::string::npos);
  EXPECT_NE(error_of("common_filter = [{ channels = ['F'], corner_hz = -2.0 }]").find("corner_hz"), std::string::npos);
  EXPECT_NE(error_of("common_filter = [{ channels = ['G'], corner_hz = 2.0 }]").find("unknown channel"),
            std::string::npos);
  EXPECT_NE(error_of("clock = [{ channels = [], offset = 0.1 }]").find("channels"), std::string::npos);
  EXPECT_NE(error_of("clock = [{ channels = ['F'], ofset = 0.1 }]").find("ofset"), std::string::npos);
  EXPECT_NE(error_of("hum = [{ channels = ['F'], hz = 50.0, amplitude = [1.0, 2.0] }]").find("amplitude"),
            std::string::npos);
  EXPECT_NE(error_of("drift = [{ path = 'tyre.hardness', per_cent = 1.0 }]").find("tyre.hardness"), std::string::npos);
  EXPECT_NE(error_of("hold = [{ channels = ['F'], period = 2.0 }]").find("period"), std::string::npos);
  EXPECT_NE(error_of("filter = []").find("recording.filter"), std::string::npos);
}

}  // namespace
}  // namespace recorder_reader_test
