#include "host_sim/identification/learn/surface_fit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "host_sim/identification/learn/penalised_fit.hpp"
#include "host_sim/identification/learn/thresholds.hpp"

namespace host_sim::identification {
namespace {

using Grid = model::SurfaceTable<double>;

/// One axis of the grid: its nodes, and the finer points of the table, of which the nodes are some.
struct GridAxis {
  std::vector<double> nodes, points;
};

/// `at(share)`: a place on one side, from 0 at 0 to its end at 1; the other side likewise with its own end.
template <class Place>
GridAxis axis_of(const ExcitedRange& range, int nodes_each_side, Place at) {
  constexpr int each_side = (static_cast<int>(model::surface_points) - 1) / 2;
  const auto places = [&](int count) {
    std::vector<double> list;
    for (int i = -count; i <= count; ++i) {
      const double end = i < 0 ? -range.lowest : range.highest;
      if (i == 0) list.push_back(0.0);
      if (i == 0 || !(end > 0.0)) continue;
      const double x = at(std::abs(i) / static_cast<double>(count), end);
      list.push_back(i < 0 ? -x : x);
    }
    return list;
  };
  return {places(nodes_each_side), places(each_side)};
}

/// N of (1) at `points`: row p, column i. A natural spline's second derivatives m solve a tridiagonal system in the
/// values, so everything is linear in them.
Eigen::MatrixXd natural_spline(const std::vector<double>& nodes, const std::vector<double>& points) {
  const auto n = static_cast<Eigen::Index>(nodes.size());
  const auto h = [&](Eigen::Index i) {
    const auto k = static_cast<std::size_t>(i);
    return nodes[k + 1] - nodes[k];
  };
  Eigen::MatrixXd of_bends = Eigen::MatrixXd::Identity(n, n), of_values = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    of_bends.row(i).segment<3>(i - 1) << h(i - 1) / 6.0, (h(i - 1) + h(i)) / 3.0, h(i) / 6.0;
    of_values.row(i).segment<3>(i - 1) << 1.0 / h(i - 1), -1.0 / h(i - 1) - 1.0 / h(i), 1.0 / h(i);
  }
  const Eigen::MatrixXd second = of_bends.partialPivLu().solve(of_values);
  Eigen::MatrixXd spline = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()), n);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto above = std::upper_bound(nodes.begin(), nodes.end(), points[p]) - nodes.begin();
    const Eigen::Index i = std::clamp<Eigen::Index>(above, 1, n - 1) - 1;
    const double b = (points[p] - nodes[static_cast<std::size_t>(i)]) / h(i), a = 1.0 - b, h2 = h(i) * h(i) / 6.0;
    auto row = spline.row(static_cast<Eigen::Index>(p));
    row = h2 * ((a * a * a - a) * second.row(i) + (b * b * b - b) * second.row(i + 1));
    row(i) += a;
    row(i + 1) += b;
  }
  return spline;
}

/// The node (i, j) among those that are free, row by row; the node at (0, 0) is not.
struct FreeNode {
  std::size_t row, column;
};
std::vector<FreeNode> free_nodes(const std::vector<double>& deflections, const std::vector<double>& velocities) {
  std::vector<FreeNode> list;
  for (std::size_t i = 0; i < deflections.size(); ++i) {
    for (std::size_t j = 0; j < velocities.size(); ++j) {
      if (deflections[i] != 0.0 || velocities[j] != 0.0) list.push_back({i, j});
    }
  }
  return list;
}

GridAxis deflections_of(const ExcitedRange& range) {
  return axis_of(range, thresholds::deflection_nodes, [](double share, double end) { return share * end; });
}

GridAxis velocities_of(const ExcitedRange& range) {
  const double s = thresholds::innermost_velocity * range.rms;
  return axis_of(range, thresholds::velocity_nodes,
                 [s](double share, double end) { return s * std::sinh(share * std::asinh(end / s)); });
}

/// P of (2), on the free nodes.
Eigen::MatrixXd penalty_of(const std::vector<double>& deflections, const std::vector<double>& velocities) {
  const std::vector<FreeNode> free = free_nodes(deflections, velocities);
  const auto along = [&](const Eigen::MatrixXd& b, const auto& line_of, const auto& place_of) {
    const Eigen::MatrixXd p = b.transpose() * b;
    const auto count = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index m = 0; m < count; ++m) {
      for (Eigen::Index n = 0; n < count; ++n) {
        const FreeNode &one = free[static_cast<std::size_t>(m)], &other = free[static_cast<std::size_t>(n)];
        if (line_of(one) == line_of(other)) {
          all(m, n) = p(static_cast<Eigen::Index>(place_of(one)), static_cast<Eigen::Index>(place_of(other)));
        }
      }
    }
    return all;
  };
  const auto row = [](const FreeNode& node) { return node.row; };
  const auto column = [](const FreeNode& node) { return node.column; };
  return along(bends(velocities), row, column) + along(bends(deflections), column, row);
}

double largest(const Grid& table) {
  double most = 0.0;
  for (const auto& row : table.value) {
    for (const double value : row) most = std::max(most, std::abs(value));
  }
  return most;
}

/// (3): the surface as F_0, and what the data know of it. `law` is free at its nodes.
PlacedLaw determined(const PlacedLaw& law, const LawInformation& known) {
  const auto surface = [&](const Eigen::VectorXd& forces) {
    PlacedLaw other = law;
    other.values.assign(forces.begin(), forces.end());
    return surface_of(other);
  };
  SurfaceBasis basis{surface(known.now * known.scale), {}};
  const Eigen::MatrixXd m = known.matrix / known.temper;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(m, m + known.lambda * known.penalty);
  if (solver.info() == Eigen::Success) {
    for (Eigen::Index k = solver.eigenvalues().size(); k-- > 0 && solver.eigenvalues()(k) > 0.5;) {
      const Eigen::VectorXd direction = solver.eigenvectors().col(k);
      basis.directions.push_back(surface(direction / std::max(largest(surface(direction)), 1e-300)));
    }
  }
  PlacedLaw few = law;
  few.values.assign(basis.directions.size(), 0.0);
  few.basis = std::make_shared<const SurfaceBasis>(std::move(basis));
  return few;
}

}  // namespace

PlacedLaw surface_through(const ExcitedRange& deflection, const ExcitedRange& velocity,
                          const std::function<double(double, double)>& force) {
  PlacedLaw law{.over = CurveOver::both,
                .family = LawFamily::free_surface,
                .rms = deflection.rms,
                .largest = deflection.largest(),
                .rms_velocity = velocity.rms,
                .largest_velocity = velocity.largest()};
  const GridAxis x = deflections_of(deflection), v = velocities_of(velocity);
  const Eigen::MatrixXd over_x = natural_spline(x.nodes, x.points), over_v = natural_spline(v.nodes, v.points);
  SurfaceBasis basis;
  Grid& grid = basis.from;
  grid.rows = static_cast<std::uint8_t>(x.points.size());
  grid.columns = static_cast<std::uint8_t>(v.points.size());
  std::copy(x.points.begin(), x.points.end(), grid.deflection.begin());
  std::copy(v.points.begin(), v.points.end(), grid.velocity.begin());
  for (const FreeNode& node : free_nodes(x.nodes, v.nodes)) {
    Grid one = grid;
    for (std::size_t i = 0; i < one.rows; ++i) {
      for (std::size_t j = 0; j < one.columns; ++j) {
        one.value[i][j] = over_x(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(node.row)) *
                          over_v(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(node.column));
      }
    }
    basis.directions.push_back(one);
    law.values.push_back(force(x.nodes[node.row], v.nodes[node.column]));
  }
  basis.deflections = x.nodes;
  basis.velocities = v.nodes;
  law.basis = std::make_shared<const SurfaceBasis>(std::move(basis));
  return law;
}

std::optional<CandidateModel> fit_surface(const IdentificationProblem& problem, const SearchSpace& space,
                                          const Hypothesis& start, const std::vector<firmware::PlacedEffect>& effects,
                                          int most) {
  constexpr Eigen::Index straight = 3;  // x, v and x v
  const SurfaceBasis& nodes = *start.laws.back().basis;
  PenalisedFit fit(problem, space, start, effects, penalty_of(nodes.deflections, nodes.velocities), straight);
  if (!fit.is_finite()) return std::nullopt;
  fit.run(most);
  CandidateModel model = fit.model();
  std::vector<PlacedLaw>& laws = model.fit.hypothesis.laws;
  laws.back() = determined(laws.back(), fit.known());
  if (laws.back().values.empty()) return std::nullopt;
  put_laws(laws, model.fit.hypothesis.rig);
  model.fit.parameters = parameters_with_laws(space, model.fit.hypothesis, effects);
  return model;
}

}  // namespace host_sim::identification
