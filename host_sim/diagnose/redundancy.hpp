// What the rig's redundancy says before anything is fitted: residuals that belong to one place each.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// A relation between measured channels, and how far it is from holding. Each holds whatever the other parts do:
///
///   (1)  body        m_b z̈_b = F_s[dz_b] + F_act        F_s[d]: the component's model on the measured deflection
///   (2)  balance     m_w z̈_w + m_b z̈_b = F_w
///   (3)  tyre        F_w = k_t dz_w + b_t ḋz_w           in hil too, of the program's numbers
///   (4)  suspension  z̈_w − z̈_b = d²dz_b/dt²             sensors only, as (5) and (6)
///   (5)  tyre        z̈_r − z̈_w = d²dz_w/dt²
///   (6)  foot point  z̈_r = d²z_r/dt²
///   (7)  machine     x_act = M[x_cmd]                     hil and component_bench, as (8)
///   (8)  component   F = F_s[x_act]
///
/// A channel that is not recorded is made of those that are (dz_w = z_r − z_w), or the relation is left out. All terms
/// are seen through one smooth window φ, a B-spline of degree 5: φ∗ÿ = φ″∗y, so nothing is differentiated twice by
/// differences. Parameters under tolerance that stand in a relation are first fitted to it, inside their bounds.
struct Residue {
  static constexpr std::size_t bands = 11;  ///< 0.5 … 60 Hz
  /// A place where a fault would show here, and what a unit of its power makes of the band, in that of noise.
  struct Suspect {
    std::string place;  ///< "suspension", "sensor F_w" …
    std::array<double, bands> gain{};
  };
  std::string relation;  ///< "body: m_b z̈_b = F_s[dz_b]"
  std::vector<Suspect> suspects;
  std::array<double, bands> excess{};  ///< power ÷ that of noise − 1, by band
  double significance = 0.0;           ///< of the strongest band above noise [standard deviations]
  double ratio = 1.0;                  ///< power ÷ that of noise, over the bands that are above it
  double lowest = 0.0, highest = 0.0;  ///< band that holds the middle 80 % of what is above noise [Hz]
  std::string looks;                   ///< what it goes with, in words; empty where it is noise, or nothing stands out
  [[nodiscard]] bool loud() const { return significance > 8.0 && ratio > 1.15; }
};

/// Over the fitted windows. Empty for a rig whose description has effects outside its component already: the relations
/// are those of a rig without.
[[nodiscard]] std::vector<Residue> redundancy(const RigDescription& description, const std::vector<Evidence>& evidence);

/// The place whose fault, with one spectrum, would make all relations as loud or quiet as they are: a force between two
/// bodies, or a sensor. Where that is as good for several, "body guide or sensor zdd_b"; empty where nothing is loud,
/// or none explains nine tenths of it, or more than three do.
[[nodiscard]] std::string likely_place(const std::vector<Residue>& residues);

}  // namespace host_sim::diagnose
