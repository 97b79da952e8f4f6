// Constants of a sensor that no motion of the rig makes: the static wheel load, gravity, the distance of a laser.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim {

/// A constant that was taken off a channel.
struct StaticValue {
  enum class Kind : unsigned char {
    wheel_load,  ///< (m_b + m_w) g of F_w
    gravity,     ///< g of an acceleration
    unknown,     ///< a constant of which the description says nothing
  };
  model::Channel channel;
  double value;     ///< that was taken off: the channel's mean [SI]
  double expected;  ///< of its kind [SI]; 0: unknown
  Kind kind;
};

/// Constants in the channels of a recording, whose displacements and forces count from the static equilibrium:
///
///   (1)  F_w     |mean| nearer to (m_b + m_w) g than to 0      its mean is (m_b Δż_b + m_w Δż_w)/T of motion
///   (2)  z̈       |mean| nearer to g than to 0                  of a sensor that feels gravity
///   (3)  others  |mean| > 2 max |x − mean|                      it stays far from zero throughout
///
/// x_cmd and x_act have none: of both the model knows the mean, since one follows the other. In a hil rig the constant
/// of F goes round the loop. `unusable`: by channel, samples that say nothing; empty: none.
using UnusableSamples = std::array<std::vector<bool>, model::channel_count>;
[[nodiscard]] std::vector<StaticValue> static_values(const model::RigParameters<double>& rig,
                                                     const firmware::Recording& recording,
                                                     const UnusableSamples& unusable = {});

/// Takes them off.
void tare(const std::vector<StaticValue>& values, firmware::Recording& recording);

/// "F_w holds the static wheel load, 3241 N (described: 3237 N); it was taken off"
[[nodiscard]] std::string words(const StaticValue& value);

}  // namespace host_sim
