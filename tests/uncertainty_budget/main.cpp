// rigtwin_uncertainty_budget: do estimates scatter as their uncertainty budgets say?
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "tests/uncertainty_budget/draws.hpp"

namespace {

int run(const uncertainty_budget::Asked& asked) {
  std::printf("%zu draws of a %s, %.3g s, seed %llu\n", asked.draws, asked.rig.c_str(), asked.duration,
              static_cast<unsigned long long>(asked.seed));
  for (const uncertainty_budget::Compared& one : uncertainty_budget::compare(asked)) {
    std::printf("  %-36s spread %10.4g  budget %10.4g  ratio %.3f  bias %6.2f spreads   %s\n", one.number.c_str(),
                one.spread, one.combined, one.spread / one.combined, one.bias / one.spread, one.parts.c_str());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Holds uncertainty budgets against Monte Carlo draws");
  uncertainty_budget::Asked asked;
  app.add_option("rig", asked.rig, "component_bench or quarter_car")->capture_default_str();
  app.add_option("--draws", asked.draws, "Rigs, sensors and noises")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  app.add_option("--seed", asked.seed, "Seed of the draws")->capture_default_str();
  app.add_option("--duration", asked.duration, "Length of the recordings [s]")->capture_default_str();
  app.add_flag("!--exact-sensors", asked.calibration, "Without [calibration]");
  app.add_flag("!--exact-rig", asked.tolerances, "Without tolerances of what is not fitted");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(asked);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigtwin_uncertainty_budget: %s\n", error.what());
    return 1;
  }
}
