#include "firmware/description/laws/law_description.hpp"

#include <algorithm>

#include "firmware/description/text/number_text.hpp"

namespace firmware {
namespace {

using model::LawOver;
using model::LawPlace;
using Rig = model::RigParameters<double>;

std::string toml_real(double value) {
  std::string text = shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

template <class Numbers>
std::string list_of(const Numbers& numbers, std::size_t count) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + toml_real(numbers[i]);
  return text + "]";
}

std::string in_toml_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }

}  // namespace

std::vector<std::pair<std::string, std::string>> law_lines(const LawDescription& law, const Rig& rig) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto place = [&](LawPlace p, model::Channel channel = {}) {
    if (!lines.empty()) return;
    lines.emplace_back("place", in_toml_quotes(p == LawPlace::sensor ? "sensor " + std::string(model::name(channel))
                                                                     : std::string(model::name(p))));
  };
  if (law.curve != LawDescription::none) {
    const auto& curve = rig.laws.curves[law.curve];
    place(curve.place, curve.channel);
    if (curve.place != LawPlace::sensor) {
      lines.emplace_back("over", in_toml_quotes(curve.over == LawOver::velocity ? "velocity" : "deflection"));
    }
    lines.emplace_back("at", list_of(curve.at, curve.count));
    lines.emplace_back("value", list_of(curve.value, curve.count));
    if (curve.behind > 0.0) lines.emplace_back("behind", toml_real(curve.behind));
  }
  if (law.surface != LawDescription::none) {
    const auto& surface = rig.laws.surfaces[law.surface];
    place(surface.place);
    lines.emplace_back("over", "[\"deflection\", \"velocity\"]");
    lines.emplace_back("at", list_of(surface.deflection, surface.rows));
    lines.emplace_back("at_2", list_of(surface.velocity, surface.columns));
    std::string rows;
    for (std::size_t i = 0; i < surface.rows; ++i) {
      rows += (i == 0 ? "" : ", ") + list_of(surface.value[i], surface.columns);
    }
    lines.emplace_back("value", "[" + rows + "]");
  }
  std::string branches;
  for (std::size_t i = law.first_branch; i < law.first_branch + law.branches; ++i) {
    const auto& branch = rig.laws.branches[i];
    place(branch.place);
    branches += std::string(branches.empty() ? "" : ", ") + "{ stiffness = " + toml_real(branch.stiffness) +
                (branch.time_constant > 0.0 ? ", time_constant = " + toml_real(branch.time_constant)
                                            : ", slip_force = " + toml_real(branch.slip_force)) +
                (branch.gap > 0.0 ? ", gap = " + toml_real(branch.gap) : "") + " }";
  }
  if (!branches.empty()) lines.emplace_back("branches", "[" + branches + "]");
  if (law.feeds_energy) lines.emplace_back("feeds_energy", "true");
  return lines;
}

std::vector<LawDescription> named_laws(const std::vector<LawDescription>& laws, const Rig& rig) {
  std::vector<LawDescription> all = laws;
  const auto has = [&](const auto& holds) { return std::any_of(all.begin(), all.end(), holds); };
  const auto next_name = [&] {
    for (std::size_t n = 1;; ++n) {
      std::string name = "law_" + std::to_string(n);
      if (!has([&](const LawDescription& law) { return law.name == name; })) return name;
    }
  };
  const auto add = [&](LawDescription law) {
    law.name = next_name();
    law.feeds_energy = true;  // it need not be what a data sheet is checked for
    all.push_back(std::move(law));
  };
  for (std::size_t i = 0; i < rig.laws.curve_count; ++i) {
    if (has([i](const LawDescription& law) { return law.curve == i; })) continue;
    LawDescription law;
    law.curve = i;
    add(std::move(law));
  }
  for (std::size_t i = 0; i < rig.laws.surface_count; ++i) {
    if (has([i](const LawDescription& law) { return law.surface == i; })) continue;
    LawDescription law;
    law.surface = i;
    add(std::move(law));
  }
  for (std::size_t i = 0; i < rig.laws.branch_count; ++i) {
    const auto covers = [&i](const LawDescription& law) {
      return i >= law.first_branch && i < law.first_branch + law.branches;
    };
    if (has(covers)) continue;
    LawDescription law;  // those of one place that follow each other are one law
    law.first_branch = i;
    while (i < rig.laws.branch_count && !has(covers) &&
           rig.laws.branches[i].place == rig.laws.branches[law.first_branch].place) {
      ++i;
    }
    law.branches = i-- - law.first_branch;
    add(std::move(law));
    all.back().feeds_energy = false;  // no branch can
  }
  return all;
}

}  // namespace firmware
