#include "host_sim/transfer/posterior/component_part.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/identification/common/wording.hpp"

namespace host_sim::transfer {

using identification::FreeParameter;
using Rig = model::RigParameters<double>;

namespace {

constexpr std::string_view damping = "suspension.damping";

std::string effect_key(const firmware::PlacedEffect& effect) { return "effects." + std::string(effect.entry->name); }

bool differ(double a, double b) { return std::abs(a - b) > 1e-9 * std::max(std::abs(a), std::abs(b)); }

/// An InputError at the key of the second description.
[[noreturn]] void refuse(const firmware::RigDescription& to, const std::string& key, const std::string& what,
                         const firmware::RigDescription& from) {
  throw firmware::InputError(to.source, to.line_of(key), what, "the component of " + from.source);
}

void check_numbers(const firmware::RigDescription& from, const firmware::RigDescription& to,
                   std::vector<std::string>& remarks) {
  Rig first = from.rig, second = to.rig;
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    const std::string path = std::string(p.table) + "." + std::string(p.key);
    if (!travels(path)) continue;
    const double *const a = firmware::find_parameter(first, path), *const b = firmware::find_parameter(second, path);
    if (a == nullptr || b == nullptr || !differ(*a, *b)) continue;
    if (path == damping && *b > *a) {
      const bool virtual_one =
          from.rig.kind == model::RigKind::hil && !differ(*b - *a, from.rig.machine.virtual_damping);
      remarks.push_back(firmware::shortest(*b - *a) + " N s/m of suspension.damping belong to the second rig" +
                        (virtual_one ? ", the virtual damping of the first" : " alone"));
      continue;
    }
    refuse(to, path, path + " is " + firmware::shortest(*b) + ", not " + firmware::shortest(*a), from);
  }
}

std::vector<firmware::PlacedEffect> component_effects(const Rig& rig) {
  std::vector<firmware::PlacedEffect> list = firmware::effects_of(rig);
  std::erase_if(list, [](const firmware::PlacedEffect& e) { return !travels(*e.entry); });
  return list;
}

void check_effects(const firmware::RigDescription& from, const firmware::RigDescription& to) {
  const auto first = component_effects(from.rig), second = component_effects(to.rig);
  for (const auto& effect : first) {
    const auto same =
        std::find_if(second.begin(), second.end(), [&](const auto& e) { return e.entry == effect.entry; });
    if (same == second.end()) refuse(to, "effects", effect_key(effect) + " is missing", from);
    for (std::size_t i = 0; i < effect.values.size(); ++i) {
      if (!differ(effect.values[i], same->values[i])) continue;
      refuse(to, firmware::effect_path(*same, i),
             firmware::effect_path(*same, i) + " is " + firmware::shortest(same->values[i]) + ", not " +
                 firmware::shortest(effect.values[i]),
             from);
    }
  }
  for (const auto& effect : second) {
    if (std::none_of(first.begin(), first.end(), [&](const auto& e) { return e.entry == effect.entry; })) {
      refuse(to, effect_key(effect), effect_key(effect) + " is described here only", from);
    }
  }
}

/// The text of a law's table says all of it.
void check_laws(const firmware::RigDescription& from, const firmware::RigDescription& to) {
  const auto of_component = [](const firmware::RigDescription& d) {
    std::vector<std::pair<std::string, std::string>> list;
    for (const firmware::LawDescription& law : d.laws) {
      std::string text, place;
      for (const auto& [key, value] : firmware::law_lines(law, d.rig)) {
        if (key == "place") place = value;
        if (key != "file") text.append(key).append(" = ").append(value).append("\n");
      }
      if (place == "\"suspension\"" || place == "\"piston\"") list.emplace_back(law.name, text);
    }
    return list;
  };
  const auto first = of_component(from), second = of_component(to);
  for (const auto& law : first) {
    if (std::find(second.begin(), second.end(), law) == second.end()) {
      refuse(to, "laws." + law.first, "laws." + law.first + " is missing or another law", from);
    }
  }
  for (const auto& law : second) {
    if (std::find(first.begin(), first.end(), law) == first.end()) {
      refuse(to, "laws." + law.first, "laws." + law.first + " is described here only", from);
    }
  }
}

}  // namespace

bool travels(const firmware::CatalogueEntry& effect) {
  return effect.subsystem == model::Subsystem::suspension || effect.subsystem == model::Subsystem::fdva;
}

bool travels(std::string_view path) {
  if (path.starts_with("suspension.") || path.starts_with("fdva.")) return true;
  if (!path.starts_with("effects.")) return false;
  const std::string_view name = path.substr(8, path.find('.', 8) - 8);
  const firmware::CatalogueEntry* const entry = firmware::find_effect(name);
  return entry != nullptr && travels(*entry);
}

bool travels(const FreeParameter& parameter, const identification::Hypothesis& learned) {
  if (parameter.role == FreeParameter::Role::law) {
    return learned.laws[parameter.law].place == identification::CurvePlace::suspension;
  }
  const bool of_rig = parameter.role == FreeParameter::Role::tolerated || parameter.role == FreeParameter::Role::effect;
  return of_rig && travels(parameter.path);
}

std::vector<std::string> check_same_component(const firmware::RigDescription& from,
                                              const firmware::RigDescription& to) {
  std::vector<std::string> remarks;
  if (from.rig.has_fdva != to.rig.has_fdva) {
    refuse(to, "fdva", from.rig.has_fdva ? "the table [fdva] is missing" : "there is a table [fdva]", from);
  }
  check_numbers(from, to, remarks);
  if (from.rig.has_fdva && from.rig.fdva.ducts != to.rig.fdva.ducts) {
    refuse(to, "fdva.ducts", "fdva.ducts is " + std::to_string(to.rig.fdva.ducts), from);
  }
  if (from.rig.has_fdva && from.rig.fdva.open_ducts != to.rig.fdva.open_ducts) {
    remarks.push_back("the second rig has " + std::to_string(to.rig.fdva.open_ducts) + " ducts open, the first " +
                      std::to_string(from.rig.fdva.open_ducts) + ": a setting that was not recorded");
  }
  check_effects(from, to);
  check_laws(from, to);
  return remarks;
}

Rig with_component(const Rig& to, const Rig& from, const identification::Hypothesis& learned) {
  Rig rig = to, described = from, found = learned.rig;
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    const std::string path = std::string(p.table) + "." + std::string(p.key);
    if (!travels(path)) continue;
    const double* const value = firmware::find_parameter(found, path);
    const double* const nominal = firmware::find_parameter(described, path);
    double* const target = firmware::find_parameter(rig, path);
    if (value == nullptr || nominal == nullptr || target == nullptr) continue;
    *target = path == damping ? *target + *value - *nominal : *value;
  }
  for (const firmware::PlacedEffect& effect : component_effects(found)) firmware::put_effect(rig, effect);
  std::vector<identification::PlacedLaw> laws;
  std::size_t curves = rig.laws.curve_count, branches = rig.laws.branch_count;
  for (const identification::PlacedLaw& law : learned.laws) {
    if (law.place != identification::CurvePlace::suspension) continue;
    laws.push_back(law);
    const bool memory = identification::has_memory(law.family);
    laws.back().slot = memory ? branches : curves;
    if (memory) {
      branches += identification::branches_of(law).size();
    } else {
      ++curves;
    }
  }
  identification::put_laws(laws, rig);
  return rig;
}

}  // namespace host_sim::transfer
