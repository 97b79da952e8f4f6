// The compensators as one step of the control loop.
#pragma once

#include <cstddef>

#include "firmware/loop/compensation/compensation.hpp"
#include "firmware/loop/compensation/interface_damper.hpp"
#include "firmware/loop/compensation/lead_polynomial.hpp"
#include "firmware/loop/compensation/settings.hpp"
#include "firmware/loop/compensation/specimen_predictor.hpp"
#include "firmware/loop/compensation/time_series.hpp"
#include "firmware/loop/compensation/tracking_feedback.hpp"

namespace firmware::compensation {

/// One method, from the wanted deflection x to the command u, and from the measured force to that of the car:
///
///   (1)  polynomial                 u: LeadPolynomial over the low-frequency delay of the assumed machine
///   (2)  inverse                    u = Σ a_i x^(i), a of inverse_series()
///   (3)  adaptive_time_series       the same, a of TimeSeries
///   (4)  feedforward_feedback       u = (2) + TrackingFeedback
///   (5)  smith, virtual_damping, adaptive_virtual_damping:  u = x, a force is added to F
///   (6)  F_car = F_s + force_lead (F_s − F_s,before),  F_s = F + added force
///
/// ẋ and ẍ are states of the virtual car; x⃛ is the difference of ẍ over a period. The force of (6) is held during the
/// period, which is half a period of delay: force_lead = ½ makes up for it.
///
/// What is added, c = u − x, comes in by a smoothstep over start_ramp, changes by at most rate · h a period, and ends
/// the run beyond `limit`; the added force trips beyond force_limit. A period without a good sample of x_act changes
/// neither TimeSeries nor TrackingFeedback.
class Compensator final : public Compensation {
 public:
  struct State {
    LeadPolynomial::State past{};
    TimeSeries::State series{};
    TrackingFeedback::State feedback = TrackingFeedback::State::Zero();
    SpecimenPredictor::State specimen{};
    InterfaceDamper::State damper{};
    model::Motion<double> wanted{};  ///< x of this instant
    double last_force = 0.0;         ///< F at the instant before [N]
    double held_force = 0.0;         ///< F_car, held to the next instant [N]
    double added = 0.0;              ///< c of the command for this instant [m]
    double added_force = 0.0;        ///< of this period [N]
    double elapsed = 0.0;            ///< since the start [s], up to start_ramp
    double last_feedback = 0.0;      ///< [m]
    bool begun = false;              ///< a force has been received
  };

  /// Settings that pass check(), of delays within the lines of this period, else stops.
  Compensator(const Settings& settings, double period);

  [[nodiscard]] static bool fits(const Settings& settings, double period);

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] State& state() { return state_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }
  /// a of (2) or (3) [sⁱ].
  [[nodiscard]] const Coefficients& values() const {
    return settings_.kind == Kind::adaptive_time_series ? state_.series.values : inverse_;
  }

  /// Samples of the past, newest first, that the lines still read.
  [[nodiscard]] std::size_t reach() const;

 private:
  void do_start(double deflection) override;
  double do_force(double measured) override;
  Answer do_command(const Instant& instant) override;

  [[nodiscard]] model::Stroke<double> lead(const Instant& instant);

  Settings settings_;
  double period_;
  Coefficients inverse_;
  LeadPolynomial polynomial_;
  TimeSeries series_;
  TrackingFeedback feedback_;
  SpecimenPredictor specimen_;
  InterfaceDamper damper_;
  State state_{};
};

}  // namespace firmware::compensation
