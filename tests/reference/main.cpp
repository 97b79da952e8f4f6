// development driver
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "firmware/recording/recording_csv.hpp"
#include "tests/reference/diagnose.hpp"
#include "tests/truth/truth.hpp"

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string id = argv[i];
    const truth::Truth truth = truth::draw(id.substr(0, id.rfind(':')), std::strtoull(id.substr(id.rfind(':') + 1).c_str(), nullptr, 10));
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
    std::set<std::string> hidden, found;
    for (const auto& e : truth.effects) hidden.insert(e.name + (e.channel.empty() ? "" : " of " + e.channel));
    for (const auto& f : v.causes) if (f.confidence > 0.5) found.insert(reference::words(f.cause));
    std::printf("  %s\n", hidden == found ? "RIGHT" : "WRONG");
    for (const auto& f : v.causes) {
      std::printf("   %s [%.3f]", reference::words(f.cause).c_str(), f.confidence);
      for (double x : f.cause.values) std::printf(" %.4g", x);
    }
    std::printf("\n   unexplained %.3f, %.1f s\n", v.unexplained, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::fflush(stdout);
  }
}
