#include "host_sim/commands/paper_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/paper/paper_report.hpp"

namespace host_sim {
namespace {

/// Creates the folder and checks that it can be written, before the computation starts.
void prepare(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const std::string name = folder.string();
  if (folder.empty()) throw firmware::OutputError("''", "is an empty name", "a folder for the results");
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw firmware::OutputError(name, "is a file", "a folder for the results, or the name of a new one");
  }
  fs::create_directories(folder, error);
  if (error)
    throw firmware::OutputError(name, "cannot be created: " + error.message(),
                                "a folder that can be created and written");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw firmware::OutputError(name, std::string("cannot be written: ") + std::strerror(errno),
                                "a folder that can be written");
  }
}

}  // namespace

void reproduce_paper(const PaperOptions& options) {
  prepare(options.out);
  paper::Experiments experiments;
  {
    Progress progress("paper");
    experiments = paper::experiment([&progress](double share) { progress.show(share); });
  }
  const std::vector<paper::Statement> statements = paper::statements(experiments);
  const nlohmann::ordered_json json = paper::paper_json(experiments, statements);
  firmware::write_file(options.out / "report.html", with_how_made(paper::paper_report(experiments, statements).html()));
  firmware::write_file(options.out / "paper.json", json_text(json));
  if (write_json(options.json, json)) return;

  for (const paper::Statement& s : statements) {
    std::printf("%-14s %s\n%14s %s\n", s.agrees ? "agrees" : "does not agree", s.paper.c_str(), "", s.finding.c_str());
  }
  for (const paper::KickedRun& run : experiments.kicks) {
    std::printf("%-14s %s: after a kick the nonlinear loop %s\n", "simulation", run.name.c_str(),
                paper::in_words(run).c_str());
  }
  std::printf("report    %s\n", (options.out / "report.html").c_str());
}

void add_paper(CLI::App& app, PaperOptions& options) {
  CLI::App* command = app.add_subcommand("paper", "Reproduce the paper's figures from the shipped rigs");
  command->add_option("--out", options.out, "Folder for report.html and paper.json")->required();
  add_json_option(*command, options.json, "paper.json here, too,");
  command->callback([&options] { reproduce_paper(options); });
}

}  // namespace host_sim
