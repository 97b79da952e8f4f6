#include "host_sim/fmu/model_description.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/version.hpp"
#include "host_sim/fmu/variables.hpp"

namespace host_sim::fmu {
namespace {

/// A unit by powers of SI base units.
struct Unit {
  std::string_view name;
  int kg, m, s;
};
constexpr std::array units{
    Unit{"s", 0, 0, 1},      Unit{"1", 0, 0, 0},        Unit{"m", 0, 1, 0},    Unit{"m/s", 0, 1, -1},
    Unit{"m/s²", 0, 1, -2},  Unit{"N", 1, 1, -2},       Unit{"N/m", 1, 0, -2}, Unit{"N s/m", 1, 0, -1},
    Unit{"kg", 1, 0, 0},     Unit{"kg/m³", 1, -3, 0},   Unit{"m²", 0, 2, 0},   Unit{"m²/s", 0, 2, -1},
    Unit{"Hz", 0, 0, -1},    Unit{"Pa", 1, -1, -2},     Unit{"m³", 0, 3, 0},   Unit{"1/s", 0, 0, -1},
    Unit{"N/m³", 1, -2, -2}, Unit{"N s²/m²", 1, -1, 0},
};

std::string escaped(std::string_view text) {
  std::string xml;
  for (const char c : text) {
    switch (c) {
      case '&':
        xml += "&amp;";
        break;
      case '<':
        xml += "&lt;";
        break;
      case '>':
        xml += "&gt;";
        break;
      case '"':
        xml += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) xml += c;
    }
  }
  return xml;
}

std::string attribute(std::string_view name, std::string_view value) {
  return " " + std::string(name) + "=\"" + escaped(value) + "\"";
}

std::string unit_definitions(const Variables& variables, bool with_time) {
  std::string xml = "  <UnitDefinitions>\n";
  for (const Unit& unit : units) {
    const bool used = std::ranges::any_of(variables.list(), [&](const Variable& v) { return v.unit == unit.name; });
    if (!used && !(with_time && unit.name == "s")) continue;
    xml += "    <Unit" + attribute("name", unit.name) + "><BaseUnit";
    if (unit.kg != 0) xml += attribute("kg", std::to_string(unit.kg));
    if (unit.m != 0) xml += attribute("m", std::to_string(unit.m));
    if (unit.s != 0) xml += attribute("s", std::to_string(unit.s));
    xml += "/></Unit>\n";
  }
  return xml + "  </UnitDefinitions>\n";
}

/// What the elements and attributes of a variable are called.
struct Dialect {
  std::string_view real, integer, boolean, string;
};
constexpr Dialect fmi2_types{"Real", "Integer", "Boolean", "String"};
constexpr Dialect fmi3_types{"Float64", "Int32", "Boolean", "String"};

std::string_view type_of(const Variable& variable, const Dialect& types) {
  const std::array<std::string_view, 4> names{types.real, types.integer, types.boolean, types.string};
  return names[variable.start.index()];
}

/// Unit, bounds and start value as attributes; the start of a String is left to its caller. An output has no start: it
/// is calculated.
std::string value_attributes(const Variable& variable) {
  const bool output = variable.causality == Causality::output;
  if (const auto* const real = std::get_if<double>(&variable.start)) {
    if (std::ranges::none_of(units, [&](const Unit& unit) { return unit.name == variable.unit; })) {
      throw std::logic_error("no SI powers are known for the unit " + variable.unit);
    }
    return attribute("unit", variable.unit) + (output ? "" : attribute("start", firmware::shortest(*real)));
  }
  if (output) return {};
  if (const auto* const integer = std::get_if<int>(&variable.start)) {
    return attribute("min", "0") + attribute("start", std::to_string(*integer));
  }
  if (const auto* const boolean = std::get_if<bool>(&variable.start)) {
    return attribute("start", *boolean ? "true" : "false");
  }
  return {};
}

/// Name, reference, causality, variability: the same words in both versions.
std::string common_attributes(const Variable& variable, std::size_t reference) {
  const std::string xml = attribute("name", variable.name) + attribute("valueReference", std::to_string(reference)) +
                          attribute("description", variable.description);
  switch (variable.causality) {
    case Causality::parameter:
      return xml + attribute("causality", "parameter") + attribute("variability", "fixed");
    case Causality::input:
      return xml + attribute("causality", "input") + attribute("variability", "continuous");
    case Causality::output:
      break;
  }
  return xml + attribute("causality", "output") +
         attribute("variability", variable.continuous ? "continuous" : "discrete") + attribute("initial", "calculated");
}

std::string variables_of_fmi2(const Variables& variables) {
  std::string xml = "  <ModelVariables>\n";
  for (std::size_t i = 0; i < variables.list().size(); ++i) {
    const Variable& variable = variables.list()[i];
    const auto* const text = std::get_if<std::string>(&variable.start);
    const bool has_text = text != nullptr && variable.causality != Causality::output;
    xml += "    <ScalarVariable" + common_attributes(variable, i) + "><" + std::string(type_of(variable, fmi2_types)) +
           value_attributes(variable) + (has_text ? attribute("start", *text) : "") + "/></ScalarVariable>\n";
  }
  return xml + "  </ModelVariables>\n";
}

/// FMI 3.0 demands the time as a variable.
std::string variables_of_fmi3(const Variables& variables) {
  std::string xml = "  <ModelVariables>\n";
  for (std::size_t i = 0; i < variables.list().size(); ++i) {
    const Variable& variable = variables.list()[i];
    const std::string type(type_of(variable, fmi3_types));
    const auto* const text = std::get_if<std::string>(&variable.start);
    const bool has_text = text != nullptr && variable.causality != Causality::output;
    xml += "    <" + type + common_attributes(variable, i) + value_attributes(variable) +
           (has_text ? "><Start" + attribute("value", *text) + "/></" + type + ">\n" : "/>\n");
  }
  return xml + "    <Float64" + attribute("name", "time") +
         attribute("valueReference", std::to_string(variables.time())) +
         attribute("description", "Time of the communication point") + attribute("causality", "independent") +
         attribute("variability", "continuous") + attribute("unit", "s") + "/>\n  </ModelVariables>\n";
}

/// An element for each output.
template <class Element>
std::string for_outputs(const Variables& variables, const Element& element) {
  std::string xml;
  for (std::size_t i = 0; i < variables.list().size(); ++i) {
    if (variables.list()[i].causality == Causality::output) xml += element(i);
  }
  return xml;
}

std::string structure_of_fmi2(const Variables& variables) {
  const auto unknowns = [&](const std::string& list) {
    return "    <" + list + ">\n" +
           for_outputs(
               variables,
               [](std::size_t i) { return "      <Unknown" + attribute("index", std::to_string(i + 1)) + "/>\n"; }) +
           "    </" + list + ">\n";
  };
  return unknowns("Outputs") + unknowns("InitialUnknowns");
}

std::string structure_of_fmi3(const Variables& variables) {
  const auto unknowns = [&](const std::string& element) {
    return for_outputs(variables, [&](std::size_t i) {
      return "    <" + element + attribute("valueReference", std::to_string(i)) + "/>\n";
    });
  };
  return unknowns("Output") + unknowns("InitialUnknown");
}

}  // namespace

std::string description_in_fmu(const firmware::RigDescription& rig) {
  const bool files = std::ranges::any_of(rig.laws, [](const auto& law) { return !law.file.empty(); });
  if (!files) return rig.text;
  firmware::RigDescription complete = rig;
  for (auto& law : complete.laws) law.file.clear();
  return firmware::format_rig(complete);
}

std::string model_description(const firmware::RigDescription& rig, std::string_view name, std::string_view guid,
                              Version version) {
  const Variables variables(rig);
  const bool three = version == Version::fmi3;
  const std::string period = firmware::shortest(rig.period());
  return std::string("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription") +
         attribute("fmiVersion", three ? "3.0" : "2.0") + attribute("modelName", name) +
         attribute(three ? "instantiationToken" : "guid", guid) +
         attribute("description", "A " + std::string(model::name(rig.rig.kind)) +
                                      " rig as rigtwin simulates it: firmware, rig and sensors in one loop") +
         attribute("generationTool", "rigtwin " + std::string(firmware::version)) +
         attribute("variableNamingConvention", "structured") + (three ? ">\n" : " numberOfEventIndicators=\"0\">\n") +
         "  <CoSimulation" + attribute("modelIdentifier", model_identifier) +
         attribute("canHandleVariableCommunicationStepSize", "true") +
         (three ? attribute("fixedInternalStepSize", period) + attribute("mightReturnEarlyFromDoStep", "true") +
                      attribute("canGetAndSetFMUState", "true") + attribute("canSerializeFMUState", "true")
                : attribute("canNotUseMemoryManagementFunctions", "true") + attribute("canGetAndSetFMUstate", "true") +
                      attribute("canSerializeFMUstate", "true")) +
         "/>\n" + unit_definitions(variables, three) +
         "  <LogCategories><Category name=\"logStatusError\"/></LogCategories>\n"
         "  <DefaultExperiment startTime=\"0\" stopTime=\"60\"" +
         attribute("stepSize", period) + "/>\n" +
         (three ? variables_of_fmi3(variables) : variables_of_fmi2(variables)) + "  <ModelStructure>\n" +
         (three ? structure_of_fmi3(variables) : structure_of_fmi2(variables)) +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace host_sim::fmu
