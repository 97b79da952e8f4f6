#include "host_sim/identification/predict/placed_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/laws/branch.hpp"
#include "model/laws/surface.hpp"

namespace host_sim::identification {
namespace {

using Kind = LawValue::Kind;

double sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/// The x below which a family bends most.
double bend(const PlacedLaw& law) {
  switch (law.family) {
    case LawFamily::soft_sign:
    case LawFamily::falling:
    case LawFamily::levelling:
      return 0.5 * law.values[1];
    default:
      return 0.3 * law.rms;
  }
}

model::LawPlace place_of(const PlacedLaw& law) {
  constexpr std::array places{model::LawPlace::suspension, model::LawPlace::tyre, model::LawPlace::body_guide,
                              model::LawPlace::wheel_guide};
  return places[static_cast<std::size_t>(law.place)];
}

}  // namespace

double between(const std::vector<double>& at, const std::vector<double>& value, double x) {
  if (at.size() < 2) return 0.0;
  const auto above = std::upper_bound(at.begin(), at.end(), x) - at.begin();
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above, 1, std::ssize(at) - 1));
  return value[i - 1] + (value[i] - value[i - 1]) * (x - at[i - 1]) / (at[i] - at[i - 1]);
}

std::vector<double> points_around(double bend, double largest, int each_side) {
  std::vector<double> points;
  const double last = std::asinh(largest / bend);
  for (int i = -each_side; i <= each_side; ++i) points.push_back(i == 0 ? 0.0 : bend * std::sinh(last * i / each_side));
  return points;
}

std::string_view name(CurvePlace place) {
  constexpr std::array<std::string_view, 4> names{"suspension", "tyre", "body_guide", "wheel_guide"};
  return names[static_cast<std::size_t>(place)];
}
std::string_view name(CurveOver over) {
  constexpr std::array<std::string_view, 3> names{"velocity", "deflection", "deflection and velocity"};
  return names[static_cast<std::size_t>(over)];
}

std::vector<model::BranchNumbers<double>> branches_of(const PlacedLaw& law) {
  std::vector<model::BranchNumbers<double>> list;
  for (std::size_t i = 0; i < law.values.size(); ++i) {
    const double c = law.values[i];
    if (!(c > 0.0)) continue;
    model::BranchNumbers<double> branch;
    branch.place = place_of(law);
    if (law.family == LawFamily::sliders) {
      branch.stiffness = c / law.at[i];
      branch.slip_force = c;
      branch.gap = law.gap;
    } else {
      branch.stiffness = c / law.rms;
      branch.time_constant = law.at[i];
    }
    list.push_back(branch);
  }
  return list;
}

const std::vector<LawValue>& values_of(LawFamily family) {
  constexpr LawValue c{"force", Kind::force, 0.0, 0.0}, other{"force_below", Kind::force, 0.0, 0.0};
  constexpr LawValue exponent{"exponent", Kind::exponent, 0.2, 5.0}, width{"width", Kind::width, 0.01, 5.0};
  static const std::array<std::vector<LawValue>, law_families> values{{{},
                                                                       {c, exponent},
                                                                       {c, other},
                                                                       {c, other, exponent},
                                                                       {c, width},
                                                                       {c, width},
                                                                       {c, other, width},
                                                                       {c, other, width},
                                                                       {c, width},
                                                                       {},
                                                                       {},
                                                                       {c, width},
                                                                       {c, exponent},
                                                                       {}}};
  return values[static_cast<std::size_t>(family)];
}

std::vector<double> PlacedLaw::forces_along(const std::vector<double>& x, double period) const {
  std::vector<double> forces(x.size(), 0.0);
  if (is_surface(family)) {
    const auto follow = [&](const auto& surface) {
      for (std::size_t k = 1; k + 1 < x.size(); ++k) forces[k] = surface(x[k], (x[k + 1] - x[k - 1]) / (2.0 * period));
    };
    if (family == LawFamily::free_surface) {
      follow(model::Surface<double>(surface_of(*this)));
    } else {
      follow([this](double deflection, double v) { return force(deflection, v); });
    }
    return forces;
  }
  if (!has_memory(family)) {
    std::transform(x.begin(), x.end(), forces.begin(), [this](double each) { return force(each); });
    return forces;
  }
  for (const model::BranchNumbers<double>& numbers : branches_of(*this)) {
    const model::Branch<double> branch(numbers, period);
    double w = 0.0;
    for (std::size_t k = 1; k < x.size(); ++k) {
      w = branch.after(w, x[k] - x[k - 1]);
      forces[k] += branch.force(w);
    }
  }
  return forces;
}

double PlacedLaw::force(double x) const {
  const double a = std::abs(x), s = sign(x);
  switch (family) {
    case LawFamily::points:
      return between(at, values, x);
    case LawFamily::power:
      return values[0] * s * std::pow(a / rms, values[1]);
    case LawFamily::two_slopes:
      return (x > 0.0 ? values[0] : values[1]) * x / rms;
    case LawFamily::two_powers:
      return (x > 0.0 ? values[0] : -values[1]) * std::pow(a / rms, values[2]);
    case LawFamily::soft_sign:
      return values[0] * std::tanh(x / values[1]);
    case LawFamily::falling:
      return -values[0] * (1.0 - std::exp(-(a / values[1]) * (a / values[1]))) * s;
    case LawFamily::knee:
      return s * (values[0] * std::min(a, values[2]) + values[1] * std::max(a - values[2], 0.0)) / rms;
    case LawFamily::one_sided:
      return (values[0] * std::max(x - values[2], 0.0) + values[1] * std::min(x + values[2], 0.0)) / rms;
    case LawFamily::levelling:
      return values[0] * x / (rms * (1.0 + a / values[1]));
    case LawFamily::follows_load:
    case LawFamily::along_stroke:
    case LawFamily::free_surface:
      return force(x, rms_velocity);
    case LawFamily::sliders:
    case LawFamily::maxwell:
      break;
  }
  const double pulled = s * std::max(a - 0.5 * gap, 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i] * (family == LawFamily::sliders ? std::clamp(pulled / at[i], -1.0, 1.0) : x / rms);
  }
  return sum;
}

namespace {

/// Some rows of (14).
model::SurfaceTable<double> free_surface_of(const PlacedLaw& law, std::size_t first, std::size_t rows) {
  const model::SurfaceTable<double>& from = law.basis->from;
  model::SurfaceTable<double> table;
  table.place = place_of(law);
  table.rows = static_cast<std::uint8_t>(rows);
  table.columns = from.columns;
  table.velocity = from.velocity;
  for (std::size_t i = 0; i < rows; ++i) {
    table.deflection[i] = from.deflection[first + i];
    for (std::size_t j = 0; j < table.columns; ++j) {
      double force = from.value[first + i][j];
      for (std::size_t k = 0; k < law.values.size(); ++k) {
        force += law.values[k] * law.basis->directions[k].value[first + i][j];
      }
      table.value[i][j] = force;
    }
  }
  return table;
}

/// (14) at one place: of its rows only the two around x.
double free_force(const PlacedLaw& law, double x, double v) {
  const model::SurfaceTable<double>& from = law.basis->from;
  const auto end = from.deflection.begin() + from.rows;
  const auto above = std::upper_bound(from.deflection.begin(), end, x) - from.deflection.begin();
  const auto first = std::clamp<std::ptrdiff_t>(above - 1, 0, from.rows - 2);
  return model::Surface<double>(free_surface_of(law, static_cast<std::size_t>(first), 2))(x, v);
}

}  // namespace

double PlacedLaw::force(double x, double v) const {
  const double along = std::abs(x) / rms;
  if (family == LawFamily::follows_load) return values[0] * along * std::tanh(v / values[1]);
  if (family == LawFamily::free_surface) return free_force(*this, x, v);
  if (family == LawFamily::along_stroke) return values[0] * std::pow(along, values[1]) * v / rms_velocity;
  return force(x);
}

model::SurfaceTable<double> surface_of(const PlacedLaw& law) {
  if (law.family == LawFamily::free_surface) return free_surface_of(law, 0, law.basis->from.rows);
  constexpr int each_side = (static_cast<int>(model::surface_points) - 1) / 2;
  const bool load = law.family == LawFamily::follows_load;
  // Straight over |x| and straight over v: three points are enough there.
  const double end = std::max(law.largest, law.farthest);
  const std::vector<double> x = points_around(0.5 * end, end, load ? 1 : each_side);
  const std::vector<double> v =
      points_around(load ? 0.5 * law.values[1] : law.largest_velocity, law.largest_velocity, load ? each_side : 1);
  model::SurfaceTable<double> table;
  table.place = place_of(law);
  table.rows = static_cast<std::uint8_t>(x.size());
  table.columns = static_cast<std::uint8_t>(v.size());
  std::copy(x.begin(), x.end(), table.deflection.begin());
  std::copy(v.begin(), v.end(), table.velocity.begin());
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) table.value[i][j] = law.force(x[i], v[j]);
  }
  return table;
}

LawTable table_of(const PlacedLaw& law) {
  if (law.family == LawFamily::points) return {law.at, law.values};
  constexpr int each_side = 16;
  const double end = std::max(law.largest, law.farthest);
  std::vector<double> side;  // x > 0
  if (law.family == LawFamily::power || law.family == LawFamily::two_powers) {
    // The cubics are off by some h³ F″²/F′, h: to the next point. It is the same everywhere where x grows as i^(3/p).
    const double grows = 3.0 / law.values.back();
    for (int i = 1; i <= each_side; ++i) side.push_back(end * std::pow(static_cast<double>(i) / each_side, grows));
  } else {
    const double s = bend(law), last = std::asinh(end / s);
    for (int i = 1; i <= each_side; ++i) side.push_back(s * std::sinh(last * i / each_side));
  }
  if (law.family == LawFamily::knee || law.family == LawFamily::one_sided) {  // a point on the corner and one beside it
    const double w = law.values[2];
    auto nearest = std::min_element(side.begin(), side.end(),
                                    [w](double a, double b) { return std::abs(a - w) < std::abs(b - w); });
    if (nearest + 1 != side.end()) *nearest = w;
  }
  LawTable table;
  for (auto x = side.rbegin(); x != side.rend(); ++x) table.at.push_back(-*x);
  table.at.push_back(0.0);
  table.at.insert(table.at.end(), side.begin(), side.end());
  for (const double x : table.at) table.value.push_back(law.force(x));
  return table;
}

void put_laws(const std::vector<PlacedLaw>& laws, model::RigParameters<double>& rig) {
  for (const PlacedLaw& law : laws) {
    if (has_memory(law.family)) {
      const auto branches = branches_of(law);
      rig.laws.branch_count = static_cast<std::uint8_t>(law.slot);
      for (std::size_t i = 0; i < std::min(branches.size(), rig.laws.branches.size() - law.slot); ++i) {
        rig.laws.branches[rig.laws.branch_count++] = branches[i];
      }
      continue;
    }
    if (is_surface(law.family)) {
      if (law.slot >= rig.laws.surfaces.size()) continue;
      rig.laws.surfaces[law.slot] = surface_of(law);
      rig.laws.surface_count = static_cast<std::uint8_t>(std::max<std::size_t>(rig.laws.surface_count, law.slot + 1));
      continue;
    }
    if (law.slot >= rig.laws.curves.size()) continue;
    const LawTable table = table_of(law);
    auto& out = rig.laws.curves[law.slot];
    out.place = place_of(law);
    out.over = law.over == CurveOver::velocity ? model::LawOver::velocity : model::LawOver::deflection;
    out.count = static_cast<std::uint8_t>(std::min(table.at.size(), model::curve_points));
    std::copy_n(table.at.begin(), out.count, out.at.begin());
    std::copy_n(table.value.begin(), out.count, out.value.begin());
    rig.laws.curve_count = static_cast<std::uint8_t>(std::max<std::size_t>(rig.laws.curve_count, law.slot + 1));
  }
}

}  // namespace host_sim::identification
