// Runs benchmarks as Google Benchmark's own main does, then prints the ratios that speed is wanted by: two of them run
// side by side on this machine, the least of the repetitions of each. (Not the medians: on a shared machine a step
// takes 24 to 36 ns from one run to the next, while the chain of products that it is held against stays at 10.5; a
// neighbour on the same core would do that.)
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace {

struct Ratio {
  const char* measured;
  const char* rival;
  double most;
};
constexpr std::array<Ratio, 10> ratios{{{"step/hil_fdva", "step/limit_matvec6", 2.5},
                                        {"step/hil_fdva", "step/odeint_rk4", 0.5},
                                        {"step/hil_fdva_silent", "step/hil_fdva", 1.1},  // 1, and a machine's noise
                                        {"lanes/quarter_car/beside", "lanes/quarter_car/alone", 0.4},
                                        {"lanes/quarter_car_fdva/beside", "lanes/quarter_car_fdva/alone", 0.4},
                                        {"lanes/hil_fdva/beside", "lanes/hil_fdva/alone", 0.4},
                                        {"lanes/friction/beside", "lanes/friction/alone", 0.4},
                                        {"lanes/stop/beside", "lanes/stop/alone", 0.4},
                                        {"lanes/law/beside", "lanes/law/alone", 0.4},
                                        {"estimator/kalman", "estimator/covariance", 0.5}}};

class WithRatios final : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const bool single = run.run_type == Run::RT_Iteration && run.repetitions <= 1;
      if (single || run.aggregate_name == "min") times_[run.run_name.function_name] = run.GetAdjustedCPUTime();
    }
  }

  void Finalize() override {
    ConsoleReporter::Finalize();
    for (const Ratio& ratio : ratios) {
      const auto measured = times_.find(ratio.measured), rival = times_.find(ratio.rival);
      if (measured == times_.end() || rival == times_.end()) continue;
      const double found = measured->second / rival->second;
      std::printf("%s takes %.2f times %s, wanted %.2f at most: %s\n", ratio.measured, found, ratio.rival, ratio.most,
                  found <= ratio.most ? "kept" : "NOT KEPT here");
    }
  }

 private:
  std::map<std::string, double> times_;  // CPU time, in the benchmark's unit
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  WithRatios reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  return 0;
}
