#pragma once
#include <string>
#include <vector>

#include "tests/truth/truth.hpp"

namespace truth {

/// What can hide, and how large it is on a real rig.
struct Candidate {
  struct Parameter {
    std::string key;
    double low;  ///< first draw, logarithmic
    double high;
  };
  std::string name;
  std::string kinds;  ///< letters of q(uarter_car), h(il), b(ench)
  std::vector<Parameter> parameters;
  std::string strength;  ///< the parameter that is scaled to reach the wanted size; empty: none
  int exponent = 1;      ///< −1: a smaller value is the larger effect
  double least = 0.0;    ///< limits of the scaled parameter
  double most = 0.0;
  bool either_sign = false;
  std::string words;  ///< outside the catalogue: what truth.json says
  bool joins = true;  ///< drawn for pairs and triples too; false for effects added later: the draws of a seed stay
};

[[nodiscard]] const std::vector<Candidate>& rig_effects();     ///< of the contract, without a channel
[[nodiscard]] const std::vector<Candidate>& sensor_effects();  ///< of the contract, with a channel
[[nodiscard]] const std::vector<Candidate>& laws();  ///< of force over velocity or deflection, for group "law"
[[nodiscard]] const std::vector<Candidate>& outside_effects();  ///< not of the contract, in rig or component
[[nodiscard]] const std::vector<Candidate>& outside_sensors();  ///< not of the contract, in a channel
[[nodiscard]] const std::vector<Candidate>& neighbour_laws();   ///< not of the contract, but near one of its laws

/// Channels an effect of a sensor is drawn for: measured ones, without z_r, whose gain or lateness is that of the whole
/// rig's input.
[[nodiscard]] std::vector<std::string> suspects(Kind kind);

}  // namespace truth
