// Relations between the channels of a rig that hold one by one.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/identification/parity/smooth_window.hpp"

namespace host_sim::identification {

/// factor × the channel's derivative of that order.
struct Term {
  model::Channel channel;
  int order;
  double factor;
};
using Signal = std::vector<Term>;

[[nodiscard]] Signal derived(Signal signal, int by);

/// Where a fault may come from: a part that makes a force or a motion of its own, or a sensor.
struct FaultOrigin {
  std::string place;
  std::optional<model::Channel> sensor{};
};

/// A relation as its residual, which is zero where the relation holds.
struct ParityRelation {
  std::string words;
  std::vector<FaultOrigin> origins;
  Signal sum;
  std::vector<std::pair<std::string, Signal>> tolerated;  ///< path, the parameter's term in the sum
  std::optional<Signal> deflection;                       ///< minus the component's force F_s on this deflection
  bool machine = false;                                   ///< minus the machine's answer M to x_cmd
  Signal motion;                                          ///< that the residual may depend on
};

/// The relations that these channels allow. Each holds whatever the other parts of the rig do:
///
///   (1)  body        m_b z̈_b = F_s[dz_b] + F_act        F_s[d]: the component's model on the measured deflection
///   (2)  balance     m_w z̈_w + m_b z̈_b = F_w
///   (3)  tyre        F_w = k_t dz_w + b_t ḋz_w           in hil too, of the program's numbers
///   (4)  suspension  z̈_w − z̈_b = d²dz_b/dt²             sensors only, as (5) and (6)
///   (5)  tyre        z̈_r − z̈_w = d²dz_w/dt²
///   (6)  foot point  z̈_r = d²z_r/dt²
///   (7)  machine     x_act = M[x_cmd]                     hil and component_bench, as (8)
///   (8)  component   F = F_s[x_act]
///   (9)  mass        F − m ẍ = F_s[x_act]                 driven_mass: ẍ is z̈_b, or d²x_act/dt²; both: (6) of them
///
/// A channel that is not recorded is made of those that are (dz_w = z_r − z_w), or the relation is left out.
/// Source: structured residuals, J. Gertler, Fault Detection and Diagnosis in Engineering Systems, 1998, ch. 6.
[[nodiscard]] std::vector<ParityRelation> parity_relations(const model::RigParameters<double>& rig,
                                                           const firmware::Recording& recording);

/// The signal's samples: through a smooth window or, of order 0, as they are (nullptr).
[[nodiscard]] std::vector<double> samples_of(const firmware::Recording& recording, const Signal& signal,
                                             const SmoothWindow* window);

}  // namespace host_sim::identification
