#include "host_sim/compensation/method_comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/compensation/comparison_report.hpp"
#include "host_sim/compensation/compensated_loop.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/sampled_loop.hpp"

namespace {

namespace compensation = host_sim::compensation;

firmware::RigDescription paper(double virtual_damping) {
  firmware::RigDescription description = firmware::read_rig("host_sim/rigs/paper_hil_fdva.toml");
  description.rig.machine.virtual_damping = virtual_damping;
  return description;
}

const compensation::MethodResult& method(const compensation::MethodComparison& all, const std::string& name) {
  return *std::find_if(all.methods.begin(), all.methods.end(), [&](const auto& m) { return m.name == name; });
}

// Law. Without a compensator the map of a period has the spectral radius of the matrix that `stability` makes of the
// whole rig's step: two ways to one loop. Both are exact but for rounding, about 1e-10 with 30 states.
TEST(CompensatedLoop, WithoutCompensatorIsTheSampledLoopOfStability) {
  for (const double damping : {0.0, 1140.0}) {
    const auto rig = host_sim::stability::linear_part(paper(damping).rig);
    const auto loop = compensation::compensated_loop(rig, 1e-3, nullptr);
    EXPECT_NEAR(loop.spectral_radius(), host_sim::stability::sampled_loop(rig, 1e-3, 0.010, {}).spectral_radius, 1e-8)
        << damping;
  }
}

// Journey. The paper's rig without virtual damping is unstable; the time series makes it stable, and its wheel-load
// peak is within 4 % of the undelayed one, also with a machine that is 20 % later. No such method needs a model of the
// component. (Where deflections are compared in place of velocities the coefficients settle elsewhere: 14 %.)
TEST(MethodComparison, KeepsThePaperRigsPeakWithoutVirtualDamping) {
  const auto comparison = compensation::compare_methods(paper(0.0));
  EXPECT_FALSE(method(comparison, "none").over_changes[0].stable);
  const auto& best = method(comparison, "adaptive_time_series");
  ASSERT_TRUE(best.over_changes[0].stable);
  EXPECT_LE(*best.over_changes[0].peak_error, 0.04);
  ASSERT_TRUE(best.over_changes[1].stable);
  EXPECT_LE(*best.over_changes[1].peak_error, 0.04);
  EXPECT_FALSE(best.needs_component_model);
  EXPECT_TRUE(method(comparison, "smith").needs_component_model);
  // What adapts bears more error of the assumed delay than what does not.
  EXPECT_GT(best.critical_error.value_or(1.0), 2.0 * *method(comparison, "inverse").critical_error);

  const auto json = compensation::to_json(comparison);
  for (const char* key : {"stable", "critical_delay_error", "peak_error", "tracking_nrmse", "needs_component_model"}) {
    EXPECT_TRUE(json["methods"]["adaptive_time_series"].contains(key)) << key;
  }
  EXPECT_TRUE(json["methods"]["none"]["peak_error"].is_null());
}

// Fault. A rig without a loop, and one whose machine is not late, are refused.
TEST(MethodComparison, RefusesRigsWithoutALateLoop) {
  auto description = paper(0.0);
  description.rig.effects = {};
  EXPECT_THROW((void)compensation::compare_methods(description), firmware::InputError);
  EXPECT_THROW((void)compensation::compare_methods(firmware::read_rig("host_sim/rigs/paper_rig_fdva.toml")),
               firmware::InputError);
}

}  // namespace
