// The road of a run: one road, a repeated road or a programme. It is checked before anything moves.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/devices/options.hpp"
#include "firmware/controller/reference/cycle_reference.hpp"
#include "firmware/controller/reference/programme_reference.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/simulation/road.hpp"

namespace firmware::controller {

/// The reference of a run.
class RunRoad {
 public:
  /// Reads and computes the roads. The whole run is looked at (run_objection) at its own level, every block and joint
  /// of it: InputError where it does not fit the limits. `operated`: somebody may ask for another level, so the highest
  /// one that fits is looked for. A replay shows what was, and is not looked at.
  RunRoad(const Options& options, const RigDescription& rig, const ReplayedRun* replayed, bool operated);

  [[nodiscard]] Reference& reference();
  [[nodiscard]] const std::string& text() const { return text_; }  ///< for the recording's comments
  /// P of a road that repeats; 0: it does not.
  [[nodiscard]] std::uint64_t cycle_samples() const { return cycle_samples_; }
  [[nodiscard]] const ProgrammeReference* programme() const { return programme_.get(); }
  /// The highest level that an operator may ask for, ReferencePlayer::highest_level at most.
  [[nodiscard]] double highest_level() const { return highest_level_; }

 private:
  void compute_road(const Options& options, const RigDescription& rig, const ReplayedRun* replayed);
  void compute_programme(const Options& options, const RigDescription& rig);
  void look(const Options& options, const RigDescription& rig, bool operated);

  std::vector<FootPointMotion> roads_;
  std::vector<ProgrammeReference::Block> blocks_;
  std::unique_ptr<CycleReference> cycles_;
  std::unique_ptr<ProgrammeReference> programme_;
  std::string text_;
  std::uint64_t cycle_samples_ = 0;
  double highest_level_;
};

}  // namespace firmware::controller
