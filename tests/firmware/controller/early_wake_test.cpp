#include "firmware/controller/early_wake.hpp"

#include <gtest/gtest.h>

#include <random>

namespace {

using firmware::controller::EarlyWake;
using hal::microseconds;
using hal::Time;

/// So many periods on a machine that wakes up to `latest` late and takes `rehearsal`; the share that was rehearsed and
/// the share that was rehearsed beyond its instant, of the second half.
struct Shares {
  double rehearsed, overran;
};
Shares drive(EarlyWake& wake, Time latest, Time rehearsal) {
  std::mt19937_64 generator(3);
  std::uniform_int_distribution<std::int64_t> late(0, latest.ns);
  constexpr int periods = 100'000;
  Shares shares{};
  for (int k = 0; k < periods; ++k) {
    const Time left = wake.early() - Time{late(generator)};
    if (!wake.there_is_time(left)) continue;
    wake.rehearsed(left - rehearsal);
    if (k < periods / 2) continue;
    shares.rehearsed += 2.0 / periods;
    if (left < rehearsal) shares.overran += 2.0 / periods;
  }
  return shares;
}

// On a machine that wakes up to 40 µs late, a rehearsal of 8 µs: 48 µs early and up to a step of 10 µs more, from which
// it comes down in a thousand periods. The rehearsal's own span moves by steps of 2 µs.
TEST(EarlyWake, IsAsEarlyAsTheMachineNeeds) {
  for (const Time most : {microseconds(100), microseconds(250)}) {
    EarlyWake wake(most);
    const Shares shares = drive(wake, microseconds(40), microseconds(8));
    EXPECT_GT(wake.early(), microseconds(46));
    EXPECT_LT(wake.early(), microseconds(62));
    EXPECT_GT(shares.rehearsed, 0.997);
    EXPECT_LT(shares.overran, 0.003);
  }
}

// A board on which rehearsing takes 60 µs is given that time; one that has less than it needs does without, and its
// periods begin at their instants.
TEST(EarlyWake, LearnsHowLongARehearsalTakes) {
  EarlyWake slow(microseconds(250));
  const Shares shares = drive(slow, microseconds(10), microseconds(60));
  EXPECT_GT(slow.early(), microseconds(60));
  EXPECT_LT(slow.early(), microseconds(85));
  EXPECT_GT(shares.rehearsed, 0.99);
  EXPECT_LT(shares.overran, 0.005);

  EarlyWake never(microseconds(50));
  EXPECT_LT(drive(never, microseconds(10), microseconds(60)).overran, 0.005);
}

}  // namespace
