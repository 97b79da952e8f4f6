// What travels, what is refused, and what is compared.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"
#include "host_sim/transfer/predict/outcome.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

namespace transfer = host_sim::transfer;
using host_sim::Response;
using model::Channel;

// Point. The component travels; machine, sensors, guides, body, wheel and tyre stay.
TEST(TransferComponent, KnowsWhatTravels) {
  for (const char* path : {"suspension.stiffness", "fdva.oil_viscosity", "effects.seal_friction.force",
                           "effects.top_mount.stiffness", "effects.relaxation.time_constant"}) {
    EXPECT_TRUE(transfer::travels(path)) << path;
  }
  for (const char* path : {"machine.virtual_damping", "body.mass", "tyre.stiffness", "effects.actuator_delay.delay",
                           "effects.moving_mass.mass", "effects.sensor_lag.F.time_constant",
                           "effects.body_guide_friction.force", "effects.progressive_tyre.cubic_stiffness"}) {
    EXPECT_FALSE(transfer::travels(path)) << path;
  }
}

std::string refusal(const firmware::RigDescription& from, const firmware::RigDescription& to) {
  try {
    (void)transfer::check_same_component(from, to);
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "";
}

// Fault. Two descriptions of different components are refused with the parameter's name; a damper of the car beside the
// component and another number of open ducts are remarks.
TEST(TransferComponent, RefusesAnotherComponent) {
  const firmware::RigDescription from = support::rig("paper_hil_fdva"), to = support::rig("paper_rig_fdva");
  EXPECT_EQ(refusal(from, to), "");
  const auto remarks = transfer::check_same_component(from, to);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("the virtual damping of the first"), std::string::npos) << remarks[0];

  auto other = to;
  other.rig.fdva.oil_viscosity *= 1.01;
  EXPECT_NE(refusal(from, other).find("fdva.oil_viscosity is"), std::string::npos) << refusal(from, other);
  EXPECT_NE(refusal(from, other).find(":" + std::to_string(to.line_of("fdva.oil_viscosity"))), std::string::npos);
  other = to;
  other.rig.suspension.damping = -1.0;
  EXPECT_NE(refusal(from, other).find("suspension.damping is"), std::string::npos);
  other = to;
  firmware::put_effect(other.rig, {firmware::find_effect("seal_friction"), std::nullopt, {25.0}});
  EXPECT_NE(refusal(from, other).find("effects.seal_friction is described here only"), std::string::npos);
  EXPECT_NE(refusal(other, to).find("effects.seal_friction is missing"), std::string::npos);
  auto another = other;
  firmware::put_effect(another.rig, {firmware::find_effect("seal_friction"), std::nullopt, {26.0}});
  EXPECT_NE(refusal(other, another).find("effects.seal_friction.force is 26"), std::string::npos);
  other = to;
  other.rig.has_fdva = false;
  EXPECT_NE(refusal(from, other).find("[fdva] is missing"), std::string::npos);
  other = to;
  other.rig.fdva.open_ducts = 3;
  EXPECT_EQ(transfer::check_same_component(from, other).size(), 2U);
}

// Point. (1), (2): stiffness and effects are carried over, of damping what was learned; the delay stays.
TEST(TransferComponent, PutsTheComponentIntoTheSecondRig) {
  const firmware::RigDescription from = support::rig("paper_hil_fdva"), to = support::rig("paper_rig_fdva");
  host_sim::identification::Hypothesis learned{from.rig, {}};
  learned.rig.suspension.stiffness = 30000.0;
  learned.rig.suspension.damping = 50.0;
  learned.rig.fdva.oil_viscosity = 35e-6;
  firmware::put_effect(learned.rig, {firmware::find_effect("seal_friction"), std::nullopt, {25.0}});
  learned.rig.body.mass = 1.0;
  auto rig = transfer::with_component(to.rig, from.rig, learned);
  EXPECT_EQ(rig.suspension.stiffness, 30000.0);
  EXPECT_EQ(rig.suspension.damping, 1190.0);
  EXPECT_EQ(rig.fdva.oil_viscosity, 35e-6);
  EXPECT_EQ(rig.body.mass, to.rig.body.mass);
  ASSERT_NE(firmware::find_parameter(rig, "effects.seal_friction.force"), nullptr);
  EXPECT_EQ(*firmware::find_parameter(rig, "effects.seal_friction.force"), 25.0);
  EXPECT_EQ(firmware::find_parameter(rig, "effects.actuator_delay.delay"), nullptr);
}

// Golden. ISO 2631-1:1997, table 3, W_k in thousandths: the formulas reproduce it to the last digit or two.
TEST(TransferOutcome, WeighsAsTheStandardDoes) {
  const std::vector<std::pair<double, double>> table{{0.5, 0.418},  {1.0, 0.482},  {2.0, 0.531},  {4.0, 0.967},
                                                     {5.0, 1.039},  {6.3, 1.054},  {8.0, 1.036},  {10.0, 0.988},
                                                     {16.0, 0.768}, {25.0, 0.513}, {63.0, 0.186}, {80.0, 0.132}};
  for (const auto& [f, weight] : table) EXPECT_NEAR(transfer::vertical_weighting(f), weight, 0.006) << f << " Hz";
  EXPECT_EQ(transfer::vertical_weighting(0.0), 0.0);
}

// Point. A rig whose channels are multiples of the road: responses are those multiples, rms values follow.
TEST(TransferOutcome, FindsResponsesAndLevels) {
  std::vector<double> road(20000);
  for (std::size_t k = 0; k < road.size(); ++k) {
    const double t = static_cast<double>(k) * 1e-3;
    for (int i = 1; i < 200; ++i) road[k] += 1e-3 * std::sin(2.0 * 3.141592653589793 * 0.15 * i * t + i * i);
  }
  const transfer::Analysis analysis({road}, 1000.0, 3000.0);
  Response run;
  double squares = 0.0, peak = 0.0, mean = 0.0;
  for (const double z : road) mean += z / 20000.0;
  for (const double z : road) {
    run[index(Channel::F_w)].push_back(2e5 * z);
    run[index(Channel::zdd_b)].push_back(-30.0 * z);
    run[index(Channel::dz_b)].push_back(0.5 * z);
    squares += (z - mean) * (z - mean);
    peak = std::max(peak, std::abs(z - mean));
  }
  const double rms = std::sqrt(squares / 20000.0);
  const transfer::Outcome outcome = analysis.of({&run, 1});
  ASSERT_EQ(outcome.response[0].size(), analysis.frequencies().size());
  EXPECT_NEAR(analysis.frequencies().front(), 0.5, 1e-9);
  EXPECT_NEAR(analysis.frequencies().back(), 25.0, 0.26);
  for (std::size_t k = 0; k < outcome.response[0].size(); ++k) {
    EXPECT_NEAR(std::abs(outcome.response[0][k] / 2e5 - 1.0), 0.0, 1e-9);
    EXPECT_NEAR(std::abs(outcome.response[1][k] / -30.0 - 1.0), 0.0, 1e-9);
  }
  EXPECT_NEAR(outcome.quantity[0] / (2e5 * rms), 1.0, 1e-9);
  EXPECT_NEAR(outcome.quantity[1] / (2e5 * rms / 3000.0), 1.0, 1e-9);
  EXPECT_NEAR(outcome.quantity[2] / (30.0 * rms), 1.0, 1e-9);
  EXPECT_LT(outcome.quantity[3], 1.06 * outcome.quantity[2]);
  EXPECT_NEAR(outcome.quantity[4] / (0.5 * rms), 1.0, 1e-9);
  EXPECT_NEAR(outcome.quantity[5] / (0.5 * peak), 1.0, 1e-9);
}

}  // namespace
