// Units and signs that are wrong. The recordings come from tests/truth, which shares no code
// with the model.
#include "host_sim/identification/prepare/unit_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using identification::unit_errors;
using model::Channel;
using sample::given;
using sample::Given;

void scale(Recording& recording, Channel channel, double factor) {
  for (double& v : recording[channel]) v *= factor;
}

std::string refusal(const RigDescription& description, const Recording& recording) {
  try {
    (void)identification::check_units(description, recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Law. Whatever channel of whatever rig is in a unit or has a sign of its own: it is found, with its factor, and no
// other is blamed. The input among them: one channel against all others.
TEST(UnitCheck, FindTheChannelAndItsFactor) {
  for (const char* group : {"none:quarter_car", "none:component_bench", "none:hil"}) {
    const Given rig = given(group);
    EXPECT_TRUE(unit_errors(rig.description, rig.recording).empty()) << group;
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      const Channel channel = model::channel_at(c);
      if (!rig.recording.has(channel)) continue;
      for (const double factor : {-1.0, model::unit(channel) == "N" ? 1e-3 : 1e3}) {
        Recording wrong = rig.recording;
        scale(wrong, channel, factor);
        const auto found = unit_errors(rig.description, wrong);
        ASSERT_EQ(found.size(), 1U) << group << " " << model::name(channel) << " × " << factor;
        EXPECT_EQ(found[0].channel, channel) << group << " " << model::name(channel) << " × " << factor;
        EXPECT_EQ(found[0].factor, factor) << group << " " << model::name(channel);
      }
    }
  }
}

// Law. Effects of the catalogue and beyond, however strong, are no unit errors.
TEST(UnitCheck, AreNotSeenInEffects) {
  for (const char* group : {"single:hil:actuator_delay", "single:component_bench:actuator_resonance",
                            "single:hil:actuator_rate_limit", "single:component_bench:backlash",
                            "single:component_bench:sensor_delay:F", "single:quarter_car:sensor_hold:F_w",
                            "single:quarter_car:sensor_delay:zdd_w", "single:quarter_car:sensor_gain:zdd_r",
                            "single:quarter_car:sensor_saturation:dz_b", "unknown:component_bench:jitter"}) {
    const Given rig = given(group);
    EXPECT_TRUE(unit_errors(rig.description, rig.recording).empty()) << group;
  }
}

// The line tells what to do: what it looks like, and the entry that would mend it, with the column of the one that is
// there.
TEST(UnitCheck, AreRefusedWithWhatToWrite) {
  Given rig = given("none:quarter_car");
  Recording wrong = rig.recording;
  scale(wrong, Channel::z_r, 1e3);
  std::string line = refusal(rig.description, wrong);
  EXPECT_NE(line.find("rec.csv: z_r looks like millimetres"), std::string::npos) << line;
  EXPECT_NE(line.find("[channels]: z_r = { column = \"z_r\", scale = 0.001 }"), std::string::npos) << line;

  wrong = rig.recording;
  scale(wrong, Channel::F_w, -1e-3);
  scale(wrong, Channel::zdd_b, 1.0 / 9.81);
  rig.description.channels["F_w"] = {"Load", std::nullopt, 0.0};
  line = refusal(rig.description, wrong);
  EXPECT_NE(line.find("zdd_b looks like multiples of g"), std::string::npos) << line;
  EXPECT_NE(line.find("F_w looks like kilonewtons with the sign swapped"), std::string::npos) << line;
  EXPECT_NE(line.find("F_w = { column = \"Load\", scale = -1000 }"), std::string::npos) << line;
  EXPECT_NE(line.find("scale = 9.81"), std::string::npos) << line;
}

// Point. A scale that somebody wrote is kept: it is a remark. So is a guess: of a bench whose stiffness is described
// 500 times too small the force may be anything.
TEST(UnitCheck, CanBeOverruled) {
  Given rig = given("none:quarter_car");
  scale(rig.recording, Channel::F_w, 1e-3);
  EXPECT_NE(refusal(rig.description, rig.recording).find("a scale that is written there is kept"), std::string::npos);
  rig.description.channels["F_w"] = {"F_w", 1.0, 0.0};
  const auto remarks = identification::check_units(rig.description, rig.recording);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_EQ(remarks.front(), "rec.csv: F_w looks like kilonewtons; kept as [channels] says");
  EXPECT_EQ(firmware::parse_rig("kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 1.0\n"
                                "damping = 1.0\n[channels]\nF = { column = 'F', scale = 1.0 }\n",
                                "rig.toml")
                .channels.at("F")
                .scale,
            1.0);

  Given bench = given("none:component_bench");
  bench.description.rig.suspension.stiffness /= 750.0;
  bench.description.rig.suspension.damping /= 750.0;
  EXPECT_EQ(refusal(bench.description, bench.recording), "");
}

}  // namespace
