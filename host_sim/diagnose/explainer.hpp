// Fits a set of effects, and one more beside it.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "host_sim/diagnose/candidates.hpp"
#include "host_sim/diagnose/fit.hpp"

namespace host_sim::diagnose {

struct Explanation;

/// What an effect must gain to be believed, in χ² of whitened residuals, and how widely is searched for it.
struct Price {
  double effect = 30.0;       ///< for each effect
  double parameter = 10.0;    ///< and each of its parameters
  double first_share = 0.03;  ///< of what is left over beyond noise
  double later_share = 0.30;
  bool sensors = true;              ///< effects of sensors are candidates
  std::size_t beam = 2, tried = 8;  ///< explanations kept for the next effect; candidates fitted beside each
  std::size_t compared = 8;         ///< candidates fitted in the place of each effect

  /// Of what is left over by an explanation, that one more effect must explain.
  [[nodiscard]] double share(const Explanation& base) const;
};

/// A set of effects, fitted.
struct Explanation {
  Fit fit;
  std::vector<PlacedEffect> effects;  ///< those found, without those of the rig description

  [[nodiscard]] double cost(const Price& price) const;
};

/// The case with only this share of each fitted window, from its beginning. Empty: pieces are not grown.
using Shorten = std::function<Case(double share)>;

/// Leaves of a fit what it says, not what the next step would need: megabytes for minutes.
void lighten(Fit& fit);

/// For one case: fits with the unknowns that all explanations share, and candidates beside one. From several threads.
class Explainer {
 public:
  Explainer(const Case& all, std::vector<Unknown> common, const Price& price)
      : all_(all), common_(std::move(common)), price_(price) {}

  [[nodiscard]] Explanation fitted(const Hypothesis& start, std::vector<PlacedEffect> effects, int most = 12,
                                   const Eigen::MatrixXd& known_slope = {}) const;

  /// The same with all slopes as they are in the end.
  [[nodiscard]] Explanation settled(const Hypothesis& start, std::vector<PlacedEffect> effects, int most = 12) const;
  void settle(Explanation& e, int most) const;

  [[nodiscard]] Explanation without(const Explanation& whole, std::size_t leave_out) const;

  /// One more effect: the candidates that promise most, fitted, best first. At most `most`; no more than three of those
  /// that promise less than a third of the best, and none that promises less than `least`.
  [[nodiscard]] std::vector<Explanation> extended(const Explanation& base, const Scales& scales, std::size_t most,
                                                  double least = 0.0) const;

  /// The hold of a channel whose renewals are regular, where it is not there yet.
  [[nodiscard]] std::optional<Explanation> held(const Explanation& base, const Scales& scales,
                                                model::Channel channel) const;

  /// Whether an effect is a hold that the values themselves show, repeated in regular turns: nothing else repeats them,
  /// so it has no rivals, however alike they are below 90 Hz.
  [[nodiscard]] bool is_seen(const PlacedEffect& effect) const;

  /// Fitted again in growing pieces; as it was where that is no better.
  void regrow(Explanation& e, const Shorten& shorten) const;

  /// Whether what an explanation leaves is noise, in each band and altogether.
  [[nodiscard]] bool leaves_noise(const Explanation& e) const;

  mutable std::atomic<std::size_t> simulations{0};  ///< so far
  mutable std::atomic<std::size_t> tried{0};        ///< candidates, so far

 private:
  struct Scanned;

  /// Everything that may move in a hypothesis with these effects: common unknowns first.
  [[nodiscard]] std::vector<Unknown> unknowns(const std::vector<PlacedEffect>& effects) const;

  /// Candidates beside an explanation, with what their starts promise; best first.
  [[nodiscard]] std::vector<Scanned> scan(const Explanation& base, const Scales& scales) const;

  /// A candidate beside an explanation, fitted from its best start or two; slopes of what is there are kept.
  [[nodiscard]] Explanation refined(const Explanation& base, const Scanned& scanned) const;

  /// A hold renewed by a clock of its own, in step with the recorder: where between two samples its values are taken
  /// only they tell. Golden section over what the renewals allow; all else makes way inside its bounds, since a little
  /// damping looks like a little time.
  void set_clock(Explanation& e, model::Channel channel) const;

  [[nodiscard]] bool repeats(model::Channel channel) const;

  const Case& all_;
  std::vector<Unknown> common_;
  const Price& price_;
};

}  // namespace host_sim::diagnose
