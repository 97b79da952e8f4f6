#include "host_sim/paper_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "host_sim/input_error.hpp"
#include "host_sim/output_file.hpp"
#include "host_sim/paper/paper_report.hpp"
#include "host_sim/progress.hpp"

namespace host_sim {
namespace {

/// The folder is there and may be written, before seconds are spent on what goes into it.
void prepare(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const std::string name = folder.string();
  if (folder.empty()) throw OutputError("''", "is no name", "a folder for the results");
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw OutputError(name, "is a file", "a folder for the results, or a name that is free");
  }
  fs::create_directories(folder, error);
  if (error) throw OutputError(name, "cannot be made: " + error.message(), "a folder that may be made and written");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw OutputError(name, std::string("cannot be written: ") + std::strerror(errno), "a folder that may be written");
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
  write_file(options.out / "report.html", paper::paper_report(experiments, statements).html());
  write_file(options.out / "paper.json", paper::paper_json(experiments, statements));

  for (const paper::Statement& s : statements) {
    std::printf("%-14s %s\n%14s %s\n", s.agrees ? "agrees" : "does not agree", s.paper.c_str(), "", s.finding.c_str());
  }
  for (const paper::KickedRun& run : experiments.kicks) {
    std::printf("%-14s %s: the kicked nonlinear loop %s\n", "in time", run.name.c_str(), paper::in_words(run).c_str());
  }
  std::printf("report    %s\n", (options.out / "report.html").c_str());
}

void add_paper(CLI::App& app, PaperOptions& options) {
  CLI::App* command = app.add_subcommand("paper", "Reproduce the paper's figures from the rigs it comes with");
  command->add_option("--out", options.out, "Folder for report.html and paper.json")->required();
  command->callback([&options] { reproduce_paper(options); });
}

}  // namespace host_sim
