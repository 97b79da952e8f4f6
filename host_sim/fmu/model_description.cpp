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
    Unit{"1", 0, 0, 0},      Unit{"m", 0, 1, 0},    Unit{"m/s", 0, 1, -1},   Unit{"m/s²", 0, 1, -2},
    Unit{"N", 1, 1, -2},     Unit{"N/m", 1, 0, -2}, Unit{"N s/m", 1, 0, -1}, Unit{"kg", 1, 0, 0},
    Unit{"kg/m³", 1, -3, 0}, Unit{"m²", 0, 2, 0},   Unit{"m²/s", 0, 2, -1},  Unit{"Hz", 0, 0, -1},
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

std::string unit_definitions(const Variables& variables) {
  std::string xml = "  <UnitDefinitions>\n";
  for (const Unit& unit : units) {
    const bool used = std::ranges::any_of(variables.list(), [&](const Variable& v) { return v.unit == unit.name; });
    if (!used) continue;
    xml += "    <Unit" + attribute("name", unit.name) + "><BaseUnit";
    if (unit.kg != 0) xml += attribute("kg", std::to_string(unit.kg));
    if (unit.m != 0) xml += attribute("m", std::to_string(unit.m));
    if (unit.s != 0) xml += attribute("s", std::to_string(unit.s));
    xml += "/></Unit>\n";
  }
  return xml + "  </UnitDefinitions>\n";
}

/// The element that holds type and start value. An output has no start: it is calculated.
std::string typed(const Variable& variable) {
  const bool output = variable.causality == Causality::output;
  std::string xml;
  if (const auto* const real = std::get_if<double>(&variable.start)) {
    if (std::ranges::none_of(units, [&](const Unit& unit) { return unit.name == variable.unit; })) {
      throw std::logic_error("no SI powers are known for the unit " + variable.unit);
    }
    xml = "<Real" + attribute("unit", variable.unit) + (output ? "" : attribute("start", firmware::shortest(*real)));
  } else if (const auto* const integer = std::get_if<int>(&variable.start)) {
    xml = "<Integer" + (output ? std::string() : attribute("min", "0") + attribute("start", std::to_string(*integer)));
  } else if (const auto* const boolean = std::get_if<bool>(&variable.start)) {
    xml = "<Boolean" + (output ? std::string() : attribute("start", *boolean ? "true" : "false"));
  } else {
    xml = "<String" + (output ? std::string() : attribute("start", std::get<std::string>(variable.start)));
  }
  return xml + "/>";
}

std::string scalar_variables(const Variables& variables) {
  std::string xml = "  <ModelVariables>\n";
  for (std::size_t i = 0; i < variables.list().size(); ++i) {
    const Variable& variable = variables.list()[i];
    xml += "    <ScalarVariable" + attribute("name", variable.name) + attribute("valueReference", std::to_string(i)) +
           attribute("description", variable.description);
    switch (variable.causality) {
      case Causality::parameter:
        xml += attribute("causality", "parameter") + attribute("variability", "fixed");
        break;
      case Causality::input:
        xml += attribute("causality", "input") + attribute("variability", "continuous");
        break;
      case Causality::output:
        xml += attribute("causality", "output") +
               attribute("variability", variable.continuous ? "continuous" : "discrete") +
               attribute("initial", "calculated");
        break;
    }
    xml += ">" + typed(variable) + "</ScalarVariable>\n";
  }
  return xml + "  </ModelVariables>\n";
}

std::string unknowns(const Variables& variables, const std::string& element) {
  std::string xml = "    <" + element + ">\n";
  for (std::size_t i = 0; i < variables.list().size(); ++i) {
    if (variables.list()[i].causality != Causality::output) continue;
    xml += "      <Unknown" + attribute("index", std::to_string(i + 1)) + "/>\n";
  }
  return xml + "    </" + element + ">\n";
}

}  // namespace

std::string description_in_fmu(const firmware::RigDescription& rig) {
  const bool files = std::ranges::any_of(rig.laws, [](const auto& law) { return !law.file.empty(); });
  if (!files) return rig.text;
  firmware::RigDescription complete = rig;
  for (auto& law : complete.laws) law.file.clear();
  return firmware::format_rig(complete);
}

std::string model_description(const firmware::RigDescription& rig, std::string_view name, std::string_view guid) {
  const Variables variables(rig);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\"" +
         attribute("modelName", name) + attribute("guid", guid) +
         attribute("description", "A " + std::string(model::name(rig.rig.kind)) +
                                      " rig as rigtwin simulates it: firmware, rig and sensors in one loop") +
         attribute("generationTool", "rigtwin " + std::string(firmware::version)) +
         attribute("variableNamingConvention", "structured") + " numberOfEventIndicators=\"0\">\n" + "  <CoSimulation" +
         attribute("modelIdentifier", model_identifier) +
         " canHandleVariableCommunicationStepSize=\"true\" canNotUseMemoryManagementFunctions=\"true\""
         " canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"/>\n" +
         unit_definitions(variables) +
         "  <LogCategories><Category name=\"logStatusError\"/></LogCategories>\n"
         "  <DefaultExperiment startTime=\"0\" stopTime=\"60\"" +
         attribute("stepSize", firmware::shortest(rig.period())) + "/>\n" + scalar_variables(variables) +
         "  <ModelStructure>\n" + unknowns(variables, "Outputs") + unknowns(variables, "InitialUnknowns") +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace host_sim::fmu
