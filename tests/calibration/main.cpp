// rigtwin_plan_calibration: does diagnose find what plan promises?
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "tests/calibration/calibration.hpp"

namespace {

int run(const calibration::Asked& asked) {
  std::size_t promised = 0, named = 0, unseen = 0, believed = 0;
  for (const calibration::Case& one : calibration::calibrate(asked)) {
    std::printf("%-5s %-30s %12.5g  %s\n", one.promised ? "10 σ" : "1.5 σ", one.effect.c_str(), one.value,
                !one.failure.empty() ? one.failure.c_str()
                : one.found.empty()  ? "nothing"
                                     : one.found.c_str());
    if (!one.failure.empty()) continue;
    (one.promised ? promised : unseen) += 1;
    named += one.promised && one.named ? 1 : 0;
    believed += !one.promised && one.believed ? 1 : 0;
  }
  std::printf("%s, seed %llu: %zu of %zu promised effects named; %zu of %zu below 2 σ named with confidence\n",
              asked.kind.c_str(), static_cast<unsigned long long>(asked.seed), named, promised, believed, unseen);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Holds rigtwin diagnose against what rigtwin plan promises");
  calibration::Asked asked;
  app.add_option("kind", asked.kind, "quarter_car, hil or component_bench")->capture_default_str();
  app.add_option("seed", asked.seed, "Seed of rig, road and noise")->capture_default_str();
  app.add_option("--part", asked.part, "Of so many parts of the effects the one with this number")
      ->check(CLI::PositiveNumber);
  app.add_option("--parts", asked.parts, "Parts of the effects")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--duration", asked.duration, "Length of the recordings [s]")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return run(asked);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigtwin_plan_calibration: %s\n", error.what());
    return 1;
  }
}
