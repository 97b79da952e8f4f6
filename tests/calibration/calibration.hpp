// Tests that `rigtwin diagnose` finds what `rigtwin plan` promises, on rigs made without the model (tests/truth).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calibration {

/// An effect of one size in one rig.
struct Case {
  std::string effect;     ///< "sensor_lag of F"
  double value = 0.0;     ///< of its leading parameter
  bool promised = false;  ///< ten standard deviations beside the nearest rival; else one and a half in all
  std::string found{};    ///< what diagnose names, with confidence
  std::string failure{};  ///< why there is no recording; such a case counts for nothing
  bool named = false;     ///< the effect is among it
  bool believed = false;  ///< with a confidence above a half
};

struct Asked {
  std::string kind = "quarter_car";  ///< of the rig
  std::uint64_t seed = 1;
  std::uint64_t part = 1, parts = 1;  ///< of the effects that have a size, chosen by name (support::is_in_part)
  double duration = 30.0;             ///< [s]
};

/// Draws a rig without effects, plans the experiment, puts each effect into the rig in both sizes, records, diagnoses.
[[nodiscard]] std::vector<Case> calibrate(const Asked& asked);

}  // namespace calibration
