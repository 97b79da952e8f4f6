// A step of a drive through the motion of the wheel.
#include "host_sim/replicate/motion_inverse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road.hpp"
#include "host_sim/replicate/band_inverse.hpp"
#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/replicate/target.hpp"
#include "tests/support/rig_texts.hpp"

namespace motion_inverse_test {
namespace {

using firmware::RigDescription;
using host_sim::replicate::BandInverse;
using host_sim::replicate::DriveModel;
using host_sim::replicate::MotionInverse;
using host_sim::replicate::Target;
using model::Channel;
namespace replicate = host_sim::replicate;

RigDescription car(const std::string& more) {
  return firmware::parse_rig(support::rig("paper_rig_fdva").text +
                                 "[effects.actuator_delay]\ndelay = 0.0044\n[effects.actuator_lag]\ntime_constant = "
                                 "0.0222\n[limits]\nspeed = 3.0\n" +
                                 more,
                             "rig.toml");
}

/// A class B road, within the band, and how a wheel moves on it: the drives of these tests.
std::vector<double> road(std::size_t size, std::uint64_t seed) {
  const firmware::IsoRoad road{.roughness = 64e-6, .speed = 27.78, .bandwidth = 30.0, .seed = seed};
  std::vector<double> z;
  for (const auto& m : firmware::drive_over(road, 1000.0, size)) z.push_back(m.position);
  return z;
}

/// A step between two drives that are known: what remains of the difference of their answers, ÷ that difference.
struct Known {
  explicit Known(const RigDescription& rig)
      : model(rig, {Channel::zdd_w}), target(target_of(rig)), inverse(model, target) {
    from = inverse.drive(target.values);
    to = from;
    const std::vector<double> other = road(from.size(), 8);
    for (std::size_t k = 0; k < to.size(); ++k) to[k] += 0.3 * other[k];
    inverse.end_at_rest(to);
    to = inverse.drive({inverse.in_band(0, DriveModel(linear(rig), model).answer(to).front())});
    error = difference(model.answer(to).front(), model.answer(from).front());
  }

  static model::RigParameters<double> linear(const RigDescription& rig) {
    return replicate::with_corners(rig.rig, 0.0);
  }
  static Target target_of(const RigDescription& rig) {
    const std::vector<double> z = road(6000, 7);
    firmware::Recording recording;
    recording.source = "target.csv";
    recording.sample_period = 1e-3;
    recording.time = firmware::sample_times(z.size(), 1000.0);
    recording[Channel::zdd_w] = DriveModel(rig, {Channel::zdd_w}).answer(z).front();
    return replicate::make_target(rig, replicate::parse_request("zdd_w", {"0.7:40"}), {recording});
  }
  [[nodiscard]] std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) const {
    std::vector<double> d = a;
    for (std::size_t k = 0; k < d.size(); ++k) d[k] -= b[k];
    return inverse.in_band(0, d);
  }
  [[nodiscard]] double left_of(const std::vector<double>& step) const {
    std::vector<double> drive = from;
    for (std::size_t k = 0; k < drive.size(); ++k) drive[k] += step[k];
    const auto left = difference(model.answer(to).front(), model.answer(drive).front());
    return replicate::rms_over(target.events, left) / replicate::rms_over(target.events, error);
  }

  DriveModel model;
  Target target;
  BandInverse inverse;
  std::vector<double> from, to, error;
};

// Law. Without corners the motion of the wheel is no detour: the step is that of the linear inverse. Left are the duct's
// quadratic losses, which the linear inverse does not know.
TEST(MotionInverse, IsTheLinearInverseOfARigWithoutCorners) {
  RigDescription rig = car("");
  rig.rig.has_fdva = false;
  const Known known(rig);
  const auto step = MotionInverse(known.model, known.inverse).drive(known.model.rig(), known.from, {known.error});
  const auto linear = known.inverse.drive({known.error});
  EXPECT_LT(known.left_of(linear), 1e-2);
  EXPECT_LT(known.left_of(step), 1e-2);
}

// Law. A drive and another one whose answer is known: with friction and a stop one step goes from one to the other.
TEST(MotionInverse, GoesThroughFrictionAndStopsInOneStep) {
  const RigDescription rig =
      car("[effects.coulomb_friction]\nforce = 80.0\n[effects.bump_stop]\nclearance = 0.008\nstiffness = 200e3\n");
  const Known known(rig);
  const auto step = MotionInverse(known.model, known.inverse).drive(known.model.rig(), known.from, {known.error});
  const double linear = known.left_of(known.inverse.drive({known.error}));
  EXPECT_GT(linear, 0.2) << "the corners are worth a test";
  EXPECT_LT(known.left_of(step), 0.5 * linear);
}

}  // namespace
}  // namespace motion_inverse_test
