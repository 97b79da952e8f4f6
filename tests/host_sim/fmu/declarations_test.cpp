// Our declarations of FMI 2.0 are those of the standard.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

// Both declare the same C functions: a source with both of them compiles only if each agrees, name by name. The
// standard's type names are put into a namespace of their own, so that every type and value can be compared with ours.
TEST(FmiDeclarations, AgreeWithTheHeadersOfTheStandard) {
  const auto headers = support::shared / "fmi";
  if (!std::filesystem::exists(headers / "fmi2Functions.h")) GTEST_SKIP() << headers << " is missing";
  std::string source =
      "#include <cstddef>\n#include <type_traits>\n#include \"host_sim/fmu/fmi2.hpp\"\n"
      "namespace standard {\n#include \"fmi2FunctionTypes.h\"\n}\n";
  for (const char* name : {"GetTypesPlatform",
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
                           "CancelStep"}) {
    // Enumerations differ by name only: the results are compared as functions of the same parameters.
    source += std::string("static_assert(std::is_convertible_v<parameters_of<decltype(fmi2") + name +
              ")>, parameters_of<standard::fmi2" + name + "TYPE>>);\n";
  }
  const std::size_t at = source.find("static_assert");
  source.insert(at,
                "template <class> struct parameters;\n"
                "template <class R, class... P> struct parameters<R(P...)> { using type = void (*)(P...); };\n"
                "template <class F> using parameters_of = typename parameters<F>::type;\n");
  for (const char* value :
       {"fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending", "fmi2ModelExchange",
        "fmi2CoSimulation", "fmi2DoStepStatus", "fmi2PendingStatus", "fmi2LastSuccessfulTime", "fmi2Terminated"}) {
    source += std::string("static_assert(int(") + value + ") == int(standard::" + value + "));\n";
  }
  source += "static_assert(sizeof(fmi2CallbackFunctions) == sizeof(standard::fmi2CallbackFunctions));\n";
  for (const char* member : {"logger", "allocateMemory", "freeMemory", "stepFinished", "componentEnvironment"}) {
    source += std::string("static_assert(offsetof(fmi2CallbackFunctions, ") + member +
              ") == offsetof(standard::fmi2CallbackFunctions, " + member + "));\n";
  }
  const support::TemporaryFolder folder;
  const auto file = folder.write("both.cpp", source);
  const std::string command = "g++ -std=c++20 -fsyntax-only -I '" + support::source.string() + "' -I '" +
                              headers.string() + "' '" + file.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
