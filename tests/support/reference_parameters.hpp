// The paper's rigs with the project's reference FDVA, as parameters of the model.
#pragma once

#include "model/rig/rig_parameters.hpp"

namespace support {

/// Reference FDVA: 8 Hz with two ducts.
[[nodiscard]] inline model::Fdva<double>::Parameters reference_fdva(int open_ducts = 2) {
  return {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, open_ducts};
}

/// Paper, Table 1, with the linear component (b_b 1140 N s/m); hil with b̃ = 0 and an ideal machine.
[[nodiscard]] inline model::RigParameters<double> linear_rig(model::RigKind kind) {
  model::RigParameters<double> rig;
  rig.kind = kind;
  if (kind != model::RigKind::component_bench) {
    rig.body.mass = 290.0;
    rig.wheel.mass = 40.0;
    rig.tyre = {200e3, 100.0};
  }
  rig.suspension = {31500.0, 1140.0};
  return rig;
}

/// The same with the FDVA instead of the damper (b_b = 0); hil with b̃ = 1140 N s/m.
[[nodiscard]] inline model::RigParameters<double> fdva_rig(model::RigKind kind, int open_ducts = 2) {
  model::RigParameters<double> rig = linear_rig(kind);
  rig.suspension.damping = 0.0;
  if (kind == model::RigKind::hil) rig.machine.virtual_damping = 1140.0;
  rig.has_fdva = true;
  rig.fdva = reference_fdva(open_ducts);
  return rig;
}

}  // namespace support
