// What is refused and what is left out before a diagnosis. The recordings come from tests/truth, which shares no code
// with the model.
#include "host_sim/identification/prepare/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"
#include "tests/truth/truth.hpp"

namespace validation_test {
namespace {

using namespace firmware;
using namespace host_sim;
using identification::validate;
using model::Channel;
using sample::given;
using sample::Given;

std::string refusal(const RigDescription& description, Recording recording) {
  try {
    (void)validate(description, {&recording});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A recording of another rig would be explained by effects that are not there.
TEST(Validation, RefusesRecordingsOfAnotherKind) {
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
TEST(Validation, LeavesOutChannelsThatNeverMove) {
  Given rig = given("none:quarter_car");
  Recording other = rig.recording;
  std::fill(rig.recording[Channel::F_w].begin(), rig.recording[Channel::F_w].end(), -3.5);
  const auto remarks = validate(rig.description, {&rig.recording, &other});
  EXPECT_FALSE(rig.recording.has(Channel::F_w));
  EXPECT_FALSE(other.has(Channel::F_w)) << "recordings of the same channels";
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("F_w is -3.5 N throughout"), std::string::npos) << remarks[0];

  other[Channel::zdd_r].clear();
  other[Channel::dz_w].clear();
  const auto missing = validate(rig.description, {&other});
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_NE(missing[0].find("without zdd_r, F_w, dz_w"), std::string::npos) << missing[0];

  std::fill(other[Channel::z_r].begin(), other[Channel::z_r].end(), 0.0);
  EXPECT_NE(refusal(rig.description, other).find("z_r never moves"), std::string::npos);

  // A bench whose command was not recorded is driven by what was reached; without either nothing moves.
  Given bench = given("none:component_bench");
  std::fill(bench.recording[Channel::x_cmd].begin(), bench.recording[Channel::x_cmd].end(), 0.0);
  EXPECT_EQ(validate(bench.description, {&bench.recording}).size(), 1U);
  EXPECT_FALSE(bench.recording.has(Channel::x_cmd));
  std::fill(bench.recording[Channel::x_act].begin(), bench.recording[Channel::x_act].end(), 0.0);
  EXPECT_NE(refusal(bench.description, bench.recording).find("x_cmd"), std::string::npos);
}

// A mass that may be zero, a damping that may be negative: everything could be explained with that.
TEST(Validation, RefusesTolerancesThatLetARigBeAnything) {
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

// Fault. A sample whose square overflows is no sensor's: one line with channel, value and time.
TEST(Validation, RefusesNumbersThatNoSensorShows) {
  sample::Given rig = sample::given("none:component_bench");
  rig.recording[model::Channel::F][3000] = -1e302;
  const std::string line = refusal(rig.description, rig.recording);
  EXPECT_NE(line.find("F is -1e+302 N at t = "), std::string::npos) << line;
}

}  // namespace
}  // namespace validation_test
