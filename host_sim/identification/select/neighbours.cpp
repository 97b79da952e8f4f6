#include "host_sim/identification/select/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/identification/common/butterworth.hpp"
#include "host_sim/identification/common/parallel.hpp"

namespace host_sim::identification {
namespace {

/// An effect of the machine in the place of a fault, its values from the delay [s] and the corner [Hz] of the fault.
struct Part {
  model::Lateness as;
  double share_of_delay;  ///< 0: the value is the corner
};
struct Neighbour {
  FaultKind fault;
  std::vector<Part> parts;
};
const std::vector<Neighbour>& neighbours() {
  static const std::vector<Neighbour> table{
      {FaultKind::clock, {{model::Lateness::delay, 1.0}}},
      {FaultKind::common_filter, {{model::Lateness::delay, 1.0}}},
      {FaultKind::common_filter, {{model::Lateness::lag, 1.0}}},
      {FaultKind::common_filter, {{model::Lateness::lag, 0.5}, {model::Lateness::delay, 0.5}}},
      {FaultKind::common_filter, {{model::Lateness::resonance, 0.0}}},
  };
  return table;
}

/// [s] by which the fault makes its channels late, in the mean of what is fitted.
double delay_of(const IdentificationProblem& problem, const PlacedFault& fault) {
  if (fault.kind == FaultKind::common_filter) {
    return butterworth_delay(fault.order) / (2.0 * std::numbers::pi * fault.values[0]);
  }
  double sum = 0.0, count = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (!r.is_fitted()) continue;
    const double middle = 0.5 * static_cast<double>(r.fitted.from + r.fitted.to) * r.samples->input.period;
    sum += static_cast<double>(r.fitted.size()) * (fault.values[0] - fault.values[1] * middle);
    count += static_cast<double>(r.fitted.size());
  }
  return sum / count;
}

std::vector<double> start_of(const IdentificationProblem& problem, const Part& part,
                             const firmware::CatalogueEntry& entry, const PlacedFault& fault) {
  std::vector<double> values{part.share_of_delay > 0.0 ? part.share_of_delay * delay_of(problem, fault)
                                                       : fault.values[0]};
  if (entry.parameters.size() > 1) values.push_back(0.5 * butterworth_damping(2, 0));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::clamp(values[i], entry.parameters[i].lower, entry.parameters[i].upper);
  }
  return values;
}

/// True: the fault delays every channel that the machine moves.
bool is_of_all_that_moves(const IdentificationProblem& problem, const PlacedFault& fault) {
  const SimulationInput& input = problem.samples().front().input;
  const std::vector<model::Channel>& channels = problem.channels();
  return !input.deflection_reached && !fault.seen && !fault.inverse && delay_of(problem, fault) > 0.0 &&
         std::all_of(channels.begin(), channels.end(), [&](model::Channel c) { return fault.acts_on(c); });
}

}  // namespace

std::vector<CandidateModel> machine_instead(const ModelFitter& fitter, const CandidateModel& whole, std::size_t fault) {
  const PlacedFault& own = whole.faults()[fault];
  const bool of_group = own.kind == FaultKind::clock || own.kind == FaultKind::common_filter;
  if (!of_group || !is_of_all_that_moves(fitter.problem(), own)) return {};
  std::vector<std::pair<Hypothesis, std::vector<firmware::PlacedEffect>>> starts;
  for (const Neighbour& neighbour : neighbours()) {
    if (neighbour.fault != own.kind) continue;
    Hypothesis start = whole.fit.hypothesis;
    start.faults.erase(start.faults.begin() + static_cast<std::ptrdiff_t>(fault));
    std::vector<firmware::PlacedEffect> effects = whole.effects;
    bool has_place = true;
    for (const Part& part : neighbour.parts) {
      const firmware::CatalogueEntry* const entry = firmware::find_effect_that(
          [&](const auto& e) { return e.subsystem == model::Subsystem::machine && e.lateness == part.as; });
      const auto is_there = [&](const firmware::PlacedEffect& e) { return e.entry == entry; };
      const auto described = firmware::effects_of(start.rig);
      has_place = has_place && firmware::has_place(start.rig, *entry, std::nullopt) &&
                  fitter.problem().samples().front().shows(*entry) &&
                  std::none_of(described.begin(), described.end(), is_there);
      if (!has_place) break;
      effects.push_back({entry, std::nullopt, start_of(fitter.problem(), part, *entry, own)});
      firmware::put_effect(start.rig, effects.back());
    }
    if (has_place) starts.emplace_back(std::move(start), std::move(effects));
  }
  std::vector<CandidateModel> list(starts.size());
  for_all(starts.size(),
          [&](std::size_t i) { list[i] = fitter.refitted(starts[i].first, std::move(starts[i].second), 12); });
  std::erase_if(list, [](const CandidateModel& model) {
    return !std::isfinite(model.fit.chi_squared) ||
           std::any_of(model.effects.begin(), model.effects.end(), ends_at_bound);
  });
  return list;
}

}  // namespace host_sim::identification
