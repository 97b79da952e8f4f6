// rigtwin_manual: runs the manual's commands and writes the page. Not installed: the page is.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/manual/manual.hpp"
#include "host_sim/report/report.hpp"

namespace {

namespace fs = std::filesystem;
using namespace host_sim::manual;

constexpr const char* measured_record = "emps_1.csv";  // of the tour

struct Arguments {
  fs::path chapters, rigs, programs, measured, out, script;
};

/// Chapters by name: 1_tour.md, 2_….
std::vector<fs::path> chapter_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  }
  if (files.empty()) throw firmware::InputError(folder.string(), 0, "holds no chapter", "the chapters of the manual");
  std::sort(files.begin(), files.end());
  return files;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Chapters and measured data by name and hash: where they lie is of no use to a reader.
host_sim::report::Origin origin_of(const std::vector<fs::path>& files) {
  host_sim::report::Origin origin{"cmake --build build/host --target manual"};
  for (const fs::path& file : files) {
    origin.inputs.push_back({file.filename().string(), firmware::sha256(bytes_of(file))});
  }
  return origin;
}

void write_manual(const Arguments& arguments) {
  std::set<std::string> known{"controller"};
  std::error_code error;
  if (!fs::exists(arguments.programs / "rig_controller", error)) known.clear();
  const fs::path measured = arguments.measured.empty() ? fs::path() : fs::absolute(arguments.measured);
  const bool real = !measured.empty() && fs::exists(measured / measured_record, error);
  const std::vector<fs::path> files = chapter_files(arguments.chapters);
  // The script of the package: whoever has it has no measured data.
  const std::string script = as_script(read_chapter(files.front(), {"controller"}));
  if (real) known.insert("measured");
  std::vector<Chapter> chapters;
  for (const fs::path& file : files) chapters.push_back(read_chapter(file, known));

  Workshop workshop(
      {arguments.programs, {"RIGS=" + fs::absolute(arguments.rigs).string(), "MEASURED=" + measured.string()}});
  const Manual manual = make_manual(chapters, workshop, effect_pictures(arguments.rigs));
  firmware::OutputFile page(arguments.out);
  std::vector<fs::path> inputs = files;
  if (real) inputs.push_back(measured / measured_record);
  page.write(host_sim::report::with_origin(manual.html, origin_of(inputs)));
  page.commit();
  if (!arguments.script.empty()) firmware::write_file(arguments.script, script);
  std::printf("%s: %zu chapters, %zu blocks of commands, on %s data, %.1f MB\n", arguments.out.c_str(), chapters.size(),
              manual.executed.size(), real ? "measured" : "simulated", 1e-6 * static_cast<double>(manual.html.size()));
}

int fail(firmware::ExitStatus status, std::string_view message) {
  std::fprintf(stderr, "rigtwin_manual: %s\n", firmware::one_line(message).c_str());
  return static_cast<int>(status);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes the manual of rigtwin", "rigtwin_manual");
  Arguments arguments;
  app.add_option("--chapters", arguments.chapters, "Folder of the chapters (*.md)")->required();
  app.add_option("--rigs", arguments.rigs, "Folder of the shipped rig descriptions")->required();
  app.add_option("--programs", arguments.programs, "Folder of rigtwin and rig_controller")->required();
  app.add_option("--measured", arguments.measured, "Folder of measured recordings; without it they are simulated");
  app.add_option("--script", arguments.script, "Write the commands of the first chapter as a script, too");
  app.add_option("--out", arguments.out, "Page to write (HTML)")->required();
  try {
    app.parse(argc, argv);
    write_manual(arguments);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(firmware::ExitStatus::wrong_usage);
  } catch (const firmware::InputError& error) {
    return fail(firmware::ExitStatus::unfit_input, error.what());
  } catch (const firmware::OutputError& error) {
    return fail(firmware::ExitStatus::cannot_write, error.what());
  } catch (const std::exception& error) {
    return fail(firmware::ExitStatus::internal, error.what());
  }
}
