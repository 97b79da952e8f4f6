// For which loop a hil rig was found stable.
#pragma once

#include <string>
#include <string_view>

#include "firmware/description/rig_description.hpp"

namespace firmware {

/// Every number that enters the loop analysis, one "key = value" a line in a fixed order: rate, car, component,
/// effects, laws, delay budget, compensation, valve plan; and the allowed delay and gain that it found. Devices, limits, noise,
/// ranges, tolerances and comments do not enter.
[[nodiscard]] std::string loop_text(const RigDescription& description);

/// "sha256:" and the SHA-256 of loop_text().
[[nodiscard]] std::string loop_fingerprint(const RigDescription& description);

/// The margins of the loop beyond what is described, as the analysis found them.
struct LoopLimits {
  double delay = 0.0;  ///< of samples and computation [s]
  double gain = 0.0;   ///< factor on the force
};

/// The text of a description with [controller] allowed_delay, allowed_gain and proven set; every other byte stays. Throws InputError
/// where the text is not that of a description, or says [controller] in another form than a table of its own.
[[nodiscard]] std::string with_loop_proof(std::string_view text, std::string_view source, const LoopLimits& limits,
                                          std::string_view fingerprint);

/// Why the loop of a hil rig must not be closed on devices, nor with [compensation] on a simulated rig: no proof, or
/// one of another loop. Empty: it may, or it is no hil rig, or [waivers] says unproven_stability.
[[nodiscard]] MotionObjection stability_objection(const RigDescription& description);

/// The same for the measured delay of samples and computation [s] against allowed_delay.
[[nodiscard]] MotionObjection delay_objection(const RigDescription& description, double measured_delay);

}  // namespace firmware
