#include "firmware/controller/real_time/wake_lead.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace {

using firmware::controller::WakeLead;
using hal::microseconds;
using hal::Time;

/// So many periods on a machine that wakes up to `latest` late and takes `warmup`; the share that was warmed and
/// the share that was warmed beyond its instant, of the second half, and the longest wait after the last warmup.
struct Shares {
  double warmed, overran;
  Time idle;
};
Shares drive(WakeLead& wake, Time latest, Time warmup) {
  std::mt19937_64 generator(3);
  std::uniform_int_distribution<std::int64_t> late(0, latest.ns);
  constexpr int periods = 1'000'000;
  Shares shares{};
  for (int k = 0; k < periods; ++k) {
    Time left = wake.early() - Time{late(generator)};
    bool warmed = false;
    wake.use([&] { return left; },
             [&] {
               left = left - warmup;
               warmed = true;
             });
    if (!warmed) continue;
    if (k < periods / 2) continue;
    shares.warmed += 2.0 / periods;
    if (left < Time{}) shares.overran += 2.0 / periods;
    shares.idle = std::max(shares.idle, left);
  }
  return shares;
}

// On a machine that wakes up to 40 µs late, a warmup of 8 µs: 48 µs early and up to a step of 10 µs more, from which
// it comes down in ten thousand periods. The warmup's own span moves by steps of 2 µs, so the last warmup, begun
// with no more than that and another warmup's time left, ends 10 µs or less before the instant.
TEST(WakeLead, IsAsEarlyAsTheMachineNeeds) {
  for (const Time most : {microseconds(100), microseconds(250)}) {
    WakeLead wake(most);
    const Shares shares = drive(wake, microseconds(40), microseconds(8));
    EXPECT_GT(wake.early(), microseconds(46));
    EXPECT_LT(wake.early(), microseconds(62));
    EXPECT_GT(shares.warmed, 0.9997) << "one in ten thousand, thrice for the steps it is held by";
    EXPECT_LT(shares.overran, 0.0003);
    EXPECT_LE(shares.idle, microseconds(10));
  }
}

// A board on which warming takes 60 µs is given that time; one that has less than it needs does without, and its
// periods begin at their instants.
TEST(WakeLead, LearnsHowLongARehearsalTakes) {
  WakeLead slow(microseconds(250));
  const Shares shares = drive(slow, microseconds(10), microseconds(60));
  EXPECT_GT(slow.early(), microseconds(60));
  EXPECT_LT(slow.early(), microseconds(85));
  EXPECT_GT(shares.warmed, 0.99);
  EXPECT_LT(shares.overran, 0.005);

  WakeLead never(microseconds(50));
  EXPECT_LT(drive(never, microseconds(10), microseconds(60)).overran, 0.005);
}

}  // namespace
