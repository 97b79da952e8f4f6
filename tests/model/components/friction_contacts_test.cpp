#include "model/components/friction_contacts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/reference_road.hpp"

namespace {

using Friction = model::FrictionContacts<double>;
using State = model::Column<double, 2>;
using Columns = model::Block<double, 2, Friction::contacts>;

/// A mass of 1 kg at contact `suspension` (velocity x₀) and one of 2 kg at `piston` (x₁), not coupled, steps of 0.1 s.
Columns uncoupled() {
  Columns columns = Columns::Zero();
  columns(0, Friction::suspension) = -0.1;
  columns(1, Friction::piston) = -0.05;
  return columns;
}
double velocity(int contact, const State& x) {
  return contact == Friction::suspension ? x(0) : (contact == Friction::piston ? x(1) : 0.0);
}

// Point (1). Moving at 3 m/s without any drive: slips against 10 N to 2 m/s. At 0.5 m/s the mass comes to rest in the
// middle of the step: 10 N until then, 5 N in the mean, none at the end.
TEST(FrictionContacts, SlipWithTheirLimitAndStopWithLess) {
  const Friction friction({10.0, 0.0, 0.0, 0.0});
  for (const double sign : {1.0, -1.0}) {
    Friction::Forces forces{};
    State x(3.0 * sign, 7.0);
    friction.solve(x, State(3.0 * sign, 7.0), uncoupled(), friction.limits(), forces, velocity);
    EXPECT_NEAR(x(0), 2.0 * sign, 1e-15);
    EXPECT_EQ(forces[Friction::suspension], 10.0 * sign);
    EXPECT_EQ(x(1), 7.0) << "no friction where there is no limit";
    x(0) = 0.5 * sign;
    friction.solve(x, State(0.5 * sign, 7.0), uncoupled(), friction.limits(), forces, velocity);
    EXPECT_NEAR(x(0), 0.0, 1e-15);
    EXPECT_NEAR(forces[Friction::suspension], 0.0, 1e-14);
  }
}

// Point (1), (2). At rest and driven with 8 N (0.8 m/s a step) it sticks with 8 N; driven with 15 N it slips against
// 10, to 0.5 m/s.
TEST(FrictionContacts, StickUntilTheDriveExceedsTheLimit) {
  const Friction friction({10.0, 0.0, 0.0, 0.0});
  for (const double sign : {1.0, -1.0}) {
    Friction::Forces forces{};
    State x(0.8 * sign, 0.0);
    friction.solve(x, State(0.0, 0.0), uncoupled(), friction.limits(), forces, velocity);
    EXPECT_NEAR(x(0), 0.0, 1e-15);
    EXPECT_NEAR(forces[Friction::suspension], 8.0 * sign, 1e-14);
    x(0) = 1.5 * sign;
    friction.solve(x, State(0.0, 0.0), uncoupled(), friction.limits(), forces, velocity);
    EXPECT_NEAR(x(0), 0.5 * sign, 1e-15);
    EXPECT_EQ(forces[Friction::suspension], 10.0 * sign);
  }
}

// Point (2). A contact that turns round: from 1 m/s, driven by −30 N (to −2 m/s without friction). It slows with 40 N
// and rests after ¼ of the step, then goes back against 10 N, with 20 N: −1.5 m/s. Mean force ¼·10 − ¾·10 = −5 N.
TEST(FrictionContacts, TurnRoundWithinAStep) {
  const Friction friction({10.0, 0.0, 0.0, 0.0});
  for (const double sign : {1.0, -1.0}) {
    Friction::Forces forces{};
    State x(-2.0 * sign, 0.0);
    friction.solve(x, State(1.0 * sign, 0.0), uncoupled(), friction.limits(), forces, velocity);
    EXPECT_NEAR(x(0), -1.5 * sign, 1e-15);
    EXPECT_EQ(forces[Friction::suspension], -10.0 * sign);
  }
}

// Law. The force of the last step is only a start: what comes out does not depend on it.
TEST(FrictionContacts, ForgetTheForceOfTheLastStep) {
  const Friction friction({10.0, 4.0, 0.0, 0.0});
  Friction::Forces cold{}, warm{-10.0, 4.0, 0.0, 0.0};
  const State start(0.3, 0.0);
  State a(0.5, -0.1), b(0.5, -0.1);
  friction.solve(a, start, uncoupled(), friction.limits(), cold, velocity);
  friction.solve(b, start, uncoupled(), friction.limits(), warm, velocity);
  EXPECT_LT((a - b).norm(), 1e-15);
  EXPECT_NEAR(cold[Friction::suspension], warm[Friction::suspension], 1e-13);
  EXPECT_NEAR(cold[Friction::piston], warm[Friction::piston], 1e-13);
}

// Law. |λ| ≤ f, and at the end of a step (1) holds at every contact, for coupled contacts, too: it rubs against the
// velocity there, or there is none. What the sweeps leave is 1e-6 of what the limit does in a step.
TEST(FrictionContacts, RubAgainstTheVelocityOfEachContact) {
  using State4 = model::Column<double, 4>;
  using Columns4 = model::Block<double, 4, Friction::contacts>;
  // Four contacts of one body each, pushing each other a little: −G symmetric, positive definite.
  Columns4 columns;
  columns << -1.0, 0.2, 0.1, 0.0, 0.2, -2.0, 0.3, 0.1, 0.1, 0.3, -1.5, 0.2, 0.0, 0.1, 0.2, -3.0;
  columns *= 1e-3;
  const Friction friction({50.0, 30.0, 70.0, 20.0});
  support::NormalNoise noise(31);
  const auto random = [&noise] { return State4(0.1 * noise(), 0.1 * noise(), 0.1 * noise(), 0.1 * noise()); };
  Friction::Forces forces{};
  int sticking = 0;
  for (int k = 0; k < 2000; ++k) {
    const State4 start = k % 2 == 0 ? random() : State4(State4::Zero());
    State4 x = start + random();
    friction.solve(x, start, columns, friction.limits(), forces,
                   [](int contact, const State4& v) { return v(contact); });
    for (int p = 0; p < Friction::contacts; ++p) {
      const double force = forces[static_cast<std::size_t>(p)], limit = friction.limits()[static_cast<std::size_t>(p)];
      EXPECT_LE(std::fabs(force), limit);
      const double rest = 1e-6 * limit * 3e-3;
      EXPECT_GE(force * x(p), -rest * limit) << "seed 31, step " << k;
      if (std::fabs(force) == limit) continue;
      ++sticking;
      EXPECT_LE(std::fabs(x(p)), rest) << "seed 31, step " << k;
    }
  }
  EXPECT_GT(sticking, 500);
}

// Fault. A contact that cannot move (a locked piston) takes no force and makes no NaN.
TEST(FrictionContacts, LeaveAContactThatCannotMove) {
  const Friction friction({0.0, 5.0, 0.0, 0.0});
  Friction::Forces forces{};
  State x(1.0, 0.0);
  friction.solve(x, State(1.0, 0.0), Columns::Zero().eval(), friction.limits(), forces, velocity);
  EXPECT_EQ(x(1), 0.0);
  EXPECT_EQ(forces[Friction::piston], 0.0);
}

}  // namespace
