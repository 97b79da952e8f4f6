#include "firmware/controller/real_time/cache_warmup.hpp"

#include <gtest/gtest.h>

#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/support/without_heap.hpp"

namespace {

using firmware::Mode;
using firmware::controller::CacheWarmup;
using model::RigKind;
using rig_under_test::Journey;
using rig_under_test::Scene;

// The second loop executes a period of a run, for as long as anybody likes, whatever the rig and its ranges: a stand-in
// that had tripped or still moved to the beginning of its reference would warm up the wrong instructions.
TEST(CacheWarmup, WarmsPeriodsOfARunForever) {
  for (const RigKind kind : {RigKind::hil, RigKind::quarter_car, RigKind::component_bench}) {
    Scene scene(kind);
    scene.settings.ramps.rest = 0.03;
    scene.settings.ramps.settling = 0.5;
    for (auto& sensor : scene.sensors) {
      if (sensor.fitted) sensor.lowest = 0.5 * sensor.highest;  // zero is outside of it
    }
    Journey real{scene};
    CacheWarmup warmup(real.loop, real.journal, scene.settings, scene.parameters, scene.sensors);
    warmup.step();
    for (int i = 0; i < 5000; ++i) {
      support::without_heap([&] { warmup.step(); });
      ASSERT_EQ(warmup.stand_in().mode(), Mode::running) << name(kind) << ", period " << i;
    }
    EXPECT_EQ(warmup.stand_in().trip().reason, firmware::Reason::none);
    EXPECT_EQ(warmup.stand_in().counters(), firmware::Counters{});
  }
}

// The real loop knows nothing of it: a run with warm-up before every period is the run without, to the last bit.
TEST(CacheWarmup, LeavesTheRealLoopAlone) {
  const Scene scene(RigKind::hil, 300);
  Journey plain{scene}, warmed{scene};
  CacheWarmup warmup(warmed.loop, warmed.journal, scene.settings, scene.parameters, scene.sensors);
  plain.loop.arm();
  plain.loop.start();
  warmed.loop.arm();
  warmed.loop.start();
  for (int k = 0; k < 310; ++k) {
    plain.periods(1);
    warmup.step();
    warmed.periods(1);
  }
  const auto a = plain.rows(Mode::running), b = warmed.rows(Mode::running);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 290U);
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a[k].command, b[k].command) << k;
    ASSERT_EQ(a[k].time, b[k].time) << k;
    ASSERT_EQ(a[k].counters, b[k].counters) << k;
  }
}

}  // namespace
