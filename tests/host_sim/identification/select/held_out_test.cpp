// Windows that no fit has seen, as evidence between models; and whether a law holds at every amplitude. The recordings
// of the second part come from tests/truth, which shares no code with the model.
#include "host_sim/identification/select/held_out.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/select/law_constancy.hpp"
#include "host_sim/identification/select/search.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/host_sim/identification/select/bench_problem.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace host_sim::identification;
using sample::Bench;

// Law. The rig that was recorded leaves one of χ² per held-out residual, another one more; a part of the windows, which
// holds nothing out, says nothing.
TEST(HeldOut, CountsWhatNoFitHasSeen) {
  const Bench bench(sample::bench());
  const auto& recording = bench.problem.recordings().front();
  const auto count = static_cast<double>(recording.held_out_whitening->count());
  EXPECT_NEAR(held_out_chi_squared(bench.problem, bench.given) / count, 1.0, 5.0 * std::sqrt(2.0 / count));
  Hypothesis other = bench.given;
  firmware::put_effect(other.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {20.0}});
  EXPECT_GT(held_out_chi_squared(bench.problem, other), 2.0 * count);
  EXPECT_EQ(held_out_chi_squared(bench.problem.truncated(0.5), bench.given), 0.0);
  EXPECT_EQ(held_out_count(bench.problem), recording.held_out_whitening->count());
  EXPECT_EQ(held_out_count(bench.problem.truncated(0.5)), 0U);
}

// Law. An effect that the fitted windows support and the held-out ones contradict is left out again. The friction acts
// for the first 6 s only, which are the fitted ones.
TEST(HeldOut, TakesAwayWhatItContradicts) {
  const firmware::RigDescription friction = sample::with_effect(sample::bench(), "coulomb_friction", {1.5});
  firmware::Recording recording = sample::recorded(friction);
  const firmware::Recording plain = sample::recorded(sample::bench());
  auto& force = recording[model::Channel::F];
  for (std::size_t k = 6000; k < force.size(); ++k)
    force[k] = plain[model::Channel::F][k] - 2.0 * (force[k] - plain[model::Channel::F][k]);
  const auto diagnosed = [&](bool all_fitted) {
    std::vector<Record> records{{recording, all_fitted ? Use::fitted : Use::shared}};
    if (all_fitted) records.front().recording = sample::recorded(friction);
    return diagnose(sample::bench(), records);
  };
  EXPECT_EQ(diagnosed(true).effects.size(), 1U) << "the fitted windows alone support it";
  for (const NamedEffect& named : diagnosed(false).effects) EXPECT_NE(named.effect.entry->name, "coulomb_friction");
}

/// 20 s of a bench on which one law acts.
Diagnosis bench_with(const std::vector<truth::Effect>& effects, const std::map<std::string, double>& outside) {
  truth::Truth truth = truth::draw("none:component_bench", 3);
  truth.effects = effects;
  truth.unknown = outside.empty() ? "" : "a law";
  truth.unknown_parameters = outside;
  truth.records.resize(1);
  truth.records[0].duration = 20.0;
  truth.records[0].warm = 0.0;
  return diagnose(
      firmware::parse_rig(truth::rig_toml(truth), "rig.toml"),
      {{firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"), Use::shared}});
}

// Journey. A damper whose force grows with the power 1.6 of velocity is not a quadratic one: no effect is believed; a
// law is learned, or something is said to be left. The quadratic one keeps its name and no law is learned.
TEST(LawConstancy, DoubtsALawThatIsOnlyNear) {
  const Diagnosis quadratic = bench_with({{"quadratic_damping", "", {{"coefficient", 600.0}}}}, {});
  ASSERT_EQ(quadratic.effects.size(), 1U);
  EXPECT_EQ(quadratic.effects[0].effect.entry->name, "quadratic_damping");
  EXPECT_GT(quadratic.effects[0].confidence, 0.9);
  EXPECT_FALSE(quadratic.unexplained) << quadratic.residual;
  EXPECT_TRUE(quadratic.laws.empty());
  for (const double exponent : {1.6, 2.5}) {
    const Diagnosis near = bench_with({}, {{"power", 600.0}, {"exponent", exponent}});
    EXPECT_NE(near.unexplained, !near.laws.empty()) << exponent;
    for (const NamedEffect& named : near.effects)
      EXPECT_LT(named.confidence, 0.5) << named.effect.entry->name << " for the power " << exponent;
  }
}

// Point. Both the significance and the size count.
TEST(LawConstancy, FailsBySignificanceAndSize) {
  const LawConstancy large{.gain = 100.0, .share = 0.1};
  EXPECT_TRUE(large.fails());
  const LawConstancy weak{.gain = 20.0, .share = 0.1};
  EXPECT_FALSE(weak.fails());
  const LawConstancy tiny{.gain = 100.0, .share = 0.01};
  EXPECT_FALSE(tiny.fails());
}

}  // namespace
