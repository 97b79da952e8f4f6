// The sampled loop: the model's own step as a matrix.
#include "host_sim/stability/roots/sampled_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/stability/margins/analysis.hpp"
#include "model/rig/rig_model.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using namespace host_sim::stability;
using stability_tests::described;
using stability_tests::fdva_rig;
using stability_tests::linear_rig;
using stability_tests::random_rig;
using stability_tests::Rig;

// Golden. With 1 ms steps and a held force the linear component at b̃ = 0 is stable with 14 samples of delay and
// unstable with 15, although the continuous loop bears 15.25 ms.
TEST(SampledLoop, IsStableWith14SamplesAndUnstableWith15) {
  EXPECT_LT(sampled_loop(linear_rig(), 1e-3, 0.014, {}).spectral_radius, 1.0);
  EXPECT_GT(sampled_loop(linear_rig(), 1e-3, 0.015, {}).spectral_radius, 1.0);
}

// Law. Hold and sampling act like half a step: the critical delay falls by T/2, within what the next order of T leaves.
TEST(SampledLoop, AddsHalfAStep) {
  for (const double rate : {500.0, 1000.0, 4000.0}) {
    SCOPED_TRACE(rate);
    const StabilityAnalysis a = analyse(described(linear_rig(0.010), rate));
    ASSERT_TRUE(a.sampled && a.sampled->added_delay);
    EXPECT_NEAR(*a.sampled->added_delay * rate, 0.5, 0.02);
    EXPECT_NEAR(*a.sampled->critical_delay + *a.sampled->added_delay, *a.margins.critical_delay, 1e-15);
    // There the largest eigenvalue is on the circle, and just beside it on either side.
    const auto radius = [&](double delay) { return sampled_loop(linear_rig(), 1.0 / rate, delay, {}).spectral_radius; };
    EXPECT_NEAR(radius(*a.sampled->critical_delay), 1.0, 1e-9);
    EXPECT_LT(radius(0.99 * *a.sampled->critical_delay), 1.0);
    EXPECT_GT(radius(1.01 * *a.sampled->critical_delay), 1.0);
  }
}

// Law. With a short period the eigenvalues are e^{sT} of the loop with half a step more delay.
TEST(SampledLoop, TendsToTheContinuousLoop) {
  const double period = 1e-4;
  for (const Rig& rig : {linear_rig(), fdva_rig(), random_rig(4, true), random_rig(8, true)}) {
    const LinearRig linear = linearise(rig);
    const Rig step = linear_part(rig);
    const SampledLoop loop = sampled_loop(step, period, linear.machine_delay, {});
    const Complex expected = characteristic_roots(linear.equation(linear.delay() + 0.5 * period), -60.0).rightmost();
    double nearest = 1e300;
    for (const Complex lambda : loop.eigenvalues)
      nearest = std::min(nearest, std::abs(std::log(lambda) / period - expected));
    EXPECT_LT(nearest, 2e-3 * std::abs(expected));
  }
}

// Law. The matrix takes any state of the model where its step takes it; all linear effects at once, whole and broken
// delays. (step_matrix itself runs model and matrix side by side and throws where they part.)
TEST(SampledLoop, HoldsTheWholeStateOfTheModel) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const Rig rig = linear_part(random_rig(seed, true));
    model::MachinePath<double> path{};
    rig.effects.act_on(path);
    EXPECT_NO_THROW(static_cast<void>(step_matrix(rig, 1e-3, path.delay)));
    EXPECT_NO_THROW(static_cast<void>(step_matrix(rig, 1e-3, 0.007)));
    EXPECT_NO_THROW(static_cast<void>(step_matrix(rig, 1e-3, 0.0)));
  }
  // A delayed sensor of another channel is no part of the loop, and its line not taken for that of F.
  Rig two = linear_rig();
  two.effects.add(model::Channel::z_w, model::SensorDelay<double>{0.004});
  two.effects.add(model::Channel::F, model::SensorDelay<double>{0.0025});
  const StepMatrix step = step_matrix(linear_part(two), 1e-3, 0.010);
  two.effects.get<model::SensorDelay>(model::Channel::z_w).active = false;
  EXPECT_EQ(step.matrix, step_matrix(linear_part(two), 1e-3, 0.010).matrix);
}

// Fault. A rig that is not linear is no matrix, and that is noticed.
TEST(SampledLoop, NoticesThatAStepIsNotLinear) {
  EXPECT_THROW(static_cast<void>(step_matrix(fdva_rig(), 1e-3, 0.010)), std::logic_error);
  Rig friction = linear_rig();
  friction.effects.add(model::CoulombFriction<double>{500.0});
  EXPECT_THROW(static_cast<void>(step_matrix(friction, 1e-3, 0.010)), std::logic_error);
}

// Law. The spectral radius is the growth of the model itself, run freely until only the largest eigenvalue is left.
TEST(SampledLoop, RadiusIsTheGrowthOfTheModelRunFreely) {
  const Rig rig = linear_part(fdva_rig(0.010, 700.0));
  const double radius = sampled_loop(rig, 1e-3, 0.010, {}).spectral_radius;
  const model::RigModel<> model(rig, 1e-3);
  auto x = model.start();
  model::RigModel<>::Input in;
  in.foot_point.position = 1e-3;
  const auto size = [&] {  // the largest of a few turns, which are 74 samples long
    double largest = 0.0;
    for (int k = 0; k < 740; ++k) {
      model.step(x, in);
      largest = std::max(largest, std::abs(model.deflection(x).velocity));
    }
    return largest;
  };
  for (int k = 0; k < 4; ++k) static_cast<void>(size());
  const double first = size(), second = size();
  EXPECT_NEAR(std::log(second / first) / 740.0, std::log(radius), 0.02 * std::log(radius));
}

// Fault. A delay beyond the model's line is refused here and left open in the analysis, not guessed.
TEST(SampledLoop, RefusesADelayBeyondTheLine) {
  EXPECT_THROW(static_cast<void>(step_matrix(linear_rig(), 1e-3, 0.6)), UnfitLoop);
  auto description = described(linear_rig(0.4));
  description.delay_budget.transport = 0.3;
  const StabilityAnalysis a = analyse(description);
  EXPECT_FALSE(a.sampled);
  EXPECT_FALSE(a.stable);
}

}  // namespace
