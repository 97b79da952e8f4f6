// rigtwin_transfer_calibration: do the bands of rigtwin transfer hold as often as they say?
#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <exception>

#include "tests/transfer_calibration/calibration.hpp"

namespace {

namespace calibration = transfer_calibration;

void print_prior(std::size_t rigs, std::uint64_t seed) {
  std::printf("ranks of %zu rigs from the prior, seed %llu, %zu bins, χ² of %zu degrees of freedom\n", rigs,
              static_cast<unsigned long long>(seed), calibration::Ranks::bins, calibration::Ranks::bins - 1);
  for (const auto& [name, ranks] : calibration::calibrate_on_prior(rigs, seed).ranks) {
    std::printf("  %-26s χ² %6.2f  p %.3f  ", name.c_str(), ranks.chi_squared(), ranks.p());
    for (const std::size_t count : ranks.counts) std::printf(" %3zu", count);
    std::printf("\n");
    std::fflush(stdout);
  }
}

void print_case(const calibration::TruthCase& one, calibration::Hidden hidden) {
  std::printf("  seed %llu: %s%s50 %% %.2f, 95 %% %.2f, quantities %.2f, %s", static_cast<unsigned long long>(one.seed),
              one.outside.c_str(), one.outside.empty() ? "" : ": ", one.coverage50, one.coverage95, one.load,
              one.holds ? "holds" : "does not hold");
  if (hidden == calibration::Hidden::component) {
    std::printf(
        "; carried over: %s; a band off by %.1f %% at most; discrepancy up to %.1f %% of the force, %.2f of a "
        "parameter's variance; without the process 50 %% %.2f, 95 %% %.2f",
        one.travels.empty() ? "nothing" : one.travels.c_str(), 100.0 * one.deviation, 100.0 * one.discrepancy,
        one.confounded, one.coverage50_without, one.coverage95_without);
  }
  std::printf("\n");
  std::fflush(stdout);
}

void print_truth(std::size_t pairs, std::uint64_t seed, calibration::Hidden hidden, double duration) {
  calibration::TruthCase sum;
  std::size_t count = 0, holds = 0, said = 0, carried = 0;
  for (std::size_t i = 0; i < pairs; ++i) {
    const auto one = calibration::transfer_truth(seed + 10 * i, hidden, duration);
    if (!one.failure.empty()) {
      std::printf("  seed %llu: %s\n", static_cast<unsigned long long>(one.seed), one.failure.c_str());
      continue;
    }
    ++count;
    sum.coverage50 += one.coverage50;
    sum.coverage95 += one.coverage95;
    sum.coverage50_without += one.coverage50_without;
    sum.coverage95_without += one.coverage95_without;
    sum.load += one.load;
    holds += one.holds ? 1 : 0;
    said += one.said ? 1 : 0;
    carried += one.discrepancy > 0.0 ? 1 : 0;
    print_case(one, hidden);
  }
  if (count == 0) return;
  constexpr std::array<const char*, 3> what{"", " with an effect of the second rig alone",
                                            " with a law of the component that the catalogue does not hold"};
  const auto n = static_cast<double>(count);
  std::printf(
      "%zu pairs of tests/truth%s, seed %llu: coverage %.3f of 50 %% bands, %.3f of 95 %% bands, %.3f of the "
      "quantities; %zu hold",
      count, what[static_cast<std::size_t>(hidden)], static_cast<unsigned long long>(seed), sum.coverage50 / n,
      sum.coverage95 / n, sum.load / n, holds);
  if (hidden == calibration::Hidden::second_rig) std::printf(", said of %zu", said);
  if (hidden == calibration::Hidden::component) {
    std::printf("; a discrepancy carried over in %zu, without it %.3f and %.3f", carried, sum.coverage50_without / n,
                sum.coverage95_without / n);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Holds the bands of rigtwin transfer against rigs whose truth is known");
  std::size_t rigs = 200, pairs = 40, outside = 40, laws = 12;
  std::uint64_t seed = 7001;
  double duration = 20.0;
  app.add_option("--rigs", rigs, "Rigs from the prior")->capture_default_str();
  app.add_option("--pairs", pairs, "Pairs of rigs of tests/truth")->capture_default_str();
  app.add_option("--outside", outside, "Pairs with an effect of the second rig alone")->capture_default_str();
  app.add_option("--laws", laws, "Pairs whose component follows a law that the catalogue does not hold")
      ->capture_default_str();
  app.add_option("--seed", seed, "First seed")->capture_default_str();
  app.add_option("--duration", duration, "Length of their recordings [s]")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    if (rigs > 0) print_prior(rigs, seed);
    if (pairs > 0) print_truth(pairs, seed, calibration::Hidden::known, duration);
    if (outside > 0) print_truth(outside, seed, calibration::Hidden::second_rig, duration);
    if (laws > 0) print_truth(laws, seed, calibration::Hidden::component, duration);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigtwin_transfer_calibration: %s\n", error.what());
    return 1;
  }
}
