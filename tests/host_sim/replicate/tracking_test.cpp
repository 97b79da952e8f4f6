// Derivatives of the rig's step, and the drive that they find.
#include "host_sim/replicate/tracking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/simulation/road.hpp"
#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/replicate/stepped_rig.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using model::Channel;
namespace tracked = host_sim::replicate;

model::RigParameters<double> tracked_car(const std::string& more = "") {
  const auto rig = support::rig("paper_rig_fdva");
  return firmware::parse_rig(rig.text + "[effects.actuator_lag]\ntime_constant = 0.0222\n" + more, "rig.toml").rig;
}

/// 3 s of a class B road.
std::vector<double> tracked_road() {
  const firmware::IsoRoad road{.roughness = 64e-6, .speed = 27.78, .bandwidth = 30.0, .seed = 3};
  std::vector<double> z;
  for (const auto& m : firmware::drive_over(road, 1000.0, 3000)) z.push_back(m.position);
  return z;
}

// Law. A step from a neighbouring state ends where the derivatives say: what is left is of second order, 1e-3 of the
// deviation here.
TEST(SteppedRig, DerivesItsStep) {
  const auto rig = tracked::stepped_rig(tracked_car(), 1e-3, {Channel::zdd_w, Channel::F_w});
  const std::size_t n = rig->states();
  rig->start();
  for (int k = 0; k < 300; ++k) rig->step(20.0 * std::sin(0.07 * k));
  tracked::LinearStep step;
  rig->derive(5.0, step);
  std::vector<double> at(n), further(n), y(2), moved(2);
  rig->keep(0);
  rig->step(5.0);
  rig->state(at.data());
  rig->read(y.data());
  rig->return_to(0);
  rig->step(6.0);
  rig->state(further.data());
  rig->read(moved.data());
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(further[i] - at[i], step.b[i], 1e-3 * std::abs(step.b[i]) + 1e-12);
  for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(moved[c] - y[c], step.d[c], 1e-3 * std::abs(step.d[c]) + 1e-9);
}

/// Error of a tracking of what the rig itself did, on its way.
std::vector<double> tracking_errors(const model::RigParameters<double>& parameters, int iterations) {
  const auto rig = tracked::stepped_rig(parameters, 1e-3, {Channel::zdd_w, Channel::F_w});
  const auto smooth =
      tracked::stepped_rig(tracked::with_corners(parameters, 0.0), 1e-3, {Channel::zdd_w, Channel::F_w});
  const tracked::DriveLimits none{1e9, 1e9, 1e9, 1e12};
  tracked::Tracking truth(*rig, 1e-3, {{{0.7, 40.0}, 1.0}}, {}, none);
  const std::vector<double> road = tracked_road();
  truth.begin(road, {std::vector<double>(road.size(), 0.0)});
  const auto target = truth.answer();
  const double size = truth.error();
  const auto again = tracked::stepped_rig(parameters, 1e-3, {Channel::zdd_w, Channel::F_w});
  tracked::Tracking tracking(*again, 1e-3, {{{0.7, 40.0}, 1.0}}, {1.0, 1e-8}, none);
  std::vector<double> half = road;
  for (double& z : half) z *= 0.5;
  tracking.begin(half, target);
  tracking.lead_by(*smooth);
  std::vector<double> errors{tracking.error() / size};
  for (int i = 0; i < iterations; ++i) {
    tracking.iterate();
    errors.push_back(tracking.error() / size);
  }
  return errors;
}

// Law. Of a rig whose only nonlinearities are losses, two iterations find the drive.
TEST(Tracking, SolvesARigWithoutCornersAtOnce) {
  const auto errors = tracking_errors(tracked_car(), 2);
  EXPECT_GT(errors.front(), 0.3);
  EXPECT_LT(errors.back(), 0.01);
}

// Law. Friction and a stop are solved too, in more iterations.
TEST(Tracking, ComesNearWithFrictionAndAStop) {
  const auto errors = tracking_errors(
      tracked_car(
          "[effects.coulomb_friction]\nforce = 60.0\n[effects.bump_stop]\nclearance = 0.008\nstiffness = 200e3\n"),
      8);
  EXPECT_LT(errors.back(), 0.2 * errors.front());
}

}  // namespace
