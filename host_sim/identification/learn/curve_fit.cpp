#include "host_sim/identification/learn/curve_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/identification/learn/penalised_fit.hpp"
#include "host_sim/identification/learn/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// (2) of the points that are free: all but 0.
Eigen::MatrixXd bends_of_free(const std::vector<double>& at) {
  const Eigen::MatrixXd all = bends(at);
  Eigen::MatrixXd free(all.rows(), all.cols() - 1);
  const auto zero = std::find(at.begin(), at.end(), 0.0) - at.begin();
  free << all.leftCols(zero), all.rightCols(all.cols() - 1 - zero);
  return free;
}

}  // namespace

PlacedLaw flat_curve(CurvePlace place, CurveOver over, const ExcitedRange& range) {
  PlacedLaw law{place, over, LawFamily::points, range.rms, range.largest()};
  const double innermost = thresholds::innermost_point * range.rms;
  for (const double x : points_around(innermost, range.largest(), thresholds::points_each_side)) {
    if (x < thresholds::beyond_range * range.lowest || x > thresholds::beyond_range * range.highest) continue;
    law.at.push_back(x);
  }
  law.values.assign(law.at.size(), 0.0);
  law.farthest = thresholds::table_beyond * range.farthest;
  return law;
}

std::optional<CurveFit> fit_curve(const IdentificationProblem& problem, const SearchSpace& space,
                                  const Hypothesis& start, const std::vector<firmware::PlacedEffect>& effects,
                                  int most) {
  const std::vector<double>& at = start.laws.back().at;
  const Eigen::MatrixXd b = bends_of_free(at);
  PenalisedFit fit(problem, space, start, effects, b.transpose() * b, 1);
  if (!fit.is_finite()) return std::nullopt;
  fit.run(most);
  const LawInformation& known = fit.known();
  CurveFit out;
  out.matrix = known.matrix / (known.scale * known.scale * known.temper);
  out.gradient = known.gradient / (known.scale * known.temper);
  out.force = known.now * known.scale;
  for (const double x : at) {
    if (x != 0.0) out.at.push_back(x);
  }
  out.temper = known.temper;
  out.freedom = known.freedom();
  out.gain = fit.gain();
  out.model = fit.model();
  return out;
}

}  // namespace host_sim::identification
