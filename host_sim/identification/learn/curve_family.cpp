#include "host_sim/identification/learn/curve_family.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "host_sim/identification/learn/thresholds.hpp"

namespace host_sim::identification {
namespace {

using Kind = LawValue::Kind;

/// The values of a family that are searched on a grid.
std::vector<double> grid_of(const LawValue& value, double rms) {
  std::vector<double> grid;
  if (value.kind == Kind::exponent) {
    for (double p = value.lower; p <= value.upper; p += thresholds::exponent_step) grid.push_back(p);
  } else {
    for (double w = value.lower; w <= value.upper; w *= thresholds::width_factor) grid.push_back(w * rms);
  }
  return grid;
}

/// The forces of a member that fit best, while its last value is what it is.
void solve_forces(const CurveFit& curve, FamilyMember& member) {
  const std::vector<LawValue>& values = values_of(member.law.family);
  const auto n = static_cast<Eigen::Index>(curve.at.size());
  const auto forces = static_cast<Eigen::Index>(
      std::count_if(values.begin(), values.end(), [](const LawValue& v) { return v.kind == Kind::force; }));
  Eigen::MatrixXd basis(n, forces);
  for (Eigen::Index f = 0; f < forces; ++f) {
    PlacedLaw one = member.law;
    for (Eigen::Index k = 0; k < forces; ++k) one.values[static_cast<std::size_t>(k)] = k == f ? 1.0 : 0.0;
    for (Eigen::Index i = 0; i < n; ++i) basis(i, f) = one.force(curve.at[static_cast<std::size_t>(i)]);
  }
  Eigen::MatrixXd h = basis.transpose() * curve.matrix * basis;
  const Eigen::VectorXd g = basis.transpose() * (curve.matrix * curve.force - curve.gradient);
  h.diagonal() *= 1.0 + 1e-12;
  h.diagonal().array() += 1e-300;
  const Eigen::VectorXd c = h.ldlt().solve(g);
  for (Eigen::Index f = 0; f < forces; ++f) member.law.values[static_cast<std::size_t>(f)] = c(f);
  member.farther = curve.farther(basis * c);
}

}  // namespace

std::vector<FamilyMember> families_of(const CurveFit& curve, bool beside_friction) {
  const PlacedLaw& free = curve.model.fit.hypothesis.laws.back();
  std::vector<FamilyMember> list;
  for (const LawFamily family : {LawFamily::power, LawFamily::two_slopes, LawFamily::two_powers, LawFamily::soft_sign,
                                 LawFamily::falling, LawFamily::knee, LawFamily::one_sided, LawFamily::levelling}) {
    if (family == LawFamily::falling && !(beside_friction && free.over == CurveOver::velocity)) continue;
    if (family == LawFamily::soft_sign && free.over != CurveOver::velocity) continue;
    if (family == LawFamily::one_sided && free.over != CurveOver::deflection) continue;
    const std::vector<LawValue>& values = values_of(family);
    FamilyMember best;
    best.farther = INFINITY;
    FamilyMember member{free, 0.0};
    member.law.family = family;
    member.law.at.clear();
    member.law.values.assign(values.size(), 0.0);
    std::vector<double> grid{0.0};
    if (values.back().kind != Kind::force) grid = grid_of(values.back(), free.rms);
    for (const double value : grid) {
      if (values.back().kind == Kind::width && value > free.largest) break;
      if (values.back().kind != Kind::force) member.law.values.back() = value;
      solve_forces(curve, member);
      if (std::isfinite(member.farther) && member.farther < best.farther) best = member;
    }
    if (std::isfinite(best.farther)) list.push_back(best);
  }
  const SelectionCriterion criterion;
  const auto cost = [&](const FamilyMember& m) {
    return m.farther + criterion.parameter * static_cast<double>(m.law.values.size());
  };
  std::sort(list.begin(), list.end(), [&](const FamilyMember& a, const FamilyMember& b) { return cost(a) < cost(b); });
  return list;
}

}  // namespace host_sim::identification
