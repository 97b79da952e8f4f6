#include "host_sim/stability/map/boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "firmware/description/rig_description.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/margins/affine_family.hpp"
#include "host_sim/stability/margins/crossings.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::stability {
namespace {

/// Whether the loop is stable just below or just above `delay`, at which a pair of roots crosses.
bool is_border(const Polynomial& p, const Polynomial& q, double delay) {
  const auto frequencies = crossing_frequencies(p, q);
  const double beside = 1e-9 * std::max(delay, 1e-3);
  const auto before = unstable_roots(p, q, frequencies, std::max(0.0, delay - beside));
  const auto after = unstable_roots(p, q, frequencies, delay + beside);
  return (before && *before == 0) || (after && *after == 0);
}

/// Delay and virtual damping on the axis at ω, on one of the two branches of the quadratic.
struct OnAxis {
  double damping{}, delay{};  ///< the delay in 0 … 2π/ω
};

class DampingCurve {
 public:
  DampingCurve(AffineFamily family, const Axis& delay, const Axis& damping, bool delay_is_x)
      : family_(std::move(family)), delay_(delay), damping_(damping), delay_is_x_(delay_is_x) {}

  [[nodiscard]] std::vector<BoundaryCurve> trace() {
    const double top = highest_frequency(family_, std::max(std::abs(damping_.from), std::abs(damping_.to)));
    constexpr int pieces = 3000;
    const double first = 1e-4 * top;
    double before = first;
    walk_.push_back({first, at(first)});
    for (int i = 1; i <= pieces; ++i) {
      const double omega = first * std::pow(top / first, static_cast<double>(i) / pieces);
      refine(before, walk_.back().second, omega, at(omega), 24);
      before = omega;
    }
    return curves();
  }

 private:
  using Branches = std::array<std::optional<OnAxis>, 2>;

  [[nodiscard]] Branches at(double omega) const {
    const Complex s(0.0, omega);
    const Complex p0 = family_.p0(s), p1 = family_.p1(s), q0 = family_.q0(s), q1 = family_.q1(s);
    const double a = std::norm(p1) - std::norm(q1);
    const double b = (p0 * std::conj(p1) - q0 * std::conj(q1)).real();
    const double c = std::norm(p0) - std::norm(q0);
    Branches result;
    const double discriminant = b * b - a * c;
    if (!(discriminant >= 0.0)) return result;
    // Both solutions of the quadratic without cancellation.
    const double sum = -(b + std::copysign(std::sqrt(discriminant), b));
    const std::array<double, 2> values{sum / a, c / sum};
    for (std::size_t i = 0; i < 2; ++i) {
      // The larger one first, so that a branch is continuous where b changes its sign.
      const double damping = i == 0 ? std::max(values[0], values[1]) : std::min(values[0], values[1]);
      if (!std::isfinite(damping)) continue;
      double angle = -std::arg(-(p0 + damping * p1) / (q0 + damping * q1));
      if (angle < 0.0) angle += full_turn;
      result[i] = OnAxis{damping, angle / omega};
    }
    return result;
  }

  [[nodiscard]] bool inside(const OnAxis& point) const {
    const double slack = 1e-12 * (damping_.to - damping_.from);
    return point.damping >= damping_.from - slack && point.damping <= damping_.to + slack;
  }

  /// Whether the curve between two neighbours deviates visibly from a straight line.
  [[nodiscard]] bool coarse(const Branches& a, const Branches& b) const {
    constexpr double finest = 1.0 / 400.0;
    for (std::size_t i = 0; i < 2; ++i) {
      if (a[i].has_value() != b[i].has_value()) return true;
      if (!a[i]) continue;
      const double change = std::abs(a[i]->damping - b[i]->damping) / (damping_.to - damping_.from);
      const bool near =
          inside(*a[i]) || inside(*b[i]) || (a[i]->damping < damping_.from) != (b[i]->damping < damping_.from);
      if (!near) continue;
      if (change > finest) return true;
      const double later = std::abs(a[i]->delay - b[i]->delay) / (delay_.to - delay_.from);
      if (later > finest && inside(*a[i]) && inside(*b[i])) return true;
    }
    return false;
  }

  void refine(double low, const Branches& at_low, double high, const Branches& at_high, int depth) {
    if (depth > 0 && coarse(at_low, at_high)) {
      const double middle = 0.5 * (low + high);
      const Branches at_middle = at(middle);
      refine(low, at_low, middle, at_middle, depth - 1);
      refine(middle, at_middle, high, at_high, depth - 1);
      return;
    }
    walk_.push_back({high, at_high});
  }

  [[nodiscard]] std::vector<BoundaryCurve> curves() const {
    std::vector<BoundaryCurve> found;
    for (std::size_t branch = 0; branch < 2; ++branch) {
      std::map<int, BoundaryCurve> open;  // by the number of whole turns
      double before = 0.0;
      int shift = 0;  // of the turns, where the angle passes 2π
      for (const auto& [omega, branches] : walk_) {
        const auto& point = branches[branch];
        if (!point || !inside(*point)) {
          close(open, found);
          shift = 0;
          before = point ? point->delay * omega : 0.0;
          continue;
        }
        const double angle = point->delay * omega;
        if (!open.empty() && angle - before > 0.5 * full_turn) --shift;
        if (!open.empty() && angle - before < -0.5 * full_turn) ++shift;
        before = angle;
        std::map<int, BoundaryCurve> going_on;
        for (int k = 0;; ++k) {
          const double delay = point->delay + k * full_turn / omega;
          if (delay > delay_.to) break;
          if (delay < delay_.from) continue;
          const int key = k + shift;
          BoundaryCurve curve = open.contains(key) ? std::move(open[key]) : BoundaryCurve{true, {}};
          open.erase(key);
          const DelayEquation equation = family_.at(point->damping, delay);
          const bool border = is_border(equation.p(), equation.q(), delay);
          curve.points.push_back(delay_is_x_ ? BoundaryPoint{delay, point->damping, omega, border}
                                             : BoundaryPoint{point->damping, delay, omega, border});
          going_on.emplace(key, std::move(curve));
        }
        close(open, found);
        open = std::move(going_on);
      }
      close(open, found);
    }
    return found;
  }

  static void close(std::map<int, BoundaryCurve>& open, std::vector<BoundaryCurve>& found) {
    for (auto& [key, curve] : open) {
      if (curve.points.size() > 1) found.push_back(std::move(curve));
    }
    open.clear();
  }

  AffineFamily family_;
  const Axis& delay_;
  const Axis& damping_;
  bool delay_is_x_;
  std::vector<std::pair<double, Branches>> walk_;
};

bool is_damping(const Axis& axis) {
  return axis.variable == "virtual_damping" || axis.variable == "machine.virtual_damping";
}

/// With τ on one axis: the closed form at each value of the other.
BoundaryCurve by_values(const LoopFamily& family, const Axis& delay, const Axis& other, bool delay_is_x) {
  BoundaryCurve curve{false, {}};
  for (std::size_t i = 0; i < other.count; ++i) {
    const double value = other.value(i);
    const DelayEquation equation = family.at({{other.variable, value}});
    for (const Crossing& c : crossings(crossing_frequencies(equation.p(), equation.q()), delay.to)) {
      if (c.delay < delay.from) continue;
      const bool border = is_border(equation.p(), equation.q(), c.delay);
      curve.points.push_back(delay_is_x ? BoundaryPoint{c.delay, value, c.omega, border}
                                        : BoundaryPoint{value, c.delay, c.omega, border});
    }
  }
  return curve;
}

/// Between two parameters: zeros of the rightmost real part on the lines of the map.
BoundaryCurve on_lines(const LoopFamily& family, const StabilityMap& map) {
  BoundaryCurve curve{false, {}};
  const auto add = [&](const Axis& along, double low, double at_low, double high, double at_high, const Axis& across,
                       double fixed) {
    if ((at_low < 0.0) == (at_high < 0.0)) return;
    RootTracker tracker;
    Complex root;
    const auto value = [&](double position) {
      root = tracker.rightmost(family.at({{along.variable, position}, {across.variable, fixed}}));
      return root.real();
    };
    // Illinois method: a secant method that keeps the bracket.
    int side = 0;
    double position = low;
    for (int i = 0; i < 100 && std::abs(high - low) > 1e-13 * (along.to - along.from); ++i) {
      position = (low * at_high - high * at_low) / (at_high - at_low);
      const double here = value(position);
      if (here == 0.0 || std::abs(here) < 1e-12 * std::abs(root)) break;
      if ((here < 0.0) == (at_high < 0.0)) {
        high = position;
        at_high = here;
        if (side == -1) at_low *= 0.5;
        side = -1;
      } else {
        low = position;
        at_low = here;
        if (side == 1) at_high *= 0.5;
        side = 1;
      }
    }
    const bool along_x = &along == &map.x;
    curve.points.push_back({along_x ? position : fixed, along_x ? fixed : position, std::abs(root.imag()), true});
  };
  for (std::size_t iy = 0; iy < map.y.count; ++iy) {
    for (std::size_t ix = 0; ix < map.x.count; ++ix) {
      const double here = map.at(ix, iy), x = map.x.value(ix), y = map.y.value(iy);
      if (ix + 1 < map.x.count) add(map.x, x, here, map.x.value(ix + 1), map.at(ix + 1, iy), map.y, y);
      if (iy + 1 < map.y.count) add(map.y, y, here, map.y.value(iy + 1), map.at(ix, iy + 1), map.x, x);
    }
  }
  return curve;
}

}  // namespace

double& parameter_of(model::RigParameters<double>& rig, std::string_view variable) {
  double* const parameter =
      firmware::find_parameter(rig, variable == "virtual_damping" ? "machine.virtual_damping" : variable);
  if (parameter == nullptr) throw std::logic_error("stability: a variable that the rig does not have");
  return *parameter;
}

std::vector<BoundaryCurve> boundary(const LoopFamily& family, const StabilityMap& map) {
  if (!map.x.is_delay() && !map.y.is_delay()) return {on_lines(family, map)};
  const bool delay_is_x = map.x.is_delay();
  const Axis& delay = delay_is_x ? map.x : map.y;
  const Axis& other = delay_is_x ? map.y : map.x;
  if (!is_damping(other)) return {by_values(family, delay, other, delay_is_x)};
  const AffineFamily affine = affine_family(
      [&](double damping) {
        const DelayEquation equation = family.at({{other.variable, damping}});
        return LoopPolynomials{equation.p(), equation.q()};
      },
      1024.0);
  return DampingCurve(affine, delay, other, delay_is_x).trace();
}

}  // namespace host_sim::stability
