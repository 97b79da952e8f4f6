// Step 3: parity relations between channels, checked before anything is fitted.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/parity/thresholds.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim::identification {

/// How far a relation (parity_relation.hpp) is from holding, after its tolerated parameters were fitted to it. In a
/// band of width B, over T seconds:
///
///   (1)  excess       = P/P_noise − 1                       P: power of the residual
///   (2)  significance = excess · √(T B)                      a band's mean power scatters by 1/√(T B)
///
/// A relation fails where (2) exceeds thresholds::parity_significance and the power exceeds that of noise by
/// parity_share.
struct ParityResidual {
  static constexpr std::size_t bands = thresholds::parity_bands;
  /// A place where a fault would show in this relation.
  struct FaultLocation {
    std::string place;                 ///< "suspension", "sensor F_w" …
    std::array<double, bands> gain{};  ///< what a unit of its power makes of the band, in units of the noise's power
  };
  std::string relation;  ///< "body: m_b z̈_b = F_s[dz_b]"
  std::vector<FaultLocation> locations;
  std::array<double, bands> excess{};  ///< (1)
  double significance = 0.0;           ///< (2) of the strongest band
  double ratio = 1.0;                  ///< power ÷ that of noise, over the significant bands
  double lowest = 0.0, highest = 0.0;  ///< band that holds the middle 80 % of the excess [Hz]
  std::string description;             ///< what the residual depends on, in words; empty where nothing stands out
  [[nodiscard]] bool significant() const {
    return significance > thresholds::parity_significance && ratio > 1.0 + thresholds::parity_share;
  }
};

/// Over the fitted windows. Empty for a rig whose description has effects outside its component and machine, laws, dry
/// friction or hysteresis: the relations are those of a rig without. A force of friction follows from the measured
/// motion only up to its sign, which noise decides wherever the motion is slow; what an element with memory holds at
/// the start of a recording nobody has measured.
[[nodiscard]] std::vector<ParityResidual> parity_residuals(const firmware::RigDescription& description,
                                                           const std::vector<PreparedRecording>& recordings);

}  // namespace host_sim::identification
