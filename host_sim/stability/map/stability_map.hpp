// The rightmost root over a plane of two parameters, and the stability border in it.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/stability/roots/characteristic_roots.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::stability {

/// Follows the rightmost root while an equation changes in small steps. Every result is proven: Newton from the
/// followed roots, then the argument principle on a line between them and all others. Where the two disagree, the roots
/// are searched again (characteristic_roots). Error below 1e-9 of the root.
class RootTracker {
 public:
  [[nodiscard]] Complex rightmost(const DelayEquation& equation);

  [[nodiscard]] std::size_t searches() const { return searches_; }  ///< number of new searches

 private:
  [[nodiscard]] bool follow(const DelayEquation& equation);
  void search(const DelayEquation& equation);

  std::vector<Complex> roots_;  // Im >= 0, rightmost first
  std::size_t searches_ = 0;
};

/// One side of the plane, or the variable of a sweep: `count` values from `from` to `to`, both included.
struct Axis {
  std::string variable;  ///< "tau": the loop delay [s]; "virtual_damping"; or a parameter path of the rig
  double from{}, to{};
  std::size_t count{};

  [[nodiscard]] double value(std::size_t i) const {
    return i + 1 == count ? to : from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  [[nodiscard]] bool is_delay() const { return variable == "tau"; }
};

/// "tau=0:0.03:200" → Axis; "a=…,b=…" → two. Throws UsageError when the text has another form, the range is
/// empty or outside the bounds of the variable, or the rig has no such parameter (the nearest name is suggested).
[[nodiscard]] Axis parse_axis(std::string_view text, const model::RigParameters<double>& rig, double period);
[[nodiscard]] std::pair<Axis, Axis> parse_map(std::string_view text, const model::RigParameters<double>& rig,
                                              double period);

/// The equation at a value of one or two variables; `extra_delay`: part of the loop delay that is not an effect.
class LoopFamily {
 public:
  LoopFamily(model::RigParameters<double> rig, double extra_delay) : rig_(std::move(rig)), extra_delay_(extra_delay) {}

  struct Setting {
    std::string_view variable;
    double value;
  };
  [[nodiscard]] DelayEquation at(const std::vector<Setting>& settings) const;
  [[nodiscard]] const model::RigParameters<double>& rig() const { return rig_; }

 private:
  model::RigParameters<double> rig_;
  double extra_delay_;
};

struct BoundaryPoint {
  double x{}, y{};  ///< in the variables of the map
  double omega{};   ///< of the pair of roots on the axis [rad/s]
  bool border{};    ///< stable on one side; false: a further pair crosses in the unstable region
};

/// `connected`: consecutive points form a line (axes tau and virtual_damping); otherwise the points are separate.
struct BoundaryCurve {
  bool connected{};
  std::vector<BoundaryPoint> points;
};

struct StabilityMap {
  Axis x, y;
  std::vector<double> rightmost;  ///< Re of the rightmost root [1/s], row after row of constant y
  std::vector<double> frequency;  ///< its Im [rad/s]
  std::vector<BoundaryCurve> boundary;
  std::size_t searches{};  ///< points that needed a new search
  unsigned threads{};

  [[nodiscard]] double at(std::size_t ix, std::size_t iy) const { return rightmost[iy * x.count + ix]; }
};

/// \param threads   0: one for each processor
/// \param progress  called repeatedly with the share that is done, from one thread only; may be empty
///
/// The boundary is exact: with τ on an axis it is the closed form |P| = |Q|, τ = −arg(−P/Q)/ω, by values of the other
/// parameter, and for virtual_damping, which enters P and Q linearly, parametrised by ω: |P₀ + b̃P₁|² = |Q₀ + b̃Q₁|² is
/// quadratic in b̃. Between two other parameters it is found on the lines of the map between two neighbours of opposite
/// verdict, to 1e-12 of the range.
[[nodiscard]] StabilityMap stability_map(const LoopFamily& family, const Axis& x, const Axis& y, unsigned threads = 0,
                                         const std::function<void(double)>& progress = {});

/// The roots at each value of one variable.
struct PoleSweep {
  Axis axis;
  std::vector<std::vector<Complex>> roots;  ///< right of the line, Im ≥ 0, rightmost first
};
[[nodiscard]] PoleSweep pole_sweep(const LoopFamily& family, const Axis& axis, double line);

}  // namespace host_sim::stability
