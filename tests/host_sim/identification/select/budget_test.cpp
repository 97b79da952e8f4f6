// The work that a diagnosis may spend.
#include "host_sim/identification/select/budget.hpp"

#include <gtest/gtest.h>

#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/select/thresholds.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"

namespace {

using namespace host_sim::identification;

void spend(const IdentificationProblem& problem, double share) {
  problem.samples().front().work->add_simulation(share * thresholds::most_work);
}

// Law. One simulation costs its samples times its steps a sample and what comes around them, in every copy and part of
// the problem.
TEST(Budget, CountsTheStepsOfEverySimulation) {
  const sample::Bench bench(sample::bench(), 3.0);
  const IdentificationProblem part = bench.problem.truncated(0.3);
  const double before = bench.problem.work().steps();
  double samples = 0.0;
  for (const IdentificationProblem* problem : {&bench.problem, &part}) {
    const Prediction prediction = predict(*problem, bench.given);
    samples += static_cast<double>(problem->recordings().front().fit_whitening->window().to);
  }
  EXPECT_EQ(bench.problem.work().steps(), before + samples * 5.0);  // one step, and four for what is around it
  EXPECT_EQ(part.work().steps(), bench.problem.work().steps());
}

// Law. Below the limit every stage may begin; above it none, and each is said once.
TEST(Budget, SaysWhatItDidNotTry) {
  const sample::Bench bench(sample::bench(), 3.0);
  spend(bench.problem, 0.9);
  EXPECT_TRUE(may_begin(bench.problem, "laws"));
  EXPECT_TRUE(bench.problem.work().left_out().empty());
  spend(bench.problem, 0.2);
  EXPECT_FALSE(may_begin(bench.problem, "laws"));
  EXPECT_FALSE(may_begin(bench.problem, "laws"));
  EXPECT_FALSE(may_begin(bench.problem.truncated(0.3), "events"));
  EXPECT_EQ(bench.problem.work().left_out(), (std::vector<std::string>{"laws", "events"}));
}

// Law. A stage ends at half of what was left when it began, and a later one gets half of the rest.
TEST(Budget, LeavesHalfToTheNextStage) {
  const sample::Bench bench(sample::bench(), 3.0);
  spend(bench.problem, 0.2);
  const StageBudget first(bench.problem);
  spend(bench.problem, 0.3);  // of 0.4
  EXPECT_TRUE(first.allows(bench.problem, "exchanges"));
  spend(bench.problem, 0.2);
  EXPECT_FALSE(first.allows(bench.problem, "exchanges"));
  EXPECT_EQ(bench.problem.work().left_out(), std::vector<std::string>{"exchanges"});
  const StageBudget second(bench.problem);
  EXPECT_FALSE(second.is_spent(bench.problem));
  spend(bench.problem, 0.2);  // of 0.15
  EXPECT_TRUE(second.is_spent(bench.problem));
}

}  // namespace
