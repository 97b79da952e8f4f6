// The 95 % band of a learned curve: how often it holds the law that made the recordings.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/learn/curve_fit.hpp"
#include "host_sim/identification/learn/describe_law.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

constexpr double coefficient = 900.0, exponent = 1.5;  // [N], of v in m/s

double hidden(double v) { return coefficient * std::copysign(std::pow(std::abs(v), exponent), v); }

/// A bench with that law as a table.
firmware::RigDescription rig_with_law() {
  firmware::RigDescription truth = sample::bench();
  PlacedLaw law;
  law.family = LawFamily::power;
  law.rms = 0.1;
  law.largest = 0.4;
  law.values = {hidden(law.rms), exponent};
  put_laws({law}, truth.rig);
  return truth;
}

/// Noise that is three times as large in every second second: the same power throughout is what a likelihood expects.
firmware::Recording in_bursts(firmware::Recording recording, std::uint64_t seed) {
  support::NormalNoise noise(1000 + seed);
  for (std::size_t k = 0; k < recording.time.size(); ++k) {
    const bool burst = static_cast<int>(recording.time[k]) % 2 == 1;
    const double more = noise() * sample::force_noise * std::sqrt(8.0);  // 1 + 8 = 3²
    if (burst) recording[Channel::F][k] += more;
  }
  return recording;
}

/// How many points of a table, of all inside the excited range, have the hidden law inside their band.
struct Coverage {
  int held = 0, all = 0;
};
void count(const firmware::Recording& recording, LawFamily family, Coverage& coverage) {
  const firmware::RigDescription described = sample::bench();
  std::vector<PreparedRecording> recordings{prepare_recording(described, recording, Use::fitted, false)};
  const Hypothesis given = described_hypothesis(described, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  const SearchSpace space = search_space(described, problem.samples(), given);
  const auto range = excited_range(problem, given, CurvePlace::suspension, CurveOver::velocity);
  ASSERT_TRUE(range);
  Hypothesis start = given;
  start.laws.push_back(flat_curve(CurvePlace::suspension, CurveOver::velocity, *range));
  PlacedLaw& law = start.laws.back();
  law.size = hidden(range->rms);
  if (family == LawFamily::power) {
    law.family = family;
    law.at.clear();
    law.values = {0.8 * law.size, 1.8};
  }
  put_laws(start.laws, start.rig);
  Fit fitted;
  if (family == LawFamily::power) {
    fitted = fitted_with_laws(problem, space, start, {}, 8).fit;
  } else {
    auto curve = fit_curve(problem, space, start, {}, 3);
    ASSERT_TRUE(curve);
    fitted = std::move(curve->model.fit);
  }
  const Uncertainty known = uncertainty(problem, space.suspects, fitted);
  const std::vector<DescribedLaw> laws = describe_laws(problem, fitted, known);
  ASSERT_EQ(laws.size(), 1U);
  for (std::size_t k = 0; k < laws[0].at.size(); ++k) {
    const double v = laws[0].at[k];
    if (v == 0.0 || v < range->lowest || v > range->highest) continue;
    ++coverage.all;
    coverage.held += hidden(v) > laws[0].lower[k] && hidden(v) < laws[0].upper[k] ? 1 : 0;
  }
}

/// 95 % of the points, less three deviations of 24 independent recordings whose points move together:
/// 0.95 − 3 √(0.95 · 0.05/24) = 0.82.
constexpr double least_held = 0.82;
constexpr std::uint64_t recordings = 24;

// Law. White noise: the band of a family and that of a free curve hold the law as often as they say.
TEST(LawBand, HoldsTheLawInWhiteNoise) {
  const firmware::RigDescription truth = rig_with_law();
  for (const LawFamily family : {LawFamily::power, LawFamily::points}) {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= recordings; ++seed)
      count(sample::recorded(truth, 8.0, seed), family, coverage);
    RecordProperty("held", coverage.held);
    EXPECT_GE(coverage.held, least_held * coverage.all) << static_cast<int>(family) << " of " << coverage.all;
  }
}

// Fault. Noise in bursts, which the declared noise does not know: the blocks of the sandwich widen the band.
TEST(LawBand, HoldsTheLawInBurstsOfNoise) {
  const firmware::RigDescription truth = rig_with_law();
  Coverage coverage;
  for (std::uint64_t seed = 1; seed <= recordings; ++seed)
    count(in_bursts(sample::recorded(truth, 8.0, seed), seed), LawFamily::power, coverage);
  EXPECT_GE(coverage.held, least_held * coverage.all) << "of " << coverage.all;
}

}  // namespace
