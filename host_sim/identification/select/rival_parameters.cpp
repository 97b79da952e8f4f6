#include "host_sim/identification/select/rival_parameters.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"
#include "host_sim/identification/select/thresholds.hpp"
#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {
namespace {

using Eigen::Index;

/// Parameters of the description that may be off: those that are not freed already.
std::vector<FreeParameter> not_freed(const SearchSpace& space, const SearchResult& found) {
  std::vector<FreeParameter> others;
  for (const FreeParameter& suspect : space.suspects) {
    const auto same = [&](const FreeParameter& p) { return p.path == suspect.path; };
    if (std::none_of(found.freed.begin(), found.freed.end(), same)) others.push_back(suspect);
  }
  return others;
}

/// "suspension.stiffness" is of the suspension, "air_spring.volume" of the air spring.
bool is_of(const std::string& path, model::Subsystem subsystem) {
  std::string component(name(subsystem));
  std::replace(component.begin(), component.end(), ' ', '_');
  return path.starts_with(component + ".");
}

/// (1) of every pair of an effect and a parameter, from inner products of what was fitted, of slopes and of changes.
class Resemblance {
 public:
  Resemblance(const IdentificationProblem& problem, const CandidateModel& best,
              const std::vector<FreeParameter>& suspects);

  [[nodiscard]] double squared_cosine(std::size_t effect, std::size_t suspect) const;
  /// Whether the one number of an effect changes the residuals as a parameter does.
  [[nodiscard]] bool is_one_number(std::size_t effect, std::size_t suspect) const;

 private:
  [[nodiscard]] static double squared_cosine(const Eigen::MatrixXd& gram, const std::vector<Index>& others, Index one,
                                             Index other);

  Eigen::MatrixXd gram_;
  std::vector<Index> free_;              ///< columns of what was fitted and is at no bound
  std::vector<Index> suspects_;          ///< column of each
  std::vector<std::vector<Index>> own_;  ///< columns of the parameters of each effect
  std::vector<Index> changes_;           ///< column of what each effect changes
};

Resemblance::Resemblance(const IdentificationProblem& problem, const CandidateModel& best,
                         const std::vector<FreeParameter>& suspects) {
  Fit fit = best.fit;
  if (fit.jacobian.cols() != static_cast<Index>(fit.parameters.size())) refresh_jacobian(problem, fit);
  std::vector<Variation> variations;
  std::vector<double> steps;
  Index columns = fit.jacobian.cols();
  for (const FreeParameter& suspect : suspects) {
    const auto fitted = std::find_if(fit.parameters.begin(), fit.parameters.end(), [&](const FreeParameter& p) {
      return p.role == FreeParameter::Role::tolerated && p.path == suspect.path;
    });
    if (fitted != fit.parameters.end()) {
      suspects_.push_back(fitted - fit.parameters.begin());
      continue;
    }
    suspects_.push_back(columns++);
    variations.push_back({fit.hypothesis, std::nullopt});
    suspect.put(variations.back().hypothesis, suspect.get(fit.hypothesis) + suspect.difference);
    steps.push_back(suspect.difference);
  }
  auto first = static_cast<Index>(fit.parameters.size());  // those of the effects stand last
  for (const firmware::PlacedEffect& effect : best.effects)
    first -= static_cast<Index>(effect_parameters(effect).size());
  for (const firmware::PlacedEffect& effect : best.effects) {
    changes_.push_back(columns++);
    variations.push_back({fit.hypothesis, std::nullopt});
    firmware::remove_effect(variations.back().hypothesis.rig, *effect.entry, effect.channel);
    steps.push_back(1.0);
    std::vector<Index>& own = own_.emplace_back();
    for (std::size_t p = 0; p < effect_parameters(effect).size(); ++p) own.push_back(first++);
  }
  const std::vector<Eigen::VectorXd> values = residuals_of_each(problem, variations, false, &fit.prediction);
  Eigen::MatrixXd all(fit.residual.size(), columns);
  all.leftCols(fit.jacobian.cols()) = fit.jacobian;
  for (std::size_t v = 0; v < values.size(); ++v) {
    const Eigen::VectorXd d = (values[v] - fit.residual) / steps[v];
    all.col(fit.jacobian.cols() + static_cast<Index>(v)) = d.allFinite() ? d : Eigen::VectorXd::Zero(d.size());
  }
  gram_ = gram(all);
  for (std::size_t p = 0; p < fit.parameters.size(); ++p) {
    if (!fit.parameters[p].at_bound(fit.hypothesis)) free_.push_back(static_cast<Index>(p));
  }
}

double Resemblance::squared_cosine(std::size_t effect, std::size_t suspect) const {
  const Index one = changes_[effect], other = suspects_[suspect];
  std::vector<Index> others = free_;
  std::erase_if(others, [&](Index i) {
    return i == other || std::find(own_[effect].begin(), own_[effect].end(), i) != own_[effect].end();
  });
  return squared_cosine(gram_, others, one, other);
}

bool Resemblance::is_one_number(std::size_t effect, std::size_t suspect) const {
  if (own_[effect].size() != 1) return false;
  const Index one = own_[effect].front(), other = suspects_[suspect];
  constexpr double limit = thresholds::at_the_limit * thresholds::at_the_limit;
  return gram_(one, other) * gram_(one, other) >= limit * gram_(one, one) * gram_(other, other);
}

double Resemblance::squared_cosine(const Eigen::MatrixXd& gram, const std::vector<Index>& others, Index one,
                                   Index other) {
  const std::vector<Index> two{one, other};
  Eigen::MatrixXd of_others = gram(others, others);
  of_others.diagonal() *= 1.0 + 1e-10;  // as in linear_refit.cpp
  of_others.diagonal().array() += 1e-30;
  const Eigen::MatrixXd between = gram(others, two);
  const Eigen::MatrixXd left = gram(two, two) - between.transpose() * of_others.ldlt().solve(between);
  const auto seen = [&](Index i, Index column) { return left(i, i) > 1e-8 * gram(column, column); };
  return seen(0, one) && seen(1, other) ? left(0, 1) * left(0, 1) / (left(0, 0) * left(1, 1)) : 0.0;
}

}  // namespace

void find_rival_parameters(IdentificationProblem& problem, const SearchSpace& space, SearchResult& found) {
  const CandidateModel& best = found.best;
  found.causes.resize(best.effects.size());
  for (FoundCause& cause : found.causes) cause.parameters.clear();
  const SelectionCriterion criterion;
  const ModelFitter fitter(problem, untied(space, found.freed).common, criterion);
  if (best.effects.empty() || !best.fit.hypothesis.laws.empty() || problem.is_apart() || !fitter.leaves_noise(best)) {
    return;
  }
  const std::vector<FreeParameter> suspects = not_freed(space, found);
  const Resemblance resemblance(problem, best, suspects);
  const auto cost = [&](const CandidateModel& model) {
    return model.penalised_chi_squared(criterion) + held_out_chi_squared(problem, model.fit.hypothesis);
  };
  const double of_best = cost(best);
  for (std::size_t i = 0; i < best.effects.size(); ++i) {
    if (fitter.is_seen(best.effects[i])) continue;
    const double unlike =
        std::max(thresholds::unlike, 2.0 * std::log(thresholds::listed_odds) / std::max(found.causes[i].gain, 1.0));
    std::vector<std::pair<double, std::size_t>> alike;  // cos², place in `suspects`
    for (std::size_t s = 0; s < suspects.size(); ++s) {
      const double squared = resemblance.squared_cosine(i, s);
      const bool same = is_of(suspects[s].path, best.effects[i].entry->subsystem) && resemblance.is_one_number(i, s);
      if (1.0 - squared <= unlike && !same) alike.emplace_back(squared, s);
    }
    if (alike.empty()) continue;
    std::sort(alike.rbegin(), alike.rend());
    if (alike.size() > thresholds::fitted_suspects) alike.resize(thresholds::fitted_suspects);
    const CandidateModel without = fitter.without(best, i);
    std::vector<RivalParameter>& rivals = found.causes[i].parameters;
    rivals.resize(alike.size());
    for_all(alike.size(), [&](std::size_t r) {
      const FreeParameter& parameter = suspects[alike[r].second];
      std::vector<FreeParameter> freed = found.freed;
      freed.push_back(parameter);
      const CandidateModel other =
          fitter.with_common(untied(space, freed).common).refitted(without.fit.hypothesis, without.effects);
      const double apart = cost(other) + criterion.effect + criterion.parameter - of_best;
      rivals[r] = {parameter.path, parameter.value(parameter.get(other.fit.hypothesis)), apart, other.fit.hypothesis};
    });
    std::erase_if(rivals, [](const RivalParameter& r) { return !std::isfinite(r.penalised_chi_squared); });
    std::sort(rivals.begin(), rivals.end(), [](const RivalParameter& a, const RivalParameter& b) {
      return a.penalised_chi_squared < b.penalised_chi_squared;
    });
  }
}

}  // namespace host_sim::identification
