// The cases that a plan stands for.
#include "host_sim/sweep/sweep_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace host_sim::sweep;
using support::TemporaryFolder;

class SweepPlan_ : public testing::Test {
 protected:
  TemporaryFolder folder_;
  void SetUp() override {
    folder_.write("car.toml", TemporaryFolder::read(support::rig_file("paper_rig_fdva")) +
                                  "\n[tolerance]\n\"tyre.stiffness\" = 0.03\n");
  }
  [[nodiscard]] SweepPlan plan(const std::string& text) const {
    return read_plan(folder_.write("plan.toml", "rig = \"car.toml\"\n" + text));
  }
  [[nodiscard]] std::string error_of(const std::string& text) const {
    try {
      static_cast<void>(plan(text));
      return "nothing";
    } catch (const firmware::InputError& error) {
      return error.what();
    }
  }
};

// Point (1): 2 roads × 3 dampings × 2 repeats; the last factor varies fastest, repeats before it.
TEST_F(SweepPlan_, CountsThroughItsCombinations) {
  const SweepPlan p = plan(
      "repeats = 2\n[vary]\nroad = [\"iso8608:A\", \"iso8608:C\"]\nsuspension.damping = { from = 100, to = 300, steps "
      "= "
      "3 }\n");
  ASSERT_EQ(p.cases.count, 12U);
  const auto shown = [&](std::uint64_t id) {
    const RigCase one = case_of(p, id);
    return one.road + " " + std::to_string(std::lround(one.rig.rig.suspension.damping));
  };
  EXPECT_EQ(shown(0), "iso8608:A 100");
  EXPECT_EQ(shown(1), "iso8608:A 100");
  EXPECT_EQ(shown(2), "iso8608:A 200");
  EXPECT_EQ(shown(5), "iso8608:A 300");
  EXPECT_EQ(shown(6), "iso8608:C 100");
  EXPECT_EQ(shown(11), "iso8608:C 300");
}

// Point (2): the first outputs of SplitMix64 from seed 1234567, as published with its reference code.
TEST_F(SweepPlan_, GivesEachCaseASeedOfItsId) {
  EXPECT_EQ(seed_of_case(1234567, 0), 6457827717110365317ULL);
  EXPECT_EQ(seed_of_case(1234567, 1), 3203168211198807973ULL);
  EXPECT_EQ(seed_of_case(1234567, 2), 9817491932198370423ULL);
  const SweepPlan p = plan("seed = 1234567\nrepeats = 3\n");
  EXPECT_EQ(case_of(p, 2).seed, 9817491932198370423ULL);
}

// Law. Draws follow their distributions, and a case alone draws what it draws among others. 2000 cases: a mean is known
// to 1/√2000 = 2.2 % of a standard deviation, here asked for within five of these; a standard deviation to 1.6 %.
TEST_F(SweepPlan_, DrawsFromItsDistributions) {
  const SweepPlan p = plan(
      "repeats = 2000\n[draw]\nwithin_tolerance = true\n\"body.mass\" = { mean = 290, standard_deviation = 3 }\nspeed "
      "= "
      "{ from = 10, to = 20 }\n");
  double mass = 0.0, squares = 0.0, speed = 0.0;
  std::set<double> stiffnesses;
  for (std::uint64_t id = 0; id < 2000; ++id) {
    const RigCase one = case_of(p, id);
    mass += one.rig.rig.body.mass / 2000.0;
    squares += (one.rig.rig.body.mass - 290.0) * (one.rig.rig.body.mass - 290.0) / 2000.0;
    speed += one.speed / 2000.0;
    stiffnesses.insert(one.rig.rig.tyre.stiffness);
  }
  EXPECT_NEAR(mass, 290.0, 5.0 * 3.0 / std::sqrt(2000.0));
  EXPECT_NEAR(std::sqrt(squares), 3.0, 5.0 * 3.0 / std::sqrt(4000.0));
  EXPECT_NEAR(speed, 15.0, 5.0 * 10.0 / std::sqrt(12.0 * 2000.0));
  EXPECT_EQ(stiffnesses.size(), 2000U);
  const double described = p.rig.rig.tyre.stiffness;
  EXPECT_GT(*stiffnesses.begin(), 0.97 * described);
  EXPECT_LT(*stiffnesses.rbegin(), 1.03 * described);
  EXPECT_LT(*stiffnesses.begin(), 0.9705 * described) << "the whole range is drawn from";
}

// Results of one plan must not be continued under another: whatever changes a result changes the fingerprint.
TEST_F(SweepPlan_, FingerprintsWhateverChangesAResult) {
  folder_.write("bump.csv", "t,z_r [m]\n0,0\n0.001,0\n0.002,0.001\n0.003,0\n0.004,0\n");
  std::set<std::string> seen;
  const auto note = [&](const std::string& text) { return seen.insert(plan(text).cases.fingerprint).second; };
  EXPECT_TRUE(note(""));
  EXPECT_FALSE(note("# a comment changes nothing\n"));
  EXPECT_TRUE(note("seed = 2\n"));
  EXPECT_TRUE(note("repeats = 2\n"));
  EXPECT_TRUE(note("[run]\nduration = 2.0\n"));
  EXPECT_TRUE(note("[run]\nspeed = 2.0\n"));
  EXPECT_TRUE(note("[run]\nnoise = false\n"));
  EXPECT_TRUE(note("[run]\nroad = \"bump.csv\"\n"));
  folder_.write("bump.csv", "t,z_r [m]\n0,0\n0.001,0\n0.002,0.002\n0.003,0\n0.004,0\n");
  EXPECT_TRUE(note("[run]\nroad = \"bump.csv\"\n")) << "another road under the same name";
  EXPECT_TRUE(note("[vary]\nspeed = [10.0, 20.0]\n"));
  EXPECT_TRUE(note("[vary]\nspeed = [10.0, 21.0]\n"));
  EXPECT_TRUE(note("[draw]\nspeed = { from = 10, to = 20 }\n"));
  folder_.write("car.toml", TemporaryFolder::read(support::rig_file("paper_rig_fdva")));
  EXPECT_TRUE(note("")) << "another rig under the same name";
}

TEST_F(SweepPlan_, NamesTheLineOfAnError) {
  const std::pair<const char*, const char*> wrong[] = {
      {"[vary]\nsuspension.dampign = [1.0]\n", "plan.toml:3: no parameter of this rig"},
      {"[vary]\nspeed = []\n", "plan.toml:3: vary.speed is no list"},
      {"[vary]\nspeed = [1.0, \"fast\"]\n", "plan.toml:3: vary.speed holds something else"},
      {"[vary]\nspeed = [0.0]\n", "plan.toml:3: speed = 0"},
      {"[vary]\nopen_ducts = [7]\n", "plan.toml:3: open_ducts = 7"},
      {"[vary]\nopen_ducts = [1.5]\n", "plan.toml:3: open_ducts = 1.5"},
      {"[vary]\nroad = [\"iso8608:Z\"]\n", "plan.toml:3: unknown road"},
      {"[vary]\nroad = [\"nowhere.csv\"]\n", "plan.toml:3: the road 'nowhere.csv' cannot be opened"},
      {"[vary]\nspeed = { from = 1, to = 2 }\n", "plan.toml:3: [vary.speed] has no 'steps'"},
      {"[vary]\nspeed = [1.0]\n[draw]\nspeed = { from = 1, to = 2 }\n", "plan.toml:5: speed stands in [vary] already"},
      {"[draw]\nroad = { from = 1, to = 2 }\n", "plan.toml:3: draw.road is no distribution"},
      {"[draw]\nspeed = 3.0\n", "plan.toml:3: draw.speed is no distribution"},
      {"[run]\nduration = -1\n", "plan.toml:3: run.duration = -1"},
      {"[run]\nduration = 1e6\n", "plan.toml:3: run.duration is longer"},
      {"repeats = 0\n", "plan.toml:2: repeats is out of range"},
      {"seeds = 3\n", "plan.toml:2: unknown key"},
      {"repeats = 1000000000\n[vary]\nspeed = [1.0, 2.0]\n", "more than 1000000000 cases"},
      {"[run\n", "plan.toml:2: TOML syntax"}};
  for (const auto& [text, says] : wrong) {
    EXPECT_NE(error_of(text).find(says), std::string::npos) << text << " gave: " << error_of(text);
  }
}

}  // namespace
