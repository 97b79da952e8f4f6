// development driver
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "firmware/recording/recording_csv.hpp"
#include "tests/reference/diagnose.hpp"
#include "tests/truth/truth.hpp"

int main(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) {
    const truth::Truth truth = truth::draw(argv[i], std::strtoull(argv[1], nullptr, 10));
    const auto description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
    std::vector<firmware::Recording> records;
    for (const truth::Record& record : truth::simulate(truth))
      records.push_back(firmware::parse_recording_csv(truth::csv(truth, record), "rec.csv", description.channels, description.sample_rate));
    std::printf("%s: ", truth.id.c_str());
    for (const auto& e : truth.effects) {
      std::printf("%s %s", e.name.c_str(), e.channel.c_str());
      for (const auto& [k, v] : e.parameters) std::printf(" %s=%.4g", k.c_str(), v);
    }
    std::printf("  (size %.3g, %zu rec)\n", truth.size, records.size());
    const auto begin = std::chrono::steady_clock::now();
    const auto v = reference::diagnose(description, records);
    for (const auto& f : v.causes) {
      std::printf("   %s [%.3f]", reference::words(f.cause).c_str(), f.confidence);
      for (double x : f.cause.values) std::printf(" %.4g", x);
    }
    std::printf("\n   unexplained %.3f, %.1f s\n", v.unexplained, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::fflush(stdout);
  }
}
