#include "host_sim/comparison/refit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/least_squares/gauss_newton.hpp"

namespace host_sim {
namespace {

using Rig = model::RigParameters<double>;

constexpr int most_steps = 60;  // of each start; real fits take 5 to 15
constexpr int starts = 3;

/// A parameter that may move, as a factor on its value in the description.
struct Free {
  std::string path;
  double value;
  double lowest;   ///< factor
  double highest;  ///< factor
};

std::vector<Free> free_parameters(const firmware::RigDescription& description) {
  std::vector<Free> free;
  Rig rig = description.rig;
  for (const auto& [path, tolerance] : description.tolerance) {
    const double value = *firmware::find_parameter(rig, path);
    // A relative bound on zero, or of zero, leaves nothing to fit. Masses and stiffnesses stay off zero.
    if (value != 0.0 && tolerance > 0.0)
      free.push_back({path, value, std::max(1.0 - tolerance, 1e-3), 1.0 + tolerance});
  }
  return free;
}

/// Channels that are compared, over all recordings.
double channel_count(const std::vector<ComparedRecording>& recordings) {
  double count = 0.0;
  for (const ComparedRecording& recording : recordings) {
    count += static_cast<double>(recording.residual_count()) / static_cast<double>(recording.recording().size());
  }
  return count;
}

/// (1) as a least-squares problem in the factors.
class RefitProblem {
 public:
  RefitProblem(const firmware::RigDescription& description, const std::vector<ComparedRecording>& recordings,
               const std::function<void(double, double)>& progress)
      : description_(description),
        recordings_(recordings),
        progress_(progress),
        free_(free_parameters(description)),
        channels_(channel_count(recordings)) {}

  [[nodiscard]] const std::vector<Free>& free() const { return free_; }
  [[nodiscard]] const Eigen::VectorXd& factors() const { return factors_; }
  [[nodiscard]] double pooled_error() const { return std::sqrt(chi_squared() / channels_); }

  /// false: no rig, or not a finite simulation.
  bool begin(int start, const Eigen::VectorXd& factors) {
    start_ = start;
    jacobians_ = 0;
    factors_ = factors;
    auto residual = residual_at(factors);
    if (!residual) return false;
    residual_ = std::move(*residual);
    return true;
  }

  [[nodiscard]] Rig rig_at(const Eigen::VectorXd& factors) const {
    Rig rig = description_.rig;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      *firmware::find_parameter(rig, free_[i].path) = free_[i].value * factors(static_cast<Eigen::Index>(i));
    }
    return rig;
  }

  bool find_jacobian() {
    if (progress_) {
      const double done = std::min(1.0, static_cast<double>(jacobians_++) / most_steps);
      progress_((start_ + done) / starts, pooled_error());
    }
    jacobian_.setZero(residual_.size(), factors_.size());
    for (Eigen::Index i = 0; i < factors_.size(); ++i) {
      // A forward difference; backward at a bound, or where the step makes no rig (a delay as long as its line).
      constexpr double difference = 1e-6;
      const bool at_bound = factors_(i) + difference > free_[static_cast<std::size_t>(i)].highest;
      for (const double step : {at_bound ? -difference : difference, at_bound ? difference : -difference}) {
        Eigen::VectorXd factors = factors_;
        factors(i) += step;
        const auto moved = residual_at(factors);
        if (!moved) continue;
        jacobian_.col(i) = (*moved - residual_) / step;
        break;
      }
    }
    return true;
  }

  [[nodiscard]] NormalEquations normal_equations() const {
    return {jacobian_.transpose() * jacobian_, jacobian_.transpose() * residual_};
  }

  /// Inside the bounds, and half of the described value at most: a rig is not linear in its parameters further than
  /// that.
  [[nodiscard]] StepBox box(double trust) const {
    constexpr double trust_radius = 0.5;  // factor
    StepBox box{Eigen::VectorXd(factors_.size()), Eigen::VectorXd(factors_.size())};
    for (Eigen::Index i = 0; i < factors_.size(); ++i) {
      const Free& free = free_[static_cast<std::size_t>(i)];
      box.lower(i) = std::max(free.lowest - factors_(i), -trust * trust_radius);
      box.upper(i) = std::min(free.highest - factors_(i), trust * trust_radius);
    }
    return box;
  }

  [[nodiscard]] double chi_squared() const { return residual_.squaredNorm(); }

  std::optional<double> try_step(const Eigen::VectorXd& d) {
    tried_factors_ = factors_ + d;
    for (Eigen::Index i = 0; i < d.size(); ++i) {  // rounding must not leave the bounds
      const Free& free = free_[static_cast<std::size_t>(i)];
      tried_factors_(i) = std::clamp(tried_factors_(i), free.lowest, free.highest);
    }
    auto residual = residual_at(tried_factors_);
    if (!residual) return std::nullopt;
    tried_residual_ = std::move(*residual);
    return tried_residual_.squaredNorm();
  }

  void accept() {
    factors_ = tried_factors_;
    residual_ = tried_residual_;
  }

 private:
  /// Normalised errors of all recordings; nullopt: the factors make no rig, or one that does not stay finite.
  [[nodiscard]] std::optional<Eigen::VectorXd> residual_at(const Eigen::VectorXd& factors) const {
    const Rig rig = rig_at(factors);
    if (firmware::find_rig_fault(rig, description_.period())) return std::nullopt;
    std::vector<double> all;
    for (const ComparedRecording& recording : recordings_) recording.residuals(recording.simulate(rig), all);
    Eigen::VectorXd residual = Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
    if (!residual.allFinite()) return std::nullopt;
    return residual;
  }

  const firmware::RigDescription& description_;
  const std::vector<ComparedRecording>& recordings_;
  const std::function<void(double, double)>& progress_;
  std::vector<Free> free_;
  double channels_;
  int start_ = 0, jacobians_ = 0;
  Eigen::VectorXd factors_, residual_, tried_factors_, tried_residual_;
  Eigen::MatrixXd jacobian_;
};

std::vector<std::string> at_bounds(const RefitProblem& problem) {
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < problem.free().size(); ++i) {
    const Free& free = problem.free()[i];
    const double factor = problem.factors()(static_cast<Eigen::Index>(i)), margin = 1e-6 * (free.highest - free.lowest);
    if (factor < free.lowest + margin || factor > free.highest - margin) paths.push_back(free.path);
  }
  return paths;
}

}  // namespace

Refit refit(const firmware::RigDescription& description, const std::vector<ComparedRecording>& recordings,
            const std::function<void(double share, double pooled_error)>& progress) {
  RefitProblem problem(description, recordings, progress);
  const auto n = static_cast<Eigen::Index>(problem.free().size());
  if (n == 0) {
    throw firmware::InputError(description.source, 0, "nothing to refit", "parameters that may move under [tolerance]");
  }
  if (std::all_of(recordings.begin(), recordings.end(), [](const auto& r) { return r.residual_count() == 0; })) {
    throw firmware::InputError(recordings.front().recording().source, 0, "nothing moves in it that could be fitted",
                               "a recording of a rig that was shaken");
  }
  Refit best;
  best.pooled_before = best.pooled_after = std::numeric_limits<double>::infinity();
  for (int start = 0; start < starts; ++start) {
    Eigen::VectorXd factors = Eigen::VectorXd::Ones(n);
    for (Eigen::Index i = 0; i < n && start > 0; ++i) {
      const Free& free = problem.free()[static_cast<std::size_t>(i)];
      factors(i) = 0.5 * (1.0 + (start == 1 ? free.lowest : free.highest));
    }
    if (!problem.begin(start, factors)) continue;
    if (start == 0) best.pooled_before = problem.pooled_error();
    // χ² to 1e-8 of itself: far below what noise allows.
    gauss_newton(problem, {.most_steps = most_steps, .enough = 1e-16, .enough_relative = 1e-8});
    if (!(problem.pooled_error() < best.pooled_after)) continue;
    best.pooled_after = problem.pooled_error();
    best.rig = problem.rig_at(problem.factors());
    best.parameters.clear();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Free& free = problem.free()[static_cast<std::size_t>(i)];
      best.parameters[free.path] = free.value * problem.factors()(i);
    }
    best.at_bound = at_bounds(problem);
  }
  if (!std::isfinite(best.pooled_after)) {
    throw firmware::InputError(description.source, 0, "no parameters inside the tolerances give a finite simulation",
                               "a rig that is stable on these recordings");
  }
  return best;
}

}  // namespace host_sim
