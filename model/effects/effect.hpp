// The card of an effect: all that the project knows of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "model/components/channel.hpp"
#include "model/numerics/require.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// The part of a rig on which an effect acts.
enum class Subsystem : unsigned char { machine, suspension, fdva, body_guide, wheel_guide, tyre, sensor, air_spring };

inline constexpr std::array<std::string_view, 8> subsystem_names{"machine",     "suspension", "fdva",   "body guide",
                                                                 "wheel guide", "tyre",       "sensor", "air spring"};

[[nodiscard]] constexpr std::string_view name(Subsystem subsystem) {
  return subsystem_names[static_cast<std::size_t>(subsystem)];
}

/// The kinds of rig on which an effect exists, as a set.
class RigKinds {
 public:
  template <class... Kinds>
  explicit constexpr RigKinds(Kinds... kinds) : bits_((0U | ... | bit(kinds))) {}
  [[nodiscard]] constexpr bool contains(RigKind kind) const { return (bits_ & bit(kind)) != 0U; }

 private:
  static constexpr unsigned bit(RigKind kind) { return 1U << static_cast<unsigned>(kind); }
  unsigned bits_;
};

inline constexpr RigKinds every_rig{RigKind::quarter_car, RigKind::hil, RigKind::component_bench, RigKind::driven_mass};
/// Rigs whose motion a machine makes.
inline constexpr RigKinds moved_rigs{RigKind::quarter_car, RigKind::hil, RigKind::component_bench};

/// How large things are in the recordings, from a simulation of them. Fits start in proportion to these.
struct MotionScales {
  double force{};              ///< of the component, rms [N]
  double deflection{};         ///< of the component, rms [m]
  double deflection_peak{};    ///< [m]
  double velocity{};           ///< of that deflection, rms [m/s]
  double velocity_peak{};      ///< [m/s]
  double acceleration{};       ///< of that deflection, rms [m/s²]
  double tyre_force{};         ///< dynamic, rms [N]
  double tyre_deflection{};    ///< rms [m]
  double foot_acceleration{};  ///< rms [m/s²]
  double ripple_period{};      ///< of a ripple over the deflection in what the model leaves of the force [m]
  double channel{};            ///< of the channel on whose sensor an effect acts, rms [unit of the channel]
};

/// Characteristic sizes of a parameter. A card may name one of these or bring a function of its own.
namespace scales {
inline constexpr double least = 1e-12;  ///< keeps a rig that stands still away from a division by zero [SI]

constexpr double unit(const MotionScales& /*s*/) { return 1.0; }          ///< the factors are the values [SI]
constexpr double millisecond(const MotionScales& /*s*/) { return 1e-3; }  ///< [s]
constexpr double channel(const MotionScales& s) { return s.channel; }
constexpr double force(const MotionScales& s) { return s.force; }
constexpr double deflection(const MotionScales& s) { return s.deflection; }
constexpr double deflection_peak(const MotionScales& s) { return s.deflection_peak; }
constexpr double ripple_period(const MotionScales& s) { return s.ripple_period; }
constexpr double velocity_peak(const MotionScales& s) { return s.velocity_peak; }
constexpr double stiffness(const MotionScales& s) { return s.force / std::max(s.deflection, least); }  ///< [N/m]
constexpr double damping(const MotionScales& s) { return s.force / std::max(s.velocity, least); }      ///< [N s/m]
constexpr double tyre_stiffness(const MotionScales& s) {                                               ///< [N/m]
  return s.tyre_force / std::max(s.tyre_deflection, least);
}
}  // namespace scales

/// A few factors: starts of a fit in units of its scale.
class Factors {
 public:
  constexpr Factors() = default;
  constexpr Factors(std::initializer_list<double> factors) {  // NOLINT(google-explicit-constructor): a list of factors
    for (const double factor : factors) factors_[count_++] = factor;
  }
  [[nodiscard]] constexpr const double* begin() const { return factors_.data(); }
  [[nodiscard]] constexpr const double* end() const { return factors_.data() + count_; }
  [[nodiscard]] constexpr std::size_t size() const { return count_; }

 private:
  std::array<double, 6> factors_{};
  std::size_t count_ = 0;
};

/// What the values of a channel show by themselves. Where they do not show it, there is no such effect.
enum class Reading : unsigned char {
  nothing,           ///< the start of a fit is a factor times a scale
  repeated_extreme,  ///< the largest |value|, where it comes again exactly: the start of a fit
  renewal_period,    ///< the time from one change of a held value to the next
};

/// Where the fit of a parameter starts: at each of the factors, or at what is read off the recording. Of an effect with
/// two parameters every pair of starts is tried.
struct Starts {
  double (*scale)(const MotionScales&) = nullptr;
  Factors factors{};
  Reading read = Reading::nothing;
};

/// A law that is in no catalogue and moves a rig as the effect does while one parameter is near a value.
struct Lookalike {
  std::string_view law{};  ///< its name; empty: there is none
  double at = 0.0;         ///< [unit of the parameter] mean of what is found where that law acts
  double deviation = 0.0;  ///< and its standard deviation
  double range = 0.0;      ///< in which the effect itself has any value
};

/// One parameter of an effect. Bounds are physical: nobody would build or believe a rig beyond them.
struct EffectParameter {
  std::string_view name;
  std::string_view unit;
  double lower;
  double upper;
  Starts starts;
  double neutral = 0.0;      ///< the value with which the effect does nothing, of a parameter that may have either sign
  bool fitted = true;        ///< false: what was read off the recording is the value
  double kept_within = 0.0;  ///< share of its start by which a fit may move it, where it is read off; 0: any
  bool from_contained = false;  ///< starts at the first parameter of the effect that this one contains, where that is
  Lookalike lookalike{};        ///< `diagnose` weighs the effect against it
};

/// What an effect is in the linearised loop of a hil rig, which `rigtwin stability` analyses.
enum class Linearisation : unsigned char {
  exact,     ///< linear, and acts through act_on: part of the loop as it is
  tangent,   ///< a law with a slope at rest (`tangent()`): that slope is part of the loop
  left_out,  ///< without a linear part at rest: left out of the loop, which the analysis says
  outside,   ///< does not act on the loop
};

/// Slopes of a law of the suspension at rest.
template <class S>
struct Tangent {
  S stiffness{};  ///< [N/m]
  S damping{};    ///< [N s/m]
};

/// An instant, decided by the motion, from which on an effect acts otherwise and changes the motion. Diagnose simulates
/// a rig with such effects in several steps a sample, and fits it in growing pieces of the recording: the fit has many
/// minima.
enum class Corner : unsigned char {
  none,
  sticking,    ///< dry friction: where a velocity comes to zero
  free_play,   ///< where play ends
  stop,        ///< where a stop is met
  rate_limit,  ///< where a limit of velocity is reached
  reversal,    ///< hysteresis that is much steeper on the way back: where the deflection turns
};

/// The variable of which the force of an effect is a curve, at its place.
enum class Over : unsigned char { nothing, velocity, deflection };

/// The form of a force: what a learned law of the same form is.
enum class Form : unsigned char {
  other,
  power,       ///< sign(x) |x|^p: dry friction has the exponent 0, a damper or a spring 1
  falling,     ///< dry friction that falls as the velocity grows
  two_slopes,  ///< a slope for each direction
  relaxing,    ///< a spring in series with a dashpot
};

struct ForceForm {
  Over over = Over::nothing;
  Form form = Form::other;
  double exponent = 0.0;  ///< p of Form::power

  [[nodiscard]] constexpr bool is_power(Over variable, double p) const {
    return over == variable && form == Form::power && exponent == p;
  }
};

/// How an effect makes what it acts on late: what a second clock (delay) or a low-pass of the recorder does as well.
enum class Lateness : unsigned char { none, delay, lag, resonance };

/// A number in the words of an effect, of its values and the described damping of the component [N s/m]. NaN: there are
/// no such words.
struct WordFigure {
  double (*of)(const double* values, double damping) = nullptr;
  int digits = 3;
};

/// What an effect that was found does, in the words of learned laws. `#` stands for the next of the figures; where the
/// first is negative, `otherwise` is said of its magnitude, if there is such a text.
struct Words {
  std::string_view text = {};
  std::string_view otherwise = {};
  std::array<WordFigure, 3> figures = {};
};

/// Everything about an effect but its values. Nothing in the project asks for an effect by its name: what it wants to
/// know stands here. Read by programs on a PC; of all this a board's program has names and bounds of parameters.
template <std::size_t ParameterCount>
struct EffectCard {
  std::string_view name;
  Subsystem subsystem;
  RigKinds rigs;
  bool needs_fdva = false;        ///< only where the rig has an FDVA
  bool needs_air_spring = false;  ///< only where it has an air spring
  std::array<EffectParameter, ParameterCount> parameters;
  std::string_view equation;
  std::string_view shows;  ///< how it shows in a recording
  Linearisation linearisation;
  Corner corner = Corner::none;
  /// Another effect that this one is for some of its values: it takes its place and never stands beside it.
  std::string_view contains = {};
  /// A law whose shape is free enough to imitate others: diagnose names it only where it leaves nothing but noise.
  bool imitates = false;
  ForceForm force = {};
  Lateness lateness = Lateness::none;
  Words words = {};
};

/// What is missing on a card, or wrong; empty: nothing.
template <std::size_t N>
[[nodiscard]] constexpr std::string_view find_gap(const EffectCard<N>& card) {
  if (card.name.empty() || card.equation.empty() || card.shows.empty()) return "name, equation and how it shows";
  for (const EffectParameter& p : card.parameters) {
    if (p.name.empty() || p.unit.empty()) return "name and unit of a parameter";
    if (!(p.lower < p.upper)) return "bounds of a parameter";
    const bool scaled = p.starts.scale != nullptr && p.starts.factors.size() > 0;
    if (scaled == (p.starts.read != Reading::nothing)) return "where the fit of a parameter starts";
    if (!p.fitted && p.starts.read == Reading::nothing) return "a parameter that is neither fitted nor read";
  }
  return {};
}

}  // namespace model
