#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/truth/truth.hpp"

/// rigtwin_truth GROUP SEED OUTDIR [--varied] [--weak] [--duration SECONDS] | --groups
/// rigtwin_truth --rough CONDITION SEED OUTDIR | --conditions
int main(int argc, char** argv) {
  try {
    if (argc == 2 && std::string(argv[1]) == "--groups") {
      for (const std::string& group : truth::groups()) std::puts(group.c_str());
      return 0;
    }
    if (argc == 2 && std::string(argv[1]) == "--conditions") {
      for (const std::string& condition : truth::conditions()) std::puts(condition.c_str());
      return 0;
    }
    if (argc < 4 || (argc < 5 && std::string(argv[1]) == "--rough")) {
      std::fputs(
          "rigtwin_truth GROUP SEED OUTDIR [--varied] [--weak] [--duration SECONDS] | rigtwin_truth --groups\n"
          "rigtwin_truth --rough CONDITION SEED OUTDIR | rigtwin_truth --conditions\n",
          stderr);
      return 2;
    }
    truth::Wanted wanted;
    for (int i = 4; i < argc; ++i) {
      const std::string option = argv[i];
      if (option == "--varied") wanted.varied = true;
      if (option == "--weak") wanted.weak = true;
      if (option == "--duration" && i + 1 < argc) wanted.duration = std::stod(argv[++i]);
    }
    const bool rough = std::string(argv[1]) == "--rough";
    const std::string group = argv[rough ? 2 : 1];
    const std::uint64_t seed = std::stoull(argv[rough ? 3 : 2]);
    const truth::Truth drawn = rough ? truth::draw_rough(group, seed) : truth::draw(group, seed, wanted);
    const std::filesystem::path folder(argv[rough ? 4 : 3]);
    if (folder.string().starts_with("-")) throw std::invalid_argument("OUTDIR is missing before " + folder.string());
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "rig.toml") << truth::rig_toml(drawn);
    std::ofstream(folder / "truth.json") << truth::truth_json(drawn);
    int number = 0;
    for (const truth::Record& record : truth::simulate(drawn))
      std::ofstream(folder / ("rec" + std::to_string(++number) + ".csv")) << truth::csv(drawn, record);
    return 0;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "rigtwin_truth: %s\n", problem.what());
    return 2;
  }
}
