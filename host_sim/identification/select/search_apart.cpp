#include "host_sim/identification/select/search_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

using firmware::PlacedEffect;
using model::Channel;

SelectionCriterion criterion_of_component(bool imitating) {
  SelectionCriterion criterion;
  criterion.imitating = imitating;
  criterion.sensors = criterion.machine = criterion.faults = false;
  return criterion;
}

/// Whether every recording measures a machine's command, its stroke and the component's force, and a part is held out.
bool can_be_apart(const IdentificationProblem& problem) {
  if (!problem.has_held_out()) return false;
  const std::vector<PreparedRecording>& samples = problem.samples();
  return std::all_of(samples.begin(), samples.end(), [](const PreparedRecording& r) {
    return r.input.channel == Channel::x_cmd && r.explains(Channel::x_act) && r.explains(Channel::F);
  });
}

/// Whether the residual of x_act is larger than its noise.
bool leaves_stroke(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const auto left = channel_excesses(band_powers(problem, hypothesis));
  return std::any_of(left.begin(), left.end(), [](const ChannelExcess& e) {
    return e.channel == Channel::x_act && e.significance > thresholds::significant_deviations;
  });
}

/// Product of the channels' errors, rms ÷ rms, on what is held out.
double held_out_error(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const std::vector<Response> readings = read_all(problem, hypothesis);
  double product = 1.0;
  for (const Channel channel : problem.channels()) {
    const SquaredError squares = held_out_squares(problem, readings, channel);
    product *= std::sqrt(squares.error / squares.data);
  }
  return std::isfinite(product) ? product : std::numeric_limits<double>::infinity();
}

/// A set of effects of the machine, fitted to the stroke alone.
struct Machine {
  std::vector<std::size_t> candidates;  ///< in ascending order
  CandidateModel model;
  double error;  ///< held_out_error(); infinite where it is not fitted
  /// Whether a fit stayed finite and inside the bounds of the cards.
  [[nodiscard]] bool is_fitted() const { return std::isfinite(model.fit.chi_squared); }
  [[nodiscard]] bool has(std::size_t candidate) const {
    return std::binary_search(candidates.begin(), candidates.end(), candidate);
  }
  [[nodiscard]] std::size_t parameters() const {
    std::size_t count = 0;
    for (const PlacedEffect& effect : model.effects) count += effect.values.size();
    return count;
  }
};

class MachineSearch {
 public:
  MachineSearch(IdentificationProblem stroke, const SearchSpace& space, const Scales& scales)
      : stroke_(std::move(stroke)), fitter_(stroke_, {}, criterion_), given_(space.given) {
    for (Candidate& candidate : candidates(stroke_.samples(), given_, scales)) {
      if (candidate.entry->subsystem == model::Subsystem::machine) candidates_.push_back(std::move(candidate));
    }
  }

  /// Every set of one and of two effects, that of no effect first.
  [[nodiscard]] std::vector<Machine> sets() const {
    std::vector<std::vector<std::size_t>> sets{{}};
    for (std::size_t i = 0; i < candidates_.size(); ++i) sets.push_back({i});
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      for (std::size_t j = i + 1; j < candidates_.size(); ++j) sets.push_back({i, j});
    }
    std::vector<Machine> machines(sets.size());
    for_all(sets.size(), [&](std::size_t s) {
      CandidateModel model = fitted(sets[s]);
      machines[s] = {sets[s], std::move(model), std::numeric_limits<double>::infinity()};
      if (!machines[s].is_fitted()) return;
      machines[s].error = held_out_error(fitter_.problem(), machines[s].model.fit.hypothesis);
    });
    return machines;
  }

 private:
  /// From each of the starts, of two effects from each pair of theirs, a few steps; then to the end from the best that
  /// stay inside the bounds of the cards.
  [[nodiscard]] CandidateModel fitted(const std::vector<std::size_t>& set) const {
    std::vector<std::vector<PlacedEffect>> starts{{}};
    for (const std::size_t i : set) {
      std::vector<std::vector<PlacedEffect>> longer;
      for (const auto& effects : starts) {
        for (const Start& start : candidates_[i].starts) {
          longer.push_back(effects);
          longer.back().push_back({candidates_[i].entry, std::nullopt, start.values});
        }
      }
      starts = std::move(longer);
    }
    std::vector<CandidateModel> begun;
    for (const auto& effects : starts) {
      Hypothesis hypothesis = given_;
      for (const PlacedEffect& effect : effects) firmware::put_effect(hypothesis.rig, effect);
      if (firmware::find_rig_fault(hypothesis.rig, fitter_.problem().sample_period())) continue;
      CandidateModel model = fitter_.fitted(hypothesis, effects, thresholds::first_steps);
      drop_jacobian(model.fit);
      if (std::isfinite(model.fit.chi_squared)) begun.push_back(std::move(model));
    }
    const auto less = [](const CandidateModel& a, const CandidateModel& b) {
      return a.fit.chi_squared < b.fit.chi_squared;
    };
    std::sort(begun.begin(), begun.end(), less);
    CandidateModel best;
    best.fit.chi_squared = std::numeric_limits<double>::infinity();
    int ended = 0;
    for (const CandidateModel& begin : begun) {
      if (ended == thresholds::starts_to_the_end) break;
      CandidateModel model = fitter_.fitted(begin.fit.hypothesis, begin.effects);
      drop_jacobian(model.fit);
      if (!std::isfinite(model.fit.chi_squared)) continue;
      if (std::any_of(model.effects.begin(), model.effects.end(), ends_at_bound)) continue;
      ++ended;
      if (less(model, best)) best = std::move(model);
    }
    return best;
  }

  IdentificationProblem stroke_;
  SelectionCriterion criterion_{};
  ModelFitter fitter_;
  const Hypothesis& given_;
  std::vector<Candidate> candidates_;
};

std::vector<Machine> machine_sets(const IdentificationProblem& stroke, const SearchSpace& space, const Scales& scales) {
  return MachineSearch(stroke, space, scales).sets();
}

/// The set with the least error; one with more parameters must be better by thresholds::replaces_error.
const Machine& best_of(std::vector<Machine>& machines) {
  std::stable_sort(machines.begin(), machines.end(),
                   [](const Machine& a, const Machine& b) { return a.parameters() < b.parameters(); });
  const Machine* best = &machines.front();
  for (const Machine& machine : machines) {
    const bool larger = machine.parameters() > best->parameters();
    if (machine.error < (larger ? thresholds::replaces_error : 1.0) * best->error) best = &machine;
  }
  return *best;
}

/// One more effect beside a component, as long as what is held out is explained better by it.
void grow(IdentificationProblem& force, const SearchSpace& space, const SelectionCriterion& criterion,
          SearchResult& found) {
  const ModelFitter fitter(force, space.common, criterion);
  double error = held_out_error(force, found.best.fit.hypothesis);
  while (found.best.effects.size() < thresholds::most_effects) {
    std::optional<CandidateModel> better;
    for (const CandidateModel& longer : fitter.extended(found.best, found.scales, thresholds::grown_apart)) {
      CandidateModel model = fitter.refitted(longer.fit.hypothesis, longer.effects);
      const double reached = held_out_error(force, model.fit.hypothesis);
      if (!criterion.prefers(model, found.best) || reached >= thresholds::replaces_error * error) continue;
      error = reached;
      better = std::move(model);
    }
    if (!better) break;
    found.best = std::move(*better);
  }
}

/// The component in what F says, moved by a machine that is known.
SearchResult search_component(const IdentificationProblem& force, const SearchSpace& space,
                              const ProgressCallback& progress) {
  const auto searched = [&](bool imitating) {
    IdentificationProblem problem = force;
    const SearchOptions options{criterion_of_component(imitating), true, progress};
    SearchResult found = search(problem, space, options);
    grow(problem, space, options.criterion, found);
    compare(problem, space, options, found);
    return found;
  };
  SearchResult found = searched(false);
  if (is_whole(force, found.best.fit) || !may_begin(force, "laws of a component apart")) return found;
  SearchResult other = searched(true);
  const double error = held_out_error(force, found.best.fit.hypothesis);
  if (held_out_error(force, other.best.fit.hypothesis) < thresholds::replaces_error * error) {
    found = std::move(other);
  }
  return found;
}

/// The sets that differ from `machine` in its effect `place`, in the place of it.
std::vector<Rival> rivals_in(const std::vector<Machine>& machines, const Machine& machine, std::size_t place,
                             const IdentificationProblem& stroke, const Hypothesis& both, double now) {
  const auto rated = [&](const Machine& m) {
    return m.model.penalised_chi_squared({}) + held_out_chi_squared(stroke, m.model.fit.hypothesis);
  };
  const double own = rated(machine);
  std::vector<Rival> rivals;
  for (const Machine& other : machines) {
    if (other.candidates.size() != machine.candidates.size() || !other.is_fitted()) continue;
    std::vector<std::size_t> different;  // effects of the other that the machine does not have
    for (std::size_t k = 0; k < other.candidates.size(); ++k) {
      if (!machine.has(other.candidates[k])) different.push_back(k);
    }
    if (different.size() != 1 || other.has(machine.candidates[place])) continue;
    Rival rival{other.model.effects[different.front()], now + rated(other) - own, both};
    for (const PlacedEffect& e : machine.model.effects) firmware::remove_effect(rival.hypothesis.rig, *e.entry, {});
    for (const PlacedEffect& e : other.model.effects) firmware::put_effect(rival.hypothesis.rig, e);
    rivals.push_back(std::move(rival));
  }
  std::sort(rivals.begin(), rivals.end(),
            [](const Rival& a, const Rival& b) { return a.penalised_chi_squared < b.penalised_chi_squared; });
  return rivals;
}

/// The χ² that one effect of a machine gains. Without it a set may have no fit inside its bounds: then it is compared
/// with the machine without effects, the first of all.
double gain_in(const std::vector<Machine>& machines, const Machine& machine, std::size_t place) {
  const auto is_without = [&](const Machine& other) {
    return other.candidates.size() + 1 == machine.candidates.size() && !other.has(machine.candidates[place]) &&
           std::all_of(other.candidates.begin(), other.candidates.end(), [&](std::size_t c) { return machine.has(c); });
  };
  const auto reduced = std::find_if(machines.begin(), machines.end(), is_without);
  const Machine& without = reduced->is_fitted() ? *reduced : machines.front();
  return without.model.fit.chi_squared - machine.model.fit.chi_squared;
}

}  // namespace

bool search_apart(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                  SearchResult& found) {
  if (!can_be_apart(problem) || !leaves_stroke(problem, found.best.fit.hypothesis)) return false;
  const IdentificationProblem stroke = problem.of_channels({Channel::x_act});
  std::vector<Machine> machines = machine_sets(stroke, space, found.scales);
  const Machine& machine = best_of(machines);
  if (machine.candidates.empty()) return false;

  SearchSpace moved = space;
  moved.given = machine.model.fit.hypothesis;
  SearchResult component = search_component(problem.of_channels({Channel::F}), moved, progress);
  const Hypothesis& both = component.best.fit.hypothesis;
  const double error = held_out_error(problem, found.best.fit.hypothesis);
  if (held_out_error(problem, both) >= thresholds::replaces_error * error) return false;

  problem = problem.apart(machine.model.effects);
  problem.update_input_noise(both);
  CandidateModel united{component.best.fit, machine.model.effects, component.best.channels};
  const auto& effects = component.best.effects;
  united.effects.insert(united.effects.end(), effects.begin(), effects.end());
  found.best = ModelFitter::refitted_in(problem, space, {}, united);
  found.causes.clear();
  found.faults.clear();
  found.freed.clear();
  found.suspects.clear();
  const double now = found.best.penalised_chi_squared({});
  for (std::size_t i = 0; i < machine.candidates.size(); ++i) {
    found.causes.push_back(
        {.gain = gain_in(machines, machine, i), .rivals = rivals_in(machines, machine, i, stroke, both, now)});
  }
  const double alone = component.best.penalised_chi_squared({});
  for (std::size_t i = 0; i < effects.size(); ++i) {
    found.causes.push_back(std::move(component.causes[i]));
    found.causes.back().shift_rivals(now - alone);
  }
  return true;
}

}  // namespace host_sim::identification
