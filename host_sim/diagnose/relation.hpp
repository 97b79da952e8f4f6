// Relations between the channels of a rig that hold one by one.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/diagnose/smooth_window.hpp"
#include "host_sim/recording.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// factor × the channel's derivative of that order.
struct Term {
  model::Channel channel;
  int order;
  double factor;
};
using Signal = std::vector<Term>;

[[nodiscard]] Signal derived(Signal signal, int by);

/// A part that makes a force or a motion of its own, or a sensor.
struct Origin {
  std::string place;
  std::optional<model::Channel> sensor{};
};

/// A relation as its residual: what should be zero.
struct Relation {
  std::string words;
  std::vector<Origin> origins;
  Signal sum;
  std::vector<std::pair<std::string, Signal>> tolerated;  ///< path, what the parameter's part in the sum is
  std::optional<Signal> deflection;                       ///< minus the component's force on this
  bool machine = false;                                   ///< minus what the machine makes of x_cmd
  Signal motion;                                          ///< what the residual may go with
};

/// The relations (1)–(8) of redundancy.hpp that these channels allow.
[[nodiscard]] std::vector<Relation> relations_of(const model::RigParameters<double>& rig, const Recording& recording);

/// The signal, smoothed (with a window) or, of order 0, as it is.
[[nodiscard]] std::vector<double> samples_of(const Recording& recording, const Signal& signal,
                                             const SmoothWindow* window);

}  // namespace host_sim::diagnose
