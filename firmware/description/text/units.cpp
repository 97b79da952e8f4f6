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
    NamedUnit{"g_n", {Dimension::acceleration, standard_gravity}},
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
    NamedUnit{"samples/s", {Dimension::frequency, 1.0}},
    NamedUnit{"samples/sec", {Dimension::frequency, 1.0}},
    NamedUnit{"samples/second", {Dimension::frequency, 1.0}},
    NamedUnit{"pts/s", {Dimension::frequency, 1.0}},
    NamedUnit{"kS/s", {Dimension::frequency, 1e3}},
    NamedUnit{"sps", {Dimension::frequency, 1.0}},
    NamedUnit{"kHz", {Dimension::frequency, 1e3}},
    NamedUnit{"MHz", {Dimension::frequency, 1e6}},
    NamedUnit{"-", {Dimension::none, 1.0}},
    NamedUnit{"–", {Dimension::none, 1.0}},
    NamedUnit{"1", {Dimension::none, 1.0}},
    NamedUnit{"none", {Dimension::none, 1.0}},
    NamedUnit{"%", {Dimension::none, 1e-2}},
};

// Units of quantities that no channel has, in their usual case. Among them the ones that differ from a unit above by
// their case alone: a torque in Nm is no length in nm.
constexpr std::array units_of_no_channel{
    std::string_view{"V"},      std::string_view{"mV"},     std::string_view{"uV"},       std::string_view{"kV"},
    std::string_view{"Volt"},   std::string_view{"Volts"},  std::string_view{"A"},        std::string_view{"mA"},
    std::string_view{"uA"},     std::string_view{"kA"},     std::string_view{"Amp"},      std::string_view{"Amps"},
    std::string_view{"Ampere"}, std::string_view{"W"},      std::string_view{"mW"},       std::string_view{"kW"},
    std::string_view{"°C"},     std::string_view{"C"},      std::string_view{"degC"},     std::string_view{"Celsius"},
    std::string_view{"°F"},     std::string_view{"degF"},   std::string_view{"K"},        std::string_view{"Kelvin"},
    std::string_view{"Nm"},     std::string_view{"N.m"},    std::string_view{"N-m"},      std::string_view{"kNm"},
    std::string_view{"Ncm"},    std::string_view{"Nmm"},    std::string_view{"lbfft"},    std::string_view{"ft-lb"},
    std::string_view{"rpm"},    std::string_view{"1/min"},  std::string_view{"U/min"},    std::string_view{"min-1"},
    std::string_view{"rad"},    std::string_view{"mrad"},   std::string_view{"rad/s"},    std::string_view{"rad/s2"},
    std::string_view{"deg"},    std::string_view{"°"},      std::string_view{"deg/s"},    std::string_view{"°/s"},
    std::string_view{"grad"},   std::string_view{"l/min"},  std::string_view{"l/h"},      std::string_view{"l/s"},
    std::string_view{"m3/s"},   std::string_view{"m3/h"},   std::string_view{"m3"},       std::string_view{"ml"},
    std::string_view{"kg"},     std::string_view{"kg/m3"},  std::string_view{"kg/s"},     std::string_view{"J"},
    std::string_view{"kJ"},     std::string_view{"Ohm"},    std::string_view{"Ω"},        std::string_view{"kOhm"},
    std::string_view{"mV/V"},   std::string_view{"V/V"},    std::string_view{"um/m"},     std::string_view{"ustrain"},
    std::string_view{"strain"}, std::string_view{"dB"},     std::string_view{"dB(A)"},    std::string_view{"%rH"},
    std::string_view{"ppm"},    std::string_view{"counts"}, std::string_view{"count"},    std::string_view{"cts"},
    std::string_view{"cycle"},  std::string_view{"cycles"}, std::string_view{"segments"}, std::string_view{"bit"},
    std::string_view{"bits"},   std::string_view{"digit"},  std::string_view{"LSB"},      std::string_view{"rev"},
    std::string_view{"km"},     std::string_view{"N/m"},    std::string_view{"N/mm"},     std::string_view{"kN/mm"},
    std::string_view{"Ns/m"},   std::string_view{"mm2"},    std::string_view{"m2"},       std::string_view{"mT"},
    std::string_view{"lx"},     std::string_view{"pulse"},  std::string_view{"pulses"},   std::string_view{"mm3"},
    std::string_view{"uC"},     std::string_view{"pC"},     std::string_view{"Hz/s"},     std::string_view{"VDC"},
    std::string_view{"VAC"},
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
                                                                            {"³", "3"},
                                                                            {"^3", "3"},
                                                                            {"º", "°"},
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
  if (std::find(units_of_no_channel.begin(), units_of_no_channel.end(), text) != units_of_no_channel.end())
    return std::nullopt;
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

bool is_unit_of_no_channel(std::string_view text) {
  const std::string unit = normalized(text);
  if (unit.empty() || find_plain_unit(unit)) return false;
  const std::string lower = lower_ascii(unit);
  return std::any_of(units_of_no_channel.begin(), units_of_no_channel.end(), [&](std::string_view known) {
    // A single letter counts in its own case: a column "a" is no current.
    return known == unit || (known.size() > 1 && lower_ascii(known) == lower);
  });
}

bool is_unit(std::string_view text) {
  const std::optional<Unit> unit = find_unit(text);
  return unit ? unit->dimension != Dimension::none : is_unit_of_no_channel(text);
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
