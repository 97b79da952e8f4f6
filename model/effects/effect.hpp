// What every candidate effect has: a name, a place, parameters with physical bounds, an equation, a way to act.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "model/channel.hpp"

namespace model {

/// Where an effect acts.
enum class Place : unsigned char { machine, suspension, fdva, body_guide, wheel_guide, tyre, sensor };

inline constexpr std::array<std::string_view, 7> place_names{"machine",     "suspension", "fdva",  "body guide",
                                                             "wheel guide", "tyre",       "sensor"};

[[nodiscard]] constexpr std::string_view name(Place place) { return place_names[static_cast<std::size_t>(place)]; }

/// One parameter of an effect. Bounds are physical: nobody would build or believe a rig beyond them.
struct EffectParameter {
  std::string_view name;
  std::string_view unit;
  double lower;
  double upper;
};

/// The kinds of rig an effect exists on, as a set.
class RigKinds {
 public:
  template <class... Kinds>
  explicit constexpr RigKinds(Kinds... kinds) : bits_((0U | ... | bit(kinds))) {}
  [[nodiscard]] constexpr bool contains(RigKind kind) const { return (bits_ & bit(kind)) != 0U; }

 private:
  static constexpr unsigned bit(RigKind kind) { return 1U << static_cast<unsigned>(kind); }
  unsigned bits_;
};

/// The card of an effect: everything about it but its numbers.
template <std::size_t ParameterCount>
struct EffectCard {
  std::string_view name;
  Place place;
  RigKinds rigs;
  bool needs_fdva;  ///< only where the rig has an FDVA
  std::array<EffectParameter, ParameterCount> parameters;
  std::string_view equation;
  std::string_view shows;  ///< how it shows in a recording
};

}  // namespace model
