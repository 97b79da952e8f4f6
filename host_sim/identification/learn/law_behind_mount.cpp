#include "host_sim/identification/learn/law_behind_mount.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host_sim/identification/common/golden_section.hpp"
#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/identification/predict/placed_law.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

constexpr int points_each_side = 8;
constexpr std::size_t most_samples = 20'000;  ///< of all that is fitted; 17 points and two numbers need no more
/// [1] The innermost point, relative to the rms of the velocity: dry friction is the step within.
constexpr double innermost = 0.05;

/// Three samples that follow each other, and whether they may be used.
struct Sample {
  double x, f;
  double dx, df;  ///< change over two samples
  double span;    ///< [s]
};

std::vector<Sample> samples_of(const IdentificationProblem& problem) {
  std::vector<Sample> list;
  std::size_t all = 0;
  for (const ProblemRecording& r : problem.recordings()) all += r.is_fitted() ? r.fitted.size() / r.samples->step : 0;
  const std::size_t every = all / most_samples + 1;
  for (const ProblemRecording& r : problem.recordings()) {
    const PreparedRecording& e = *r.samples;
    if (!r.is_fitted() || !e.recording.has(Channel::x_act) || !e.explains(Channel::F)) continue;
    const std::vector<double>&x = e.recording[Channel::x_act], &f = e.recording[Channel::F];
    const std::vector<bool>& clipped = e.clipped[index(Channel::F)];
    const std::size_t step = e.step;
    for (std::size_t k = e.compared_from(r.fitted.from) + step; k + step < r.fitted.to; k += step * every) {
      if (!clipped.empty() && (clipped[k - step] || clipped[k] || clipped[k + step])) continue;
      list.push_back({x[k], f[k], x[k + step] - x[k - step], f[k + step] - f[k - step], 2.0 * e.compared_period()});
    }
  }
  return list;
}

double rms_about_mean(const std::vector<Sample>& samples, double Sample::*value) {
  double sum = 0.0, squares = 0.0;
  for (const Sample& s : samples) {
    sum += s.*value;
    squares += s.*value * (s.*value);
  }
  const auto n = static_cast<double>(samples.size());
  return std::sqrt(std::max(squares / n - std::pow(sum / n, 2), 0.0));
}

/// (2) for one k.
struct Rest {
  double squares = INFINITY;
  LawBehindMount law{};
};

Rest rest_of(const std::vector<Sample>& samples, double compliance) {
  const auto velocity = [compliance](const Sample& s) { return (s.dx - compliance * s.df) / s.span; };
  double squares = 0.0, largest = 0.0;
  for (const Sample& s : samples) {
    const double v = velocity(s);
    squares += v * v;
    largest = std::max(largest, std::abs(v));
  }
  const double inner = innermost * std::sqrt(squares / static_cast<double>(samples.size()));
  if (!(inner > 0.0) || !std::isfinite(largest)) return {};
  Rest rest;
  rest.law.stiffness = 1.0 / compliance;
  rest.law.at = points_around(inner, largest, points_each_side);
  constexpr Eigen::Index count = 2 * points_each_side + 1, unknowns = count + 2;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns), row(unknowns);
  double power = 0.0;
  const auto& at = rest.law.at;
  for (const Sample& s : samples) {
    const double v = velocity(s);
    const auto above = std::clamp<std::ptrdiff_t>(std::upper_bound(at.begin(), at.end(), v) - at.begin(), 1, count - 1);
    const auto upper = static_cast<std::size_t>(above);
    const double share = (v - at[upper - 1]) / (at[upper] - at[upper - 1]);
    row.setZero();
    row[above] = share;
    row[above - 1] = 1.0 - share;
    row[points_each_side] = 0.0;  // f(0) = 0
    row[count] = 1.0;
    row[count + 1] = s.x;
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += s.f * row;
    power += s.f * s.f;
  }
  for (Eigen::Index i = 0; i < unknowns; ++i) {  // a point that no sample reaches stays at 0
    matrix(i, i) = matrix(i, i) > 0.0 ? matrix(i, i) * (1.0 + 1e-9) : 1.0;
  }
  const Eigen::VectorXd found = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  rest.squares = power - found.dot(right);
  rest.law.offset = found[count];
  rest.law.force.assign(found.data(), found.data() + count);
  return rest;
}

}  // namespace

std::optional<LawBehindMount> law_behind_mount(const IdentificationProblem& problem) {
  const std::vector<Sample> samples = samples_of(problem);
  if (samples.size() < thresholds::fewest_samples) return std::nullopt;
  const double softest = std::log(rms_about_mean(samples, &Sample::f) / rms_about_mean(samples, &Sample::x));
  if (!std::isfinite(softest)) return std::nullopt;
  constexpr int grid = 24;
  const double range = std::log(1000.0);
  const auto at = [&](int i) { return softest + range * i / grid; };
  const auto left = [&](double logarithm) { return rest_of(samples, std::exp(-logarithm)).squares; };
  std::vector<double> rests;
  for (int i = 0; i <= grid; ++i) rests.push_back(left(at(i)));
  const auto best = static_cast<int>(std::min_element(rests.begin(), rests.end()) - rests.begin());
  if (best == 0 || best == grid || !std::isfinite(rests[static_cast<std::size_t>(best)])) return std::nullopt;
  constexpr int rounds = 12;  // to a two-hundredth of a step of the grid
  const LowestPoint lowest = golden_section(left, at(best - 1), at(best + 1), rounds);
  return rest_of(samples, std::exp(-lowest.at)).law;
}

}  // namespace host_sim::identification
