// What a whole diagnosis of a minute at 1 kHz costs in wall time, the whole catalogue tried; recordings of the truth
// generator.
//
//   diagnose/quarter_car/…       at most 5 s in the middle of many recordings, 15 s for the worst, on two processors
//   diagnose/component_bench/…   the same
//
// Beside it: candidates tried and simulations of the fitted part, by the second.
#include <benchmark/benchmark.h>

#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "tests/truth/truth.hpp"

namespace {

void diagnose_a_minute(benchmark::State& state, const std::string& group) {
  truth::Wanted wanted;
  wanted.duration = 60.0;
  const truth::Truth truth = truth::draw(group, 1, wanted);
  const firmware::RigDescription rig = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  std::vector<firmware::Recording> recordings;
  for (const truth::Record& record : truth::simulate(truth)) {
    recordings.push_back(firmware::parse_recording_csv(truth::csv(truth, record), "rec.csv"));
  }
  double simulations = 0.0, candidates = 0.0;
  for (auto _ : state) {
    std::vector<host_sim::identification::Record> records;
    for (const auto& recording : recordings) records.push_back({recording, host_sim::identification::Use::shared});
    const auto found = host_sim::identification::diagnose(rig, std::move(records));
    simulations += static_cast<double>(found.simulations);
    candidates += static_cast<double>(found.candidates);
    benchmark::DoNotOptimize(found.verdict);
  }
  state.counters["simulations"] = benchmark::Counter(simulations, benchmark::Counter::kIsRate);
  state.counters["candidates"] = benchmark::Counter(candidates, benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(diagnose_a_minute, quarter_car / nothing, "none:quarter_car")
    ->Name("diagnose/quarter_car/nothing")
    ->UseRealTime()
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(diagnose_a_minute, quarter_car / damping, "single:quarter_car:body_guide_damping")
    ->Name("diagnose/quarter_car/body_guide_damping")
    ->UseRealTime()
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(diagnose_a_minute, quarter_car / friction, "single:quarter_car:coulomb_friction")
    ->Name("diagnose/quarter_car/coulomb_friction")
    ->UseRealTime()
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(diagnose_a_minute, quarter_car / pair, "pair:quarter_car")
    ->Name("diagnose/quarter_car/pair")
    ->UseRealTime()
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(diagnose_a_minute, quarter_car / unknown, "unknown:quarter_car:cubic_damping")
    ->Name("diagnose/quarter_car/unknown")
    ->UseRealTime()
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(diagnose_a_minute, bench / delay, "single:component_bench:actuator_delay")
    ->Name("diagnose/component_bench/actuator_delay")
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

}  // namespace
