// The plan of a sweep: a TOML file, and the cases that it stands for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/sweep/result_file.hpp"

namespace host_sim::sweep {

using Setting = std::variant<double, std::string>;  ///< a number, or the text of a road

/// [vary]: a name with all its values.
struct Factor {
  std::string name;  ///< "road", "speed", "open_ducts" or a parameter path
  std::vector<Setting> values;
};

/// [draw]: a name with the distribution that each case draws from.
struct Draw {
  std::string name;
  bool normal = false;  ///< a, b: mean and standard deviation; else the ends of a uniform distribution
  double a = 0.0, b = 0.0;
};

/// A sweep: the combinations of all factors, each `repeats` times.
///
///   (1)  id = point · repeats + repeat;  the last factor of the plan varies fastest
///   (2)  seed of a case = output number id of the SplitMix64 generator that starts at the base seed
///
/// A case is a function of (plan, id): who computes it changes nothing.
/// SplitMix64: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014.
struct SweepPlan {
  std::filesystem::path rig_file;
  firmware::RigDescription rig;
  std::uint64_t seed = 1;
  std::uint64_t repeats = 1;
  std::string road = "iso8608:B";
  double speed = 27.78;    ///< [m/s]
  double duration = 60.0;  ///< [s]
  bool noise = true;       ///< of the sensors
  std::vector<Factor> factors;
  std::vector<Draw> draws;
  CaseSet cases;
};

/// At most so many cases: ids stay exact in every JSON reader below 2⁵³, and a bit for each is kept in memory (125 MB).
inline constexpr std::uint64_t most_cases = 1'000'000'000;

/// One case.
struct RigCase {
  std::uint64_t id = 0;
  std::uint64_t seed = 0;                                 ///< of road, noise and draws
  std::vector<std::pair<std::string, Setting>> settings;  ///< of factors and draws, in the order of the plan
  firmware::RigDescription rig;
  std::string road;
  double speed = 0.0;
};

/// Reads and checks a plan; the rig description and roads are beside it. InputError with the line for every error.
[[nodiscard]] SweepPlan read_plan(const std::filesystem::path& file);
[[nodiscard]] SweepPlan parse_plan(std::string_view text, std::string_view source);

[[nodiscard]] std::uint64_t seed_of_case(std::uint64_t base, std::uint64_t id);  ///< (2)

/// Case `id` of a plan.
[[nodiscard]] RigCase case_of(const SweepPlan& plan, std::uint64_t id);

}  // namespace host_sim::sweep
