// What the control loop of a hil rig offers to a compensation of its machine's delay.
#pragma once

#include <optional>

#include "hal/command_output.hpp"
#include "model/numerics/motion.hpp"

namespace firmware {

/// Stands between the virtual car and the machine. A loop without one commands the car's deflection itself, and links
/// none of the code behind this interface.
///
/// Every period of a run: force() before the car's step to t_{k+1}, command() after it. Static memory, the same work
/// every period.
class Compensation {
 public:
  struct Instant {
    model::Motion<double> wanted{};  ///< the car's deflection at t_{k+1}, with two derivatives
    double commanded = 0.0;          ///< what the machine was told to be at t_k [m]
    double reached = 0.0;            ///< x_act at t_k [m]
    bool measured = false;           ///< reached is a good sample of this instant
    int open_ducts = 0;              ///< from t_k to t_{k+1}
  };
  /// More than it may add.
  struct Excess {
    double value = 0.0;  ///< [m] or [N]
    double limit = 0.0;
    bool of_force = false;  ///< [N], added to the measured force; else added to the command
  };
  struct Answer {
    hal::Command command{};          ///< for t_{k+1}
    std::optional<Excess> excess{};  ///< the run ends
  };

  virtual ~Compensation() = default;

  /// The car begins at rest with this deflection [m].
  void start(double deflection) { do_start(deflection); }
  /// The force that enters the car, from the force measured at t_k [N].
  [[nodiscard]] double force(double measured) { return do_force(measured); }
  [[nodiscard]] Answer command(const Instant& instant) { return do_command(instant); }

 private:
  virtual void do_start(double deflection) = 0;
  virtual double do_force(double measured) = 0;
  virtual Answer do_command(const Instant& instant) = 0;
};

/// Place of a compensation in the loop, and what it added last. A microcontroller's loop has none unless its program
/// asks for it: RIGTWIN_ALONE.
class CompensationPlace {
 public:
#ifdef RIGTWIN_ALONE
  static constexpr Compensation* get() { return nullptr; }
  static constexpr double added_force() { return 0.0; }
  static constexpr void note_force(double /*added*/) {}
#else
  void set(Compensation* compensation) { compensation_ = compensation; }
  [[nodiscard]] Compensation* get() const { return compensation_; }
  [[nodiscard]] double added_force() const { return added_force_; }  ///< [N]
  void note_force(double added) { added_force_ = added; }

 private:
  Compensation* compensation_ = nullptr;
  double added_force_ = 0.0;
#endif
};

}  // namespace firmware
