// An FMU of FMI 3.0: the run of `rigtwin simulate` by the other surface of the same core.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "firmware/description/text/sha256.hpp"
#include "host_sim/fmu/fmi3.hpp"
#include "tests/host_sim/fmu/fmu_file.hpp"
#include "tests/host_sim/fmu/function_names.hpp"
#include "tests/host_sim/fmu/simulated_rows.hpp"

namespace fmu3_test {
namespace {

using support::expect_row;
using support::FmuFile;
using support::rig_file;
using support::simulated;
using support::TemporaryFolder;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// An instance of FMI 3.0, as an importer leads it.
class Instance3 {
 public:
  explicit Instance3(const FmuFile& fmu, bool may_return_early = false)
      : Instance3(fmu, fmu.guid(), may_return_early) {}
  Instance3(const FmuFile& fmu, const std::string& token, bool may_return_early, bool event_mode = false) : fmu_(fmu) {
    const std::string resources = (fmu.root() / "resources").string() + "/";
    handle_ =
        RIGTWIN_FMU_CALL(fmi3InstantiateCoSimulation)("one", token.c_str(), resources.c_str(), false, false, event_mode,
                                                      may_return_early, nullptr, 0, this, &Instance3::log, nullptr);
  }
  ~Instance3() { RIGTWIN_FMU_CALL(fmi3FreeInstance)(handle_); }
  Instance3(const Instance3&) = delete;
  Instance3& operator=(const Instance3&) = delete;

  [[nodiscard]] fmi3Instance handle() const { return handle_; }
  [[nodiscard]] const std::string& logged() const { return logged_; }

  fmi3Status enter(double start = 0.0) {
    return RIGTWIN_FMU_CALL(fmi3EnterInitializationMode)(handle_, false, 0.0, start, false, 0.0);
  }
  fmi3Status exit() { return RIGTWIN_FMU_CALL(fmi3ExitInitializationMode)(handle_); }
  fmi3Status terminate() { return RIGTWIN_FMU_CALL(fmi3Terminate)(handle_); }
  fmi3Status reset() { return RIGTWIN_FMU_CALL(fmi3Reset)(handle_); }
  void begin(double start = 0.0) {
    EXPECT_EQ(enter(start), fmi3OK) << logged_;
    EXPECT_EQ(exit(), fmi3OK) << logged_;
  }
  fmi3Status step(double from, double size) {
    return RIGTWIN_FMU_CALL(fmi3DoStep)(handle_, from, size, true, &event_handling_needed, &terminate_simulation,
                                        &early_return, &last_successful_time);
  }
  bool event_handling_needed = true, terminate_simulation = true, early_return = true;
  double last_successful_time = -1.0;

  fmi3Status set(const std::string& name, double value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi3SetFloat64)(handle_, &reference, 1, &value, 1);
  }
  fmi3Status set(const std::string& name, int value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi3SetInt32)(handle_, &reference, 1, &value, 1);
  }
  fmi3Status set(const std::string& name, bool value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi3SetBoolean)(handle_, &reference, 1, &value, 1);
  }
  fmi3Status set(const std::string& name, const char* value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi3SetString)(handle_, &reference, 1, &value, 1);
  }
  fmi3Status get(const std::string& name, double& value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi3GetFloat64)(handle_, &reference, 1, &value, 1);
  }
  [[nodiscard]] double real(const std::string& name) {
    double value = not_a_number;
    EXPECT_EQ(get(name, value), fmi3OK) << name << ": " << logged_;
    return value;
  }
  [[nodiscard]] int integer(const std::string& name) {
    const unsigned reference = fmu_.reference(name);
    int value = -1;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetInt32)(handle_, &reference, 1, &value, 1), fmi3OK);
    return value;
  }
  [[nodiscard]] bool boolean(const std::string& name) {
    const unsigned reference = fmu_.reference(name);
    bool value = false;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetBoolean)(handle_, &reference, 1, &value, 1), fmi3OK);
    return value;
  }
  [[nodiscard]] std::string text(const std::string& name) {
    const unsigned reference = fmu_.reference(name);
    fmi3String value = nullptr;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetString)(handle_, &reference, 1, &value, 1), fmi3OK);
    return value == nullptr ? "" : value;
  }

 private:
  static void log(fmi3InstanceEnvironment self, fmi3Status, fmi3String, fmi3String message) {
    static_cast<Instance3*>(self)->logged_ = message;
  }

  const FmuFile& fmu_;
  fmi3Instance handle_ = nullptr;
  std::string logged_;
};

// The promise of the room in the other version: each kind of rig, with noise, bit for bit; the time is a variable.
TEST(Fmu3, RepeatsSimulateBitForBit) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"}) {
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    const firmware::Recording recording = simulated(folder, {"--rig", rig_file(name), "--duration", "2"});
    const FmuFile fmu(rig_file(name), 3);
    Instance3 instance(fmu);
    ASSERT_NE(instance.handle(), nullptr) << instance.logged();
    instance.begin();
    for (std::size_t k = 0; k < recording.size(); ++k) {
      ASSERT_NO_FATAL_FAILURE(expect_row(instance, recording, k));
      ASSERT_EQ(instance.real("time"), static_cast<double>(k) / 1000.0);
      ASSERT_EQ(instance.step(static_cast<double>(k) * 0.001, 0.001), fmi3OK) << instance.logged();
      ASSERT_FALSE(instance.terminate_simulation || instance.early_return || instance.event_handling_needed);
    }
    EXPECT_EQ(instance.last_successful_time, static_cast<double>(recording.size()) / 1000.0);
  }
}

// Parameters of each type, and a start beside 0.
TEST(Fmu3, TakesTheParametersOfSimulate) {
  const TemporaryFolder folder;
  const firmware::Recording recording =
      simulated(folder, {"--rig", rig_file("paper_hil_fdva"), "--duration", "1", "--road", "iso8608:A", "--speed", "20",
                         "--seed", "7", "--no-noise"});
  const FmuFile fmu(rig_file("paper_hil_fdva"), 3);
  Instance3 instance(fmu);
  EXPECT_EQ(instance.set("road", "iso8608:A"), fmi3OK);
  EXPECT_EQ(instance.set("speed", 20.0), fmi3OK);
  EXPECT_EQ(instance.set("seed", 7), fmi3OK);
  EXPECT_EQ(instance.set("noise", false), fmi3OK);
  instance.begin(5.0);
  for (std::size_t k = 0; k < recording.size(); k += 20) {
    ASSERT_NO_FATAL_FAILURE(expect_row(instance, recording, k));
    ASSERT_EQ(instance.step(5.0 + static_cast<double>(k) * 0.001, 0.02), fmi3OK) << instance.logged();
  }
  EXPECT_TRUE(instance.boolean("running"));
  EXPECT_EQ(instance.integer("reason"), 0);
  EXPECT_EQ(instance.text("reason_name"), "none");
  EXPECT_EQ(instance.text("road"), "iso8608:A");
}

// The state machine: each call where it is allowed, and an error where it is not, after which the run goes on.
TEST(Fmu3, FollowsTheStateMachine) {
  const FmuFile fmu_(rig_file("paper_linear"), 3);
  Instance3 instance(fmu_);
  ASSERT_NE(instance.handle(), nullptr) << instance.logged();
  double value = 0.0;
  EXPECT_EQ(instance.exit(), fmi3Error);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi3Error);
  EXPECT_NE(instance.logged().find("a step is not allowed before initialisation"), std::string::npos);
  EXPECT_EQ(instance.terminate(), fmi3Error);
  EXPECT_EQ(instance.get("F_w", value), fmi3Error);
  EXPECT_EQ(instance.enter(not_a_number), fmi3Error);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3EnterInitializationMode)(instance.handle(), false, 0.0, 1.0, true, 0.5), fmi3Error);
  EXPECT_EQ(instance.enter(), fmi3OK);
  EXPECT_EQ(instance.enter(), fmi3Error);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi3Error);
  EXPECT_EQ(instance.get("F_w", value), fmi3OK) << "the first sample is known in initialisation mode";
  EXPECT_EQ(instance.exit(), fmi3OK);
  EXPECT_EQ(instance.exit(), fmi3Error);
  EXPECT_EQ(instance.set("seed", 2), fmi3Error);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi3OK);
  const auto without_value = [&](fmi3Status (*function)(fmi3Instance)) { return function(instance.handle()); };
  for (const char* name : {"fmi3EnterEventMode", "fmi3EnterStepMode", "fmi3EnterConfigurationMode",
                           "fmi3ExitConfigurationMode", "fmi3EvaluateDiscreteStates"}) {
    EXPECT_EQ(without_value(fmu_.function<fmi3Status(fmi3Instance)>(name)), fmi3Error) << name;
  }
  const unsigned reference = fmu_.reference("F_w");
  float single = 0.0F;
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetFloat32)(instance.handle(), &reference, 1, &single, 1), fmi3Error);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetFloat32)(instance.handle(), nullptr, 0, nullptr, 0), fmi3OK);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetFloat64)(instance.handle(), &reference, 1, &value, 2), fmi3Error);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3DoStep)(instance.handle(), 0.001, 0.001, true, nullptr, nullptr, nullptr, nullptr),
            fmi3Error);
  EXPECT_EQ(instance.terminate(), fmi3OK);
  EXPECT_EQ(instance.get("F_w", value), fmi3OK);
  EXPECT_EQ(instance.step(0.001, 0.001), fmi3Error);
  EXPECT_EQ(instance.reset(), fmi3OK);
  instance.begin();
  EXPECT_EQ(instance.step(0.0, 0.001), fmi3OK);
  EXPECT_EQ(instance.real("F_w"), value) << "reset begins the same run again";
}

// A state is the whole state, in the same instance and, serialised, in another.
TEST(Fmu3, GoesOnFromAState) {
  const FmuFile fmu_(rig_file("paper_hil_fdva"), 3);
  Instance3 first(fmu_), second(fmu_);
  const auto steps = [](Instance3& instance, int from, int to) {
    std::vector<double> seen;
    for (int k = from; k < to; ++k) {
      EXPECT_EQ(instance.step(k * 0.001, 0.001), fmi3OK) << instance.logged();
      for (const char* name : {"F_w", "x_act", "F", "z_b"}) seen.push_back(instance.real(name));
    }
    return seen;
  };
  first.begin();
  (void)steps(first, 0, 100);
  fmi3FMUState state = nullptr, again = nullptr;
  ASSERT_EQ(RIGTWIN_FMU_CALL(fmi3GetFMUState)(first.handle(), &state), fmi3OK);
  const std::vector<double> once = steps(first, 100, 200);
  ASSERT_EQ(RIGTWIN_FMU_CALL(fmi3SetFMUState)(first.handle(), state), fmi3OK);
  EXPECT_EQ(steps(first, 100, 200), once);
  std::size_t size = 0;
  ASSERT_EQ(RIGTWIN_FMU_CALL(fmi3SerializedFMUStateSize)(first.handle(), state, &size), fmi3OK);
  std::vector<fmi3Byte> bytes(size);
  ASSERT_EQ(RIGTWIN_FMU_CALL(fmi3SerializeFMUState)(first.handle(), state, bytes.data(), size), fmi3OK);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3SerializeFMUState)(first.handle(), state, bytes.data(), size - 1), fmi3Error);
  ASSERT_EQ(RIGTWIN_FMU_CALL(fmi3DeserializeFMUState)(second.handle(), bytes.data(), size, &again), fmi3OK);
  ASSERT_EQ(RIGTWIN_FMU_CALL(fmi3SetFMUState)(second.handle(), again), fmi3OK) << second.logged();
  EXPECT_EQ(steps(second, 100, 200), once);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3FreeFMUState)(first.handle(), &state), fmi3OK);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3FreeFMUState)(second.handle(), &again), fmi3OK);
  EXPECT_EQ(state, nullptr);
}

// A run that the firmware ends asks the importer to terminate: an early return where it may be one, else a step of
// which only a part could be done.
TEST(Fmu3, SaysWhereTheFirmwareEndedTheRun) {
  const FmuFile fmu(rig_file("paper_rig_fdva"), 3);
  for (const bool early : {false, true}) {
    Instance3 instance(fmu, early);
    EXPECT_EQ(instance.set("road", "input"), fmi3OK);
    instance.begin();
    ASSERT_EQ(instance.step(0.0, 0.01), fmi3OK);
    EXPECT_EQ(instance.set("excitation.position", 10.0), fmi3OK);
    EXPECT_EQ(instance.step(0.01, 0.01), early ? fmi3OK : fmi3Discard);
    EXPECT_NE(instance.logged().find("the firmware ended the run: "), std::string::npos) << instance.logged();
    EXPECT_TRUE(instance.terminate_simulation);
    EXPECT_EQ(instance.early_return, early);
    EXPECT_NEAR(instance.last_successful_time, 0.01, 0.0051);
    EXPECT_FALSE(instance.boolean("running"));
    EXPECT_GT(instance.integer("reason"), 0);
    EXPECT_NE(instance.text("reason_name"), "none");
  }
}

TEST(Fmu3, RefusesWhatItIsNot) {
  const FmuFile fmu_(rig_file("paper_linear"), 3);
  EXPECT_EQ(fmu_.guid(), firmware::sha256(TemporaryFolder::read(rig_file("paper_linear"))));
  const Instance3 foreign(fmu_, "0123", false), events(fmu_, fmu_.guid(), false, true);
  EXPECT_EQ(foreign.handle(), nullptr);
  EXPECT_NE(foreign.logged().find("the GUID is 0123, expected " + fmu_.guid()), std::string::npos) << foreign.logged();
  EXPECT_EQ(events.handle(), nullptr);
  EXPECT_NE(events.logged().find("no event mode"), std::string::npos) << events.logged();
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3InstantiateModelExchange)("one", "", "", false, false, nullptr, nullptr), nullptr);
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3InstantiateScheduledExecution)("one", "", "", false, false, nullptr, nullptr, nullptr,
                                                                nullptr, nullptr),
            nullptr);
  EXPECT_STREQ(RIGTWIN_FMU_CALL(fmi3GetVersion)(), "3.0");
  const Instance3 car(fmu_);
  std::size_t states = 0;
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3GetNumberOfContinuousStates)(car.handle(), &states), fmi3Error);
  EXPECT_NE(car.logged().find("not for model exchange"), std::string::npos) << car.logged();
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi3ActivateModelPartition)(car.handle(), 0, 0.0), fmi3Error);
  EXPECT_NE(car.logged().find("no clocks"), std::string::npos) << car.logged();
}

// An importer (FMPy 0.3.30 for one) looks for every function of FMI 3.0 when it loads the library.
TEST(Fmu3, ExportsEveryFunction) {
  const FmuFile fmu(rig_file("paper_linear"), 3);
  EXPECT_EQ(std::set<std::string>(support::fmi3_functions.begin(), support::fmi3_functions.end()).size(), 75U);
  for (const char* name : support::fmi3_functions) EXPECT_NE(fmu.function<void()>(name), nullptr) << name;
}

}  // namespace
}  // namespace fmu3_test
