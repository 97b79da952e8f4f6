// Diagnoses of the shipped rig with an active air spring, and of a rig whose ducts a policy switches: recordings of the
// control loop itself, which commands the area and the ducts.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

#include "firmware/simulation/road_choice.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

namespace identification = host_sim::identification;
using firmware::RigDescription;
using identification::Diagnosis;
using identification::Verdict;
using Hide = std::function<void(model::RigParameters<double>&)>;

/// `described` drives over a road with an effect that its description does not know of.
firmware::Recording recorded_with(const RigDescription& described, const Hide& hide, const char* over) {
  RigDescription driven = described;
  hide(driven.rig);
  const std::size_t samples = firmware::samples_of(30.0, driven.sample_rate);
  const firmware::RoadChoice road{over, 27.78, 3, std::nullopt, std::nullopt};
  const auto motion = firmware::excitation(
      driven.rig, firmware::motion_over(road, driven, samples, host_sim::read_recording), driven.sample_rate);
  host_sim::Run run = host_sim::run_closed_loop(driven, motion, {});
  EXPECT_EQ(run.trip.reason, firmware::Reason::reference_ended);
  return std::move(run.recording);
}

Diagnosis diagnosed(const RigDescription& described, const Hide& hide, const char* over = "iso8608:B") {
  return identification::diagnose(described, {{recorded_with(described, hide, over), identification::Use::shared}});
}

/// Named first, with the value of its one parameter within `relative` of the hidden one.
void expect_named(const Diagnosis& found, const std::string& name, double value, double relative) {
  EXPECT_EQ(found.verdict, Verdict::named) << identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << identification::sentence(found);
  EXPECT_EQ(found.effects[0].effect.entry->name, name);
  EXPECT_NEAR(found.effects[0].parameters[0].value / value, 1.0, relative);
}

// Law. The area that the skyhook commanded is an input of the explanation, from the recorded body of the virtual car: a
// rig that is as described shows nothing.
TEST(AirSpringDiagnosis, FindsNothingOnTheShippedRig) {
  const Diagnosis found = diagnosed(support::rig("paper_hil_aas"), [](auto&) {});
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << identification::sentence(found);
}

TEST(AirSpringDiagnosis, NamesALeak) {
  expect_named(
      diagnosed(support::rig("paper_hil_aas"), [](auto& rig) { rig.effects.add(model::AirLeak<double>{0.003}); }),
      "air_leak", 0.003, 0.05);
}

TEST(AirSpringDiagnosis, NamesAStuckArea) {
  expect_named(
      diagnosed(support::rig("paper_hil_aas"), [](auto& rig) { rig.effects.add(model::StuckArea<double>{0.02}); }),
      "stuck_area", 0.02, 0.05);
}

TEST(AirSpringDiagnosis, NamesAWrongExponent) {
  expect_named(
      diagnosed(support::rig("paper_hil_aas"), [](auto& rig) { rig.effects.add(model::GasExponent<double>{1.2}); }),
      "gas_exponent", 1.2, 0.02);
}

// Law. The component of a hil rig behind a lever moves on x_cmd as it is: the lever is one of the computed car.
TEST(AirSpringDiagnosis, FindsNothingBehindALever) {
  RigDescription rig = support::rig("paper_hil_fdva");
  rig.rig.lever.count = 3;
  rig.rig.lever.at = {-0.08, 0.0, 0.06};
  rig.rig.lever.ratio = {0.7, 0.8, 0.85};
  const Diagnosis found = diagnosed(rig, [](auto&) {});
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << identification::sentence(found);
}

// Law. Ducts that the rollout switches stand on record as the valves stood: nothing is found where nothing is, and what
// is there is named beside them. Class A: on B the cylinder reaches its speed limit, and such a kink is no motion
// between samples.
TEST(SwitchedDuctsDiagnosis, FindsNothingWhereNothingIs) {
  const Diagnosis found = diagnosed(
      support::rig("paper_rig_kalman"), [](auto&) {}, "iso8608:A");
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << identification::sentence(found);
}

TEST(SwitchedDuctsDiagnosis, NamesFrictionBesideThem) {
  expect_named(diagnosed(support::rig("paper_rig_kalman"),
                         [](auto& rig) { rig.effects.add(model::CoulombFriction<double>{40.0}); }),
               "coulomb_friction", 40.0, 0.05);
}

}  // namespace
