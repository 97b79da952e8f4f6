// Bounded Gauss–Newton on recordings of tests/truth, which shares no code with the model.
#include "host_sim/diagnose/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/catalogue.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace host_sim;
using model::Channel;

struct Bench {
  RigDescription description;
  diagnose::Case all;
  diagnose::Hypothesis hypothesis;
};

/// Eight seconds of a bench, from rest, with one sensor effect; nothing else to be found.
Bench bench_with(const truth::Effect& effect) {
  truth::Truth truth = truth::draw("none:component_bench", 3);
  truth.actual = truth.nominal;
  truth.effects = {effect};
  truth.records.resize(1);
  truth.records[0].duration = 8.0;
  truth.records[0].warm = 0.0;
  Bench bench{parse_rig(truth::rig_toml(truth), "rig.toml"), {}, {}};
  Recording recording = parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv");
  bench.all.evidence.push_back(
      diagnose::evidence_of(bench.description, std::move(recording), diagnose::Use::fitted, false));
  const diagnose::Evidence& e = bench.all.evidence.front();
  bench.all.fit.emplace_back(e, e.fit, std::vector<Eigen::MatrixXcd>{}, 0.0);
  bench.all.fitted.push_back(0);
  bench.hypothesis = {diagnose::explained_part(bench.description.rig),
                      {resting(diagnose::explained_part(bench.description.rig), e.drive)}};
  return bench;
}

// Law. What enters a channel linearly is found in a step or two, however far from its start: −400 N from 1 N. 10 N of
// noise over 8000 samples leave 0.11 N.
TEST(Fit, ReachesAnOffsetFarFromItsStart) {
  const Bench bench = bench_with({"sensor_offset", "F", {{"offset", -400.0}}});
  const PlacedEffect start{find_effect("sensor_offset"), Channel::F, {1.0}};
  diagnose::Hypothesis hypothesis = bench.hypothesis;
  put_effect(hypothesis.rig, start);
  const diagnose::Fit fit = diagnose::fit(bench.all, hypothesis, diagnose::effect_unknowns(start), 4);
  EXPECT_NEAR(fit.unknowns[0].value(fit.unknowns[0].get(fit.hypothesis)), -400.0, 0.6);
}

// Law. Starts of a motion stay near the motion: ten times as large at most, three in one step.
TEST(Unknown, KnowsHowFarItsSlopeMayBeBelieved) {
  diagnose::Unknown u{};
  u.role = diagnose::Unknown::Role::start;
  EXPECT_EQ(u.reach(7.0), 3.0);
  u.role = diagnose::Unknown::Role::effect;
  EXPECT_EQ(u.reach(0.2), 1.0);
  EXPECT_EQ(u.reach(-8.0), 8.0);
  u.logarithmic = true;
  EXPECT_EQ(u.reach(-8.0), 1.0);
  u = {};
  u.role = diagnose::Unknown::Role::effect;
  u.sensor = Channel::F;
  EXPECT_TRUE(std::isinf(u.reach(1.0)));
}

// Law. A hypothesis from elsewhere may lie beyond the bounds of this fit, which are relative to its own start. Its step
// may stay where it is or come back, and never has less than no room: then a parameter without a slope would run away.
TEST(Unknown, HasRoomForAStepEvenBeyondItsBounds) {
  const PlacedEffect lag{find_effect("sensor_lag"), Channel::F, {1e-3}};
  const diagnose::Unknown u = diagnose::effect_unknowns(lag)[0];
  for (const double at : {u.lower - 1.7, u.lower - 0.2, u.lower, 0.0, u.upper, u.upper + 3.0}) {
    for (const double trust : {1.0, 0.25}) {
      const auto [lower, upper] = u.room(at, trust);
      EXPECT_LE(lower, 0.0) << at;
      EXPECT_GE(upper, 0.0) << at;
      EXPECT_GE(lower, -trust) << at;
      EXPECT_LE(upper, trust) << at;
      if (at <= u.lower) {
        EXPECT_EQ(lower, 0.0) << at;
        EXPECT_EQ(upper, trust) << at;
      }
      if (at >= u.upper) {
        EXPECT_EQ(upper, 0.0) << at;
      }
    }
  }
}

}  // namespace
