#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/truth/truth.hpp"

/// rigtwin_truth GROUP SEED OUTDIR [--varied] [--weak] [--duration SECONDS] | --groups
int main(int argc, char** argv) {
  try {
    if (argc == 2 && std::string(argv[1]) == "--groups") {
      for (const std::string& group : truth::groups()) std::puts(group.c_str());
      return 0;
    }
    if (argc < 4) {
      std::fputs("rigtwin_truth GROUP SEED OUTDIR [--varied] [--weak] [--duration SECONDS] | rigtwin_truth --groups\n",
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
    const truth::Truth drawn = truth::draw(argv[1], std::stoull(argv[2]), wanted);
    const std::filesystem::path folder(argv[3]);
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
