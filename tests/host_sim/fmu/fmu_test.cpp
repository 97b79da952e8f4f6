// An FMU gives the run of `rigtwin simulate` to whoever imports it, and refuses what the standard does not allow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "firmware/description/text/sha256.hpp"
#include "model/numerics/motion.hpp"
#include "tests/host_sim/fmu/fmu_file.hpp"
#include "tests/host_sim/fmu/function_names.hpp"
#include "tests/host_sim/fmu/simulated_rows.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::Ended;
using support::expect_row;
using support::FmuFile;
using support::FmuInstance;
using support::rig_file;
using support::rigtwin;
using support::simulated;
using support::TemporaryFolder;

using Motion = model::Motion<double>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// The promise of the room: without inputs an FMU repeats `rigtwin simulate` bit for bit, for each kind of rig, with
// noise. CSV keeps every bit (shortest decimals), so ASSERT_EQ compares bits.
TEST(Fmu, RepeatsSimulateBitForBit) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"}) {
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    const firmware::Recording recording = simulated(folder, {"--rig", rig_file(name), "--duration", "2"});
    const FmuFile fmu(rig_file(name));
    FmuInstance instance(fmu);
    ASSERT_NE(instance.component(), nullptr) << instance.logged();
    instance.begin();
    for (std::size_t k = 0; k < recording.size(); ++k) {
      ASSERT_NO_FATAL_FAILURE(expect_row(instance, recording, k));
      ASSERT_EQ(instance.step(static_cast<double>(k) * 0.001, 0.001), fmi2OK) << instance.logged();
    }
  }
}

// Parameters are those of the command line, and steps of several periods see the same samples.
TEST(Fmu, TakesTheParametersOfSimulate) {
  const TemporaryFolder folder;
  const firmware::Recording recording =
      simulated(folder, {"--rig", rig_file("paper_hil_fdva"), "--duration", "1", "--road", "iso8608:A", "--speed", "20",
                         "--seed", "7", "--bandwidth", "40", "--cut-off", "0.1", "--no-noise"});
  const FmuFile fmu(rig_file("paper_hil_fdva"));
  FmuInstance instance(fmu);
  EXPECT_EQ(instance.set("road", "iso8608:A"), fmi2OK);
  EXPECT_EQ(instance.set("speed", 20.0), fmi2OK);
  EXPECT_EQ(instance.set("seed", 7), fmi2OK);
  EXPECT_EQ(instance.set("noise", false), fmi2OK);
  EXPECT_EQ(instance.set("bandwidth", 40.0), fmi2OK);
  EXPECT_EQ(instance.set("cut_off", 0.1), fmi2OK);
  instance.begin(5.0);
  for (std::size_t k = 0; k < recording.size(); k += 20) {
    ASSERT_NO_FATAL_FAILURE(expect_row(instance, recording, k));
    ASSERT_EQ(instance.step(5.0 + static_cast<double>(k) * 0.001, 0.02), fmi2OK) << instance.logged();
  }
  EXPECT_TRUE(instance.boolean("running"));
  EXPECT_EQ(instance.integer("reason"), 0);
  EXPECT_EQ(instance.text("reason_name"), "none");
  EXPECT_EQ(instance.text("road"), "iso8608:A");
  EXPECT_EQ(instance.integer("seed"), 7);
  EXPECT_FALSE(instance.boolean("noise"));
}

// A number of the rig description is a parameter: the FMU with it changed is the FMU of the changed description.
TEST(Fmu, ANumberOfTheRigMayBeChanged) {
  const TemporaryFolder folder;
  const std::string text = TemporaryFolder::read(rig_file("paper_rig_fdva"));
  const auto softer = folder.write("softer.toml", support::with(text, "stiffness = 200e3", "stiffness = 180e3"));
  const firmware::Recording recording = simulated(folder, {"--rig", softer, "--duration", "0.2"});
  const FmuFile fmu(rig_file("paper_rig_fdva"));
  FmuInstance instance(fmu);
  EXPECT_EQ(instance.set("tyre.stiffness", 180e3), fmi2OK);
  instance.begin();
  for (std::size_t k = 0; k < recording.size(); ++k) {
    ASSERT_NO_FATAL_FAILURE(expect_row(instance, recording, k));
    ASSERT_EQ(instance.step(static_cast<double>(k) * 0.001, 0.001), fmi2OK);
  }
  EXPECT_EQ(instance.set("tyre.stiffness", 1.0), fmi2Error) << "a parameter is fixed once the run has begun";
  ASSERT_EQ(instance.reset(), fmi2OK);
  EXPECT_EQ(instance.set("tyre.stiffness", -1.0), fmi2OK);
  EXPECT_EQ(instance.set_up(), fmi2OK);
  EXPECT_EQ(instance.enter(), fmi2OK);
  EXPECT_EQ(instance.exit(), fmi2Error);
  EXPECT_NE(instance.logged().find("tyre.stiffness"), std::string::npos) << instance.logged();
}

// From outside: the foot point of a recording, given step by step, leads to the recording. With input_at = "end" the
// input of a step is where the rig is at its end, as the firmware of a rig commands it.
//
// The velocity given from outside is a sum of accelerations. By Euler and Maclaurin this rectangle rule is wrong by
//
//   (1)  δ = h/2 · z̈_r + h²/12 · z⃛_r + …          the rig begins at rest
//
// Through the tyre's damping it is in the wheel load at once, b_t δ; through its stiffness only by the path between two
// samples, which begins and ends right because positions are given: an impulse k_t h² (δ₀ − δ₁)/12 on the wheel, whose
// sum k_t h³ z̈_r/24 moves the wheel by less than 1e-4 m/s here, 0.01 N. With z⃛_r as the difference of two
// accelerations, half a period late, (1) is right within (2π f h)²/12 of h/2 · |z̈_r|: 3 % at 100 Hz, where the road's
// low-pass begins, 21 % at 250 Hz, beyond which it leaves little. Bound: a fifth of h/2 · max|z̈_r| so far.
TEST(Fmu, IsDrivenFromOutside) {
  const TemporaryFolder folder;
  const FmuFile fmu(rig_file("paper_hil_fdva"));
  FmuInstance inside(fmu), outside(fmu);
  for (FmuInstance* instance : {&inside, &outside}) EXPECT_EQ(instance->set("noise", false), fmi2OK);
  EXPECT_EQ(outside.set("road", "input"), fmi2OK);
  EXPECT_EQ(outside.set("input_at", "end"), fmi2OK);
  constexpr double period = 1e-3, tyre_damping = 100.0;  // [s], [N s/m] of the description
  inside.begin();
  outside.begin();
  double velocity = 0.0, before = 0.0, peak = 0.0;  // [m/s], [m/s²], [m/s²]
  for (int k = 0; k < 300; ++k) {
    ASSERT_EQ(outside.real("z_r"), inside.real("z_r")) << k;
    ASSERT_EQ(outside.real("zdd_r"), inside.real("zdd_r")) << k;
    const double now = inside.real("zdd_r");
    peak = std::max(peak, std::abs(now));
    const double predicted = tyre_damping * (period / 2.0 * now + period / 12.0 * (now - before));
    ASSERT_NEAR(outside.real("F_w") - inside.real("F_w"), predicted, 0.2 * tyre_damping * period / 2.0 * peak) << k;
    before = now;
    ASSERT_EQ(inside.step(k * 0.001, 0.001), fmi2OK);
    const double position = inside.real("z_r"), acceleration = inside.real("zdd_r");
    velocity += acceleration * period;
    ASSERT_EQ(outside.set("excitation.position", position), fmi2OK);
    ASSERT_EQ(outside.set("excitation.velocity", velocity), fmi2OK);
    ASSERT_EQ(outside.set("excitation.acceleration", acceleration), fmi2OK);
    ASSERT_EQ(outside.step(k * 0.001, 0.001), fmi2OK);
  }
  EXPECT_GT(peak, 100.0) << "the road moves the rig";
  EXPECT_EQ(outside.set("excitation.position", not_a_number), fmi2Error);
  EXPECT_NE(outside.logged().find("excitation.position is nan, expected a finite number"), std::string::npos)
      << outside.logged();
}

void give(FmuInstance& instance, const Motion& motion) {
  ASSERT_EQ(instance.set("excitation.position", motion.position), fmi2OK);
  ASSERT_EQ(instance.set("excitation.velocity", motion.velocity), fmi2OK);
  ASSERT_EQ(instance.set("excitation.acceleration", motion.acceleration), fmi2OK);
}

// Law. Inputs hold where they are set: the road of `rigtwin simulate`, given at its own instants, makes the run that
// input_at = "end" makes of the road given a step ahead, bit for bit and with noise, whether the outputs are read
// before the inputs of their instant, too, or only after them, or only at the end.
TEST(Fmu, AnInputHoldsAtItsCommunicationPoint) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"}) {
    SCOPED_TRACE(name);
    const FmuFile fmu(rig_file(name));
    const char* const column = std::string(name) == "paper_bench_fdva" ? "x_cmd" : "z_r";
    FmuInstance inside(fmu), ahead(fmu), often(fmu), once(fmu), last(fmu);
    inside.begin();
    for (FmuInstance* instance : {&ahead, &often, &once, &last}) EXPECT_EQ(instance->set("road", "input"), fmi2OK);
    EXPECT_EQ(ahead.set("input_at", "end"), fmi2OK);
    for (FmuInstance* instance : {&ahead, &often, &once, &last}) instance->begin();
    double before = inside.real(column), rate = 0.0;  // [m], [m/s]
    const auto row = [&](FmuInstance& instance) {
      std::vector<double> seen;
      for (const char* output : {column, "F", "duct_1", "F_w"}) {
        if (fmu.xml().find("name=\"" + std::string(output) + "\"") != std::string::npos) {
          seen.push_back(instance.real(output));
        }
      }
      return seen;
    };
    for (int k = 0; k < 200; ++k) {
      ASSERT_EQ(inside.step(k * 0.001, 0.001), fmi2OK);
      const double now = inside.real(column), rate_now = (now - before) / 0.001;
      const Motion motion{now, rate_now, (rate_now - rate) / 0.001};
      before = now;
      rate = rate_now;
      give(ahead, motion);
      for (FmuInstance* instance : {&ahead, &often, &once, &last}) {
        ASSERT_EQ(instance->step(k * 0.001, 0.001), fmi2OK) << instance->logged();
      }
      (void)row(often);
      for (FmuInstance* instance : {&often, &once, &last}) give(*instance, motion);
      const std::vector<double> expected = row(ahead);
      ASSERT_EQ(row(often), expected) << k;
      ASSERT_EQ(row(once), expected) << k;
    }
    EXPECT_EQ(row(last), row(ahead));
  }
}

// As most importers do it: inputs at t, the step, outputs at t + h. What is read before the inputs of its instant is
// predicted. Of a sine z = A sin ωt, Taylor with ż and z̈ leaves at most δ = A (ωh)³/6 of the position and A ω³h²/2 of
// the velocity, the line through two positions δ = A (ωh)². The wheel load has k_t and b_t times that at once; through
// the wheel's motion within one period less than k_t h²/m_w = 0.5 % more. With input_at = "end" the same importer's road
// is a whole period late.
TEST(Fmu, ADrivenRoadIsNotAPeriodLate) {
  constexpr double height = 1e-3, omega = 2.0 * 3.141592653589793 * 5.0, period = 1e-3;  // [m], [rad/s], [s]
  constexpr double tyre_stiffness = 200e3, tyre_damping = 100.0;  // of the description [N/m], [N s/m]
  constexpr double wh = omega * period, rounding = 1e-12;
  constexpr double by_taylor = height * wh * wh * wh / 6.0, by_line = height * wh * wh;  // [m]
  constexpr double rate_by_taylor = height * omega * wh * wh / 2.0;                      // [m/s]
  const FmuFile fmu(rig_file("paper_hil_fdva"));
  enum Way : std::size_t { right, right_positions, late, taylor, line, ways };
  std::vector<std::unique_ptr<FmuInstance>> instances;
  for (std::size_t i = 0; i < ways; ++i) {
    instances.push_back(std::make_unique<FmuInstance>(fmu));
    EXPECT_EQ(instances[i]->set("road", "input"), fmi2OK);
    EXPECT_EQ(instances[i]->set("noise", false), fmi2OK);
    EXPECT_EQ(instances[i]->set("input_at", i < taylor ? "end" : "start"), fmi2OK);
    instances[i]->begin();
  }
  double largest = 0.0;  // error of the wheel load with a late road [N]
  for (int k = 0; k < 400; ++k) {
    for (std::size_t i = 0; i < ways; ++i) {
      const double t = (i <= right_positions ? k + 1 : k) * period, z = height * std::sin(omega * t);
      give(*instances[i], i == right_positions || i == line
                              ? Motion{z, 0.0, 0.0}
                              : Motion{z, height * omega * std::cos(omega * t), -omega * omega * z});
      ASSERT_EQ(instances[i]->step(k * period, period), fmi2OK) << instances[i]->logged();
    }
    const double z = height * std::sin(omega * ((k + 1) * period)), load = instances[right]->real("F_w");
    ASSERT_EQ(instances[right]->real("z_r"), z);
    ASSERT_EQ(instances[late]->real("z_r"), height * std::sin(omega * (k * period)));
    ASSERT_NEAR(instances[taylor]->real("z_r"), z, by_taylor + rounding) << k;
    ASSERT_NEAR(instances[taylor]->real("F_w"), load,
                1.005 * (tyre_stiffness * by_taylor + tyre_damping * rate_by_taylor) + rounding)
        << k;
    largest = std::max(largest, std::abs(instances[late]->real("F_w") - load));
    if (k == 0) continue;  // one position makes no line
    ASSERT_NEAR(instances[line]->real("z_r"), z, by_line + rounding) << k;
    ASSERT_NEAR(instances[line]->real("F_w"), instances[right_positions]->real("F_w"),
                1.005 * tyre_stiffness * by_line + rounding)
        << k;
  }
  EXPECT_GT(largest, 1.0);
}

// Fault. A kerb is a step of the road, beyond which the line through two positions goes twice as high. A kerb that the
// rig bears ends no run, although the rig would not bear the predicted one.
TEST(Fmu, APredictionEndsNoRun) {
  const FmuFile fmu(rig_file("paper_rig_fdva"));
  const auto bears = [&fmu](const char* input_at, const std::vector<double>& kerb) {
    FmuInstance instance(fmu);
    EXPECT_EQ(instance.set("road", "input"), fmi2OK);
    EXPECT_EQ(instance.set("input_at", input_at), fmi2OK);
    instance.begin();
    int k = 0;
    for (; k < 10; ++k) EXPECT_EQ(instance.step(k * 0.001, 0.001), fmi2OK);
    for (const double height : kerb) {
      EXPECT_EQ(instance.set("excitation.position", height), fmi2OK);
      if (instance.step(k++ * 0.001, 0.001) != fmi2OK) return false;
    }
    return true;
  };
  bool met = false;
  for (double height = 1e-4; height < 1.0 && !met; height *= 1.2) {
    met = bears("end", {height, height}) && !bears("end", {height, 2.0 * height});
    if (met) {
      EXPECT_TRUE(bears("start", {height})) << height;
    }
  }
  EXPECT_TRUE(met) << "no kerb is within the limits whose prediction is not";
}

// Between communication points that are no samples, and within long steps, the prediction is what a sample keeps.
TEST(Fmu, PredictsSamplesBetweenCommunicationPoints) {
  const FmuFile fmu(rig_file("paper_hil_fdva"));
  FmuInstance instance(fmu);
  EXPECT_EQ(instance.set("road", "input"), fmi2OK);
  EXPECT_EQ(instance.set("noise", false), fmi2OK);
  instance.begin();
  give(instance, {1e-4, 2e-2, 4.0});
  const auto predicted = [](double ahead) { return 1e-4 + 2e-2 * ahead + 2.0 * ahead * ahead; };
  ASSERT_EQ(instance.step(0.0, 0.0025), fmi2OK);
  EXPECT_DOUBLE_EQ(instance.real("z_r"), predicted(0.002));
  give(instance, {0.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(instance.real("z_r"), predicted(0.002)) << "the sample was before these inputs";
  give(instance, {1e-4, 2e-2, 4.0});
  ASSERT_EQ(instance.step(0.0025, 0.001), fmi2OK);
  EXPECT_DOUBLE_EQ(instance.real("z_r"), predicted(0.0005));
  ASSERT_EQ(instance.step(0.0035, 0.0005), fmi2OK);
  EXPECT_DOUBLE_EQ(instance.real("z_r"), predicted(0.0005));
  give(instance, {5e-5, 0.0, 0.0});
  EXPECT_EQ(instance.real("z_r"), 5e-5);
  FmuInstance wrong(fmu);
  EXPECT_EQ(wrong.set("input_at", "middle"), fmi2OK);
  EXPECT_EQ(wrong.set_up(), fmi2OK);
  EXPECT_EQ(wrong.enter(), fmi2OK);
  EXPECT_EQ(wrong.exit(), fmi2Error);
  EXPECT_NE(wrong.logged().find("input_at is 'middle', expected start or end"), std::string::npos) << wrong.logged();
}

// A state is the whole state: the run goes on from it with the same bits, in the same instance, in another one after
// serialisation, on a road and driven from outside.
TEST(Fmu, GoesOnFromAState) {
  const FmuFile fmu_(rig_file("paper_hil_fdva"));
  for (const char* road : {"iso8608:B", "input"}) {
    SCOPED_TRACE(road);
    FmuInstance first(fmu_), second(fmu_);
    const auto steps = [](FmuInstance& instance, int from, int to) {
      std::vector<double> seen;
      for (int k = from; k < to; ++k) {
        EXPECT_EQ(instance.set("excitation.position", 1e-4 * std::sin(0.1 * k)), fmi2OK);
        EXPECT_EQ(instance.set("excitation.velocity", 1e-2 * std::cos(0.1 * k)), fmi2OK);
        EXPECT_EQ(instance.step(k * 0.001, 0.001), fmi2OK) << instance.logged();
        for (const char* name : {"F_w", "x_act", "F", "z_b"}) seen.push_back(instance.real(name));
      }
      return seen;
    };
    EXPECT_EQ(first.set("road", road), fmi2OK);
    first.begin();
    (void)steps(first, 0, 100);
    fmi2FMUstate state = nullptr;
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2GetFMUstate)(first.component(), &state), fmi2OK);
    const std::vector<double> once = steps(first, 100, 200);
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SetFMUstate)(first.component(), state), fmi2OK);
    EXPECT_EQ(steps(first, 100, 200), once);

    std::size_t size = 0;
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SerializedFMUstateSize)(first.component(), state, &size), fmi2OK);
    std::vector<char> bytes(size);
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SerializeFMUstate)(first.component(), state, bytes.data(), size), fmi2OK);
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2SerializeFMUstate)(first.component(), state, bytes.data(), size - 1), fmi2Error);
    fmi2FMUstate again = nullptr;
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2DeSerializeFMUstate)(second.component(), bytes.data(), size, &again), fmi2OK);
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SetFMUstate)(second.component(), again), fmi2OK) << second.logged();
    EXPECT_EQ(steps(second, 100, 200), once);
    bytes[size / 2] ^= 1;
    fmi2FMUstate damaged = nullptr;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2DeSerializeFMUstate)(second.component(), bytes.data(), size, &damaged), fmi2Error);
    EXPECT_NE(second.logged().find("damaged"), std::string::npos);
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2FreeFMUstate)(first.component(), &state), fmi2OK);
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2FreeFMUstate)(second.component(), &again), fmi2OK);
    EXPECT_EQ(state, nullptr);
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2SetFMUstate)(first.component(), nullptr), fmi2Error);
  }
}

// A state between the inputs of an instant and its outputs, and one before those inputs: both show what their instance
// showed.
TEST(Fmu, AStateKnowsWhetherInputsWereSet) {
  const FmuFile fmu_(rig_file("paper_hil_fdva"));
  for (const bool set : {false, true}) {
    FmuInstance first(fmu_), second(fmu_);
    EXPECT_EQ(first.set("road", "input"), fmi2OK);
    first.begin();
    for (int k = 0; k < 5; ++k) {
      EXPECT_EQ(first.set("excitation.position", 1e-5 * k), fmi2OK);
      ASSERT_EQ(first.step(k * 0.001, 0.001), fmi2OK);
    }
    if (set) {
      EXPECT_EQ(first.set("excitation.position", 1e-4), fmi2OK);
    }
    fmi2FMUstate state = nullptr, again = nullptr;
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2GetFMUstate)(first.component(), &state), fmi2OK);
    std::size_t size = 0;
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SerializedFMUstateSize)(first.component(), state, &size), fmi2OK);
    std::vector<char> bytes(size);
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SerializeFMUstate)(first.component(), state, bytes.data(), size), fmi2OK);
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2DeSerializeFMUstate)(second.component(), bytes.data(), size, &again), fmi2OK);
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SetFMUstate)(second.component(), again), fmi2OK) << second.logged();
    EXPECT_DOUBLE_EQ(first.real("z_r"), set ? 1e-4 : 5e-5);
    EXPECT_EQ(second.real("z_r"), first.real("z_r"));
    ASSERT_EQ(RIGTWIN_FMU_CALL(fmi2SetFMUstate)(first.component(), state), fmi2OK);
    EXPECT_EQ(first.real("z_r"), second.real("z_r"));
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2FreeFMUstate)(first.component(), &state), fmi2OK);
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2FreeFMUstate)(second.component(), &again), fmi2OK);
  }
}

// The state machine: each call where it is allowed, and an error where it is not, after which the run goes on.
TEST(Fmu, FollowsTheStateMachine) {
  const FmuFile fmu(rig_file("paper_linear"));
  FmuInstance instance(fmu);
  ASSERT_NE(instance.component(), nullptr) << instance.logged();
  double value = 0.0;
  EXPECT_EQ(instance.exit(), fmi2Error);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi2Error);
  EXPECT_NE(instance.logged().find("a step is not allowed before initialisation"), std::string::npos);
  EXPECT_EQ(instance.terminate(), fmi2Error);
  EXPECT_EQ(instance.get("F_w", value), fmi2Error);
  EXPECT_EQ(instance.set_up(not_a_number), fmi2Error);
  EXPECT_EQ(instance.set_up(), fmi2OK);
  EXPECT_EQ(instance.enter(), fmi2OK);
  EXPECT_EQ(instance.set_up(), fmi2Error);
  EXPECT_EQ(instance.enter(), fmi2Error);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi2Error);
  EXPECT_EQ(instance.get("F_w", value), fmi2OK) << "the first sample is known in initialisation mode";
  EXPECT_EQ(instance.exit(), fmi2OK);
  EXPECT_EQ(instance.exit(), fmi2Error);
  EXPECT_EQ(instance.set("seed", 2), fmi2Error);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi2OK);
  EXPECT_EQ(instance.terminate(), fmi2OK);
  EXPECT_EQ(instance.get("F_w", value), fmi2OK);
  EXPECT_EQ(instance.step(0.001, 0.001), fmi2Error);
  EXPECT_EQ(instance.set("excitation.position", 0.0), fmi2Error);
  EXPECT_EQ(instance.reset(), fmi2OK);
  instance.begin();
  EXPECT_EQ(instance.real("F_w"), instance.real("F_w"));
  EXPECT_EQ(instance.step(0.0, 0.001), fmi2OK);
  EXPECT_EQ(instance.real("F_w"), value) << "reset begins the same run again";
}

// Steps: whole periods are counted without drift; others show the newest sample; impossible ones are refused.
TEST(Fmu, CountsPeriods) {
  const FmuFile fmu(rig_file("paper_linear"));
  FmuInstance added(fmu), broken(fmu), whole(fmu);
  for (FmuInstance* instance : {&added, &broken, &whole}) instance->begin();
  double t = 0.0;
  for (int k = 0; k < 3000; ++k, t += 0.001) ASSERT_EQ(added.step(t, 0.001), fmi2OK);  // t is 3.0 + rounding
  ASSERT_EQ(whole.step(0.0, 3.0), fmi2OK);
  EXPECT_EQ(added.real("F_w"), whole.real("F_w"));
  for (int k = 0; k < 7500; ++k) ASSERT_EQ(broken.step(k * 0.0004, 0.0004), fmi2OK) << broken.logged();
  EXPECT_EQ(broken.real("F_w"), whole.real("F_w"));
  ASSERT_EQ(broken.step(3.0, 0.0009), fmi2OK);
  EXPECT_EQ(broken.real("F_w"), whole.real("F_w")) << "the newest sample is still that of t = 3 s";
  ASSERT_EQ(broken.step(3.0009, 0.0002), fmi2OK);
  ASSERT_EQ(whole.step(3.0, 0.001), fmi2OK);
  EXPECT_EQ(broken.real("F_w"), whole.real("F_w"));
  for (const double size : {0.0, -0.001, not_a_number, std::numeric_limits<double>::infinity(), 1e300}) {
    EXPECT_EQ(whole.step(3.001, size), fmi2Error) << size;
  }
  EXPECT_EQ(whole.step(3.002, 0.001), fmi2Error);
  EXPECT_NE(whole.logged().find("expected 3.001, where the last step ended"), std::string::npos) << whole.logged();
  EXPECT_EQ(whole.step(3.001, 0.001), fmi2OK) << "a refused step changes nothing";
}

// A run that the firmware ends: the step is discarded, and the importer learns when and why.
TEST(Fmu, SaysWhereTheFirmwareEndedTheRun) {
  const FmuFile fmu_(rig_file("paper_rig_fdva"));
  FmuInstance instance(fmu_);
  EXPECT_EQ(instance.set("road", "input"), fmi2OK);
  instance.begin();
  ASSERT_EQ(instance.step(0.0, 0.01), fmi2OK);
  EXPECT_EQ(instance.set("excitation.position", 10.0), fmi2OK);
  EXPECT_EQ(instance.step(0.01, 0.01), fmi2Discard);
  EXPECT_NE(instance.logged().find("the firmware ended the run: "), std::string::npos) << instance.logged();
  fmi2Boolean ended = 0;
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2GetBooleanStatus)(instance.component(), fmi2Terminated, &ended), fmi2OK);
  EXPECT_EQ(ended, 1);
  double last = 0.0;
  EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2GetRealStatus)(instance.component(), fmi2LastSuccessfulTime, &last), fmi2OK);
  EXPECT_NEAR(last, 0.01, 0.0051);
  EXPECT_FALSE(instance.boolean("running"));
  EXPECT_GT(instance.integer("reason"), 0);
  EXPECT_NE(instance.text("reason_name"), "none");
  EXPECT_EQ(instance.step(last, 0.01), fmi2Discard);
}

// What cannot be an instance is none, and the log says why.
TEST(Fmu, RefusesForeignIdentifiers) {
  const FmuFile fmu(rig_file("paper_linear"));
  const FmuInstance foreign(fmu, "0123"), exchange(fmu, fmu.guid(), fmi2ModelExchange);
  EXPECT_EQ(foreign.component(), nullptr);
  EXPECT_NE(foreign.logged().find("the GUID is 0123, expected " + fmu.guid()), std::string::npos) << foreign.logged();
  EXPECT_EQ(exchange.component(), nullptr);
  FmuInstance instance(fmu);
  EXPECT_EQ(instance.set("road", "motorway"), fmi2OK);
  EXPECT_EQ(instance.set("speed", not_a_number), fmi2Error);
  EXPECT_EQ(instance.set("F_w", 1.0), fmi2Error);
  EXPECT_EQ(instance.set("road", 1.0), fmi2Error);
  EXPECT_NE(instance.logged().find("road is a String"), std::string::npos) << instance.logged();
  EXPECT_EQ(instance.set_up(), fmi2OK);
  EXPECT_EQ(instance.enter(), fmi2OK);
  EXPECT_EQ(instance.exit(), fmi2Error);
  EXPECT_NE(instance.logged().find("road is 'motorway', expected"), std::string::npos) << instance.logged();
  EXPECT_EQ(instance.set("road", "iso8608:C"), fmi2OK);
  EXPECT_EQ(instance.exit(), fmi2OK);
}

// The log is text as it stands: an importer need not format it, and one that does sees the same.
TEST(Fmu, LogsPlainText) {
  const FmuFile fmu(rig_file("paper_linear"));
  FmuInstance instance(fmu);
  EXPECT_EQ(instance.step(0.0, 0.001), fmi2Error);
  EXPECT_EQ(instance.unformatted(), "a step is not allowed before initialisation");
  EXPECT_EQ(instance.logged(), instance.unformatted());
  EXPECT_EQ(instance.set("road", "100%s#1"), fmi2OK);
  EXPECT_EQ(instance.set_up(), fmi2OK);
  EXPECT_EQ(instance.enter(), fmi2OK);
  EXPECT_EQ(instance.exit(), fmi2Error);
  EXPECT_NE(instance.unformatted().find("road is '100%%s##1', expected"), std::string::npos);
  EXPECT_NE(instance.logged().find("road is '100%s##1', expected"), std::string::npos) << instance.logged();
}

// An importer looks for every function of co-simulation when it loads the library.
TEST(Fmu, ExportsEveryFunction) {
  const FmuFile fmu(rig_file("paper_linear"));
  EXPECT_EQ(std::set<std::string>(support::fmi2_functions.begin(), support::fmi2_functions.end()).size(), 34U);
  for (const char* name : support::fmi2_functions) EXPECT_NE(fmu.function<void()>(name), nullptr) << name;
}

// The GUID is the hash of the description, so that anybody can tell which rig an FMU is; the same rig, the same bytes.
TEST(Fmu, BelongsToOneDescription) {
  const FmuFile one(rig_file("paper_linear")), again(rig_file("paper_linear")), other(rig_file("paper_rig_fdva"));
  EXPECT_EQ(one.guid(), firmware::sha256(TemporaryFolder::read(rig_file("paper_linear"))));
  EXPECT_NE(one.guid(), other.guid());
  EXPECT_EQ(TemporaryFolder::read(one.file()), TemporaryFolder::read(again.file()));
  // A curve in a file of its own is inside the FMU, and another curve is another rig.
  const FmuFile table(rig_file("measured_damper"));
  FmuInstance instance(table);
  ASSERT_NE(instance.component(), nullptr) << instance.logged();
  instance.begin();
  EXPECT_EQ(instance.step(0.0, 0.1), fmi2OK);
  const TemporaryFolder folder;
  const std::string text = TemporaryFolder::read(rig_file("paper_linear")) +
                           "\n[laws.damper]\nplace = 'suspension'\nover = 'velocity'\nfile = 'damper.csv'\n";
  const auto rig = folder.write("rig.toml", text);
  folder.write("damper.csv", "-1,-900\n1,900\n");
  const FmuFile soft(rig);
  folder.write("damper.csv", "-1,-900\n1,901\n");
  const FmuFile stiff(rig);
  EXPECT_NE(soft.guid(), stiff.guid());
  EXPECT_EQ(stiff.guid(), firmware::sha256(TemporaryFolder::read(stiff.root() / "resources" / "rig.toml")));
}

// Errors of the command line, by the contract.
TEST(Fmu, LeavesNothingBehindAnError) {
  const TemporaryFolder folder;
  EXPECT_EQ(rigtwin({"fmu", "--rig", folder / "none.toml", "--out", folder / "rig.fmu"}).status, 3);
  EXPECT_EQ(rigtwin({"fmu", "--rig", rig_file("paper_linear")}).status, 2);
  EXPECT_EQ(rigtwin({"fmu", "--rig", rig_file("paper_linear"), "--out", folder / "rig.fmu", "--fmi", "4"}).status, 2);
  EXPECT_EQ(rigtwin({"fmu", "--rig", rig_file("paper_linear"), "--out", folder / "no" / "rig.fmu"}).status, 4);
  EXPECT_EQ(rigtwin({"fmu", "--rig", rig_file("paper_linear"), "--out", "/dev/full"}).status, 4);
  EXPECT_EQ(folder.count(), 0U);
  const Ended json = rigtwin({"fmu", "--rig", rig_file("paper_linear"), "--out", folder / "rig.fmu", "--json", "-"});
  EXPECT_EQ(json.status, 0);
  EXPECT_EQ(json.output.front(), '{');
  EXPECT_NE(json.output.find("\"guid\""), std::string::npos);
}

// The standard's own schema, where it is at hand.
TEST(Fmu, IsValidByTheSchemaOfTheStandard) {
  if (std::system("command -v xmllint >/dev/null") != 0) GTEST_SKIP() << "xmllint is missing";
  bool any = false;
  for (const int version : {2, 3}) {
    const auto schema = support::shared / "fmi" / ("fmi" + std::to_string(version) + "ModelDescription.xsd");
    if (!std::filesystem::exists(schema)) continue;
    any = true;
    for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "paper_linear"}) {
      const FmuFile fmu(rig_file(name), version);
      const std::string command =
          "xmllint --noout --schema '" + schema.string() + "' '" + (fmu.root() / "modelDescription.xml").string() + "'";
      EXPECT_EQ(std::system(command.c_str()), 0) << name << ", FMI " << version;
    }
  }
  if (!any) GTEST_SKIP() << "no schema in " << support::shared / "fmi";
}

// Nothing but the functions of FMI is shown, and nothing but the C library is needed: any importer can load it.
TEST(Fmu, StandsAlone) {
  const FmuFile fmu(rig_file("paper_linear"));
  const std::string library = "'" + fmu.library().string() + "'";
  EXPECT_NE(std::system(("nm -D --defined-only " + library + " | grep -v ' fmi[23]'").c_str()), 0);
  EXPECT_NE(std::system(
                ("readelf -d " + library + " | grep -E 'TEXTREL|R(UN)?PATH|NEEDED' | grep -vE 'lib(c|m)\\.so|ld-linux'")
                    .c_str()),
            0);
}

}  // namespace
