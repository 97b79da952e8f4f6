#include "host_sim/identification/select/search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/fault_candidates.hpp"
#include "host_sim/identification/select/fault_rewrites.hpp"
#include "host_sim/identification/select/held_out.hpp"
#include "host_sim/identification/select/model_evidence.hpp"
#include "host_sim/identification/select/neighbours.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {

using model::Channel;

double share_with(const IdentificationProblem& problem, double seconds) {
  double longest = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    longest = std::max(longest, static_cast<double>(r.fitted.size()) * r.samples->input.period);
  }
  return longest > 0.0 && seconds / longest < thresholds::most_of_window ? seconds / longest : 1.0;
}

namespace {

bool is_far_above_noise(const CandidateModel& model) {
  return model.fit.chi_squared > thresholds::far_above_noise * static_cast<double>(model.fit.residual.size());
}

bool same_effect(const firmware::PlacedEffect& a, const firmware::PlacedEffect& b) {
  return a.entry == b.entry && a.channel == b.channel;
}

/// One search: the fitter that holds its problem, its criterion and its reports.
class Search {
 public:
  Search(IdentificationProblem& problem, const SearchSpace& space, const SearchOptions& options)
      : space_(space),
        options_(options),
        criterion_(options.criterion),
        fitter_(problem, space.common, criterion_),
        budget_(problem),
        first_share_(options.truncates ? share_with(problem, thresholds::seconds_far_above_noise) : 1.0) {}

  void forward(SearchResult& found);
  void backward(SearchResult& found);

 private:
  // Forward.
  void begin(SearchResult& found);
  void add_filters_seen(SearchResult& found) const;
  [[nodiscard]] std::vector<CandidateModel> one_effect_more(const std::vector<CandidateModel>& beam,
                                                            SearchResult& found) const;
  [[nodiscard]] std::optional<CandidateModel> by_fault(const CandidateModel& base,
                                                       const std::vector<CandidateModel>& others) const;
  bool add_last_fault(SearchResult& found) const;
  void update_noise(std::vector<CandidateModel>& beam, SearchResult& found);

  // Backward.
  void compare_in_sample(SearchResult& found);
  bool take_filter_seen(SearchResult& found) const;
  bool improve(std::size_t effect, SearchResult& found);
  [[nodiscard]] std::optional<CandidateModel> rewritten(std::size_t effect, const SearchResult& found) const;
  [[nodiscard]] std::optional<CandidateModel> instead_of_limit(std::size_t effect, const SearchResult& found) const;
  [[nodiscard]] std::optional<CandidateModel> in_one(const SearchResult& found) const;
  bool improve_fault(std::size_t fault, SearchResult& found);
  [[nodiscard]] std::optional<CandidateModel> by_machine(const CandidateModel& best, std::size_t fault,
                                                         const SearchResult& found) const;
  /// −2 ln of it (model_evidence.hpp).
  [[nodiscard]] double evidence(const CandidateModel& model, const SearchResult& found) const {
    return evidence_of(fitter_.problem(), model, found.scales, {}).total();
  }
  bool eliminate_by_held_out(SearchResult& found);
  void rate_by_held_out(SearchResult& found) const;
  [[nodiscard]] CandidateModel promoted(const CandidateModel& best, std::size_t effect, const Rival& rival) const;
  [[nodiscard]] CandidateModel without(std::size_t effect, const SearchResult& found) const;
  [[nodiscard]] std::optional<CandidateModel> in_two(const SearchResult& found, std::size_t effect,
                                                     const std::vector<CandidateModel>& others) const;
  [[nodiscard]] std::vector<CandidateModel> pairs_with(const firmware::PlacedEffect& first, const Hypothesis& start,
                                                       const Scales& scales) const;
  [[nodiscard]] std::vector<Rival> rivals_of(const CandidateModel& best, const CandidateModel& reduced,
                                             std::size_t effect, const std::vector<CandidateModel>& others) const;

  /// One more effect beside a model, best first. `all`: those, too, that will hardly be accepted.
  [[nodiscard]] std::vector<CandidateModel> extended(const CandidateModel& base, const Scales& scales, bool all) const;
  [[nodiscard]] std::vector<CandidateModel> extended_on_part(const CandidateModel& base, const Scales& scales,
                                                             bool all) const;
  /// Whether no more exchanges are tried: what stands in each effect's place is still asked, of the nearest alone.
  [[nodiscard]] bool is_spent() const { return budget_.is_spent(fitter_.problem()); }
  [[nodiscard]] std::size_t most(bool all) const {
    if (!all) return criterion_.most_candidates;
    return is_spent() ? thresholds::near_rivals : criterion_.most_rivals;
  }
  [[nodiscard]] double least_gain(const CandidateModel& base, bool all) const;
  /// Evidence for a model from all windows: penalised χ² of the fitted, χ² of the held-out ones.
  [[nodiscard]] double rating(const Hypothesis& hypothesis, double penalised) const {
    return penalised + held_out_chi_squared(fitter_.problem(), hypothesis);
  }
  void sort(std::vector<CandidateModel>& models) const {
    std::sort(models.begin(), models.end(),
              [this](const CandidateModel& a, const CandidateModel& b) { return criterion_.prefers(a, b); });
  }

  void report(double share, const std::string& what) const {
    const SpentWork& work = fitter_.problem().work();
    if (options_.progress) options_.progress(share, what, work.simulations(), work.candidates());
  }

  const SearchSpace& space_;
  const SearchOptions& options_;
  const SelectionCriterion& criterion_;
  ModelFitter fitter_;
  StageBudget budget_;
  std::map<std::size_t, CandidateModel> reduced_;  ///< the compared model without its effect i, fitted
  bool has_split_ = false;                         ///< once: a rest could be split into ever smaller effects
  double first_share_;                             ///< of the windows, where candidates far above noise are told apart
};

/// Adds a slow drift where it explains a residual. Returns true if it was added.
bool Search::add_last_fault(SearchResult& found) const {
  auto fault = by_fault(found.best, {});
  if (!fault || !criterion_.accepts(*fault, found.best, criterion_.share(found.best))) return false;
  found.best = std::move(*fault);
  return true;
}

void Search::forward(SearchResult& found) {
  begin(found);
  std::vector<CandidateModel> beam{found.best};
  for (std::size_t depth = 0; found.best.effects.size() < thresholds::most_effects; ++depth) {
    if (depth > 0 && fitter_.leaves_noise(found.best)) {
      if (add_last_fault(found)) continue;
      beam = {found.best};  // for one more that every band hides
    }
    report(std::min(0.1 + 0.15 * static_cast<double>(depth), 0.55), depth == 0 ? "one effect" : "one more effect");
    std::vector<CandidateModel> next = one_effect_more(beam, found);
    if (next.empty() || !criterion_.prefers(next.front(), found.best)) break;
    found.best = next.front();
    beam = std::move(next);
    update_noise(beam, found);
    const bool has_minima = has_corners(found.best.fit.hypothesis.rig);
    if (options_.truncates && has_minima && !fitter_.leaves_noise(found.best)) {
      fitter_.refit_by_continuation(found.best);
      beam.front() = found.best;
    }
  }
}

/// The tolerated parameters alone, then holds and filters: no fit could say these better than values and noises do.
void Search::begin(SearchResult& found) {
  report(0.05, "tolerated parameters");
  found.nothing = fitter_.refitted(space_.given, {});
  const Hypothesis& hypothesis = found.nothing.fit.hypothesis;
  found.scales = scales_of(fitter_.problem().samples(), hypothesis, read_all(fitter_.problem(), hypothesis));
  // A described rig with corners has minima of its own.
  if (options_.truncates && has_corners(space_.given.rig)) fitter_.refit_by_continuation(found.nothing);
  found.best = found.nothing;
  std::vector<Channel> channels = fitter_.problem().channels();
  if (const auto input = fitter_.problem().samples().front().input_sensor()) channels.push_back(*input);
  for (const Channel channel : channels) {
    auto held = fitter_.held(found.best, found.scales, channel);
    if (held && criterion_.accepts(*held, found.best, 0.0)) found.best = std::move(*held);
  }
  add_filters_seen(found);
  if ((found.best.effects.empty() && found.best.faults().empty()) ||
      !fitter_.update_input_noise(found.best.fit.hypothesis))
    return;
  fitter_.refit(found.nothing, 4);
  fitter_.refit(found.best, 4);
}

void Search::add_filters_seen(SearchResult& found) const {
  for (const PlacedFault& filter : filters_seen(fitter_.problem())) {
    CandidateModel filtered = fitter_.filtered(found.best, filter);
    if (criterion_.accepts(filtered, found.best, 0.0)) found.best = std::move(filtered);
  }
}

/// The next beam, refitted; empty: no effect is accepted.
std::vector<CandidateModel> Search::one_effect_more(const std::vector<CandidateModel>& beam,
                                                    SearchResult& found) const {
  std::vector<CandidateModel> next;
  for (const CandidateModel& base : beam) {
    auto list = extended(base, found.scales, false);
    if (base.effects.empty() && base.faults().empty()) found.alone = list;
    if (auto fault = by_fault(base, list); fault && criterion_.accepts(*fault, base, criterion_.share(base))) {
      next.push_back(std::move(*fault));
    }
    for (std::size_t i = 0; i < std::min(criterion_.beam, list.size()); ++i) {
      if (criterion_.accepts(list[i], base, criterion_.share(base))) next.push_back(std::move(list[i]));
    }
  }
  sort(next);
  if (next.size() > criterion_.beam) next.resize(criterion_.beam);
  for (CandidateModel& model : next) fitter_.refit(model, 6);
  // One that diverges on what is held out explains nothing.
  std::erase_if(next,
                [this](const CandidateModel& model) { return !stays_finite(fitter_.problem(), model.fit.hypothesis); });
  sort(next);
  if (next.empty()) return next;
  const double left = std::max(beyond_noise(next.front().fit), criterion_.effect);
  std::erase_if(next, [left](const CandidateModel& m) { return beyond_noise(m.fit) > thresholds::far_behind * left; });
  return next;
}

/// A model with one more fault of the recordings, where that is better than the best of `others`, which have one more
/// effect.
std::optional<CandidateModel> Search::by_fault(const CandidateModel& base,
                                               const std::vector<CandidateModel>& others) const {
  if (!criterion_.faults || base.faults().size() >= thresholds::most_faults) return std::nullopt;
  double least = least_gain(base, false);
  if (!others.empty()) {
    const double gained = base.fit.chi_squared - others.front().fit.chi_squared;
    least = std::max(least, thresholds::promising_beside_best * gained);
  }
  std::optional<CandidateModel> fault = fitter_.extended_by_fault(base, least);
  if (fault && !others.empty() && !criterion_.prefers(*fault, others.front())) return std::nullopt;
  return fault;
}

/// The noise of the input passes through what was found.
void Search::update_noise(std::vector<CandidateModel>& beam, SearchResult& found) {
  if (!fitter_.update_input_noise(found.best.fit.hypothesis)) return;
  fitter_.refit(found.nothing, 4);
  for (CandidateModel& model : beam) fitter_.refit(model, 4);
  sort(beam);
  found.best = beam.front();
  for_all(found.alone.size(), [&](std::size_t i) {
    CandidateModel& model = found.alone[i];
    model = fitter_.fitted(model.fit.hypothesis, model.effects, 0);
    drop_jacobian(model.fit);
  });
}

void Search::backward(SearchResult& found) {
  compare_in_sample(found);
  if (fitter_.problem().has_held_out()) {
    for (int round = 0; round < thresholds::most_rounds && !is_spent() && eliminate_by_held_out(found); ++round)
      compare_in_sample(found);
    rate_by_held_out(found);
  }
  found.alone.clear();
}

/// Rounds of elimination and swaps on the fitted windows.
void Search::compare_in_sample(SearchResult& found) {
  const auto is_bare = [&] { return found.best.effects.empty() && found.best.faults().empty(); };
  for (int round = 0; round < thresholds::most_rounds && !is_bare(); ++round) {
    reduced_.clear();
    found.causes.assign(found.best.effects.size(), {});
    found.faults.assign(found.best.faults().size(), {});
    bool changed = take_filter_seen(found);
    for (std::size_t i = 0; i < found.best.faults().size() && !changed; ++i) changed = improve_fault(i, found);
    for (std::size_t i = 0; i < found.best.effects.size() && !changed; ++i) changed = improve(i, found);
    if (!changed) {
      auto one = is_spent() ? std::nullopt : in_one(found);
      if (!one) break;
      found.best = std::move(*one);
    }
    if (fitter_.update_input_noise(found.best.fit.hypothesis)) {
      fitter_.refit(found.nothing, 4);
      fitter_.refit(found.best, 6);
      found.alone.clear();
    }
  }
}

/// A filter that the noises show in the place of effects of its sensors, each of which imitates it: beside all of them
/// it gains nothing. true: it is better.
bool Search::take_filter_seen(SearchResult& found) const {
  if (!criterion_.faults || found.best.faults().size() >= thresholds::most_faults) return false;
  if (std::any_of(found.best.faults().begin(), found.best.faults().end(),
                  [](const PlacedFault& fault) { return fault.kind == FaultKind::common_filter; }))
    return false;
  for (const PlacedFault& filter : filters_seen(fitter_.problem())) {
    const auto behind_it = [&](const firmware::PlacedEffect& effect) {
      return effect.channel && filter.is_of(*effect.channel);
    };
    if (std::none_of(found.best.effects.begin(), found.best.effects.end(), behind_it)) continue;
    CandidateModel with = fitter_.filtered(found.best, filter);
    if (std::isfinite(with.fit.chi_squared)) improve_order(fitter_, with, with.faults().size() - 1);
    for (std::size_t i = 0; i < with.effects.size();) {
      std::optional<CandidateModel> less;
      if (behind_it(with.effects[i])) less = fitter_.without(with, i);
      if (!less || criterion_.prefers(with, *less)) {
        ++i;
      } else {
        with = std::move(*less);
        i = 0;
      }
    }
    if (!std::isfinite(with.fit.chi_squared) || !criterion_.prefers(with, found.best)) continue;
    found.best = std::move(with);
    return true;
  }
  return false;
}

/// Leaves out the effect without which the held-out windows are predicted better, by more than it gains in the fitted
/// ones. false: there is none.
bool Search::eliminate_by_held_out(SearchResult& found) {
  const double with = rating(found.best.fit.hypothesis, found.best.penalised_chi_squared(criterion_));
  for (std::size_t i = 0; i < found.best.effects.size(); ++i) {
    const auto reduced = reduced_.find(i);
    if (reduced == reduced_.end()) continue;
    const CandidateModel& other = reduced->second;
    if (rating(other.fit.hypothesis, other.penalised_chi_squared(criterion_)) >= with) continue;
    found.best = fitter_.refitted(other.fit.hypothesis, other.effects, 2);
    found.causes.clear();
    return true;
  }
  return false;
}

/// Adds to the rivals nearby what they predict worse or better than the model; the one that is better in all takes the
/// place of the effect, which becomes its rival.
void Search::rate_by_held_out(SearchResult& found) const {
  for (std::size_t i = 0; i < found.causes.size(); ++i) {
    std::vector<Rival>& rivals = found.causes[i].rivals;
    double held_out = held_out_chi_squared(fitter_.problem(), found.best.fit.hypothesis);
    for (std::size_t r = 0; r < std::min(thresholds::near_rivals, rivals.size()); ++r) {
      Rival& rival = rivals[r];
      const double now = found.best.penalised_chi_squared(criterion_);
      if (rival.penalised_chi_squared - now > thresholds::beyond_held_out) continue;
      rival.penalised_chi_squared += held_out_chi_squared(fitter_.problem(), rival.hypothesis) - held_out;
      if (rival.penalised_chi_squared >= now - thresholds::replaces) continue;
      const Rival before{found.best.effects[i], now, found.best.fit.hypothesis};
      CandidateModel better = promoted(found.best, i, rival);
      const double held_out_better = held_out_chi_squared(fitter_.problem(), better.fit.hypothesis);
      const double then = better.penalised_chi_squared(criterion_);
      if (then + held_out_better >= now + held_out - thresholds::replaces || ends_at_bound(better.effects[i])) continue;
      found.causes[i].gain += found.best.fit.chi_squared - better.fit.chi_squared;
      found.best = std::move(better);
      rival = before;
      // Relative to the new model: its own held-out windows are what all are compared with.
      for (std::size_t k = 0; k <= i; ++k) {
        std::vector<Rival>& others = found.causes[k].rivals;
        const std::size_t rated = k < i ? std::min(thresholds::near_rivals, others.size()) : r + 1;
        for (std::size_t n = 0; n < rated; ++n) others[n].penalised_chi_squared += held_out - held_out_better;
      }
      held_out = held_out_better;
    }
    std::sort(rivals.begin(), rivals.end(),
              [](const Rival& a, const Rival& b) { return a.penalised_chi_squared < b.penalised_chi_squared; });
  }
}

/// The model with a rival in the place of an effect.
CandidateModel Search::promoted(const CandidateModel& best, std::size_t effect, const Rival& rival) const {
  std::vector<firmware::PlacedEffect> effects = best.effects;
  effects[effect] = rival.effect;
  return fitter_.refitted(rival.hypothesis, std::move(effects), 6);
}

/// Tries the model without one effect and with each other in its place. true: it became better; false: the others are
/// its rivals.
bool Search::improve(std::size_t effect, SearchResult& found) {
  CandidateModel& best = found.best;
  if (fitter_.is_seen(best.effects[effect])) return false;
  report(0.6 + 0.3 * static_cast<double>(effect) / static_cast<double>(best.effects.size()),
         "rivals of " + std::string(best.effects[effect].entry->name));
  const bool exchanges = budget_.allows(fitter_.problem(), "some exchanges of effects");
  if (auto simpler = fitter_.simplified(best, effect);
      simpler && (ends_at_bound(best.effects[effect]) || criterion_.prefers(*simpler, best))) {
    best = std::move(*simpler);
    return true;
  }
  if (exchanges) {
    if (auto other = rewritten(effect, found)) {
      best = std::move(*other);
      return true;
    }
  }
  CandidateModel reduced = without(effect, found);
  if (!criterion_.prefers(best, reduced)) {
    best = std::move(reduced);
    return true;
  }
  const bool known = best.effects.size() == 1 && best.faults().empty() && !found.alone.empty();
  const std::vector<CandidateModel> others = known ? found.alone : extended(reduced, found.scales, true);
  const double to_beat = best.penalised_chi_squared(criterion_) - thresholds::replaces;
  for (const CandidateModel& other : others) {
    if (!exchanges || same_effect(other.effects.back(), best.effects[effect])) continue;
    if (other.penalised_chi_squared(criterion_) >= to_beat) continue;
    CandidateModel full = fitter_.refitted(other.fit.hypothesis, other.effects, 6);
    if (!(full.penalised_chi_squared(criterion_) < to_beat) || ends_at_bound(full.effects.back())) continue;
    if (!stays_finite(fitter_.problem(), full.fit.hypothesis)) continue;
    best = std::move(full);
    return true;
  }
  FoundCause& cause = found.causes[effect];
  cause.rivals = rivals_of(best, reduced, effect, others);
  cause.gain = reduced.fit.chi_squared - best.fit.chi_squared;
  // Refitted beside the other effects as they are now, a rival may be better after all.
  if (exchanges && !cause.rivals.empty() && cause.rivals.front().penalised_chi_squared < to_beat) {
    CandidateModel better = promoted(best, effect, cause.rivals.front());
    if (better.penalised_chi_squared(criterion_) < to_beat && !ends_at_bound(better.effects[effect])) {
      best = std::move(better);
      return true;
    }
  }
  if (auto two = exchanges ? in_two(found, effect, others) : std::nullopt) {
    best = std::move(*two);
    has_split_ = true;
    return true;
  }
  drop_jacobian(reduced.fit);
  reduced_[effect] = std::move(reduced);
  return false;
}

/// Replaces an effect by another one, by one for several sensors, or by a fault of the recording: by the first of these
/// that is better. nullopt: none is.
std::optional<CandidateModel> Search::rewritten(std::size_t effect, const SearchResult& found) const {
  if (auto other = instead_of_limit(effect, found)) return other;
  if (auto shared = in_group(fitter_, found.best, effect)) return shared;
  return in_one_fault(fitter_, found.best, effect);
}

/// Another effect in the place of one that ends at a limit of its card: a resonance of the largest damping is a lag.
/// All else is where the effect has brought it, so it begins from there. nullopt: none is better.
std::optional<CandidateModel> Search::instead_of_limit(std::size_t effect, const SearchResult& found) const {
  if (!ends_at_bound(found.best.effects[effect])) return std::nullopt;
  const CandidateModel reduced = fitter_.without(found.best, effect, 0);
  for (const CandidateModel& other : fitter_.extended(reduced, found.scales, thresholds::fault_rivals)) {
    if (ends_at_bound(other.effects.back())) continue;
    CandidateModel full = fitter_.refitted(other.fit.hypothesis, other.effects, 12);
    if (criterion_.prefers(full, found.best) && !ends_at_bound(full.effects.back()) &&
        stays_finite(fitter_.problem(), full.fit.hypothesis)) {
      return full;
    }
  }
  return std::nullopt;
}

/// An effect of the rig in the place of two of sensors: a gain and a lag of F together are nearly what a soft mount of
/// the component makes of it, while the mount in the place of either alone is worse. nullopt: none is better.
std::optional<CandidateModel> Search::in_one(const SearchResult& found) const {
  const CandidateModel& best = found.best;
  const double to_beat = best.penalised_chi_squared(criterion_) - thresholds::replaces;
  for (std::size_t second = 1; second < best.effects.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      const firmware::PlacedEffect &a = best.effects[first], &b = best.effects[second];
      if (!a.channel || !b.channel || fitter_.is_seen(a) || fitter_.is_seen(b)) continue;
      const CandidateModel reduced = fitter_.without(fitter_.without(best, second), first);
      std::size_t tried = 0;
      for (const CandidateModel& other : extended(reduced, found.scales, true)) {
        if (other.effects.back().channel) continue;
        if (++tried > thresholds::near_rivals) break;
        CandidateModel one = fitter_.refitted(other.fit.hypothesis, other.effects, 12);
        if (one.penalised_chi_squared(criterion_) < to_beat && !ends_at_bound(one.effects.back()) &&
            stays_finite(fitter_.problem(), one.fit.hypothesis)) {
          return one;
        }
      }
    }
  }
  return std::nullopt;
}

/// Two effects in the place of one that leaves more than noise: a lag and a delay of a machine look like one overdamped
/// resonance, and each alone is worse than that, so the forward selection has passed over them. Both are of the same
/// part of the rig, the first is simpler. Everything else stands still until both have found their size: without the
/// one it would move to where they are not seen. nullopt: no two are better.
std::optional<CandidateModel> Search::in_two(const SearchResult& found, std::size_t effect,
                                             const std::vector<CandidateModel>& others) const {
  const CandidateModel& best = found.best;
  const firmware::PlacedEffect& own = best.effects[effect];
  if (has_split_ || own.channel || best.effects.size() >= thresholds::most_effects || fitter_.leaves_noise(best)) {
    return std::nullopt;
  }
  std::vector<CandidateModel> pairs;
  std::size_t tried = 0;
  for (const CandidateModel& other : others) {
    const firmware::PlacedEffect& first = other.effects.back();
    if (first.channel || first.entry->subsystem != own.entry->subsystem || first.values.size() >= own.values.size()) {
      continue;
    }
    if (++tried > thresholds::split_effects) break;
    Hypothesis start = best.fit.hypothesis;
    firmware::remove_effect(start.rig, *own.entry, own.channel);
    firmware::put_effect(start.rig, first);
    for (CandidateModel& pair : pairs_with(first, start, found.scales)) pairs.push_back(std::move(pair));
  }
  sort(pairs);
  if (pairs.size() > thresholds::split_effects) pairs.resize(thresholds::split_effects);
  for (const CandidateModel& pair : pairs) {
    std::vector<firmware::PlacedEffect> effects = best.effects;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(effect));
    effects.insert(effects.end(), pair.effects.begin(), pair.effects.end());
    CandidateModel two = fitter_.refitted(pair.fit.hypothesis, std::move(effects), 12);
    if (criterion_.accepts(two, best, criterion_.first_share) && !ends_at_bound(two.effects.back()) &&
        stays_finite(fitter_.problem(), two.fit.hypothesis)) {
      return two;
    }
  }
  return std::nullopt;
}

/// An effect of `start` with each other one of the same part of the rig, fitted while all else stands still.
std::vector<CandidateModel> Search::pairs_with(const firmware::PlacedEffect& first, const Hypothesis& start,
                                               const Scales& scales) const {
  std::vector<firmware::PlacedEffect> seconds;
  for (const Candidate& candidate : candidates(fitter_.problem().samples(), start, scales)) {
    const bool same_part = !candidate.channel && candidate.entry->subsystem == first.entry->subsystem;
    if (!same_part || candidate.replaces != nullptr || (candidate.entry->imitates && !criterion_.imitating)) continue;
    for (const Start& from : candidate.starts) seconds.push_back({candidate.entry, std::nullopt, from.values});
  }
  const ModelFitter alone = fitter_.with_common({});
  std::vector<CandidateModel> pairs(seconds.size());
  for_all(seconds.size(), [&](std::size_t i) {
    Hypothesis hypothesis = start;
    firmware::put_effect(hypothesis.rig, seconds[i]);
    pairs[i] = alone.fitted(hypothesis, {first, seconds[i]}, 8);
    drop_jacobian(pairs[i].fit);
  });
  std::erase_if(pairs, [](const CandidateModel& pair) {
    return !std::isfinite(pair.fit.chi_squared) || ends_at_bound(pair.effects.front()) ||
           ends_at_bound(pair.effects.back());
  });
  sort(pairs);
  std::vector<CandidateModel> each;  // of the fits of an effect the best
  for (CandidateModel& pair : pairs) {
    if (std::none_of(each.begin(), each.end(), [&](const CandidateModel& better) {
          return same_effect(better.effects.back(), pair.effects.back());
        }))
      each.push_back(std::move(pair));
  }
  return each;
}

/// The same of a fault of the recordings: without it, another fault in its place, effects in its place.
bool Search::improve_fault(std::size_t fault, SearchResult& found) {
  CandidateModel& best = found.best;
  report(0.58, "faults of the recordings");
  const CandidateModel reduced = fitter_.without_fault(best, fault);
  if (!criterion_.prefers(best, reduced)) {
    best = reduced;
    return true;
  }
  FoundCause& support = found.faults[fault];
  support.gain = reduced.fit.chi_squared - best.fit.chi_squared;
  if (!budget_.allows(fitter_.problem(), "some exchanges of faults")) return false;
  // What is of the rig is compared with what is of the recorder by the evidence: where both explain as much, the prior
  // of a component decides, and beside a discrepancy what both leave of it is no difference.
  const double own = evidence(best, found);
  if (auto machine = by_machine(best, fault, found); machine && evidence(*machine, found) <= own) {
    best = std::move(*machine);
    return true;
  }
  if (auto sensors = by_sensors(fitter_, best, fault); sensors && evidence(*sensors, found) <= own) {
    best = std::move(*sensors);
    return true;
  }
  if (simplify_clock(fitter_, best, fault) || improve_order(fitter_, best, fault)) return true;
  if (auto filtered = in_filter(fitter_, best, fault)) {
    best = std::move(*filtered);
    return true;
  }
  const double value = best.penalised_chi_squared(criterion_), to_beat = value - thresholds::replaces;
  if (auto other = by_fault(reduced, {}); other && other->penalised_chi_squared(criterion_) < to_beat) {
    best = std::move(*other);
    return true;
  }
  auto others = fitter_.extended(reduced, found.scales, thresholds::fault_rivals);
  // What the fault was may be bent into other parameters by then: also from where these are.
  for (CandidateModel& other :
       fitter_.extended(fitter_.without_fault(best, fault, 0), found.scales, thresholds::fault_rivals)) {
    others.push_back(std::move(other));
  }
  sort(others);
  std::vector<CandidateModel> each;  // of the two fits of an effect the better one
  for (CandidateModel& other : others) {
    if (std::none_of(each.begin(), each.end(), [&](const CandidateModel& better) {
          return same_effect(better.effects.back(), other.effects.back());
        }))
      each.push_back(std::move(other));
  }
  others = std::move(each);
  for (std::size_t i = 0; i < others.size(); ++i) {
    const CandidateModel& other = others[i];
    Rival rival{other.effects.back(), other.penalised_chi_squared(criterion_), other.fit.hypothesis};
    if (i < thresholds::near_rivals) {
      CandidateModel full = fitter_.refitted(other.fit.hypothesis, other.effects, 6);
      rival.penalised_chi_squared = full.penalised_chi_squared(criterion_);
      rival.hypothesis = full.fit.hypothesis;
      if (evidence(full, found) <= own) {
        best = std::move(full);
        return true;
      }
    }
    support.rivals.push_back(std::move(rival));
  }
  return false;
}

/// The best of the machines that may be what a fault is taken for. nullopt: there is none.
std::optional<CandidateModel> Search::by_machine(const CandidateModel& best, std::size_t fault,
                                                 const SearchResult& found) const {
  std::optional<CandidateModel> machine;
  for (CandidateModel& other : machine_instead(fitter_, best, fault)) {
    if (!machine || evidence(other, found) < evidence(*machine, found)) machine = std::move(other);
  }
  return machine;
}

CandidateModel Search::without(std::size_t effect, const SearchResult& found) const {
  if (found.best.effects.size() == 1 && found.best.faults().empty()) return found.nothing;
  CandidateModel reduced = fitter_.without(found.best, effect);
  // With corners the fit without may only be in a worse one of many minima.
  if (options_.truncates && has_corners(reduced.fit.hypothesis.rig)) fitter_.refit_by_continuation(reduced);
  return reduced;
}

/// Rivals of an effect, the nearest first; the nearest are fitted again beside the other effects as they are now.
/// `reduced`: the model without the effect.
std::vector<Rival> Search::rivals_of(const CandidateModel& best, const CandidateModel& reduced, std::size_t effect,
                                     const std::vector<CandidateModel>& others) const {
  const auto rival_of = [this](const CandidateModel& model) {
    return Rival{model.effects.back(), model.penalised_chi_squared(criterion_), model.fit.hypothesis};
  };
  const auto sort_rivals = [](std::vector<Rival>& rivals) {
    std::sort(rivals.begin(), rivals.end(),
              [](const Rival& a, const Rival& b) { return a.penalised_chi_squared < b.penalised_chi_squared; });
  };
  std::vector<Rival> rivals;
  for (const CandidateModel& other : others) {
    if (!same_effect(other.effects.back(), best.effects[effect])) rivals.push_back(rival_of(other));
  }
  sort_rivals(rivals);
  const double without = reduced.penalised_chi_squared(criterion_), with = best.penalised_chi_squared(criterion_);
  const double far = without - thresholds::rival_explains * (without - with);
  for_all(std::min(thresholds::near_rivals, rivals.size()), [&](std::size_t r) {
    if (rivals[r].penalised_chi_squared > far) return;
    std::vector<firmware::PlacedEffect> effects = best.effects;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(effect));
    effects.push_back(rivals[r].effect);
    rivals[r] = rival_of(fitter_.fitted(rivals[r].hypothesis, std::move(effects), 6));
  });
  sort_rivals(rivals);
  // A resonance at the largest damping of its card is a lag: no other cause.
  std::erase_if(rivals, [](const Rival& rival) { return ends_at_bound(rival.effect); });
  return rivals;
}

double Search::least_gain(const CandidateModel& base, bool all) const {
  if (all) return 0.0;
  return thresholds::promising * std::max(criterion_.effect, criterion_.share(base) * beyond_noise(base.fit));
}

std::vector<CandidateModel> Search::extended(const CandidateModel& base, const Scales& scales, bool all) const {
  if (first_share_ < 1.0 && is_far_above_noise(base)) {
    auto list = extended_on_part(base, scales, all);
    // An effect that shows seldom may not be in the part.
    if (!list.empty() && criterion_.accepts(list.front(), base, criterion_.share(base))) return list;
  }
  return fitter_.extended(base, scales, most(all), least_gain(base, all));
}

/// Candidates are told apart on a part of the windows, then refitted on the whole.
std::vector<CandidateModel> Search::extended_on_part(const CandidateModel& base, const Scales& scales, bool all) const {
  IdentificationProblem part = fitter_.problem().truncated(first_share_);
  const ModelFitter on_part(part, space_.common, criterion_);
  const CandidateModel start = on_part.refitted(base.fit.hypothesis, base.effects, 2);
  auto list = on_part.extended(start, scales, most(all), least_gain(start, all));
  const Eigen::MatrixXd none;
  for_all(list.size(), [&](std::size_t i) {
    const int steps = i < criterion_.beam ? 6 : 0;
    const bool adds = list[i].effects.size() > base.effects.size();  // and else replaces one
    list[i] = fitter_.fitted(list[i].fit.hypothesis, list[i].effects, steps, adds ? base.fit.jacobian : none);
    drop_jacobian(list[i].fit);
  });
  sort(list);
  return list;
}

}  // namespace

SearchResult search(IdentificationProblem& problem, const SearchSpace& space, const SearchOptions& options) {
  SearchResult found;
  Search(problem, space, options).forward(found);
  return found;
}

void compare(IdentificationProblem& problem, const SearchSpace& space, const SearchOptions& options,
             SearchResult& found) {
  Search(problem, space, options).backward(found);
}

void refit_on(IdentificationProblem& problem, const SearchSpace& space, const SelectionCriterion& criterion,
              SearchResult& found) {
  const ModelFitter fitter(problem, space.common, criterion);
  const double before = found.best.penalised_chi_squared(criterion);
  const auto part = static_cast<double>(found.best.fit.residual.size());
  fitter.refit(found.nothing, 8);
  fitter.refit(found.best, 8);
  const double larger = static_cast<double>(found.best.fit.residual.size()) / part;
  const double after = found.best.penalised_chi_squared(criterion);
  for (std::vector<FoundCause>* const list : {&found.causes, &found.faults}) {
    for (FoundCause& cause : *list) {
      cause.gain *= larger;
      for (Rival& rival : cause.rivals) {
        rival.penalised_chi_squared = after + larger * (rival.penalised_chi_squared - before);
      }
    }
  }
}

}  // namespace host_sim::identification
