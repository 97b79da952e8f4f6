// Between the measured force and the commanded deflection of a hil rig: the virtual car and what stands beside it.
#pragma once

#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/compensation/compensation.hpp"
#include "firmware/loop/guards/energy_guard.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/loop/reference/reference.hpp"
#include "hal/command_output.hpp"
#include "hal/valve_bank.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// One period of a run, in this order:
///
///   receive   F(t_k) enters the car, with what a compensation adds, by a smoothstep over force_ramp from the beginning
///   step      the car with F held to t_{k+1}; energy guard; the deflection, or what a compensation makes of it, goes
///   out
///
/// Only a hil rig has a car: of the other kinds nothing but alive() is asked.
class HilInterface {
 public:
  using VirtualCar = model::VirtualCar<double>;

  HilInterface(const Settings& settings, const model::RigParameters<double>& parameters, double period);

#ifndef RIGTWIN_ALONE
  void attach(Compensation& compensation) { compensation_.set(&compensation); }
#endif

  [[nodiscard]] bool fitted() const { return car_.has_value(); }
  /// The car's state is that of this instant.
  [[nodiscard]] bool alive() const { return alive_; }
  [[nodiscard]] double body_velocity() const { return state_.core(model::CoreIndex::body_velocity); }

  /// The car at rest above the beginning of its road.
  void start(const Motion& begin);
  void end() { alive_ = false; }

  /// A measured force [N] at sample `sample` of a run; before it, 0.
  void receive(double measured, bool in_run, std::uint64_t sample);

  struct Instant {
    double commanded = 0.0;  ///< what the machine was told to be at t_k [m]
    hal::Openings openings{};
    std::uint64_t sample = 0;  ///< of the run
    hal::Time now{};
  };
  /// The command for t_{k+1} over this foot point.
  [[nodiscard]] hal::Command step(const Motion& foot_point, const Instant& instant, const SampleGuard& samples);

  /// Of the last step: energy guard or compensation.
  [[nodiscard]] const std::optional<Trip>& hazard() const { return hazard_; }
  void forget_hazard() { hazard_.reset(); }
  [[nodiscard]] const EnergyGuard& energy() const { return energy_guard_; }

  /// The car's numbers of this instant; `commanded` is the deflection put out for it.
  void note(Record& record, double commanded, bool in_run) const;

 private:
  [[nodiscard]] bool fading_in(std::uint64_t sample) const {
    return static_cast<double>(sample) * period_ < force_ramp_;
  }
  [[nodiscard]] hal::Command compensated(Compensation& compensation, const model::Motion<double>& wanted,
                                         const Instant& instant, const SampleGuard& samples);

  double period_;
  double force_ramp_;
  double whole_force_ = 0.0;  ///< of this period, before it is faded in [N]
  std::optional<VirtualCar> car_{};
  [[no_unique_address]] CompensationPlace compensation_{};
  EnergyGuard energy_guard_;
  VirtualCar::State state_{};
  bool alive_ = false;
  std::optional<Trip> hazard_{};
};

}  // namespace firmware
