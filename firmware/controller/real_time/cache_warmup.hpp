// What a period needs, brought near before the period begins.
#pragma once

#include <span>

#include "firmware/loop/control_loop.hpp"
#include "hal/simulated/rig.hpp"

namespace firmware::controller {

/// A second control loop that is stepped just before the real one.
///
/// After a millisecond of sleep the caches hold what others have left there: fetching the 12 KiB of instructions of a
/// period takes several times as long as executing them, and how long depends on the others. The second loop runs the
/// same instructions a moment earlier, in mode running, on a rig in memory whose sensors show nothing but zeros and
/// whose outputs lead nowhere: it has no way to the real one. Then it asks for the memory of the real loop, without
/// reading it. What the devices' own drivers need it cannot warm.
class CacheWarmup {
 public:
  /// `loop`, `journal`: the real ones, made of the same settings, parameters and sensors.
  CacheWarmup(const ControlLoop& loop, const Journal& journal, const Settings& settings,
              const model::RigParameters<double>& parameters, const hal::SensorSetup& sensors);

  /// A compensation of its own, as the real loop has one. Before the first step.
  void attach(Compensation& compensation) { stand_in_.attach(compensation); }

  /// One period. No heap.
  void step();

  [[nodiscard]] const ControlLoop& stand_in() const { return stand_in_; }

 private:
  struct IdlePlant final : hal::simulated::Plant, Reference {
    void do_measure(std::span<double, hal::channel_capacity> values) override;
    void do_advance(const hal::Command&, hal::Openings) override {}
    std::optional<Motion> do_at(std::uint64_t) override { return Motion{}; }
  };

  const ControlLoop& loop_;
  const Journal& journal_;
  IdlePlant idle_plant_{};
  hal::simulated::Rig rig_;
  JournalStorage<2> storage_{};
  Journal records_{storage_};
  ControlLoop stand_in_;
};

}  // namespace firmware::controller
