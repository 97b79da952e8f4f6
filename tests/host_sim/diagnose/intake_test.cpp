// What is refused and what is left out before a diagnosis. The recordings come from tests/truth, which shares no code
// with the model.
#include "host_sim/diagnose/intake.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/diagnose/suspicion.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace host_sim;
using diagnose::slips;
using diagnose::take_in;
using model::Channel;

struct Given {
  RigDescription description;
  Recording recording;
};

/// 12 s of a group, as read from its files.
Given given(const std::string& group, std::uint64_t seed = 1) {
  truth::Wanted wanted;
  wanted.duration = 12.0;
  truth::Truth truth = truth::draw(group, seed, wanted);
  truth.records.resize(1);
  Given result{parse_rig(truth::rig_toml(truth), "rig.toml"), {}};
  result.recording = parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv");
  return result;
}

void scale(Recording& recording, Channel channel, double factor) {
  for (double& v : recording[channel]) v *= factor;
}

std::string refusal(const RigDescription& description, Recording recording) {
  try {
    (void)take_in(description, {&recording});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Law. Whatever channel of whatever rig is in a unit or has a sign of its own: it is found, with its factor, and no
// other is blamed. The input among them: one channel against all others.
TEST(Slips, FindTheChannelAndItsFactor) {
  for (const char* group : {"none:quarter_car", "none:component_bench", "none:hil"}) {
    const Given rig = given(group);
    EXPECT_TRUE(slips(rig.description, rig.recording).empty()) << group;
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      const Channel channel = model::channel_at(c);
      if (!rig.recording.has(channel)) continue;
      for (const double factor : {-1.0, model::unit(channel) == "N" ? 1e-3 : 1e3}) {
        Recording wrong = rig.recording;
        scale(wrong, channel, factor);
        const auto found = slips(rig.description, wrong);
        ASSERT_EQ(found.size(), 1U) << group << " " << model::name(channel) << " × " << factor;
        EXPECT_EQ(found[0].channel, channel) << group << " " << model::name(channel) << " × " << factor;
        EXPECT_EQ(found[0].factor, factor) << group << " " << model::name(channel);
      }
    }
  }
}

// Law. Effects of the catalogue and beyond, however strong, are no slips of a pen.
TEST(Slips, AreNotSeenInEffects) {
  for (const char* group : {"single:hil:actuator_delay", "single:component_bench:actuator_resonance",
                            "single:hil:actuator_rate_limit", "single:component_bench:backlash",
                            "single:component_bench:sensor_delay:F", "single:quarter_car:sensor_hold:F_w",
                            "single:quarter_car:sensor_delay:zdd_w", "single:quarter_car:sensor_gain:zdd_r",
                            "single:quarter_car:sensor_saturation:dz_b", "unknown:component_bench:jitter"}) {
    const Given rig = given(group);
    EXPECT_TRUE(slips(rig.description, rig.recording).empty()) << group;
  }
}

// The line tells what to do: what it looks like, and the entry that would mend it, on top of the one that is there.
TEST(Slips, AreRefusedWithWhatToWrite) {
  Given rig = given("none:quarter_car");
  Recording wrong = rig.recording;
  scale(wrong, Channel::z_r, 1e3);
  std::string line = refusal(rig.description, wrong);
  EXPECT_NE(line.find("rec.csv: z_r looks like millimetres"), std::string::npos) << line;
  EXPECT_NE(line.find("[channels]: z_r = { column = \"z_r\", scale = 0.001 }"), std::string::npos) << line;

  wrong = rig.recording;
  scale(wrong, Channel::F_w, -1e-3);
  scale(wrong, Channel::zdd_b, 1.0 / 9.81);
  rig.description.channels["F_w"] = {"Load", 2.0, 0.0};
  line = refusal(rig.description, wrong);
  EXPECT_NE(line.find("zdd_b looks like multiples of g"), std::string::npos) << line;
  EXPECT_NE(line.find("F_w looks like kilonewtons with the sign swapped"), std::string::npos) << line;
  EXPECT_NE(line.find("F_w = { column = \"Load\", scale = -2000 }"), std::string::npos) << line;
  EXPECT_NE(line.find("scale = 9.81"), std::string::npos) << line;
}

// A recording of another rig would be explained by effects that are not there.
TEST(TakeIn, RefusesRecordingsOfAnotherKind) {
  const Given car = given("none:quarter_car"), bench = given("none:component_bench"), hil = given("none:hil");
  const std::array<const Given*, 3> all{&car, &bench, &hil};
  for (const Given* rig : all) {
    for (const Given* record : all) {
      const std::string line = refusal(rig->description, record->recording);
      EXPECT_EQ(line.empty(), rig == record) << line;
      if (rig == record) continue;
      EXPECT_NE(line.find("looks like a recording of a "), std::string::npos) << line;
    }
  }
  EXPECT_NE(refusal(car.description, bench.recording).find("component_bench (x_cmd, x_act, F)"), std::string::npos);
}

// A sensor that is dead is left out of all recordings and said; without motion nothing can be judged.
TEST(TakeIn, LeavesOutChannelsThatNeverMove) {
  Given rig = given("none:quarter_car");
  Recording other = rig.recording;
  std::fill(rig.recording[Channel::F_w].begin(), rig.recording[Channel::F_w].end(), -3.5);
  const auto remarks = take_in(rig.description, {&rig.recording, &other});
  EXPECT_FALSE(rig.recording.has(Channel::F_w));
  EXPECT_FALSE(other.has(Channel::F_w)) << "recordings of the same channels";
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("F_w is -3.5 N throughout"), std::string::npos) << remarks[0];

  other[Channel::zdd_r].clear();
  other[Channel::dz_w].clear();
  const auto missing = take_in(rig.description, {&other});
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_NE(missing[0].find("without zdd_r, F_w, dz_w"), std::string::npos) << missing[0];

  std::fill(other[Channel::z_r].begin(), other[Channel::z_r].end(), 0.0);
  EXPECT_NE(refusal(rig.description, other).find("z_r never moves"), std::string::npos);

  // A bench whose command was not recorded is driven by what was reached; without either nothing moves.
  Given bench = given("none:component_bench");
  std::fill(bench.recording[Channel::x_cmd].begin(), bench.recording[Channel::x_cmd].end(), 0.0);
  EXPECT_EQ(take_in(bench.description, {&bench.recording}).size(), 1U);
  EXPECT_FALSE(bench.recording.has(Channel::x_cmd));
  std::fill(bench.recording[Channel::x_act].begin(), bench.recording[Channel::x_act].end(), 0.0);
  EXPECT_NE(refusal(bench.description, bench.recording).find("x_cmd"), std::string::npos);
}

// A mass that may be zero, a damping that may be negative: everything could be explained with that.
TEST(TakeIn, RefusesTolerancesThatLetARigBeAnything) {
  Given rig = given("none:quarter_car");
  const auto with = [&](const char* path, double bound) {
    RigDescription d = rig.description;
    d.tolerance[path] = bound;
    return refusal(d, rig.recording);
  };
  EXPECT_EQ(with("body.mass", 0.99), "");
  EXPECT_NE(with("body.mass", 1.0).find("a tolerance of 1 lets body.mass be 0"), std::string::npos);
  EXPECT_EQ(with("suspension.damping", 1.0), "");
  EXPECT_NE(with("suspension.damping", 1.5).find("lets suspension.damping be negative"), std::string::npos);
}

}  // namespace
