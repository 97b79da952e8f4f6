// Hidden rigs, each with a target that it made itself: `rigtwin replicate` beside its rival, the inverse of a measured
// frequency response.
//
//   rigtwin_replicate_rival [--seed 1] [--rigs 10] [--runs 3] [--rival-runs 15] [--seconds 20] [--rig N]
//   rigtwin_replicate_rival --known …        the rig is as described: error of the first drive on the model, time for it
//
// Both have the same run of 60 s before: the rival measures its response with it, the model's tolerated numbers are
// fitted to it. Runs are those of the simulated rig behind its controller, with the noise of its sensors. Error:
// rms(target − reached)/rms(target), 0.7 to 40 Hz, as `rigtwin replicate` has it.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/replicate/replication.hpp"
#include "tests/bench/replicate_rival/hidden_rig.hpp"
#include "tests/bench/replicate_rival/inverse_response.hpp"

namespace {

using host_sim::replicate::Replication;
using model::Channel;
using namespace replicate_rival;

struct Options {
  std::uint64_t seed = 1;
  std::size_t rigs = 10, runs = 3, rival_runs = 15, only = 0;
  double seconds = 20.0;
  bool described = false, known = false;
};

constexpr double identifying = 60.0;  // [s]

struct ModelRuns {
  std::vector<double> error, predicted, damage;  ///< by run; damage of k = 5
  double seconds = 0.0;                          ///< of one core, for all drives
};

ModelRuns run_model(const HiddenRig& rig, const firmware::Recording& target, const firmware::Recording* identified,
                    std::size_t runs, std::uint64_t seed) {
  ModelRuns result;
  const std::clock_t begin = std::clock();
  Replication replication(rig.described, host_sim::replicate::parse_request("zdd_w", {"0.7:40"}), {target}, 1e-9);
  if (identified != nullptr) replication.refine_on(*identified);
  for (std::size_t r = 0; r < runs; ++r) {
    replication.solve();
    replication.take(run(rig.truth, replication.drives().back().values, seed + r));
    const auto& made = replication.results().back();
    result.error.push_back(made.error.front());
    result.predicted.push_back(made.predicted.front());
    result.damage.push_back(made.damage.front()[1]);
    if (r + 1 < runs) replication.refine();
  }
  result.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return result;
}

std::vector<double> run_rival(const HiddenRig& rig, const firmware::Recording& target,
                              const firmware::Recording& identified, double gain, std::size_t runs,
                              std::uint64_t seed) {
  namespace replicate = host_sim::replicate;
  const replicate::Target wanted =
      replicate::make_target(rig.described, replicate::parse_request("zdd_w", {"0.7:40"}), {target});
  const auto response = measured_response(identified, replicate::BandInverse::transform_length(wanted));
  InverseResponse rival(wanted, response, replicate::limits_of(rig.described), gain);
  std::vector<double> errors;
  for (std::size_t r = 0; r < runs; ++r) {
    const auto answer = run(rig.truth, rival.drive(), seed + r)[Channel::zdd_w];
    errors.push_back(replicate::rms_over(wanted.events, rival.error(answer)) / rival.target_rms());
    rival.take(answer);
  }
  return errors;
}

void solve_known(HiddenRig rig, double seconds, std::uint64_t seed) {
  rig.truth = rig.described;
  rig.truth.noise[index(Channel::zdd_w)].reset();
  const std::clock_t begin = std::clock();
  Replication replication(rig.described, host_sim::replicate::parse_request("zdd_w", {"0.7:40"}),
                          {target_of(rig, seconds, seed)}, 1e-9);
  replication.solve();
  std::printf("  on the model %5.2f %%  %5.1f s\n", 100.0 * replication.results().front().predicted.front(),
              static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  std::fflush(stdout);
}

void run_rig(const Options& options, std::size_t number) {
  const std::uint64_t seed = 1000 * options.seed + number;
  const HiddenRig rig = draw_rig(seed);
  const firmware::Recording target = target_of(rig, options.seconds, seed);
  std::printf("%2zu  %-44s stops %4.1f %%", number, rig.name.c_str(),
              100.0 * share_at_stops(rig, options.seconds, seed));
  std::fflush(stdout);
  if (options.known) {
    solve_known(rig, options.seconds, seed);
    return;
  }
  if (options.described)
    std::printf("  described %5.2f", 100.0 * run_model(rig, target, nullptr, 1, seed).error.front());
  const firmware::Recording identified = run(rig.truth, identifying_command(rig, identifying, seed + 500), seed + 500);
  const ModelRuns made = run_model(rig, target, &identified, options.runs, seed);
  std::printf("  model");
  for (const double e : made.error) std::printf(" %5.2f", 100.0 * e);
  std::printf("  predicted");
  for (const double e : made.predicted) std::printf(" %5.2f", 100.0 * e);
  std::printf("  damage");
  for (const double d : made.damage) std::printf(" %5.3f", d);
  std::printf("  %4.0f s", made.seconds);
  for (const double gain : {1.0, 0.5}) {
    if (options.rival_runs == 0) break;
    const auto errors = run_rival(rig, target, identified, gain, options.rival_runs, seed);
    std::printf("  gain %.1f", gain);
    for (const std::size_t r : {1U, 2U, 3U, 5U, 10U, 15U}) {
      if (r <= errors.size()) std::printf(" %5.1f", 100.0 * errors[r - 1]);
    }
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("rigtwin replicate and its rival on hidden rigs");
  Options options;
  app.add_option("--seed", options.seed);
  app.add_option("--rigs", options.rigs);
  app.add_option("--runs", options.runs, "of the model");
  app.add_option("--rival-runs", options.rival_runs);
  app.add_option("--seconds", options.seconds, "of target");
  app.add_option("--rig", options.only, "this rig alone");
  app.add_flag("--described", options.described, "also run 1 of the model as described, without the run before");
  app.add_flag("--known", options.known, "the rig is as described: the first drive on the model alone");
  CLI11_PARSE(app, argc, argv);
  try {
    for (std::size_t number = 1; number <= options.rigs; ++number) {
      if (options.only == 0 || options.only == number) run_rig(options, number);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
