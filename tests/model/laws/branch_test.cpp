// Branches with memory.
#include "model/laws/branch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using model::Branch;

// Point. A ramp ẋ = v: u = k v T (1 − e^{−t/T}), exactly, for steps far below and far above T.
TEST(Branch, MaxwellFollowsARampExactly) {
  for (const double period : {1e-4, 1e-3, 0.05}) {
    const double k = 8e3, time_constant = 0.02, v = 0.3;
    const Branch<double> branch({.stiffness = k, .time_constant = time_constant}, period);
    double u = 0.0;
    for (int i = 1; i <= 40; ++i) {
      u = branch.after(u, v * period);
      const double exact = k * v * time_constant * (1.0 - std::exp(-i * period / time_constant));
      EXPECT_NEAR(u, exact, 1e-12 * k * v * time_constant) << "h = " << period << ", step " << i;
    }
  }
}

// Limit. Against a time constant far beyond the record it is a spring; its force decays to 1/e in T.
TEST(Branch, MaxwellIsASpringBeforeItRelaxes) {
  const Branch<double> slow({.stiffness = 8e3, .time_constant = 1e9}, 1e-3);
  EXPECT_NEAR(slow.after(0.0, 0.01), 80.0, 1e-9);
  const Branch<double> branch({.stiffness = 8e3, .time_constant = 0.02}, 1e-3);
  double u = 100.0;
  for (int i = 0; i < 20; ++i) u = branch.after(u, 0.0);
  EXPECT_NEAR(u, 100.0 * std::exp(-1.0), 1e-10);
}

// Point. An elastic slider k, s on ±A takes 4 s (A − s/k) from each cycle, whatever the step.
TEST(Branch, SliderTakesTheWorkOfItsLoop) {
  const double k = 20e3, s = 60.0, amplitude = 0.012;
  for (const int steps : {8, 100}) {  // of each half cycle
    const Branch<double> branch({.stiffness = k, .slip_force = s}, 1e-3);
    double u = 0.0, work = 0.0;
    for (int half = 0; half < 8; ++half) {
      const double travel = (half % 2 == 0 ? 2.0 : -2.0) * amplitude / steps;
      for (int i = 0; i < steps; ++i) {
        const double free = u + k * travel, after = branch.after(u, travel);
        // exact work of a step in one direction: the spring's part, then the slider at ±s
        const double sliding = (free - after) / k;
        if (half >= 2) work += 0.5 * (u + after) * (travel - sliding) + after * sliding;
        u = after;
        EXPECT_LE(std::abs(u), s);
      }
    }
    EXPECT_NEAR(work / 3.0, 4.0 * s * (amplitude - s / k), 1e-9);
  }
}

// Point. With lost motion g the same loop is shorter by g on each side of it: 4 s (A − s/k − g/2) a cycle, exactly
// where steps end on the corners; after a reversal the force stays 0 over the whole of g.
TEST(Branch, LostMotionShortensTheLoop) {
  const double k = 20e3, s = 60.0, gap = 4e-3, amplitude = 0.012, step = 0.5e-3;  // s/k, g and A are whole steps
  const Branch<double> branch({.stiffness = k, .slip_force = s, .gap = gap}, 1e-3);
  double w = 0.0, work = 0.0, lost = 0.0;
  for (int half = 0; half < 8; ++half) {
    const double travel = half % 2 == 0 ? step : -step;
    for (int i = 0; i < std::lround((half == 0 ? 1.0 : 2.0) * amplitude / step); ++i) {
      const double before = branch.force(w);
      w = branch.after(w, travel);
      const double after = branch.force(w);
      EXPECT_LE(std::abs(after), s + 1e-12);
      if (half >= 2) work += 0.5 * (before + after) * travel;
      if (half == 3 && before == 0.0 && after == 0.0) lost += step;
    }
  }
  EXPECT_NEAR(work / 3.0, 4.0 * s * (amplitude - s / k - 0.5 * gap), 1e-9);
  EXPECT_NEAR(lost, gap, 1.01 * step);
}

}  // namespace
