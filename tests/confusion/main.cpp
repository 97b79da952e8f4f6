// rigtwin_confusion: how often `rigtwin diagnose` is right, over recordings whose answer is known.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "firmware/description/text/sha256.hpp"
#include "firmware/description/version.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/sweep/merge.hpp"
#include "host_sim/sweep/run_cases.hpp"
#include "tests/confusion/golden.hpp"
#include "tests/confusion/laws.hpp"
#include "tests/confusion/rough.hpp"
#include "tests/confusion/workers.hpp"

namespace {

using namespace confusion;

struct Options {
  Run run;
  std::vector<std::string> groups;
  std::string part;
  std::size_t jobs = 2;
  unsigned most_seconds = 600;
  bool list = false;
  bool rough = false;
  std::uint64_t rough_seed = 1;
  std::size_t count = 10;
  std::string condition;
  bool laws = false;
  std::uint64_t laws_seed = 1;
  std::string out, golden, against;
  bool compare_models = false;
  std::filesystem::path results;  ///< folder of the shards
  std::string shard;
  bool merge = false;
};

std::vector<Asked> chosen(const Options& options) {
  std::vector<Asked> all = options.laws ? laws_plan(options.laws_seed, options.count) : plan(options.run.seed);
  if (!options.part.empty()) {
    unsigned part = 0, parts = 0;
    if (std::sscanf(options.part.c_str(), "%u/%u", &part, &parts) != 2 || part < 1 || part > parts) {
      throw CLI::ValidationError("--part", "expected K/N with 1 ≤ K ≤ N, as 1/5");
    }
    all = part_of(all, part, parts);
  }
  if (options.groups.empty()) return all;
  std::erase_if(all, [&](const Asked& asked) {
    for (const std::string& text : options.groups) {
      if (asked.group.find(text) != std::string::npos) return false;
    }
    return true;
  });
  return all;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16] = "";
  std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
  return text;
}

int compared(const Options& options, const Table& table, const std::vector<Outcome>& outcomes) {
  std::vector<std::string> worse;
  std::ifstream file(options.against);
  if (file) {
    worse = regressions(options.run, outcomes, nlohmann::ordered_json::parse(file));
  } else {
    std::printf("%s is not there: held against minimum shares\n", options.against.c_str());
    worse = shortfalls(table);
  }
  for (const std::string& what : worse) std::printf("worse: %s\n", what.c_str());
  return worse.empty() ? 0 : 1;
}

/// The recordings as cases of a sweep: a case is a recording, whoever diagnoses it.
host_sim::sweep::CaseSet cases_of(const Options& options, const std::vector<Asked>& asked) {
  const truth::Wanted& wanted = options.run.wanted;
  std::string all = std::string(firmware::version) +
                    nlohmann::ordered_json{wanted.weak, wanted.duration, wanted.varied, options.most_seconds}.dump();
  for (const Asked& a : asked) all += a.id() + "\n";
  return {asked.size(), firmware::sha256(all)};
}

/// One shard of the recordings into files of --results; one recording at a time, in a process of its own.
void run_shard(const Options& options, const std::vector<Asked>& asked) {
  namespace sweep = host_sim::sweep;
  const auto engine = sweep::shard_of_engine(sweep::process_environment);
  const sweep::Shard shard =
      options.shard.empty() ? engine.value_or(sweep::Shard{}) : sweep::parse_shard(options.shard);
  std::filesystem::create_directories(options.results);
  const auto line = [&](std::uint64_t id) {
    const auto outcome = run_all({asked[id]}, options.run.wanted, 1, options.most_seconds, {});
    nlohmann::ordered_json json{{"id", id}};
    json["outcome"] = to_json(outcome.front());
    return json.dump();
  };
  const auto tell = [](const sweep::ShardWork& work) {
    std::fprintf(stderr, "%llu/%llu\n", static_cast<unsigned long long>(work.before + work.now),
                 static_cast<unsigned long long>(work.cases));
  };
  sweep::run_cases(cases_of(options, asked), shard, options.results, 1, line, tell);
}

/// The outcomes of all shards; throws where one is missing, there twice, or of other recordings.
std::vector<Outcome> merged(const Options& options, const std::vector<Asked>& asked) {
  std::vector<Outcome> outcomes;
  const auto cases = host_sim::sweep::merge(options.results, [&](const auto& line) {
    outcomes.push_back(outcome_from(nlohmann::ordered_json::parse(line.text)["outcome"]));
  });
  if (cases.fingerprint != cases_of(options, asked).fingerprint) {
    throw std::runtime_error(options.results.string() + " holds other recordings than these options ask for");
  }
  return outcomes;
}

int main_of(const Options& options) {
  const std::vector<Asked> asked =
      options.rough ? rough_plan(options.rough_seed, options.count, options.condition) : chosen(options);
  if (options.list) {
    for (const Asked& a : asked) std::puts(a.id().c_str());
    return 0;
  }
  if (!options.results.empty() && !options.merge) {
    run_shard(options, asked);
    return 0;
  }
  std::size_t done = 0;
  const auto tell = [&](const Outcome& o) {
    std::fprintf(stderr, "%3zu/%zu %s %s: %s\n", ++done, asked.size(), o.right() ? "right" : "WRONG",
                 o.asked.id().c_str(), (o.failure.empty() ? o.found : o.failure).c_str());
  };
  const auto outcomes = options.merge ? merged(options, asked)
                                      : run_all(asked, options.run.wanted, options.jobs, options.most_seconds, tell,
                                                options.compare_models);
  const Table table = table_of(outcomes);
  const std::string words = options.rough  ? rough_text(outcomes)
                            : options.laws ? laws_text(outcomes)
                                           : text(table, outcomes);
  std::printf("%s", words.c_str());
  if (!options.out.empty()) {
    nlohmann::ordered_json all = golden_copy(options.run, today(), table, {});
    all["recordings"] = nlohmann::ordered_json::array();
    for (const Outcome& o : outcomes) all["recordings"].push_back(to_json(o));
    firmware::write_file(options.out, all.dump(1) + "\n");
  }
  if (!options.golden.empty()) {
    firmware::write_file(options.golden + ".json", golden_copy(options.run, today(), table, outcomes).dump(1) + "\n");
    firmware::write_file(options.golden + ".txt", today() + ", " + words);
  }
  return options.against.empty() ? 0 : compared(options, table, outcomes);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"How often rigtwin diagnose is right, over recordings whose answer is known"};
  app.add_option("--seed", options.run.seed, "First seed of every group")->capture_default_str();
  app.add_option("--groups", options.groups, "Only groups whose name holds one of these texts");
  app.add_option("--part", options.part, "Only part K of N, as 1/5");
  app.add_option("--duration", options.run.wanted.duration, "Length of a recording [s]")->capture_default_str();
  app.add_flag("--varied", options.run.wanted.varied, "Other rigs, roads, noise and sample rates");
  app.add_flag("--weak", options.run.wanted.weak, "Effects of 30 … 100 σ in all");
  CLI::Option* rough =
      app.add_option("--rough", options.rough_seed, "Rigs that are not as described; a seed may follow")
          ->expected(0, 1);
  CLI::Option* laws =
      app.add_option("--laws", options.laws_seed, "Laws outside the catalogue on every kind of rig; a seed may follow")
          ->expected(0, 1)
          ->excludes(rough);
  app.add_option("--condition", options.condition, "Of --rough: one condition alone");
  app.add_option("--count", options.count, "Of --rough and --laws: recordings of each condition or law")
      ->capture_default_str();
  app.add_option("--jobs", options.jobs, "Recordings at once")->capture_default_str();
  app.add_option("--most-seconds", options.most_seconds, "For one recording; more is a failure")->capture_default_str();
  app.add_flag("--list", options.list, "Name the recordings and end");
  app.add_option("--out", options.out, "JSON with everything");
  app.add_flag("--models", options.compare_models, "In --out: the evidence for each model that was compared");
  app.add_option("--golden", options.golden, "FILE.json and FILE.txt to be kept, as tests/golden/confusion");
  app.add_option("--against", options.against, "Golden copy: status 1 where less is right than there");
  app.add_option("--results", options.results, "Folder for the outcomes of one shard, which goes on where it was");
  app.add_option("--shard", options.shard, "i/n (default: as the cluster's engine says), with --results");
  app.add_flag("--merge", options.merge, "The table of all shards in --results");
  try {
    app.parse(argc, argv);
    if (options.results.empty() && (options.merge || !options.shard.empty())) {
      throw CLI::ValidationError("--results", "expected the folder of the shards");
    }
    options.rough = rough->count() > 0;
    options.laws = laws->count() > 0;
    return main_of(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "rigtwin_confusion: %s\n", problem.what());
    return 5;
  }
}
