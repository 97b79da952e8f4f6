#include "host_sim/identification/assess/cause_support.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "host_sim/identification/assess/chance_of_share.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/learn/law_fit.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"

namespace host_sim::identification {
namespace {

template <class T>
void erase_at(std::vector<T>& list, std::size_t i) {
  if (i < list.size()) list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
}

/// Fits models with one cause less to a copy of a problem. A law of the model stands still meanwhile.
class Reduction {
 public:
  Reduction(const IdentificationProblem& problem, const SearchSpace& space, const SearchResult& found)
      : problem_(problem), space_(untied(space, found.freed)), fitter_(problem_, space_.common, criterion_) {}

  [[nodiscard]] CandidateModel without_effect(const SearchResult& found, std::size_t i) const {
    const bool alone = found.best.effects.size() == 1 && found.best.faults().empty() && found.freed.empty() &&
                       found.best.fit.hypothesis.laws.empty();
    return alone ? found.nothing : fitter_.without(found.best, i);
  }
  [[nodiscard]] CandidateModel without_fault(const SearchResult& found, std::size_t i) const {
    return fitter_.without_fault(found.best, i);
  }
  /// The model becomes that of `found`, with its Jacobian, which a fit may have dropped. Rivals keep their distance.
  void take(CandidateModel model, SearchResult& found) const {
    const double before = found.best.penalised_chi_squared(criterion_);
    found.best = std::move(model);
    if (found.best.fit.hypothesis.laws.empty()) {
      fitter_.refit(found.best, 2);
    } else {
      found.best = fitted_with_laws(problem_, space_, found.best.fit.hypothesis, found.best.effects, 6);
    }
    const double shift = found.best.penalised_chi_squared(criterion_) - before;
    for (std::vector<FoundCause>* const list : {&found.causes, &found.faults}) {
      for (FoundCause& cause : *list) cause.shift_rivals(shift);
    }
  }

 private:
  SelectionCriterion criterion_;
  IdentificationProblem problem_;
  SearchSpace space_;
  ModelFitter fitter_;
};

std::string words_of(const PlacedFault& fault) {
  switch (fault.kind) {
    case FaultKind::clock:
      return "clock";
    case FaultKind::common_filter:
      return "common_filter";
    case FaultKind::mains_hum:
      return "mains_hum";
    case FaultKind::drift:
      return "drift of " + fault.path;
  }
  return {};
}

}  // namespace

double error_of_prediction(const IdentificationProblem& problem, Hypothesis hypothesis) {
  if (!problem.has_held_out()) return pooled_error(problem, hypothesis);
  estimate_held_out_starts(hypothesis, problem.samples());
  const std::vector<Response> readings = read_all(problem, hypothesis);
  double sum = 0.0, terms = 0.0;
  for (const model::Channel channel : problem.channels()) {
    const SquaredError squares = held_out_squares(problem, readings, channel);
    if (!(squares.data > 0.0)) continue;
    sum += 0.5 * std::log(std::max(squares.error, std::numeric_limits<double>::min()) / squares.data);
    terms += 1.0;
  }
  return terms > 0.0 ? std::exp(sum / terms) : 0.0;
}

CauseSupport support_of_causes(const IdentificationProblem& problem, const IdentificationProblem& whole,
                               const SearchSpace& space, bool beside_a_rest, SearchResult& found) {
  CauseSupport support;
  while (true) {
    const std::size_t effects = found.best.effects.size();
    const std::size_t causes = effects + (beside_a_rest ? found.best.faults().size() : 0);
    if (causes == 0) return support;
    const Reduction reduction(problem, space, found);
    const double with = error_of_prediction(whole, found.best.fit.hypothesis);
    std::vector<double> shares(causes);
    std::vector<CandidateModel> models(causes);
    for_all(causes, [&](std::size_t i) {
      models[i] = i < effects ? reduction.without_effect(found, i) : reduction.without_fault(found, i - effects);
      const double error = error_of_prediction(whole, models[i].fit.hypothesis);
      // A model that diverges without the cause cannot do without it.
      shares[i] = std::isfinite(error) ? 1.0 - with / error : 1.0;
    });
    const auto least = static_cast<std::size_t>(std::min_element(shares.begin(), shares.end()) - shares.begin());
    if (!beside_a_rest || shares[least] > -thresholds::raises_error) {
      support.shares.assign(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(effects));
      support.chances.assign(effects, 0.0);
      if (!beside_a_rest) return support;
      const std::size_t tried = candidates(whole.samples(), space.given, found.scales).size();
      const std::vector<ChannelRest> rest = rest_of_channels(whole, found.best.fit.hypothesis);
      for_all(effects, [&](std::size_t i) {
        support.chances[i] = chance_of_cause(rest, rest_of_channels(whole, models[i].fit.hypothesis), tried);
      });
      return support;
    }
    if (least < effects) {
      support.left_out.push_back(words(found.best.effects[least]));
      erase_at(found.causes, least);
    } else {
      support.left_out.push_back(words_of(found.best.faults()[least - effects]));
      erase_at(found.faults, least - effects);
    }
    reduction.take(std::move(models[least]), found);
  }
}

std::vector<Undetermined> leave_out_undetermined(const IdentificationProblem& problem, const SearchSpace& space,
                                                 const Uncertainty& known, SearchResult& found) {
  std::vector<Undetermined> list;
  const Fit& fit = found.best.fit;
  const auto spans = [&](std::size_t i) {
    const FreeParameter& parameter = fit.parameters[i];
    const double u = parameter.get(fit.hypothesis), half = known.half_widths(static_cast<Eigen::Index>(i));
    return u - half <= parameter.lower && u + half >= parameter.upper;
  };
  std::vector<std::size_t> effects, faults;
  std::size_t next = fit.parameters.size();  // those of the effects stand last
  for (const firmware::PlacedEffect& effect : found.best.effects) next -= effect_parameters(effect).size();
  for (std::size_t e = 0; e < found.best.effects.size(); ++e) {
    bool open = false;
    for (std::size_t p = effect_parameters(found.best.effects[e]).size(); p > 0; --p) open = spans(next++) || open;
    if (open) effects.push_back(e);
  }
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FreeParameter& parameter = fit.parameters[i];
    if (parameter.role != FreeParameter::Role::fault || !spans(i)) continue;
    // A curvature that is open says nothing of the drift itself.
    if (found.best.faults()[parameter.fault].kind == FaultKind::drift && parameter.number > 0) continue;
    if (faults.empty() || faults.back() != parameter.fault) faults.push_back(parameter.fault);
  }
  const auto open = [](const std::string& cause) {
    return Undetermined{cause, "its 95 % interval spans what is allowed", cause};
  };
  for (auto e = effects.rbegin(); e != effects.rend(); ++e) {
    list.push_back(open(words(found.best.effects[*e])));
    const Reduction reduction(problem, space, found);
    CandidateModel model = reduction.without_effect(found, *e);
    erase_at(found.causes, *e);
    reduction.take(std::move(model), found);
  }
  for (auto f = faults.rbegin(); f != faults.rend(); ++f) {
    list.push_back(open(words_of(found.best.faults()[*f])));
    const Reduction reduction(problem, space, found);
    CandidateModel model = reduction.without_fault(found, *f);
    erase_at(found.faults, *f);
    reduction.take(std::move(model), found);
  }
  return list;
}

}  // namespace host_sim::identification
