// Diagnosis while the rig runs: what has begun to be wrong, since when, and how much.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/live/reading_faults.hpp"
#include "host_sim/live/samples.hpp"
#include "host_sim/live/score_test.hpp"
#include "host_sim/live/twins.hpp"

namespace host_sim::live {

/// A cause of the catalogue or a parameter, with its size.
struct NamedCause {
  std::string name;     ///< of the effect or "suspension.damping"
  std::string channel;  ///< of a sensor's effect; empty: none
  std::string parameter, unit;
  double described = 0.0;  ///< value that the description has, or what was named before
  double value = 0.0, deviation = 0.0;
  std::string shows;  ///< how it shows in a recording
};

/// What has happened to the rig.
struct Finding {
  enum class Kind : unsigned char {
    named,        ///< a cause of the catalogue
    unexplained,  ///< the rig has changed, and no cause explains half of it
    stuck,        ///< a sensor shows one value while the model moves
    lost,         ///< a sensor shows nothing
    returned,     ///< it shows values again
  } kind = Kind::named;
  NamedCause cause;
  std::vector<NamedCause> rivals{};  ///< that explain it nearly as well
  double since = 0.0;                ///< [s] on the rig's clock
  double named_at = 0.0;             ///< [s]
  double motion = 0.0;               ///< [s] of motion between the two
  double share = 0.0;                ///< of the rise of the residual that the cause explains, 0 … 1
};

[[nodiscard]] std::string_view name(Finding::Kind kind);
/// One sentence.
[[nodiscard]] std::string sentence(const Finding& finding);

/// How far the diagnosis is.
struct Progress {
  enum class Stage : unsigned char { waiting, learning, watching } stage = Stage::waiting;
  double lacking = 0.0;   ///< [s] of motion until it watches
  std::string waits_for;  ///< why nothing could be learned of the motion so far; empty: nothing is wrong
  std::size_t candidates = 0;
  double largest = 0.0, level = 0.0;  ///< significance of the last block, and the one that is needed
  double watched = 0.0;               ///< [s] of motion that were tested
  std::size_t passed = 0;             ///< disturbances that were over before they had a name
};
[[nodiscard]] std::string_view name(Progress::Stage stage);

/// Takes samples one after the other:
///
///   1  acquaintance  the first seconds of motion: channels, noise, sizes, candidates        identification/prepare
///   2  baseline      what the model gets wrong from the beginning                            score_test.hpp (3)–(5)
///   3  watching      score tests of every candidate                                          score_test.hpp (7), (8)
///
/// A cause that was named becomes part of the described rig, and 2 begins again. So does it behind a gap, with the rig
/// as it is. An unexplained change becomes part of the baseline.
class LiveDiagnosis {
 public:
  /// InputError: this rig cannot be watched (a compensated loop).
  explicit LiveDiagnosis(const firmware::RigDescription& description);

  /// The findings that this sample completes. InputError: the samples do not hold what drives the simulation.
  [[nodiscard]] std::vector<Finding> push(const LiveSample& sample);

  [[nodiscard]] Progress progress() const;
  [[nodiscard]] const std::vector<Finding>& findings() const { return findings_; }

 private:
  void take(const Block& block);
  void begin();
  void observe(const Block& block);
  [[nodiscard]] bool moves(const Block& block) const;  ///< what drives it
  void conclude(const Onset& onset);
  /// A cause at a value.
  struct Sized {
    Cause cause;
    double value, deviation;  ///< [SI]
    double gain;              ///< [χ²] that it explains, less its price
  };
  /// The contenders of an onset, each by a second Newton step, from the value that the first one gave: those that are
  /// not linear in their parameter are told apart there. The best first.
  [[nodiscard]] std::vector<Sized> second_step(const Onset& onset) const;
  [[nodiscard]] static NamedCause named(const Sized& sized);
  void add(Finding finding);

  firmware::RigDescription description_;  ///< with what was named
  BlockBuffer buffer_;
  ReadingFaults readings_;
  std::deque<Block> known_;   ///< blocks of the acquaintance
  std::deque<Block> recent_;  ///< the latest ones that were observed, one behind the other
  std::optional<identification::PreparedRecording> prepared_;
  std::unique_ptr<Twins> twins_;
  std::unique_ptr<ScoreTest> test_;
  Residuals residuals_{};
  std::size_t run_in_ = 0;  ///< blocks that the simulations still need
  std::string waits_for_;
  std::vector<Finding> findings_, fresh_;
  double watched_ = 0.0;
  std::size_t passed_ = 0;
};

}  // namespace host_sim::live
