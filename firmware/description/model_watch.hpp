// [controller] model_watch: whether a diagnosis beside the controller may stop the rig.
#pragma once

#include "firmware/description/rig_description.hpp"

namespace firmware {

/// True for model_watch = "stop": what `rigtwin diagnose --live` or `rigtwin watch --diagnose` names asks the controller
/// for a stop. The key is for the programs beside the controller, which itself does nothing with it, so it is taken from the
/// description's text, where the reader has checked it.
[[nodiscard]] bool model_watch_stops(const RigDescription& description);

}  // namespace firmware
