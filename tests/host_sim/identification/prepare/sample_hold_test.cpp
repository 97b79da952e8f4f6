// Renewals of held channels.
#include "host_sim/identification/prepare/sample_hold.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using host_sim::identification::before_hold;
using host_sim::identification::Renewals;
using host_sim::identification::renewals_of;
using host_sim::identification::taken_at;

/// A ramp that is renewed at every sample k with k − 1 < t_0 + n P ≤ k.
std::vector<double> held_ramp(double first, double turn, std::size_t count) {
  std::vector<double> samples(count, -1.0);
  for (std::size_t k = 0; k < count; ++k) {
    const double n = std::floor((static_cast<double>(k) - first) / turn);
    if (n >= 0.0) samples[k] = n;
  }
  return samples;
}

// Law (1). Renewal instants rounded up to samples give back t_0 and P within what they leave open, and that is little.
TEST(Renewals, GiveBackPeriodAndPhase) {
  for (const double turn : {4.3, 5.0, 7.77}) {
    const auto found = renewals_of(held_ramp(2.4, turn, 5000));
    ASSERT_TRUE(found) << turn;
    EXPECT_TRUE(found->regular) << turn;
    EXPECT_NEAR(found->period, turn, found->period_slack + 1e-9) << turn;
    EXPECT_LT(found->period_slack, 2.0 / (5000.0 / turn)) << turn;
    EXPECT_NEAR(found->first, 2.4, found->slack + found->period_slack * found->turn.back() + 1e-9) << turn;
    EXPECT_EQ(found->at.size(), found->turn.size());
  }
}

// Rows that were not recorded are filled in with straight lines, whose values are no renewals. A renewal inside such a
// gap shows late; it says nothing of t_0 and P, and has the number of the last turn before it shows.
TEST(Renewals, PassOverMissingSamples) {
  const double turn = 4.713;
  const std::vector<double> whole = held_ramp(2.4, turn, 5000);
  std::vector<double> samples = whole;
  std::vector<bool> filled(samples.size(), false);
  for (std::size_t k = 50; k + 60 < samples.size(); k += 97) {
    const std::size_t length = 1 + k % 13;
    for (std::size_t i = 0; i < length; ++i) {
      filled[k + i] = true;
      const double share = static_cast<double>(i + 1) / static_cast<double>(length + 1);
      samples[k + i] = whole[k - 1] + share * (whole[k + length] - whole[k - 1]);
    }
  }
  const auto found = renewals_of(samples, 0.0, filled);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->regular);
  EXPECT_NEAR(found->period, turn, found->period_slack + 1e-9);
  EXPECT_LT(found->period_slack, 2.0 / (5000.0 / turn));
  EXPECT_NEAR(found->first, 2.4, found->slack + found->period_slack * found->turn.back() + 1e-9);
  // held_ramp() counts its turns from 0, the renewals from the first that is seen, at turn 0.
  for (std::size_t i = 0; i < found->at.size(); ++i) EXPECT_EQ(found->turn[i], whole[found->at[i]]) << i;
}

// A channel that is new with every sample is not held; one that is renewed without a period is not regular.
TEST(Renewals, AreNoneOrIrregularWhereThereIsNoClock) {
  std::vector<double> free(1000);
  for (std::size_t k = 0; k < free.size(); ++k) free[k] = static_cast<double>(k);
  EXPECT_FALSE(renewals_of(free));
  std::vector<double> jitter;
  for (std::size_t turn = 0; turn < 300; ++turn) {
    const std::size_t length = turn % 7 == 3 ? 6 : 4;
    for (std::size_t i = 0; i < length; ++i) jitter.push_back(static_cast<double>(turn));
  }
  const auto found = renewals_of(jitter);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->regular);
}

// Limit. A sine that is held comes back between its renewals as exactly as the polynomial says: 1e-3 at f P = 0.25. A
// value that came twice is no renewal, but a turn.
TEST(Renewals, GiveBackWhatWasHeld) {
  constexpr double turn_length = 6.68, first = 3.1, omega = 2.0 * 3.141592653589793 * 0.25 / turn_length;
  std::vector<double> held(3000, 0.0);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const double n = std::max(std::floor((static_cast<double>(k) - first) / turn_length), 0.0);
    held[k] = std::sin(omega * (first + (n == 200.0 ? 199.0 : n) * turn_length));
  }
  const auto renewals = renewals_of(held);
  ASSERT_TRUE(renewals && renewals->regular);
  const auto values = before_hold(held, *renewals, {true, 0.0, 0.0});
  // t_0 and P are known to what the renewals leave open.
  const double late = renewals->slack + renewals->period_slack * renewals->turn.back() * 0.5;
  for (std::size_t k = 100; k < 2900; ++k) {
    const double turn = (static_cast<double>(k) - first) / turn_length;
    if (std::abs(turn - 200.0) < 9.0) continue;
    ASSERT_NEAR(values[k], std::sin(omega * static_cast<double>(k)), 1.5e-3 + omega * late) << k;
  }
  EXPECT_LT(omega * late, 0.01);
  EXPECT_NEAR(taken_at(*renewals, 0, {true, 1.0, 0.0}) - taken_at(*renewals, 0, {true, 0.0, 0.0}), renewals->slack,
              1e-12);
  const std::size_t last = renewals->at.size() - 1;
  EXPECT_NEAR(taken_at(*renewals, last, {true, 0.0, 1.0}) - taken_at(*renewals, last, {true, 0.0, 0.0}),
              renewals->period_slack * 0.5 * renewals->turn[last], 1e-9);
  EXPECT_EQ(taken_at(*renewals, 5, {}), static_cast<double>(renewals->at[5]));
}

}  // namespace
