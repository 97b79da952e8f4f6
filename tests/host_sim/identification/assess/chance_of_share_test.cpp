// Causes that explain something by chance.
#include "host_sim/identification/assess/chance_of_share.hpp"

#include <gtest/gtest.h>

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
    const double angle = std::asin(1.0 - share);
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
  constexpr double share = 0.15;
  int singles = 0, best_of_20 = 0;
  bool any = false;
  for (int i = 1; i <= draws; ++i) {
    const double known = std::pow(normal(random), 2);
    double all = known;
    for (int k = 1; k < 12; ++k) all += std::pow(normal(random), 2);
    const bool reached = 1.0 - std::sqrt(1.0 - known / all) >= share;  // error falls from 1 to √(1 − cos²)
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

/// A bench whose F holds sines of the same size that no model explains.
IdentificationProblem with_sines(const std::vector<double>& frequencies, const sample::Bench& bench) {
  PreparedRecording recording = bench.problem.samples().front();
  std::vector<double>& force = recording.recording.channels[index(Channel::F)];
  for (std::size_t k = 0; k < force.size(); ++k) {
    const double t = static_cast<double>(k) * recording.input.period;
    for (const double f : frequencies) force[k] += 1e4 * std::sin(2.0 * std::numbers::pi * f * t);
  }
  return IdentificationProblem({recording});
}

// Law. (1): four directions of each band in which as much is left; noise beside it adds hardly any.
TEST(ChanceOfShare, CountsTheBandsInWhichSomethingIsLeft) {
  const sample::Bench bench(sample::bench(), 8.0);
  EXPECT_NEAR(directions_left(with_sines({10.0}, bench), bench.given), 4.0, 0.2);
  EXPECT_NEAR(directions_left(with_sines({10.0, 30.0}, bench), bench.given), 8.0, 0.4);
  EXPECT_NEAR(directions_left(with_sines({10.0, 12.0, 30.0}, bench), bench.given), 4.0 * 9.0 / 5.0, 0.4);
}

}  // namespace
