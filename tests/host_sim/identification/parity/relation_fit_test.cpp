// Single parity relations: which there are, how their parameters are fitted, what their residual goes with.
#include "host_sim/identification/parity/relation_fit.hpp"

#include <gtest/gtest.h>

#include "host_sim/identification/parity/describe_residual.hpp"
#include "host_sim/identification/parity/parity_relation.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

// Point. A car with all channels has relations (1)–(6); without F_w no balance and no tyre law; where deflections are
// not recorded they are made of displacements.
TEST(ParityRelations, AreThoseThatTheChannelsAllow) {
  const model::RigParameters<double> car = firmware::parse_rig(support::quarter_car_text, "car").rig;
  firmware::Recording r;
  const std::vector<double> samples(10, 1.0);
  r.time = firmware::sample_times(10, 1000.0);
  for (const Channel c :
       {Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b, Channel::F_w, Channel::dz_w, Channel::dz_b}) {
    r[c] = samples;
  }
  EXPECT_EQ(parity_relations(car, r).size(), 6U);
  r[Channel::F_w].clear();
  EXPECT_EQ(parity_relations(car, r).size(), 4U);
  r[Channel::dz_b].clear();
  r[Channel::z_w] = samples;
  r[Channel::z_b] = {3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0};
  const auto relations = parity_relations(car, r);
  ASSERT_FALSE(relations.empty());
  EXPECT_EQ(relations[0].words, "body: m_b z̈_b = F_s[dz_b]");
  EXPECT_EQ(samples_of(r, *relations[0].deflection, nullptr)[0], -2.0) << "z_w − z_b";
  EXPECT_EQ(derived(relations[0].motion, 2)[0].order, relations[0].motion[0].order + 2);
}

/// The relation F = F_s[x_act] of a bench.
struct Component {
  explicit Component(const firmware::RigDescription& d, const firmware::RigDescription& truth, double seconds = 12.0)
      : description(d), recordings{sample::recorded(truth, seconds)}, window(sample::period) {
    for (const ParityRelation& r : parity_relations(description.rig, recordings[0])) {
      if (r.deflection) relation = r;
    }
  }
  firmware::RigDescription description;
  std::vector<firmware::Recording> recordings;
  SmoothWindow window;
  ParityRelation relation;
};

/// Power of the fitted residual over that of noise, 0.5 … 60 Hz.
double power_over_noise(const RelationFit& fit) {
  double power = 0.0, noise = 0.0;
  for (std::size_t k = 1; k < fit.spectra().noise.size(); ++k) {
    power += fit.power(k);
    noise += fit.spectra().noise[k];
  }
  return power / noise;
}

// Law. A stiffness 3 % off its description, tolerated by 5 %, leaves noise; where nothing is tolerated it leaves its
// force. 12 s of 60 Hz: the mean power scatters by some 5 %.
TEST(RelationFit, FitsToleratedParameters) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness *= 1.03;
  const Component tolerated(sample::bench(), truth);
  const RelationFit fit(tolerated.description, tolerated.recordings, tolerated.window, tolerated.relation);
  ASSERT_TRUE(fit.has_data());
  EXPECT_NEAR(power_over_noise(fit), 1.0, 0.2) << "seed 5";
  firmware::RigDescription exact = sample::bench();
  exact.tolerance.clear();
  const Component fixed(exact, truth);
  EXPECT_GT(power_over_noise(RelationFit(fixed.description, fixed.recordings, fixed.window, fixed.relation)), 3.0);
}

// Law. A recording that is shorter than a block and what settles says nothing.
TEST(RelationFit, HasNoDataInAShortRecording) {
  const Component brief(sample::bench(), sample::bench(), 3.0);
  EXPECT_FALSE(RelationFit(brief.description, brief.recordings, brief.window, brief.relation).has_data());
}

// Point. A residual that is the cube of the velocity is described so; one of noise has no description.
TEST(DescribeResidual, NamesTheLawThatAResidualGoesWith) {
  const Component bench(sample::bench(), sample::bench());
  const firmware::Recording& r = bench.recordings[0];
  const Signal motion{{Channel::x_cmd, 0, 1.0}};
  const std::vector<double> velocity = samples_of(r, derived(motion, 1), &bench.window);
  std::vector<ResidualSeries> residual{{{}, std::vector<bool>(r.size(), true)}};
  for (const double v : velocity) residual[0].values.push_back(v * v * v);
  const std::string words = describe_residual(motion, residual, bench.recordings, bench.window);
  EXPECT_NE(words.find("the cube of the velocity"), std::string::npos) << words;
  residual[0].values = samples_of(r, motion, &bench.window);
  const std::string linear = describe_residual(motion, residual, bench.recordings, bench.window);
  EXPECT_NE(linear.find("100 % follow the motion linearly"), std::string::npos) << linear;
  EXPECT_EQ(linear.find("go with"), std::string::npos) << linear;
  support::NormalNoise noise(9);
  for (double& v : residual[0].values) v = noise();
  const std::string of_noise = describe_residual(motion, residual, bench.recordings, bench.window);
  EXPECT_EQ(of_noise.find("go with"), std::string::npos) << of_noise << " seed 9";
  EXPECT_EQ(of_noise.find("linearly"), std::string::npos) << of_noise << " seed 9";
}

}  // namespace
