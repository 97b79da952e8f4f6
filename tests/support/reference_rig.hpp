// An independent integration of the three kinds of rig: the reference for the accuracy of the model's step.
//
// tests/truth is another one, for another question (its README compares them): it stands for a real rig with a
// continuous road and loop. This one integrates the specification of the step: the model's sampled inputs, cubic
// between samples, switched ducts, a force that is sampled and held.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace support {

/// A rig in numbers, SI.
struct ReferenceRig {
  enum class Kind { quarter_car, hil, component_bench };
  Kind kind = Kind::quarter_car;
  double m_b = 290.0, m_w = 40.0, k_t = 200e3, b_t = 100.0;
  double k_b = 31500.0, b_b = 0.0, virtual_damping = 0.0;
  bool has_fdva = true;
  double A_p = 30e-4, d = 12e-3, l = 0.6361571127, rho = 860.0, nu = 32e-6, minor_loss = 1.5, k_c = 55e3;
  unsigned open = 3;          ///< bit j: duct j + 1 is open
  double dry_friction = 0.0;  ///< [N], parallel to the spring
  bool lifts_off = false;     ///< the tyre cannot pull
  double delay = 0.0;         ///< of the machine [s], a whole number of fine steps
};

/// The foot point, or the command of a bench, at a sample; F_act at that sample.
struct ReferenceInput {
  double position = 0.0, velocity = 0.0, acceleration = 0.0, actuator_force = 0.0;
};

/// What a rig shows at a sample; a kind leaves at 0 what it does not have.
struct ReferenceSample {
  double z_w, z_b, zdd_w, zdd_b, dz_w, dz_b, F_w, x_cmd, x_act, F;
};

/// Runs a rig from rest at the first input to the last.
///
/// Straight from (1)–(9): the flow of each duct is a state; classic Runge–Kutta 4 in `fine` steps a sample; inputs on
/// the cubic Hermite polynomial through the samples, F_act straight between them. Laws are sharp. The machine of a hil
/// rig follows the deflection of the car as it was one delay ago in the fine steps, not in the samples; F is sampled
/// and held. Dry friction: in each fine step the force that stops the parts, at most the limit.
/// `open(k)`: the ducts open from sample k on; absent: as in `rig`.
[[nodiscard]] std::vector<ReferenceSample> run_reference(const ReferenceRig& rig, double period,
                                                         const std::vector<ReferenceInput>& input, int fine,
                                                         const std::function<unsigned(std::size_t)>& open = {});

}  // namespace support
