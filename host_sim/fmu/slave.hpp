// One instance of an FMU: states, values, steps.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/fmu/stepped_run.hpp"
#include "host_sim/fmu/variables.hpp"

namespace host_sim::fmu {

/// What an importer does wrong, in words for its log; the call leaves everything as it was.
class CallError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An instance by the state machine that co-simulation has in FMI 2.0 (2.0.4, figure 11) and, without its event mode,
/// in FMI 3.0 (4.2.1). Every function throws CallError where the call is not allowed in this state or its arguments are
/// wrong.
///
///   instantiated ─▶ initialising ─▶ stepping ─▶ terminated        reset(): back to instantiated from each of them
///
/// Time is counted in whole periods since the start, so communication points do not drift. A step that is no multiple
/// of the period is taken: outputs are those of the newest sample at or before the communication point, as a controller
/// of this rate shows them.
///
/// An excitation from outside holds at the communication point t_c at which it is set (input_at = "start"). The sample
/// at the end of a step belongs to the next point, whose inputs u are known when that point's outputs are taken after
/// them, or its step begins. Until then the sample is a prediction; then it is carried out anew, from the sample before:
///
///   (1)  û(t) = z + τ ż + τ²/2 z̈,  ż + τ z̈,  z̈           τ = t − t_c, where ż or z̈ is given
///   (2)  û(t) = z + τ (z − z₀)/(t_c − t₀),  0,  0          elsewhere; z₀, t₀: the point before
///
/// So the run is that of the inputs at their own instants, and only what is read of a sample before its inputs are set
/// has the error of the prediction: of (1) τ³/6 · z⃛, of (2) about τ² z̈. Samples within a step that no communication
/// point meets keep (1) or (2). Should the rig leave its limits by a prediction, it is tried with z held.
class Slave {
 public:
  enum class Phase : unsigned char { instantiated, initialising, stepping, terminated };

  /// Differences from a whole number of periods up to this are rounding, not time: an importer that adds up steps of
  /// 1 ms is 1e-7 periods off after 1000 s. At half or twice: the same for every step that is meant to be a multiple.
  static constexpr double period_rounding = 1e-6;
  /// So far [periods] an importer's communication point may be from where its last step ended.
  static constexpr double point_tolerance = 0.01;
  /// More periods in one step are refused: at 1 kHz eleven days.
  static constexpr double longest_step = 1e9;

  /// `text`: the rig description. InputError.
  explicit Slave(std::string text);

  void set_up(double start, std::optional<double> stop);
  void enter_initialisation();
  void exit_initialisation();
  void terminate();
  void reset();

  /// Values by reference; T: double, int, bool, std::string.
  template <class T>
  [[nodiscard]] T get(unsigned reference);
  /// All or none. The references must be of variables of this type.
  template <class T>
  void set(std::span<const unsigned> references, const std::vector<T>& values);

  /// False: the firmware has ended the run; time() says where.
  [[nodiscard]] bool step(double current, double size);
  [[nodiscard]] double time() const;  ///< of the communication point reached [s]
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::string why_ended() const;

  /// What is known of the communication point, with an excitation from outside that holds at it.
  struct Point {
    bool predicted = false;  ///< the newest sample is at it and was carried out before the inputs were known
    bool set = false;        ///< inputs have been set at it
    double last = 0.0;       ///< position at the point before [m]
    double step = 0.0;       ///< from there [s]; 0: there was none
  };

  /// Everything, for set_state() of any instance with this description. A copy of the run itself makes it quick in the
  /// instance that it came from; others repeat the run up to there, which gives the same bits.
  struct State {
    std::vector<Value> values{};
    Phase phase = Phase::instantiated;
    double start = 0.0, beyond = 0.0;
    std::uint64_t samples = 0;
    bool ended = false;
    std::vector<firmware::Motion> given{};  ///< excitation from outside: at the beginning, then of each sample
    Point point{};
    std::weak_ptr<SteppedRun> run{};
    SteppedRun::Saved saved{};
    SteppedRun::Saved before{};  ///< the sample before, while the newest is a prediction
  };
  [[nodiscard]] State state() const;
  void set_state(const State& state);
  [[nodiscard]] std::string serialise(const State& state) const;
  [[nodiscard]] State deserialise(std::string_view bytes) const;

  [[nodiscard]] const std::string& guid() const { return guid_; }
  [[nodiscard]] const Variables& variables() const { return variables_; }

 private:
  void demand(bool allowed, const char* call) const;
  void begin_run();
  void ensure_run();
  [[nodiscard]] firmware::Motion given() const;
  [[nodiscard]] bool from_outside() const;
  [[nodiscard]] bool at_start() const;
  [[nodiscard]] firmware::Motion predicted(double ahead) const;  ///< (1), (2)
  [[nodiscard]] bool advance(double ahead);
  void settle();
  [[nodiscard]] Value value_of(unsigned reference);

  firmware::RigDescription description_;
  std::string guid_;
  Variables variables_;
  std::vector<Value> values_;  ///< parameters and inputs as set
  Phase phase_ = Phase::instantiated;
  double start_ = 0.0;         ///< [s]
  std::uint64_t samples_ = 0;  ///< done since the start
  double beyond_ = 0.0;        ///< the communication point, after the newest sample [periods]
  bool ended_ = false;
  std::vector<firmware::Motion> given_{};
  Point point_{};
  SteppedRun::Saved before_{};
  std::shared_ptr<SteppedRun> run_{};
};

}  // namespace host_sim::fmu
