// The work that a search may spend.
#include "host_sim/identification/select/budget.hpp"

#include <gtest/gtest.h>

#include "host_sim/identification/select/thresholds.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"

namespace {

using namespace host_sim::identification;

// Law. Below the limit every step may begin; above it none, and each is said once.
TEST(Budget, SaysWhatItDidNotTry) {
  const sample::Bench bench(sample::bench(), 3.0);
  const double each = simulated_samples(bench.problem, 1);
  EXPECT_EQ(each, static_cast<double>(bench.problem.recordings().front().fitted.to));
  SearchResult found;
  found.simulations = static_cast<std::size_t>(0.9 * thresholds::most_simulated_samples / each);
  EXPECT_TRUE(may_begin(bench.problem, "laws", found));
  EXPECT_TRUE(found.not_tried.empty());
  found.simulations = static_cast<std::size_t>(1.1 * thresholds::most_simulated_samples / each);
  EXPECT_FALSE(may_begin(bench.problem, "laws", found));
  EXPECT_FALSE(may_begin(bench.problem, "laws", found));
  EXPECT_EQ(found.not_tried, std::vector<std::string>{"laws"});
}

}  // namespace
