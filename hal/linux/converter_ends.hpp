// Counts that a converter shows for whatever lies beyond its range.
#pragma once

namespace hal::linux {

/// Whether a converter of `bits` bits shows its lowest or its highest count: 0 or 2ᵇ − 1, signed −2ᵇ⁻¹ or 2ᵇ⁻¹ − 1.
/// The scale of the rig description does not matter, so its rounding cannot make such a sample good.
[[nodiscard]] constexpr bool at_end_of_converter(double counts, unsigned bits, bool is_signed) {
  double span = 1.0;
  for (unsigned i = 0; i < bits; ++i) span *= 2.0;
  const double lowest = is_signed ? -0.5 * span : 0.0;
  return counts <= lowest || counts >= lowest + span - 1.0;
}

}  // namespace hal::linux
