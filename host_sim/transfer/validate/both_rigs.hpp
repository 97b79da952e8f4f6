// Effects that live on one rig, and values that both rigs show.
#pragma once

#include <string>
#include <vector>

#include "host_sim/transfer/posterior/posterior.hpp"

namespace host_sim::transfer {

/// An effect with its parameters, as one rig shows it.
struct OwnedEffect {
  std::string name;     ///< of the catalogue; of a parameter outside its tolerance its path
  std::string channel;  ///< of a sensor effect
  std::string words;
  firmware::PlacedEffect effect{};  ///< entry nullptr: a parameter
  std::vector<LearnedValue> parameters{};
};

/// One value of the component, found on both rigs:
///
///   (1)  z = (a − b)/√(σ_a² + σ_b²)                  in logarithms where the value is positive by nature
///   (2)  pooled = (a/σ_a² + b/σ_b²)/(1/σ_a² + 1/σ_b²)
struct SharedValue {
  std::string path, unit;
  LearnedValue first, second, pooled;
  double z = 0.0;
  bool equal = true;  ///< |z| below thresholds::equal_within
};

/// A value, or the logarithm of one, and its standard deviation.
struct Estimate {
  double value, deviation;
};
/// `logarithm`: the estimates are those of logarithms.
[[nodiscard]] SharedValue shared_value(const std::string& path, const std::string& unit, Estimate first,
                                       Estimate second, bool logarithm);

struct BothRigs {
  std::vector<OwnedEffect> travels;                   ///< component effects that the first rig shows
  std::vector<OwnedEffect> stays;                     ///< its own
  std::vector<OwnedEffect> second_only;               ///< the second rig's own, named there
  std::vector<OwnedEffect> component_on_second_only;  ///< of the component, and not seen on the first rig
  std::vector<std::string> not_seen_on_second;        ///< travelled, and not named on the second rig
  std::vector<SharedValue> shared;
  bool second_unexplained = false;
};

/// What the first rig's diagnosis and posterior say.
[[nodiscard]] BothRigs sort_effects(const identification::Identified& first, const Posterior& posterior);

/// Adds what the second rig's own diagnosis says.
void compare_with_second(const identification::Identified& second, const Posterior& posterior, BothRigs& both);

/// The second rig's description with its own effects and parameters as its diagnosis has them; the component as
/// described.
[[nodiscard]] firmware::RigDescription with_own_effects(const firmware::RigDescription& to,
                                                        const identification::Diagnosis& second);

}  // namespace host_sim::transfer
