// What may ride along with the control loop: an estimator, a policy for the ducts.
#pragma once

#include <optional>

#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/estimator/state_estimator.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "hal/time.hpp"
#include "hal/valve_bank.hpp"

namespace firmware {

/// Called by the control loop once a period, in this order: follow, look, choose (in a run), opened. It decides about
/// the ducts of a run, and may end one; modes and commands do not know it. Static memory, fixed work, no exceptions.
class Companion {
 public:
  Companion() = default;
  Companion(const Companion&) = delete;
  Companion& operator=(const Companion&) = delete;
  virtual ~Companion() = default;

  /// What was seen before counts for nothing: follow() begins anew.
  void restart() { do_restart(); }
  /// The samples of this period.
  void follow(const SampleGuard& samples, hal::Time now) { do_follow(samples, now); }
  /// Whether the samples of a run contradict what it expects; what came before `runs` counts for nothing.
  [[nodiscard]] std::optional<Trip> look(bool runs, hal::Time now) { return do_look(runs, now); }
  /// The ducts to be open from now on; `planned` by the run.
  [[nodiscard]] hal::Openings choose(hal::Openings planned) { return do_choose(planned); }
  /// What the valves have been told, in every state of the loop.
  void opened(hal::Openings openings) { do_opened(openings); }

  [[nodiscard]] virtual Velocities velocities() const = 0;
  [[nodiscard]] virtual double wheel_load() const = 0;       ///< [N]
  [[nodiscard]] virtual hal::Openings standing() const = 0;  ///< where the valves stand from now on, late as they are

 private:
  virtual void do_restart() = 0;
  virtual void do_follow(const SampleGuard& samples, hal::Time now) = 0;
  virtual std::optional<Trip> do_look(bool runs, hal::Time now) = 0;
  virtual hal::Openings do_choose(hal::Openings planned) = 0;
  virtual void do_opened(hal::Openings openings) = 0;
};

/// Place of a companion in the loop. A microcontroller's loop has none unless its program asks for it: RIGTWIN_ALONE.
class CompanionPlace {
 public:
#ifdef RIGTWIN_ALONE
  static constexpr Companion* get() { return nullptr; }
#else
  void set(Companion* companion) { companion_ = companion; }
  [[nodiscard]] Companion* get() const { return companion_; }

 private:
  Companion* companion_ = nullptr;
#endif
};

}  // namespace firmware
