#include "firmware/description/text/units.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <initializer_list>
#include <string>
#include <utility>

namespace firmware {
namespace {

constexpr double standard_gravity = 9.80665;     // [m/s²] ISO 80000-3; by definition of kgf and of accelerometers' g
constexpr double pound_force = 4.4482216152605;  // [N] international pound × standard gravity
constexpr double inch = 0.0254;                  // [m]

struct NamedUnit {
  std::string_view name;
  Unit unit;
};

// Spellings after normalized(): no blanks, "²" and "^2" as "2", "µ" as "u".
constexpr std::array named_units{
    NamedUnit{"s", {Dimension::time, 1.0}},
    NamedUnit{"sec", {Dimension::time, 1.0}},
    NamedUnit{"secs", {Dimension::time, 1.0}},
    NamedUnit{"second", {Dimension::time, 1.0}},
    NamedUnit{"seconds", {Dimension::time, 1.0}},
    NamedUnit{"sek", {Dimension::time, 1.0}},
    NamedUnit{"sekunden", {Dimension::time, 1.0}},
    NamedUnit{"ms", {Dimension::time, 1e-3}},
    NamedUnit{"msec", {Dimension::time, 1e-3}},
    NamedUnit{"millisec", {Dimension::time, 1e-3}},
    NamedUnit{"milliseconds", {Dimension::time, 1e-3}},
    NamedUnit{"millisekunden", {Dimension::time, 1e-3}},
    NamedUnit{"us", {Dimension::time, 1e-6}},
    NamedUnit{"usec", {Dimension::time, 1e-6}},
    NamedUnit{"microseconds", {Dimension::time, 1e-6}},
    NamedUnit{"mikrosekunden", {Dimension::time, 1e-6}},
    NamedUnit{"ns", {Dimension::time, 1e-9}},
    NamedUnit{"nanoseconds", {Dimension::time, 1e-9}},
    NamedUnit{"min", {Dimension::time, 60.0}},
    NamedUnit{"h", {Dimension::time, 3600.0}},
    NamedUnit{"m", {Dimension::length, 1.0}},
    NamedUnit{"meter", {Dimension::length, 1.0}},
    NamedUnit{"metre", {Dimension::length, 1.0}},
    NamedUnit{"meters", {Dimension::length, 1.0}},
    NamedUnit{"dm", {Dimension::length, 1e-1}},
    NamedUnit{"cm", {Dimension::length, 1e-2}},
    NamedUnit{"mm", {Dimension::length, 1e-3}},
    NamedUnit{"millimeter", {Dimension::length, 1e-3}},
    NamedUnit{"millimetre", {Dimension::length, 1e-3}},
    NamedUnit{"um", {Dimension::length, 1e-6}},
    NamedUnit{"nm", {Dimension::length, 1e-9}},
    NamedUnit{"in", {Dimension::length, inch}},
    NamedUnit{"inch", {Dimension::length, inch}},
    NamedUnit{"inches", {Dimension::length, inch}},
    NamedUnit{"zoll", {Dimension::length, inch}},
    NamedUnit{"mil", {Dimension::length, 1e-3 * inch}},
    NamedUnit{"ft", {Dimension::length, 12.0 * inch}},
    NamedUnit{"m/s", {Dimension::velocity, 1.0}},
    NamedUnit{"cm/s", {Dimension::velocity, 1e-2}},
    NamedUnit{"mm/s", {Dimension::velocity, 1e-3}},
    NamedUnit{"mm/sec", {Dimension::velocity, 1e-3}},
    NamedUnit{"in/s", {Dimension::velocity, inch}},
    NamedUnit{"in/sec", {Dimension::velocity, inch}},
    NamedUnit{"km/h", {Dimension::velocity, 1.0 / 3.6}},
    NamedUnit{"m/s2", {Dimension::acceleration, 1.0}},
    NamedUnit{"m/s/s", {Dimension::acceleration, 1.0}},
    NamedUnit{"ms-2", {Dimension::acceleration, 1.0}},
    NamedUnit{"ms^-2", {Dimension::acceleration, 1.0}},
    NamedUnit{"m/sec2", {Dimension::acceleration, 1.0}},
    NamedUnit{"cm/s2", {Dimension::acceleration, 1e-2}},
    NamedUnit{"mm/s2", {Dimension::acceleration, 1e-3}},
    NamedUnit{"in/s2", {Dimension::acceleration, inch}},
    NamedUnit{"gal", {Dimension::acceleration, 1e-2}},
    NamedUnit{"g", {Dimension::acceleration, standard_gravity}},
    NamedUnit{"gn", {Dimension::acceleration, standard_gravity}},
    NamedUnit{"g0", {Dimension::acceleration, standard_gravity}},
    NamedUnit{"gs", {Dimension::acceleration, standard_gravity}},
    NamedUnit{"mg", {Dimension::acceleration, 1e-3 * standard_gravity}},
    NamedUnit{"N", {Dimension::force, 1.0}},
    NamedUnit{"newton", {Dimension::force, 1.0}},
    NamedUnit{"newtons", {Dimension::force, 1.0}},
    NamedUnit{"mN", {Dimension::force, 1e-3}},
    NamedUnit{"daN", {Dimension::force, 10.0}},
    NamedUnit{"kN", {Dimension::force, 1e3}},
    NamedUnit{"MN", {Dimension::force, 1e6}},
    NamedUnit{"kp", {Dimension::force, standard_gravity}},
    NamedUnit{"kgf", {Dimension::force, standard_gravity}},
    NamedUnit{"tonf", {Dimension::force, 1e3 * standard_gravity}},
    NamedUnit{"lbf", {Dimension::force, pound_force}},
    NamedUnit{"lb", {Dimension::force, pound_force}},
    NamedUnit{"lbs", {Dimension::force, pound_force}},
    NamedUnit{"kip", {Dimension::force, 1e3 * pound_force}},
    NamedUnit{"klbf", {Dimension::force, 1e3 * pound_force}},
    NamedUnit{"Pa", {Dimension::pressure, 1.0}},
    NamedUnit{"hPa", {Dimension::pressure, 1e2}},
    NamedUnit{"kPa", {Dimension::pressure, 1e3}},
    NamedUnit{"MPa", {Dimension::pressure, 1e6}},
    NamedUnit{"N/mm2", {Dimension::pressure, 1e6}},
    NamedUnit{"mbar", {Dimension::pressure, 1e2}},
    NamedUnit{"bar", {Dimension::pressure, 1e5}},
    NamedUnit{"psi", {Dimension::pressure, pound_force / (inch * inch)}},
    NamedUnit{"Hz", {Dimension::frequency, 1.0}},
    NamedUnit{"1/s", {Dimension::frequency, 1.0}},
    NamedUnit{"S/s", {Dimension::frequency, 1.0}},
    NamedUnit{"Sa/s", {Dimension::frequency, 1.0}},
    NamedUnit{"sps", {Dimension::frequency, 1.0}},
    NamedUnit{"kHz", {Dimension::frequency, 1e3}},
    NamedUnit{"MHz", {Dimension::frequency, 1e6}},
    NamedUnit{"-", {Dimension::none, 1.0}},
    NamedUnit{"–", {Dimension::none, 1.0}},
    NamedUnit{"1", {Dimension::none, 1.0}},
    NamedUnit{"none", {Dimension::none, 1.0}},
    NamedUnit{"%", {Dimension::none, 1e-2}},
};

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// One spelling for what is written in several ways.
std::string normalized(std::string_view text) {
  std::string unit(text);
  for (const auto& [from, to] :
       std::initializer_list<std::pair<std::string_view, std::string_view>>{{"²", "2"},
                                                                            {"\xb2", "2"},
                                                                            {"⁻", "-"},
                                                                            {"^-2", "-2"},
                                                                            {"^2", "2"},
                                                                            {"**2", "2"},
                                                                            {"µ", "u"},
                                                                            {"μ", "u"},
                                                                            {"\xb5", "u"},
                                                                            {"·", ""},
                                                                            {"*", ""},
                                                                            {" ", ""},
                                                                            {"\t", ""},
                                                                            {"\xc2\xa0", ""}}) {
    replace_all(unit, from, to);
  }
  return unit;
}

std::string lower_ascii(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::optional<Unit> find_plain_unit(std::string_view text) {
  for (const NamedUnit& known : named_units) {
    if (known.name == text) return known.unit;
  }
  if (text == "mS") return std::nullopt;  // siemens, or a careless millisecond: not for us to say
  const std::string lower = lower_ascii(text);
  for (const NamedUnit& known : named_units) {
    if (known.name != "mN" && lower_ascii(known.name) == lower) return known.unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Unit> find_unit(std::string_view text) {
  const std::string unit = normalized(text);
  if (unit.empty()) return std::nullopt;
  if (const std::optional<Unit> plain = find_plain_unit(unit)) return plain;
  double factor = 0.0;
  const auto [end, error] = std::from_chars(unit.data(), unit.data() + unit.size(), factor);
  if (error != std::errc{} || factor == 0.0) return std::nullopt;
  std::optional<Unit> scaled = find_plain_unit({end, static_cast<std::size_t>(unit.data() + unit.size() - end)});
  if (scaled) scaled->scale *= factor;
  return scaled;
}

Dimension dimension_of(Quantity quantity) {
  const std::string_view unit = quantity_unit(quantity);
  if (unit == "s") return Dimension::time;
  if (unit == "m") return Dimension::length;
  if (unit == "m/s²") return Dimension::acceleration;
  if (unit == "N") return Dimension::force;
  return Dimension::none;
}

std::string_view si_unit(Dimension dimension) {
  constexpr std::array<std::string_view, 8> units{"", "s", "m", "m/s", "m/s²", "N", "Pa", "Hz"};
  return units[static_cast<std::size_t>(dimension)];
}

}  // namespace firmware
