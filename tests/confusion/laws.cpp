#include "tests/confusion/laws.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "tests/confusion/table.hpp"
#include "tests/confusion/text.hpp"

namespace confusion {
namespace {

using host_sim::identification::DescribedLaw;
using host_sim::identification::Diagnosis;

constexpr double sure_of_law = 0.5;
/// [1] Ratio to the noise floor on held-out data that is wanted of laws without and with memory.
constexpr double most_over_floor = 1.2, most_with_memory = 1.5;
constexpr double exponent_tolerance = 0.05;

/// A law of the generator: every name that is right for it, of shapes, effects and faults of the recording.
struct Known {
  std::string_view law;
  bool memory;
  std::vector<std::string_view> names;
};

/// LuGre's bristles are Bouc–Wen's loop with a limit that falls: hysteresis by either name. A fractional derivative
/// lies between spring and damper: relaxation over many times. Rubber does both.
const std::vector<Known>& known_laws() {
  static const std::vector<Known> all{
      {"power_law_low", false, {"power law"}},
      {"power_law_high", false, {"power law"}},
      {"cubic_damping", false, {"power law"}},
      {"smooth_friction", false, {"smooth friction"}},
      {"stribeck_friction", false, {"stribeck", "stribeck_friction"}},
      {"lugre_friction", true, {"hysteresis", "bouc_wen", "stribeck", "stribeck_friction"}},
      {"asymmetric_damper", false, {"asymmetric", "asymmetric_damper"}},
      {"lopsided_spring", false, {"asymmetric power law"}},
      {"blow_off", false, {"degressive"}},
      {"degressive_damper", false, {"degressive", "power law"}},
      {"leaf_friction", false, {"follows the load"}},
      {"stroke_damping", false, {"along the stroke"}},
      {"bypass_damper", false, {"surface"}},
      {"fading_damping", false, {"drift"}},
      {"hysteresis", true, {"hysteresis", "bouc_wen"}},
      {"iwan", true, {"hysteresis"}},
      {"fractional_damping", true, {"relaxation"}},
      {"payne_rubber", true, {"hysteresis", "relaxation"}},
  };
  return all;
}

std::string law_of(const Asked& asked) {
  return asked.what() == "law" ? asked.group.substr(asked.group.rfind(':') + 1) : std::string();
}

const Known* known(const Asked& asked) {
  const std::string law = law_of(asked);
  const auto it = std::find_if(known_laws().begin(), known_laws().end(), [&](const Known& k) { return k.law == law; });
  return it == known_laws().end() ? nullptr : &*it;
}

bool is_one_of(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

struct LawLine {
  Share shape, floor, exponent, wrong;
  std::vector<double> ratios;
  double processor = 0.0;

  void add(const Outcome& o) {
    const Known* law = known(o.asked);
    if (law != nullptr) {
      shape.add(o.shape_right);
      floor.add(o.failure.empty() && o.gap <= (law->memory ? most_with_memory : most_over_floor));
      if (std::isfinite(o.exponent_error)) exponent.add(o.exponent_error <= exponent_tolerance);
      ratios.push_back(o.gap);
    }
    wrong.add(o.wrong_law);
    processor += o.processor;
  }
};

std::string law_line(const std::string& name, LawLine line) {
  std::sort(line.ratios.begin(), line.ratios.end());
  const std::string median =
      line.ratios.empty() ? std::string("    –") : written("%6.2f", line.ratios[line.ratios.size() / 2]);
  return written("%-18s", name.c_str()) + per_cent(line.shape) + "  " + per_cent(line.floor) + " " + median + "  " +
         per_cent(line.exponent) + "  " + per_cent(line.wrong) + written("  %7.1f\n", line.processor);
}

}  // namespace

std::vector<Asked> laws_plan(std::uint64_t seed, std::size_t count) {
  std::vector<Asked> all;
  const std::vector<std::string> kinds{"quarter_car", "hil", "component_bench"};
  for (const Known& law : known_laws()) {
    for (const std::string& kind : kinds)
      for (std::size_t k = 0; k < count; ++k)
        all.push_back({"law:" + kind + ":" + std::string(law.law), 100 * seed + k});
  }
  for (const std::string& kind : kinds) {
    for (std::size_t k = 0; k < count; ++k) all.push_back({"none:" + kind, 100 * seed + k});
    for (const char* effect : {"coulomb_friction", "viscous_damping", "quadratic_damping", "progressive_spring",
                               "bump_stop", "backlash", "top_mount", "relaxation", "position_ripple"})
      all.push_back({"single:" + kind + ":" + effect, 100 * seed});
  }
  return all;
}

void judge_law(Outcome& o, const truth::Truth& truth, const Diagnosis& diagnosis) {
  const Known* law = known(o.asked);
  if (law == nullptr) {
    o.wrong_law = !diagnosis.laws.empty();
    return;
  }
  bool other = false;  // a sure name that is not right
  for (const DescribedLaw& said : diagnosis.laws) {
    const bool right = is_one_of(law->names, said.shape);
    o.shape_right = o.shape_right || right;
    other = other || (!right && said.confidence > sure_of_law);
    for (const auto& number : said.numbers) {
      if (!right || number.name != "exponent") continue;
      if (const auto it = truth.unknown_parameters.find("exponent"); it != truth.unknown_parameters.end())
        o.exponent_error = std::abs(number.value - it->second);
      else if (law->law == "cubic_damping")
        o.exponent_error = std::abs(number.value - 3.0);
    }
  }
  for (const auto& named : diagnosis.effects) {
    const bool dry = law->law == "smooth_friction" && named.effect.entry->name == "coulomb_friction";
    const bool right = is_one_of(law->names, named.effect.entry->name) || (dry && o.gap <= most_over_floor);
    o.shape_right = o.shape_right || right;
    // Dry friction stands beside a law that falls from it or creeps into it.
    const bool part = named.effect.entry->name == "coulomb_friction" && o.shape_right;
    other = other || (!right && !part && named.confidence > sure_of_law);
  }
  for (const auto& fault : diagnosis.recording_faults)
    o.shape_right = o.shape_right || is_one_of(law->names, fault.name);
  o.wrong_law = other;
  o.shape_right = o.shape_right && !other;
}

std::string laws_text(const std::vector<Outcome>& outcomes) {
  std::map<std::string, LawLine> lines;
  LawLine memoryless, memory, nothing;
  for (const Outcome& o : outcomes) {
    const Known* law = known(o.asked);
    if (law != nullptr) lines[law_of(o.asked)].add(o);
    (law == nullptr ? nothing : law->memory ? memory : memoryless).add(o);
  }
  std::string out = "law                 recognised  at the floor median     exponent   wrong name     CPU s\n";
  for (const Known& law : known_laws())
    if (const auto it = lines.find(std::string(law.law)); it != lines.end()) out += law_line(it->first, it->second);
  out += law_line("without memory", memoryless) + law_line("with memory", memory) + law_line("no law", nothing);
  out += "\nerror of F on held-out data [%]: described, refitted, catalogue alone, with law, black box, noise\n";
  for (const Outcome& o : outcomes) {
    if (o.errors_of_force.empty()) continue;
    out += written("%-18s", law_of(o.asked).c_str());
    for (const char* of : {"described", "refitted", "catalogue", "law", "black box", "noise"})
      out += written(" %8.2f", 100.0 * o.errors_of_force.at(of));
    out += "\n";
  }
  bool first = true;
  for (const Outcome& o : outcomes) {
    const Known* law = known(o.asked);
    const bool fine = law == nullptr ? !o.wrong_law
                                     : o.shape_right && o.gap <= (law->memory ? most_with_memory : most_over_floor) &&
                                           !(o.exponent_error > exponent_tolerance);
    if (o.failure.empty() && fine) continue;
    if (first) out += "\nnot recognised, or above the floor\n";
    first = false;
    out += "  " + o.asked.id() + ": ";
    out += o.failure.empty() ? o.verdict + (o.unexplained ? ", rest" : "") + "; found " + o.found : o.failure;
    out += "; hidden " + o.hidden;
    for (const auto& [key, value] : o.law_numbers) out += " " + key + written("=%.4g", value);
    out += written("; floor × %.3g in %s, %.1f s\n", o.gap, o.gap_channel.c_str(), o.processor);
  }
  return out;
}

}  // namespace confusion
