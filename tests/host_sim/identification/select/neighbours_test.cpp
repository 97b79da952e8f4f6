// A machine and a recorder that make the same of what is recorded.
#include "host_sim/identification/select/neighbours.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/identification/predict/recording_faults.hpp"
#include "host_sim/identification/select/model_evidence.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;
using sample::Bench;

/// A fault that was found, and what the machine may be in its place.
struct Compared {
  CandidateModel by_fault;
  std::vector<CandidateModel> by_machine;
};
Compared compared(Bench& bench, const PlacedFault& fault) {
  static const SelectionCriterion criterion;
  const ModelFitter fitter(bench.problem, bench.space.common, criterion);
  Hypothesis start = bench.given;
  start.faults.push_back(fault);
  Compared result{fitter.refitted(start, {}), {}};
  result.by_machine = machine_instead(fitter, result.by_fault, 0);
  return result;
}

const double late = 6e-3;  // [s]

// Point. A delay of the machine that was taken for a late and slow clock of x_act and F: in its place the delay is found,
// to six deviations, of 20 µm of noise on a velocity of 68 mm/s rms and 6000 samples: 6 · 20e-6/(0.068 √6000) = 2.3e-5 s.
// Both explain as much, so the evidence prefers the machine by the prior of a component alone.
TEST(Neighbours, AClockOfAllThatMovesIsADelayOfTheMachine) {
  Bench bench(sample::with_effect(sample::bench(), "actuator_delay", {late}), 8.0);
  const Compared models = compared(bench, clock_fault({Channel::x_act, Channel::F}, 0.9 * late, 0.0));
  ASSERT_EQ(models.by_machine.size(), 1U);
  const CandidateModel& machine = models.by_machine.front();
  ASSERT_EQ(machine.effects.size(), 1U);
  EXPECT_EQ(machine.effects.front().entry->name, "actuator_delay");
  EXPECT_NEAR(machine.effects.front().values.front(), late, 2.3e-5);
  EXPECT_TRUE(machine.faults().empty());
  EXPECT_LT(evidence_of(bench.problem, machine, {}, {}).total(),
            evidence_of(bench.problem, models.by_fault, {}, {}).total());
}

// Point. What is said of one channel alone is none of the machine's.
TEST(Neighbours, AClockOfOneChannelIsNone) {
  Bench bench(sample::with_effect(sample::bench(), "sensor_delay", {late}, Channel::F), 4.0);
  EXPECT_TRUE(compared(bench, clock_fault({Channel::F}, late, 0.0)).by_machine.empty());
}

// Point. A filter of second order is a resonance to the stroke; a lag and a delay of the same group delay explain less
// and cost as much, so where nothing but noise is left the evidence keeps what is right.
TEST(Neighbours, AFilterIsTriedAsEachOfItsNeighbours) {
  Bench bench(sample::with_effect(sample::bench(), "actuator_resonance", {30.0, 0.7}), 8.0);
  const Compared models = compared(bench, filter_fault({Channel::x_act, Channel::F}, 30.0, 2));
  const auto value = [&](const CandidateModel& m) { return evidence_of(bench.problem, m, {}, {}).total(); };
  const auto best = std::min_element(models.by_machine.begin(), models.by_machine.end(),
                                     [&](const auto& a, const auto& b) { return value(a) < value(b); });
  ASSERT_NE(best, models.by_machine.end());
  ASSERT_EQ(best->effects.size(), 1U);
  EXPECT_EQ(best->effects.front().entry->name, "actuator_resonance");
  EXPECT_NEAR(best->effects.front().values[0], 30.0, 0.3);
}

}  // namespace
