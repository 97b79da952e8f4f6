// A sequential score test: which cause has begun to act, since when, and how large it is.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace host_sim::live {

/// What one block says of each candidate: with r what the model leaves, g the change of the prediction that a cause of
/// the size of its start makes, σ what the model leaves of a channel when nothing is wrong,
///
///   (1)  b = Σ g r/σ²        score
///   (2)  A = Σ g²/σ²         information: what b would be, were the cause there with its start's size
struct BlockScore {
  std::vector<double> score, information;  ///< b and A by candidate
  double power = 0.0;                      ///< Σ r²/σ² of all channels
  double samples = 0.0;                    ///< of that sum
  double begins = 0.0, ends = 0.0;         ///< [s]
};

/// A candidate. Several sizes of one cause are candidates, too.
struct Tested {
  std::size_t cause;
  double lower, upper;  ///< size that it may have, in units of its start: a friction is never negative
  double price;         ///< [χ²] by which it must explain more than others to be named in their place
};

/// A cause that has begun. Sizes in units of the candidate's start, relative to the baseline.
struct Onset {
  std::size_t candidate = 0;
  double size = 0.0, deviation = 0.0;  ///< one Newton step: score/information, and its standard deviation
  double gain = 0.0;                   ///< [χ²] that it explains
  double share = 0.0;                  ///< of the rise of the residual, 0 … 1
  double since = 0.0, at = 0.0;        ///< [s] the begin of the window that shows it best; when that was known
  double motion = 0.0;                 ///< [s] of motion between the two
  bool named = false;                  ///< false: nothing of the candidates explains the rise
  bool last_word = false;              ///< the longest window is full: waiting tells no more
  bool passed = false;                 ///< it is over already: a push from outside
  double unit = 1.0;                   ///< [χ²] of noise: what one of white noise would be
  /// A cause at its best size.
  struct Contender {
    std::size_t candidate;
    double size, deviation, gain;
    double information, expected;  ///< ΣA, and the score that the baseline expects
  };
  /// Every cause that explains thresholds::least_share of what the best one does, the best first.
  std::vector<Contender> contenders{};
  std::size_t rivals = 0;  ///< of those behind the first, how many are within thresholds::rival
  std::size_t blocks = 0;  ///< of the window
};

/// Score tests (Rao, 1948) of every candidate over every window of 1 … thresholds::window blocks that ends now, a
/// generalised likelihood ratio over the onset (Willsky and Jones, 1976). What the model got wrong before is the
/// baseline, all blocks that have left the window:
///
///   (3)  θ₀ = Σb/ΣA,  β = Σb/N                                     size of each candidate in the baseline of N blocks,
///                                                                   and its mean score
///   (4)  s² = κ max(f ΣA, τ² ΣA²),  f = mean e²/A,  τ² = Σe²/ΣA²,  e = b − A θ₀     variance of a window's score
///   (5)  κ = max(1, 1 + 2 Σ_l ρ_l (1 − l/5)),  l = 1 … 4            blocks that follow each other are alike
///   (6)  e_W = Σb − the nearest of θ₀ ΣA … β n                      of a window of n blocks
///   (7)  t = e_W/√(s² + (ΣA)² κ f/ΣA₀)                              Student's t with as many degrees of freedom as the
///                                                                   baseline has blocks, less one
///   (8)  e_W²/ΣA > max_i θ₀i² ΣA_i                                  more than the model got wrong before
///
/// (4): f is what noise leaves, τ what a model that is wrong leaves, in proportion to its motion; the larger one counts.
/// (6): what the model gets wrong follows the motion, and the noise of its input, which is in r and in g, adds a mean
/// that does not; between the two lies what is expected when the motion becomes another. (8): with another motion, all
/// of what the model got wrong may look like any cause, so a fault that is smaller than that is not told from it.
/// A window is significant beyond the level of thresholds::false_names_per_hour. A cause has a name once it has lasted
/// thresholds::lasting blocks and explains thresholds::least_share of what rose.
class ScoreTest {
 public:
  /// `block` [s]
  ScoreTest(std::vector<Tested> candidates, double block);

  /// The next block of motion. What is concluded stays so, and is said with each block, until forget_window().
  [[nodiscard]] std::optional<Onset> add(BlockScore block);

  /// Forgets the window: what it showed is settled, or it holds samples of a sensor that has failed.
  void forget_window();

  /// Blocks that the baseline still lacks.
  [[nodiscard]] std::size_t lacking() const;
  /// [standard deviations] beyond which a window is significant.
  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] double largest() const { return largest_; }  ///< of the last block's windows [standard deviations]

 private:
  struct Sums {
    double b = 0.0, a = 0.0, bb_a = 0.0, bb = 0.0, ab = 0.0, aa = 0.0, z = 0.0, zz = 0.0;
    double lagged[4] = {};
    double previous[4] = {};
    std::size_t blocks = 0;

    [[nodiscard]] double mean() const { return a > 0.0 ? b / a : 0.0; }
    [[nodiscard]] double noise() const;      ///< f
    [[nodiscard]] double error() const;      ///< τ²
    [[nodiscard]] double alikeness() const;  ///< κ
  };
  struct Window {
    double b = 0.0, a = 0.0, aa = 0.0;
    std::size_t blocks = 0;
  };
  struct Found {
    std::size_t candidate = 0, blocks = 0;
    double deviations = 0.0;
  };

  void learn(const BlockScore& block);
  [[nodiscard]] Window window(std::size_t candidate, std::size_t blocks) const;
  [[nodiscard]] double variance(std::size_t candidate, const Window& w) const;
  [[nodiscard]] double beyond(std::size_t candidate, const Window& w) const;  ///< e_W
  [[nodiscard]] double size(std::size_t candidate, const Window& w) const;
  [[nodiscard]] double gain(std::size_t candidate, const Window& w) const;
  [[nodiscard]] double deviations(std::size_t candidate, const Window& w) const;
  [[nodiscard]] Found most_significant() const;
  [[nodiscard]] Onset describe(const Found& found) const;
  /// What rose in the residual of the last blocks [χ²], and its standard deviation without a cause.
  struct Rise {
    double size = 0.0, deviation = 0.0;
  };
  [[nodiscard]] Rise rise(std::size_t blocks) const;

  std::vector<Tested> candidates_;
  double block_, level_;
  std::vector<Sums> sums_;
  std::deque<BlockScore> window_;
  std::size_t learned_ = 0;
  double power_ = 0.0, power_squares_ = 0.0, samples_ = 0.0;
  std::optional<std::size_t> suspected_;  ///< blocks since a window was significant, from its begin
  double largest_ = 0.0;
};

/// Standard deviations of a normal distribution as improbable as `t` of Student's with ν degrees of freedom.
/// Source: D. L. Wallace, Bounds on normal approximations to Student's and the chi-square distributions, 1959.
[[nodiscard]] double normal_of_student(double t, double degrees);

/// The standard deviation beyond which, on both sides together, a normal distribution has `probability`.
[[nodiscard]] double two_sided_quantile(double probability);

}  // namespace host_sim::live
