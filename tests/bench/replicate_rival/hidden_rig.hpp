// A rig that a replication does not know exactly.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace replicate_rival {

/// The paper's rig behind a machine, with friction, stops and either free play or a top mount. `described` has every
/// number of `truth` 1 to 3 % wrong, to either side.
struct HiddenRig {
  std::string name;  ///< "B, 53 N, stop 10.4 mm, play 0.3 mm"
  char road;         ///< class of ISO 8608
  firmware::RigDescription described, truth;
};

/// From a seed: friction 20 … 200 N (even in its logarithm), stop from 6 … 20 mm with 200 kN/m, play 0.2 … 0.6 mm or a
/// top mount of 300 … 1000 kN/m (even in its logarithm), lag 15 … 25 ms, delay 3 … 6 ms, class B or C.
[[nodiscard]] HiddenRig draw_rig(std::uint64_t seed);

/// z̈_w of the true rig on its road, with its sensor's noise.
[[nodiscard]] firmware::Recording target_of(const HiddenRig& rig, double seconds, std::uint64_t seed);

/// A command that holds all frequencies of the target's band, for the rig to be identified with.
[[nodiscard]] std::vector<double> identifying_command(const HiddenRig& rig, double seconds, std::uint64_t seed);

/// The true rig behind its controller. InputError where it stops before its first sample.
[[nodiscard]] firmware::Recording run(const firmware::RigDescription& truth, const std::vector<double>& command,
                                      std::uint64_t seed);

/// Share of the time that the target spent at its stops.
[[nodiscard]] double share_at_stops(const HiddenRig& rig, double seconds, std::uint64_t seed);

}  // namespace replicate_rival
