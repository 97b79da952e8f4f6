// The keys of a rig description that set the control loop and nothing else.
#pragma once

#include <span>
#include <string_view>

#include "firmware/loop/common/settings.hpp"

namespace firmware {

/// One key: reader, writer and README take it from here. A limit that follows from another one has the value 0 as long
/// as the description does not give it.
struct LoopSetting {
  std::string_view table;  ///< "limits", "supervision" or "motion"
  std::string_view key;
  double lowest, highest;  ///< of what a description may say
  std::string_view what;   ///< for messages: what it is and in which unit
  bool whole;              ///< a whole number
  double (*get)(const Settings&);
  void (*set)(Settings&, double);
};

/// In the order of the tables.
[[nodiscard]] std::span<const LoopSetting> loop_settings();

}  // namespace firmware
