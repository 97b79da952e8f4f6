// The size from which an effect shows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/plan/rehearsal.hpp"

namespace host_sim::plan {

/// A value of an effect's parameter and how strongly the effect shows with it.
struct Size {
  double value;         ///< of the parameter [its unit]
  double significance;  ///< [standard deviations]
};

/// An effect that the rig might have, with values to try: one of its starts (cards in model/effects/).
struct Subject {
  const firmware::CatalogueEntry* entry;
  std::optional<model::Channel> channel;
  std::vector<double> values;                 ///< in the middle of the card's starts
  std::vector<std::vector<double>> starts{};  ///< all combinations of starts
  bool seen_by_itself = false;                ///< held values repeat: they show without any comparison

  [[nodiscard]] firmware::PlacedEffect placed() const { return {entry, channel, values}; }
};

/// All effects of the catalogue that have a place on this rig beside those described, and can act where it is driven.
[[nodiscard]] std::vector<Subject> subjects(const Rehearsal& rehearsal);

/// Signature of an effect over one of its parameters, all others in the middle of their starts.
///
/// A larger value may mean more of the effect (a friction) or less (a clearance): it means more where doubling the
/// value changes more than halving it. The significance grows with the size, so that a size with a given significance
/// is found by interpolation of logarithms between bounds. Of an effect with a corner the change is taken from a
/// simulation with thresholds::absent of it; so is that of an effect which still changes something when it is as small
/// as it can be simulated.
class SizeSearch {
 public:
  SizeSearch(const Rehearsal& rehearsal, const Subject& subject, std::size_t parameter);

  [[nodiscard]] const Size& at_default() const { return default_; }

  /// The size with this significance within thresholds::size_error. nullopt: none does within thresholds::range and the
  /// bounds of the card, because the effect does not grow so much, or does not vanish.
  [[nodiscard]] std::optional<Size> with(double significance);
  /// The most significant that was tried.
  [[nodiscard]] const Size& strongest() const { return strongest_; }
  /// Whether a smaller value is more of the effect: a limit, a clearance.
  [[nodiscard]] bool falls() const { return direction_ < 0.0; }
  /// The effect too small to act, of one with a corner.
  [[nodiscard]] const std::optional<firmware::PlacedEffect>& absent() const { return absent_effect_; }
  /// The change at a size.
  [[nodiscard]] std::optional<Change> change(double value) const;

 private:
  struct Trial {
    double place, significance;  ///< place: logarithm of the size, growing with the effect
  };
  /// Trials next to a significance, on either side.
  struct Bracket {
    std::optional<Trial> below{}, above{};
  };
  [[nodiscard]] Bracket bracket(double wanted) const;
  [[nodiscard]] double direction_at(double middle) const;
  void take_absent(double place);
  [[nodiscard]] double value_at(double place) const;
  [[nodiscard]] double place_of(double value) const;
  [[nodiscard]] std::optional<Trial> trial(double place);

  const Rehearsal& rehearsal_;
  const Subject& subject_;
  std::size_t parameter_;
  double neutral_ = 0.0;                 ///< value without effect, of a parameter of either sign
  double sign_ = 1.0;                    ///< of the difference to it
  double direction_ = 1.0;               ///< −1: a smaller value is more of the effect
  double lowest_ = 0.0, highest_ = 0.0;  ///< places
  std::optional<firmware::PlacedEffect> absent_effect_{};
  std::optional<Eigen::VectorXf> absent_{};  ///< residuals with it
  std::vector<Trial> trials_{};
  Size default_{}, strongest_{};
};

}  // namespace host_sim::plan
