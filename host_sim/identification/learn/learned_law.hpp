// A law that was learned: its curve, what it looks like, and how sure that is.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

/// An explanation of what is left, by its kind.
struct Contender {
  std::string kind;  ///< "hysteresis", "a law over the velocity"
  Hypothesis hypothesis;
};

/// What learning found; the laws themselves stand in the hypothesis of the model that was searched on.
struct Learned {
  std::vector<std::string> rivals{};   ///< other laws that explain nearly as much, in words
  std::vector<double> odds_against{};  ///< of each of them
  double gain = 0.0;                   ///< [χ²] of the fitted windows, over the model without a law
  double gain_held_out = 0.0;          ///< of the held-out windows
  std::vector<std::string> remarks{};
  /// The two kinds that explain most, the better first: the law that was learned, or what came nearest. Two or none.
  std::vector<Contender> contenders{};
  std::optional<Hypothesis> without{};  ///< effects of the catalogue alone, where a law was found
  bool found = false;
};

/// A value with the interval that holds the truth with 95 %.
struct LawNumber {
  std::string name;
  double value, lower, upper;
};

/// Force over velocity of a surface at one deflection, with its 95 % band.
struct LawSection {
  double deflection;
  std::vector<double> at{}, force{}, lower{}, upper{};
};

/// A law in the words of verdict.json and of the report.
struct DescribedLaw {
  PlacedLaw law;
  std::string shape;                            ///< "power law"
  std::string words;                            ///< "grows with |v|^1.61 ± 0.04"
  std::vector<LawNumber> numbers;               ///< exponent …
  std::vector<double> at, force, lower, upper;  ///< curve with its 95 % band
  std::vector<LawSection> sections{};           ///< of a surface: at −2r, 0 and 2r
  double lowest = 0.0, highest = 0.0;           ///< x that was excited: beyond it the law is continued straight
  double confidence = 0.0;
  /// Force at the place minus the model's own, thinned, and the force the rig as described has there.
  std::vector<double> seen_at{}, seen_force{};
  /// With memory: the law along that motion, sample after sample.
  std::vector<double> loop_at{}, loop_force{};
};

}  // namespace host_sim::identification
