// Our declarations of FMI 2.0 are those of the standard.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

// Both declare the same C functions: a source with both of them compiles only if each agrees, name by name. The
// standard's type names are put into a namespace of their own, so that every type and value can be compared with ours.
// Enumerations differ by name only: the results are compared as functions of the same parameters.
std::string source_with_both(const std::string& version, const std::vector<std::string>& functions,
                             const std::vector<std::string>& values) {
  const std::string fmi = "fmi" + version;
  std::string source =
      "#include <cstddef>\n#include <cstdint>\n#include <stdbool.h>\n#include <type_traits>\n#include \"host_sim/fmu/" +
      fmi +
      ".hpp\"\n"
      "#define _Bool bool\n"
      "namespace standard {\n#include \"" +
      fmi +
      "FunctionTypes.h\"\n}\n"
      "template <class> struct parameters;\n"
      "template <class R, class... P> struct parameters<R(P...)> { using type = void (*)(P...); };\n"
      "template <class F> using parameters_of = typename parameters<F>::type;\n";
  for (const std::string& name : functions) {
    source += "static_assert(std::is_convertible_v<parameters_of<decltype(" + fmi + name +
              ")>, parameters_of<standard::" + fmi + name + "TYPE>>);\n";
  }
  for (const std::string& name : values) {
    source += "static_assert(int(" + fmi + name + ") == int(standard::" + fmi + name + "));\n";
  }
  return source;
}

void expect_compiles(const std::string& source) {
  const support::TemporaryFolder folder;
  const auto file = folder.write("both.cpp", source);
  const std::string command = "g++ -std=c++20 -fsyntax-only -I '" + support::source.string() + "' -I '" +
                              (support::shared / "fmi").string() + "' '" + file.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

bool has_headers(const std::string& version) {
  return std::filesystem::exists(support::shared / "fmi" / ("fmi" + version + "FunctionTypes.h"));
}

TEST(FmiDeclarations, AgreeWithTheHeadersOfTheStandard) {
  if (!has_headers("2")) GTEST_SKIP() << "the headers of FMI 2.0 are missing";
  std::string source =
      source_with_both("2",
                       {"GetTypesPlatform",
                        "GetVersion",
                        "SetDebugLogging",
                        "FreeInstance",
                        "SetupExperiment",
                        "EnterInitializationMode",
                        "ExitInitializationMode",
                        "Terminate",
                        "Reset",
                        "GetReal",
                        "GetInteger",
                        "GetBoolean",
                        "GetString",
                        "SetReal",
                        "SetInteger",
                        "SetBoolean",
                        "SetString",
                        "GetFMUstate",
                        "SetFMUstate",
                        "FreeFMUstate",
                        "SerializedFMUstateSize",
                        "SerializeFMUstate",
                        "DeSerializeFMUstate",
                        "GetDirectionalDerivative",
                        "SetRealInputDerivatives",
                        "GetRealOutputDerivatives",
                        "DoStep",
                        "CancelStep"},
                       {"OK", "Warning", "Discard", "Error", "Fatal", "Pending", "ModelExchange", "CoSimulation",
                        "DoStepStatus", "PendingStatus", "LastSuccessfulTime", "Terminated"});
  source += "static_assert(sizeof(fmi2CallbackFunctions) == sizeof(standard::fmi2CallbackFunctions));\n";
  for (const char* member : {"logger", "allocateMemory", "freeMemory", "stepFinished", "componentEnvironment"}) {
    source += std::string("static_assert(offsetof(fmi2CallbackFunctions, ") + member +
              ") == offsetof(standard::fmi2CallbackFunctions, " + member + "));\n";
  }
  expect_compiles(source);
}

// Functions with an enumeration or a call-back that takes one among their parameters are compared by the size of what
// they take: C++ holds enumerations of two namespaces for two types.
TEST(FmiDeclarations, AgreeWithTheHeadersOfFmi3) {
  if (!has_headers("3")) GTEST_SKIP() << "the headers of FMI 3.0 are missing";
  std::vector<std::string> functions{"GetVersion",
                                     "SetDebugLogging",
                                     "FreeInstance",
                                     "EnterInitializationMode",
                                     "ExitInitializationMode",
                                     "EnterEventMode",
                                     "Terminate",
                                     "Reset",
                                     "GetBinary",
                                     "SetBinary",
                                     "GetClock",
                                     "SetClock",
                                     "GetNumberOfVariableDependencies",
                                     "GetFMUState",
                                     "SetFMUState",
                                     "FreeFMUState",
                                     "SerializedFMUStateSize",
                                     "SerializeFMUState",
                                     "DeserializeFMUState",
                                     "GetDirectionalDerivative",
                                     "GetAdjointDerivative",
                                     "EnterConfigurationMode",
                                     "ExitConfigurationMode",
                                     "GetShiftDecimal",
                                     "GetShiftFraction",
                                     "SetIntervalDecimal",
                                     "SetIntervalFraction",
                                     "SetShiftDecimal",
                                     "SetShiftFraction",
                                     "EvaluateDiscreteStates",
                                     "UpdateDiscreteStates",
                                     "EnterStepMode",
                                     "GetOutputDerivatives",
                                     "DoStep",
                                     "EnterContinuousTimeMode",
                                     "CompletedIntegratorStep",
                                     "SetTime",
                                     "SetContinuousStates",
                                     "GetContinuousStateDerivatives",
                                     "GetEventIndicators",
                                     "GetContinuousStates",
                                     "GetNominalsOfContinuousStates",
                                     "GetNumberOfEventIndicators",
                                     "GetNumberOfContinuousStates",
                                     "ActivateModelPartition"};
  for (const char* type : {"Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64",
                           "UInt64", "Boolean", "String"}) {
    functions.push_back(std::string("Get") + type);
    functions.push_back(std::string("Set") + type);
  }
  std::string source = source_with_both("3", functions,
                                        {"OK", "Warning", "Discard", "Error", "Fatal", "Independent", "Dependent",
                                         "IntervalNotYetKnown", "IntervalChanged"});
  source += R"(
template <class> struct sizes;
template <class R, class... P> struct sizes<R(P...)> {
  static constexpr std::size_t count = sizeof...(P);
  static constexpr std::size_t sum = (sizeof(P) + ... + 0);
};
template <class A, class B> constexpr bool alike = sizes<A>::count == sizes<B>::count && sizes<A>::sum == sizes<B>::sum;
)";
  for (const char* name : {"InstantiateModelExchange", "InstantiateCoSimulation", "InstantiateScheduledExecution",
                           "GetVariableDependencies", "GetIntervalDecimal", "GetIntervalFraction"}) {
    source += std::string("static_assert(alike<decltype(fmi3") + name + "), standard::fmi3" + name + "TYPE>);\n";
  }
  expect_compiles(source);
}

}  // namespace
