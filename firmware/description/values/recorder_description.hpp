// What a recorder makes of a rig's channels, and what changes while it records: [recording].
#pragma once

#include <string>
#include <vector>

#include "model/components/channel.hpp"

namespace firmware {

/// Found by `rigtwin diagnose` or known to the user. A simulation of the rig does without it; whoever compares a
/// recording with a simulation applies it (host_sim/identification/predict/recording_faults.hpp has the equations).
struct RecorderDescription {
  /// Butterworth low-pass of these channels, the input of the rig among them or not.
  struct Filter {
    std::vector<model::Channel> channels;
    double corner = 0.0;   ///< [Hz]
    int order = 1;         ///< 1 … 4
    bool digital = false;  ///< computed from the samples
  };
  /// A clock of these channels that differs from that of the input.
  struct Clock {
    std::vector<model::Channel> channels;
    double offset = 0.0;  ///< [s], > 0: late
    double ppm = 0.0;     ///< > 0: slow, from the first sample of each recording on
  };
  /// Mains hum. Its phase is each recording's own.
  struct Hum {
    std::vector<model::Channel> channels;
    double frequency = 0.0;         ///< [Hz]
    std::vector<double> amplitude;  ///< by channel [SI]
  };
  /// A parameter that has its described value when a recording begins and changes along a first-order curve.
  struct Drift {
    std::string path;
    double per_cent = 0.0;  ///< of the described value, by the end of the recording
    double bend = 0.0;      ///< κ of the curve; 0: a straight line
  };
  std::vector<Filter> common_filter;
  std::vector<Clock> clock;
  std::vector<Hum> hum;
  std::vector<Drift> drift;

  [[nodiscard]] bool any() const { return !(common_filter.empty() && clock.empty() && hum.empty() && drift.empty()); }
};

}  // namespace firmware
