// The rig in single steps, with its derivatives.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "model/components/channel.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::replicate {

/// Position and velocity of a drive at a sample.
struct DrivePoint {
  double position = 0.0;  ///< p [m]
  double velocity = 0.0;  ///< v [m/s]
};

/// The command with acceleration w held for one period h:   p' = p + h v + ½ h² w,   v' = v + h w
[[nodiscard]] DrivePoint moved(const DrivePoint& from, double acceleration, double period);

/// Linear form of one step, about the point where it was taken, row-major:
///
///   (1)  δx' = A δx + B δw        x: motion of the rig, at its end p and v of the drive
///   (2)  δy' = C δx + D δw        y: channels at the end of the step
struct LinearStep {
  std::vector<double> a, b, c, d;
};

/// The one step function with a drive in front of it. The delay of the machine is left out: it shifts the drive. The
/// effects of sensors are left out: they act on the channels afterwards.
///
/// The state that the derivatives see: positions and velocities of the equations of motion, the machine, and the loads
/// of laws, duct losses and free play that the step carries on. What a law with memory or an air spring carries besides
/// is left out of the derivatives, not of the step.
class SteppedRig {
 public:
  virtual ~SteppedRig() = default;

  /// At rest with the drive at 0.
  virtual void start() = 0;
  virtual void step(double acceleration) = 0;
  /// Channels at this instant.
  virtual void read(double* channels) const = 0;
  /// The state x of (1).
  virtual void state(double* x) const = 0;
  [[nodiscard]] virtual DrivePoint drive() const = 0;

  /// Keeps the instant in a slot, or returns to it.
  virtual void keep(std::size_t slot) = 0;
  virtual void return_to(std::size_t slot) = 0;

  /// Derivatives of the step from this instant, by central differences.
  virtual void derive(double acceleration, LinearStep& step) = 0;

  /// Leaves entries out of x that never move: after a run through motions with every part of the rig moving.
  virtual void drop(const std::vector<bool>& unused) = 0;

  [[nodiscard]] virtual std::size_t states() const = 0;
  [[nodiscard]] virtual std::size_t channels() const = 0;
};

/// `channels`: what read() gives.
[[nodiscard]] std::unique_ptr<SteppedRig> stepped_rig(const model::RigParameters<double>& rig, double period,
                                                      const std::vector<model::Channel>& channels);

/// Delay of the machine [s].
[[nodiscard]] double machine_delay(const model::RigParameters<double>& rig);

}  // namespace host_sim::replicate
