// A residual is found over the whole record and in stretches of it, and only where there is one.
#include "host_sim/identification/estimate/residual_over_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using host_sim::identification::Power;
using model::Channel;

/// The bench as described, with something added to F: what the described rig leaves.
struct Left {
  Rest rest;
  bool by_bands;
};
Left left_of(const firmware::RigDescription& truth, const std::function<double(double)>& added,
             std::uint64_t seed = 5) {
  const firmware::RigDescription bench = sample::bench();
  firmware::Recording r = sample::recorded(truth, 12.0, seed);
  for (std::size_t k = 0; k < r.size(); ++k) r[Channel::F][k] += added(r.time[k]);
  std::vector<PreparedRecording> recordings{prepare_recording(bench, std::move(r), Use::shared, false)};
  const Hypothesis given = described_hypothesis(bench, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  return {find_rest(problem, given, read_all(problem, given)), unexplained_residual(problem, given).significant};
}

// Law. Noise alone leaves no rest: of 40 recordings with a limit of one in a thousand none is flagged.
TEST(Rest, IsNotFoundInNoise) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Rest rest = left_of(
                          sample::bench(), [](double) { return 0.0; }, seed)
                          .rest;
    EXPECT_FALSE(rest.found()) << seed << ": " << rest.z << " of " << rest.threshold << ", " << rest.words();
    EXPECT_GT(rest.threshold, 4.0);
    EXPECT_LT(rest.threshold, 5.0) << "two channels, 14 bands, 9 stretches, and all channels: M < 400";
  }
}

// Point. A tone of 35 Hz with 1.8 % of the noise's power lasts the whole record. The band of 26 … 40 Hz holds 2.8 % of
// that noise in 336 residuals, so its power is 1.6 times that of the noise, 0.6 √(336/2) = 8 standard deviations; 7
// on the fitted part, where the rule by bands needs 8.
TEST(Rest, IsFoundOverTheWholeRecord) {
  const double amplitude = 0.19 * sample::force_noise;
  const auto tone = [&](double t) { return amplitude * std::sin(2.0 * 3.14159265 * 35.0 * t); };
  const Left left = left_of(sample::bench(), tone);
  EXPECT_TRUE(left.rest.found()) << left.rest.z;
  EXPECT_FALSE(left.by_bands);
  EXPECT_EQ(left.rest.channel, Channel::F);
  EXPECT_EQ(left.rest.lowest, 26.0);
  EXPECT_EQ(left.rest.highest, 40.0);
  EXPECT_TRUE(left.rest.words().starts_with("F, 26 to 40 Hz")) << left.rest.words();
}

// Point. A tone of a second and a half is found in its stretch. Nothing of it is in the part that was held out.
TEST(Rest, IsFoundInAStretch) {
  const double amplitude = 0.45 * sample::force_noise;
  const auto burst = [&](double t) {
    return t > 3.7 && t < 5.2 ? amplitude * std::sin(2.0 * 3.14159265 * 35.0 * t) : 0.0;
  };
  const Left left = left_of(sample::bench(), burst);
  ASSERT_TRUE(left.rest.found()) << left.rest.z;
  EXPECT_FALSE(left.by_bands);
  EXPECT_FALSE(left.rest.all_time);
  EXPECT_LT(left.rest.from, 3.8);
  EXPECT_GT(left.rest.to, 5.1);
}

// Point. Σ r²/n of a stretch of noise is 1; a taper over a quarter at each end makes it scatter more than n numbers do.
TEST(StretchPower, IsThatOfNoise) {
  const firmware::RigDescription bench = sample::bench();
  auto recordings = sample::prepared(bench, bench, Use::shared, 12.0);
  const Hypothesis given = described_hypothesis(bench, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  EXPECT_DOUBLE_EQ(shown_stretch(problem), 1.0);
  const auto stretches = stretch_powers(problem, read_all(problem, given), 1.0);
  ASSERT_EQ(stretches.size(), 12U);
  Power sum;
  for (const StretchPower& stretch : stretches) {
    EXPECT_NEAR(stretch.to - stretch.from, 1.0, 0.1);
    EXPECT_GT(stretch.spread, 1.2);
    EXPECT_LT(stretch.spread, 1.6);
    for (std::size_t c = 0; c < 2; ++c) {
      sum.squares += stretch.of_channel(c).squares;
      sum.count += stretch.of_channel(c).count;
    }
  }
  EXPECT_NEAR(sum.ratio(), 1.0, 4.0 * std::sqrt(2.0 * 1.4 / sum.count));
}

// Point. Stepped sines on a test machine: the piston resonates for the first time in the quarter that is held out,
// where the parameters of the ducts, which the other three quarters hardly show, are wrong by a tenth of their
// tolerance. That is no rest. A tone in the held-out part is one.
TEST(Rest, IsNotWhatOnlyTheHeldOutPartSaysOfParameters) {
  const truth::Truth truth = truth::draw_rough("sweeps", 2026122201);
  ASSERT_EQ(truth.records[0].form, "stepped_sines");
  EXPECT_EQ(sample::diagnosis_of_all(truth).verdict, Verdict::no_discrepancy);
  for (const double amplitude : {0.0, 8.0}) {
    const Diagnosis found = sample::diagnosis_of(truth, [amplitude](sample::Columns& columns) {
      std::vector<double>& force = columns.at("F");
      for (std::size_t k = force.size() * 8 / 10; k < force.size(); ++k) {
        force[k] += amplitude * std::sin(0.01 * 2.0 * 3.14159265 * static_cast<double>(k));  // 10 Hz
      }
    });
    EXPECT_EQ(found.verdict == Verdict::no_discrepancy, amplitude == 0.0) << sentence(found);
  }
}

}  // namespace
