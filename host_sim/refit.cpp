#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/comparison.hpp"
#include "host_sim/input_error.hpp"

namespace host_sim {
namespace {

/// A parameter that may move, as a factor on its value in the description.
struct Free {
  std::string path;
  double value;
  double lowest;   ///< factor
  double highest;  ///< factor
};

model::RigParameters<double> with(const RigDescription& description, const std::vector<Free>& free,
                                  const double* factors) {
  model::RigParameters<double> rig = description.rig;
  for (std::size_t i = 0; i < free.size(); ++i) *find_parameter(rig, free[i].path) = free[i].value * factors[i];
  return rig;
}

std::vector<double> residuals(const std::vector<ComparedRecording>& recordings,
                              const model::RigParameters<double>& rig) {
  std::vector<double> all;
  for (const ComparedRecording& recording : recordings) recording.residuals(recording.simulate(rig), all);
  return all;
}

/// Normalised errors of all recordings at given factors. Factors that make no rig, or one that does not stay finite,
/// are refused.
class Errors {
 public:
  Errors(const RigDescription& description, const std::vector<Free>& free,
         const std::vector<ComparedRecording>& recordings)
      : description_(description), free_(free), recordings_(recordings) {}

  bool operator()(double const* const* factors, double* errors) const {
    const model::RigParameters<double> rig = with(description_, free_, factors[0]);
    if (find_rig_fault(rig, description_.period())) return false;
    const std::vector<double> all = residuals(recordings_, rig);
    std::copy(all.begin(), all.end(), errors);
    return std::all_of(all.begin(), all.end(), [](double e) { return std::isfinite(e); });
  }

 private:
  const RigDescription& description_;
  const std::vector<Free>& free_;
  const std::vector<ComparedRecording>& recordings_;
};

/// Channels that count, over all recordings.
double channels(const std::vector<ComparedRecording>& recordings) {
  double count = 0.0;
  for (const ComparedRecording& recording : recordings) {
    count += static_cast<double>(recording.residual_count()) / static_cast<double>(recording.recording().size());
  }
  return count;
}

double pooled(const std::vector<ComparedRecording>& recordings, const model::RigParameters<double>& rig) {
  double squares = 0.0;
  for (const double e : residuals(recordings, rig)) squares += e * e;
  return std::sqrt(squares / channels(recordings));
}

constexpr int most_iterations = 60;

/// Tells how far the fit has got.
class Telling final : public ceres::IterationCallback {
 public:
  Telling(const std::function<void(double, double)>& progress, double count) : progress_(progress), count_(count) {}
  void begin(double share) { share_ = share; }
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (progress_) {
      progress_(share_ + summary.iteration / (3.0 * most_iterations), std::sqrt(2.0 * summary.cost / count_));
    }
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<void(double, double)>& progress_;
  double count_;
  double share_ = 0.0;
};

}  // namespace

Refit refit(const RigDescription& description, const std::vector<ComparedRecording>& recordings,
            const std::function<void(double share, double pooled_error)>& progress) {
  std::vector<Free> free;
  auto rig = description.rig;
  for (const auto& [path, tolerance] : description.tolerance) {
    const double value = *find_parameter(rig, path);
    // A relative bound on zero, or of zero, leaves nothing to fit. Masses and stiffnesses stay off zero.
    if (value != 0.0 && tolerance > 0.0)
      free.push_back({path, value, std::max(1.0 - tolerance, 1e-3), 1.0 + tolerance});
  }
  if (free.empty()) {
    throw InputError(description.source, 0, "nothing to refit", "parameters that may move under [tolerance]");
  }

  if (std::all_of(recordings.begin(), recordings.end(), [](const auto& r) { return r.residual_count() == 0; })) {
    throw InputError(recordings.front().recording().source, 0, "nothing moves in it that could be fitted",
                     "a recording of a rig that was shaken");
  }
  int residual_count = 0;
  for (const ComparedRecording& recording : recordings) residual_count += static_cast<int>(recording.residual_count());
  auto* cost =
      new ceres::DynamicNumericDiffCostFunction<Errors, ceres::FORWARD>(new Errors(description, free, recordings));
  cost->AddParameterBlock(static_cast<int>(free.size()));
  cost->SetNumResiduals(residual_count);

  ceres::Problem problem;
  std::vector<double> factors(free.size(), 1.0);
  problem.AddResidualBlock(cost, nullptr, factors.data());
  for (std::size_t i = 0; i < free.size(); ++i) {
    problem.SetParameterLowerBound(factors.data(), static_cast<int>(i), free[i].lowest);
    problem.SetParameterUpperBound(factors.data(), static_cast<int>(i), free[i].highest);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = 1e-8;  // of the squared error: far below what noise lets anybody see
  options.parameter_tolerance = 1e-8;
  Telling telling(progress, channels(recordings));
  options.callbacks.push_back(&telling);

  Refit best;
  best.pooled_before = pooled(recordings, description.rig);
  double least = std::numeric_limits<double>::infinity();
  for (const double towards : {0.0, -0.5, 0.5}) {  // start: as described, half way to the lower, to the upper bounds
    for (std::size_t i = 0; i < free.size(); ++i) {
      const double bound = towards < 0.0 ? free[i].lowest : free[i].highest;
      factors[i] = 1.0 + std::abs(towards) * (bound - 1.0);
    }
    telling.begin(towards == 0.0 ? 0.0 : (towards < 0.0 ? 1.0 / 3.0 : 2.0 / 3.0));
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable() || !(summary.final_cost < least)) continue;
    least = summary.final_cost;
    best.rig = with(description, free, factors.data());
    best.parameters.clear();
    best.at_bound.clear();
    for (std::size_t i = 0; i < free.size(); ++i) {
      best.parameters[free[i].path] = free[i].value * factors[i];
      const double margin = 1e-6 * (free[i].highest - free[i].lowest);
      if (factors[i] < free[i].lowest + margin || factors[i] > free[i].highest - margin) {
        best.at_bound.push_back(free[i].path);
      }
    }
  }
  if (!std::isfinite(least)) {
    throw InputError(description.source, 0, "no parameters inside the tolerances give a finite simulation",
                     "a rig that is stable on these recordings");
  }
  best.pooled_after = pooled(recordings, best.rig);
  return best;
}

}  // namespace host_sim
