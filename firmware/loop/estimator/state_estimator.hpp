// What the sensors do not say themselves.
#pragma once

#include <optional>

#include "firmware/loop/estimator/velocity_observer.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "model/components/channel.hpp"

namespace firmware {

/// Velocities of the rig [m/s]; NaN where nothing measured leads to one.
struct Velocities {
  double foot_point;
  double wheel;
  double body;
  double deflection;  ///< of the component: z_w − z_b, or what the test machine reaches
};

/// Velocities and wheel load from what is fitted:
///
///   (1)  z_r = z_r       z_w = z_w or z_r − dz_w       z_b = z_b or z_w − dz_b       (the first that is measured)
///   (2)  velocities of the three by VelocityObserver, with zdd_r, zdd_w, zdd_b where fitted
///   (3)  velocity of the deflection: wheel − body; without them x_act or dz_b differentiated
///   (4)  F_w,c = k_t dz_w, dz_w = dz_w or z_r − z_w: soft sensor of the wheel load, without the tyre's damping
class StateEstimator {
 public:
  StateEstimator(const SampleGuard& samples, double tyre_stiffness, const Observers& settings, double period);

  /// Once a period, after the samples were taken; waits until every fitted channel has shown a good one.
  void step(const SampleGuard& samples);
  /// What was seen before counts for nothing: the next step starts at rest.
  void restart();

  [[nodiscard]] const Velocities& velocities() const { return velocities_; }
  [[nodiscard]] double wheel_load() const { return wheel_load_; }  ///< (4) [N]; NaN without deflection or tyre

 private:
  struct Place {
    std::optional<double> displacement{};
    std::optional<double> acceleration{};
  };
  struct Places {
    Place foot_point{}, wheel{}, body{}, deflection{};
    std::optional<double> tyre_deflection{};
  };

  /// What is known, of what is fitted: by channel, (1) and (3).
  template <class Known>
  [[nodiscard]] static Places places(const Known& known);
  [[nodiscard]] static VelocityObserver::Inputs inputs(const Place& place);
  [[nodiscard]] static double follow(VelocityObserver& observer, const Place& place);

  double tyre_stiffness_;
  Velocities velocities_;
  double wheel_load_;
  VelocityObserver foot_point_;
  VelocityObserver wheel_;
  VelocityObserver body_;
  VelocityObserver deflection_;
};

}  // namespace firmware
