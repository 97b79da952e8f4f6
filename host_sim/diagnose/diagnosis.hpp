// Where rig and model disagree, which effect is missing, and what is left when it is there.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/diagnose/gap.hpp"
#include "host_sim/diagnose/named_effect.hpp"
#include "host_sim/diagnose/noise_bands.hpp"
#include "host_sim/diagnose/overlay.hpp"
#include "host_sim/diagnose/redundancy.hpp"
#include "host_sim/diagnose/search.hpp"
#include "host_sim/diagnose/where.hpp"
#include "host_sim/recording.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

enum class Verdict : unsigned char { no_discrepancy, named, ambiguous, unexplained };
[[nodiscard]] std::string_view name(Verdict verdict);

struct Diagnosis {
  Verdict verdict;
  std::vector<Residue> relations;  ///< of the rig's redundancy, before anything is fitted
  std::vector<Place> where;
  std::vector<BandPower> left_by_refit, left_after;  ///< tolerances refitted; effects, too
  std::vector<NamedEffect> effects;
  std::map<model::Channel, Gap> gap;
  std::map<std::string, Interval> parameters;  ///< tolerated, refitted
  bool unexplained = false;
  std::vector<Overlay> overlays;
  std::string rest;    ///< what the unexplained rest looks like, in words; empty without one
  RigDescription rig;  ///< with effects and refitted parameters
  double chi_squared_before = 0.0, chi_squared_refit = 0.0, chi_squared_after = 0.0;  ///< per residual: 1 is noise
  std::size_t simulations = 0, candidates = 0;                                        ///< tried
  std::vector<std::string> remarks;  ///< clipped samples, channels left out, noise estimated
};

struct Record {
  Recording recording;
  Use use;
};

/// InputError where the recordings are unfit.
[[nodiscard]] Diagnosis diagnose(const RigDescription& description, std::vector<Record> records, const Tell& tell = {});

}  // namespace host_sim::diagnose
