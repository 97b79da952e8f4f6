// Causes that explain something by chance.
#include "host_sim/identification/assess/chance_of_share.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/host_sim/identification/select/bench_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

// Law. On a circle every angle is as likely, on a sphere every height: (2) in closed form.
TEST(ChanceOfShare, IsKnownInTwoAndThreeDirections) {
  for (const double share : {0.01, 0.1, 0.3, 0.8, 1.0}) {
    const double angle = std::acos(std::sqrt(share));
    EXPECT_NEAR(chance_of_share(share, 2.0, 1), angle / (0.5 * std::numbers::pi), 1e-12) << share;
    EXPECT_NEAR(chance_of_share(share, 3.0, 1), 1.0 - std::cos(angle), 1e-12) << share;
  }
  EXPECT_EQ(chance_of_share(0.0, 3.0, 1), 1.0);
  EXPECT_EQ(chance_of_share(-0.2, 3.0, 1), 1.0);
}

// Property. Of drawn directions among 12 as many explain a share as (2) says, to four standard deviations; of 20 the best
// does at most as often as chance allows.
TEST(ChanceOfShare, IsThatOfDirectionsThatAreDrawn) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int draws = 40000;
  constexpr double share = 0.3;
  int singles = 0, best_of_20 = 0;
  bool any = false;
  for (int i = 1; i <= draws; ++i) {
    const double known = std::pow(normal(random), 2);
    double all = known;
    for (int k = 1; k < 12; ++k) all += std::pow(normal(random), 2);
    const bool reached = known / all >= share;
    singles += static_cast<int>(reached);
    any = any || reached;
    if (i % 20 != 0) continue;
    best_of_20 += static_cast<int>(any);
    any = false;
  }
  const double chance = chance_of_share(share, 12.0, 1);
  EXPECT_NEAR(singles / static_cast<double>(draws), chance, 4.0 * std::sqrt(chance * (1.0 - chance) / draws));
  EXPECT_LE(20.0 * best_of_20 / draws, chance_of_share(share, 12.0, 20));
  EXPECT_EQ(chance_of_share(share, 12.0, 20), std::min(1.0, 20.0 * chance));
}

/// The rest of F of a bench that holds sines which no model explains.
ChannelRest rest_with_sines(const std::vector<double>& frequencies, double amplitude, const sample::Bench& bench) {
  PreparedRecording recording = bench.problem.samples().front();
  std::vector<double>& force = recording.recording.channels[index(Channel::F)];
  for (std::size_t k = 0; k < force.size(); ++k) {
    const double t = static_cast<double>(k) * recording.input.period;
    for (const double f : frequencies) force[k] += amplitude * std::sin(2.0 * std::numbers::pi * f * t);
  }
  const IdentificationProblem problem({recording});
  const auto place = std::find(problem.channels().begin(), problem.channels().end(), Channel::F);
  return rest_of_channels(problem, bench.given).at(static_cast<std::size_t>(place - problem.channels().begin()));
}

// Law. (1): four directions of each band in which as much is left. The excess is that of the sines, noise taken off; of
// noise alone the share of it that is not known.
TEST(ChanceOfShare, CountsTheBandsInWhichSomethingIsLeft) {
  const sample::Bench bench(sample::bench(), 8.0);
  EXPECT_NEAR(rest_with_sines({10.0}, 1e4, bench).directions, 4.0, 0.2);
  EXPECT_NEAR(rest_with_sines({10.0, 30.0}, 1e4, bench).directions, 8.0, 0.4);
  EXPECT_NEAR(rest_with_sines({10.0, 12.0, 30.0}, 1e4, bench).directions, 4.0 * 9.0 / 5.0, 0.4);
  const double sine = rest_with_sines({10.0}, 1e4, bench).excess, larger = rest_with_sines({10.0}, 2e4, bench).excess;
  EXPECT_NEAR(larger / sine, 4.0, 0.01);
  const double noise = bench.problem.recordings().front().noise_variance(Channel::F);
  const auto count = static_cast<double>(bench.problem.samples().front().size());
  EXPECT_NEAR(rest_with_sines({10.0}, 20.0 * std::sqrt(noise), bench).excess, 200.0 * noise * count,
              0.05 * 200.0 * noise * count);
  EXPECT_NEAR(rest_with_sines({}, 0.0, bench).excess, 0.15 * noise * count, 0.02 * noise * count);
}

// Law. What takes all but noise of one channel away is no chance, whatever the others do; what takes nothing away is.
TEST(ChanceOfShare, IsThatOfTheChannelThatShowsACause) {
  const auto rest = [](double left, double excess) { return ChannelRest{left, excess, 12.0}; };
  const std::vector<ChannelRest> with{rest(1.0, 0.5), rest(5.0, 4.0)};
  EXPECT_LT(chance_of_cause(with, {rest(100.0, 99.5), rest(5.0, 4.0)}, 60), 1e-6);
  EXPECT_EQ(chance_of_cause(with, with, 60), 1.0);
  EXPECT_EQ(chance_of_cause(with, {rest(1.0, 0.5), rest(INFINITY, INFINITY)}, 60), 0.0);
  // Either of what is left and of what noise does not explain may show it.
  EXPECT_EQ(chance_of_cause({rest(2.0, 1.0)}, {rest(4.0, 1.0)}, 3), chance_of_share(0.5, 12.0, 6));
  EXPECT_EQ(chance_of_cause({rest(9.0, 1.0)}, {rest(10.0, 2.0)}, 3), chance_of_share(0.5, 12.0, 6));
  EXPECT_EQ(chance_of_cause({rest(2.0, 2.0), rest(9.0, 9.0)}, {rest(4.0, 4.0), rest(8.0, 8.0)}, 3),
            chance_of_share(0.5, 12.0, 12));
}

}  // namespace
