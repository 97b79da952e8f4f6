// rigtwin_rths -- the criteria J1 … J9 of the benchmark problem, for all methods, cases and earthquakes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "tests/bench/rths/methods.hpp"

namespace {

constexpr double force_limit = 8900.0;  ///< of the actuator [N]
constexpr std::uint64_t perturbed_plants = 8;
constexpr std::size_t perturbed_case = 3;  ///< the fourth
constexpr const char* head = "     J1 [ms]   J2 [%]   J3 [%]   J4 [%]   J5 [%]   J6 [%]   J7 [%]   J8 [%]   J9 [%]";

void print(const std::string& name, const rths::Criteria& criteria) {
  std::printf("  %-27s", name.c_str());
  if (!criteria.stable) {
    std::printf("  unstable\n");
    return;
  }
  for (const double value : criteria.values) std::printf(value < 1e4 ? " %8.3f" : " %8.2g", value);
  if (criteria.largest_force > force_limit)
    std::printf("  force %.0f N, limit %.0f N", criteria.largest_force, force_limit);
  std::printf("\n");
}

nlohmann::json json_of(const rths::Criteria& criteria) {
  nlohmann::json result;
  for (std::size_t i = 0; i < criteria.values.size(); ++i) {
    auto& value = result["J" + std::to_string(i + 1)];
    if (criteria.stable) value = criteria.values[i];
  }
  result["stable"] = criteria.stable;
  if (criteria.stable) result["largest_force"] = criteria.largest_force;
  if (criteria.stable) result["added_force_rms"] = criteria.noise_force;
  return result;
}

nlohmann::json all_cases(const std::string& name, const rths::Excitation& excitation, std::uint64_t seed) {
  nlohmann::json result;
  for (std::size_t c = 0; c < rths::cases.size(); ++c) {
    std::printf("%s, case %zu\n%29s%s\n", name.c_str(), c + 1, "", head);
    for (const rths::Method& method : rths::methods()) {
      const auto criteria = rths::run(excitation, {.structure = c, .seed = seed}, method);
      print(method.name, criteria);
      result[std::to_string(c + 1)][method.name] = json_of(criteria);
    }
  }
  return result;
}

nlohmann::json perturbed(const rths::Excitation& excitation, std::uint64_t seed) {
  nlohmann::json result;
  std::printf("elcentro, case %zu, %d perturbed plants: J2 [%%]\n  %-27s     mean    worst\n", perturbed_case + 1,
              static_cast<int>(perturbed_plants), "");
  for (const rths::Method& method : rths::methods()) {
    auto& entry = result[method.name];
    double sum = 0.0, worst = 0.0;
    bool stable = true;
    for (std::uint64_t plant = 1; plant <= perturbed_plants; ++plant) {
      const auto criteria =
          rths::run(excitation, {.structure = perturbed_case, .plant = rths::perturbed(plant), .seed = seed}, method);
      entry["plants"].push_back(json_of(criteria));
      sum += criteria.values[1];
      worst = std::max(worst, criteria.values[1]);
      stable = stable && criteria.stable;
      if (!criteria.stable) break;
    }
    entry["stable"] = stable;
    if (!stable) {
      std::printf("  %-27s  unstable\n", method.name.c_str());
      continue;
    }
    entry["J2_mean"] = sum / static_cast<double>(perturbed_plants);
    entry["J2_worst"] = worst;
    std::printf("  %-27s %8.3f %8.3f\n", method.name.c_str(), sum / static_cast<double>(perturbed_plants), worst);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The RTHS benchmark problem (Silva et al. 2020) with the compensators of the control loop.");
  std::filesystem::path folder = std::filesystem::path(RIGTWIN_SOURCE_DIR) / ".." / "shared" / "rths", json_file;
  std::uint64_t seed = 1;
  app.add_option("--excitation", folder, "folder with elcentro.csv and kobe.csv")->capture_default_str();
  app.add_option("--json", json_file, "the criteria as JSON");
  app.add_option("--seed", seed, "of the sensors' noise")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    nlohmann::json result;
    const auto elcentro = rths::read_excitation(folder / "elcentro.csv");
    const auto kobe = rths::read_excitation(folder / "kobe.csv");
    result["elcentro"] = all_cases("elcentro", elcentro, seed);
    result["kobe"] = all_cases("kobe", kobe, seed);
    result["perturbed"] = perturbed(elcentro, seed);
    if (!json_file.empty()) firmware::write_file(json_file, result.dump(1) + "\n");
  } catch (const firmware::OutputError& error) {
    std::fprintf(stderr, "rigtwin_rths: %s\n", error.what());
    return 4;
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "rigtwin_rths: %s\n", error.what());
    return 3;
  }
  return 0;
}
