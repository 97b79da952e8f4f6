// Why a law is asked for, and which effects may act beside it.
#pragma once

#include <vector>

#include "host_sim/identification/learn/law_behind_mount.hpp"
#include "host_sim/identification/predict/placed_law.hpp"
#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

using EffectsBeside = std::vector<firmware::PlacedEffect>;

/// A place and what acts beside a law there.
struct Beside {
  CurvePlace place;
  CurveOver over;
  EffectsBeside effects;
  const LawBehindMount* read_off = nullptr;  ///< the law begins as this, of the rig as described and without faults
};

/// What a law is asked for: whether more than noise is left; of the variables over which what was found may be another
/// law: two effects that may be one, or a power whose exponent may be another; and whether branches with memory may be
/// one.
struct Reasons {
  bool rest = false;
  bool velocity = false, deflection = false, memory = false;

  [[nodiscard]] bool any() const { return rest || velocity || deflection || memory; }
  [[nodiscard]] bool holds(CurvePlace place, CurveOver over) const {
    return rest || (place == CurvePlace::suspension && (over == CurveOver::velocity ? velocity : deflection));
  }
};
[[nodiscard]] Reasons reasons_for(const IdentificationProblem& problem, const SearchResult& found);

/// The mount that a law was read off behind, and the offset of F where that was not taken off. Empty: this rig has such a
/// mount, or no place for it.
[[nodiscard]] EffectsBeside effects_of(const LawBehindMount& law, const IdentificationProblem& problem,
                                       const model::RigParameters<double>& rig);

[[nodiscard]] model::Over variable_of(CurveOver over);
[[nodiscard]] model::Subsystem subsystem_of(CurvePlace place);
[[nodiscard]] bool is_friction(const firmware::PlacedEffect& effect);  ///< dry friction at the suspension
[[nodiscard]] bool is_guide(CurvePlace place);

/// What of the effects that were found may act beside a curve: those of sensors and of the machine, then also those of
/// other parts of the rig, with the friction at the place; last all but curves over the same variable.
[[nodiscard]] std::vector<EffectsBeside> effects_beside(const EffectsBeside& all, CurvePlace place, CurveOver over);

/// true: the effect can stand beside a law. It belongs to a sensor or to another part of the rig, or its force depends
/// on the other variable. Beside a law of a guide no other effect of that guide can.
[[nodiscard]] bool may_act_beside(const firmware::PlacedEffect& effect, CurvePlace place, CurveOver over);

/// Beside a stack of branches: everything but other memory and dry friction at the suspension, also with dry friction,
/// and what is elsewhere alone.
[[nodiscard]] std::vector<EffectsBeside> effects_beside_stack(const EffectsBeside& all);

/// Beside a law of a guide: everything but effects of that guide.
[[nodiscard]] EffectsBeside effects_beside_guide(const EffectsBeside& all, CurvePlace place);

}  // namespace host_sim::identification
