// Skyhook control of an air spring's area.
#pragma once

#include "model/rig/rig_equations.hpp"

namespace firmware {

/// The area command of an active air spring: equation (7) of model::AirSpring, with the body velocity that the program
/// knows (hil: the virtual car's, quarter_car: the estimated one).
///
///   u_c = −c_sky ż_b/k_u,  within the actuator's stroke
///
/// An actuator of 5 Hz follows by itself without jumps; a command is 0 outside of runs.
template <bool room>
class AreaControl {
 public:
  explicit AreaControl(const model::RigParameters<double>& rig) : wanted_(rig.air_spring.fitted) {
    if (wanted_) law_ = model::AirSpring<double>(rig.air_spring, model::condition_of_air_spring(rig), 1.0);
    wanted_ = wanted_ && law_.has_skyhook();
  }
  [[nodiscard]] bool wanted() const { return wanted_; }
  /// 0 for a velocity that is not known.
  [[nodiscard]] double command(double body_velocity) const {
    return body_velocity - body_velocity == 0.0 ? law_.skyhook(body_velocity) : 0.0;
  }

 private:
  bool wanted_ = false;
  model::AirSpring<double> law_{};
};

/// A program without room for an air spring.
template <>
class AreaControl<false> {
 public:
  explicit AreaControl(const model::RigParameters<double>& /*rig*/) {}
  [[nodiscard]] static constexpr bool wanted() { return false; }
  [[nodiscard]] static constexpr double command(double /*body_velocity*/) { return 0.0; }
};

}  // namespace firmware
