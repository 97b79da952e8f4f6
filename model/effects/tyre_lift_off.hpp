// Lift-off of the tyre.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/effects/effect.hpp"

namespace model {

/// Unilateral contact of the tyre.
///
///   F_w + (m_b + m_w) g ≥ 0:     F_w = max(F_w, −(m_b + m_w) g)
///
/// It acts after every other law of the tyre, on their sum. Its corner is not marked on the card: diagnose finds it
/// with one step a sample (tests/confusion).
template <class S>
struct TyreLiftOff {
  static constexpr EffectCard<0> card{
      .name = "tyre_lift_off",
      .subsystem = Subsystem::tyre,
      .rigs = RigKinds(RigKind::quarter_car, RigKind::hil),
      .parameters = {},
      .equation = "F_w + (m_b + m_w) g never below 0",
      .shows = "the wheel load is cut off flat at minus the static load while the wheel flies",
      .linearisation = Linearisation::left_out};
  static constexpr std::array<S TyreLiftOff::*, 0> values{};

  /// What the tyre gives once this law is added to `force`, the force of all laws before it [N].
  [[nodiscard]] constexpr S tyre_force(S force, S /*deflection*/, S static_load) const {
    return select(force < -static_load, -static_load, force);
  }
};

}  // namespace model
