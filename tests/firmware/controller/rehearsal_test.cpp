#include "firmware/controller/rehearsal.hpp"

#include <gtest/gtest.h>

#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/support/without_heap.hpp"

namespace {

using firmware::Mode;
using firmware::controller::Rehearsal;
using model::RigKind;
using rig_under_test::Journey;
using rig_under_test::Scene;

// What is rehearsed is a period of a run, for as long as anybody likes, whatever the rig and its ranges: a stand-in
// that had tripped or still moved to the beginning of its reference would warm up the wrong instructions.
TEST(Rehearsal, RehearsesPeriodsOfARunForever) {
  for (const RigKind kind : {RigKind::hil, RigKind::quarter_car, RigKind::component_bench}) {
    Scene scene(kind);
    scene.settings.ramps.rest = 0.03;
    scene.settings.ramps.settling = 0.5;
    for (auto& sensor : scene.sensors) {
      if (sensor.fitted) sensor.lowest = 0.5 * sensor.highest;  // zero is outside of it
    }
    Journey real{scene};
    Rehearsal rehearsal(real.loop, real.journal, scene.settings, scene.parameters, scene.sensors);
    rehearsal.step();
    for (int i = 0; i < 5000; ++i) {
      support::without_heap([&] { rehearsal.step(); });
      ASSERT_EQ(rehearsal.stand_in().mode(), Mode::running) << name(kind) << ", period " << i;
    }
    EXPECT_EQ(rehearsal.stand_in().trip().reason, firmware::Reason::none);
    EXPECT_EQ(rehearsal.stand_in().counters(), firmware::Counters{});
  }
}

// The real loop knows nothing of it: a run that is rehearsed before every period is the run without, to the last bit.
TEST(Rehearsal, LeavesTheRealLoopAlone) {
  const Scene scene(RigKind::hil, 300);
  Journey plain{scene}, rehearsed{scene};
  Rehearsal rehearsal(rehearsed.loop, rehearsed.journal, scene.settings, scene.parameters, scene.sensors);
  plain.loop.arm();
  plain.loop.start();
  rehearsed.loop.arm();
  rehearsed.loop.start();
  for (int k = 0; k < 310; ++k) {
    plain.periods(1);
    rehearsal.step();
    rehearsed.periods(1);
  }
  const auto a = plain.rows(Mode::running), b = rehearsed.rows(Mode::running);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 290U);
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a[k].command, b[k].command) << k;
    ASSERT_EQ(a[k].time, b[k].time) << k;
    ASSERT_EQ(a[k].counters, b[k].counters) << k;
  }
}

}  // namespace
