#include "host_sim/identification/select/external_event.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "host_sim/identification/estimate/left_by_fit.hpp"
#include "host_sim/identification/estimate/residual_over_time.hpp"
#include "host_sim/identification/parity/disturbed_span.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/law_constancy.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Stretches of one recording whose residuals stand out.
struct LoudStretches {
  std::size_t recording = 0;
  double from = 0.0, to = 0.0;  ///< [s]
  double peak_to = 0.0;         ///< [s] end of the loudest
  double ratio = 0.0;           ///< power of the loudest ÷ that of three quarters of all others
};

/// In one series of powers: the run around the loudest stretch, until the power is that of the others again.
std::optional<LoudStretches> loudest(const std::vector<StretchPower>& stretches, const std::vector<double>& powers) {
  if (powers.size() < 8) return std::nullopt;
  std::vector<double> sorted = powers;
  std::sort(sorted.begin(), sorted.end());
  const double usual = std::max(sorted[sorted.size() * 3 / 4], 1.0), middle = std::max(sorted[sorted.size() / 2], 1.0);
  const auto peak = static_cast<std::size_t>(std::max_element(powers.begin(), powers.end()) - powers.begin());
  const bool noise_else = usual < thresholds::only_noise_else;
  if (powers[peak] < usual * (noise_else ? thresholds::loud_in_noise : thresholds::loud_in_rest)) return std::nullopt;
  const double quiet = thresholds::quiet_again * (noise_else ? usual : middle);
  std::size_t first = peak, last = peak;
  const auto same = [&](std::size_t k) { return stretches[k].recording == stretches[peak].recording; };
  while (first > 0 && same(first - 1) && powers[first - 1] > quiet) --first;
  // How the rig began is not known better than what it forgot since.
  if (first == 0 || !same(first - 1)) return std::nullopt;
  while (last + 1 < powers.size() && same(last + 1) && powers[last + 1] > quiet) ++last;
  if (static_cast<double>(last - first + 1) > thresholds::most_left_out * static_cast<double>(powers.size())) {
    return std::nullopt;
  }
  return LoudStretches{stretches[peak].recording, stretches[first].from, stretches[last].to, stretches[peak].to,
                       powers[peak] / usual};
}

/// Returns the penalties of (1) for one event of that duration [s].
double price_of(double duration) {
  const SelectionCriterion criterion;
  return criterion.effect + criterion.parameter * (2.0 + 2.0 * thresholds::event_bandwidth * duration);
}

/// Whether (1) holds for these stretches alone: beside a strong event nothing would be too weak to be one more.
bool pays(const std::vector<StretchPower>& stretches, const LoudStretches& loud) {
  double beyond = 0.0;
  for (const StretchPower& stretch : stretches) {
    if (stretch.recording != loud.recording || stretch.from < loud.from || stretch.to > loud.to) continue;
    for (std::size_t c = 0; c < stretch.powers.size(); ++c) {
      const Power power = stretch.of_channel(c);
      beyond += power.squares - power.count;
    }
  }
  return beyond > price_of(loud.peak_to - loud.from);
}

std::optional<LoudStretches> loud_stretches(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const auto stretches = stretch_powers(problem, read_all(problem, hypothesis), thresholds::event_stretch);
  const std::size_t channels = problem.channels().size();
  // A value that is taken a moment too late is far off where the motion is fast: a held channel says nothing of events.
  const auto held = [&](std::size_t c) {
    const auto& renewals = problem.samples().front().renewals[index(problem.channels()[c])];
    return renewals && renewals->regular;
  };
  std::optional<LoudStretches> best;
  for (std::size_t c = 0; c <= channels; ++c) {  // the last: all together
    if (c < channels && held(c)) continue;
    std::vector<double> powers;
    for (const StretchPower& stretch : stretches) {
      Power sum;
      for (std::size_t i = 0; i < channels; ++i) {
        if ((c < channels && i != c) || held(i)) continue;
        const Power power = stretch.of_channel(i);
        sum.squares += power.squares;
        sum.count += power.count;
      }
      powers.push_back(sum.ratio());
    }
    const auto loud = loudest(stretches, powers);
    if (loud && pays(stretches, *loud) && (!best || loud->ratio > best->ratio)) best = loud;
  }
  return best;
}

/// The samples of a stretch [s].
Window samples_of_stretch(const PreparedRecording& recording, double from, double to) {
  const std::vector<double>& time = recording.recording.time;
  const auto first = std::lower_bound(time.begin(), time.end(), from), last = std::upper_bound(first, time.end(), to);
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - time.begin())};
}

/// Residuals of the fitted windows in these samples.
double residuals_in(const IdentificationProblem& problem, std::size_t recording, Window samples) {
  const ProblemRecording& r = problem.recordings()[recording];
  if (!r.is_fitted()) return 0.0;
  const Window window = r.fit_whitening->window();
  const std::size_t from = std::max(samples.from, window.from), to = std::min(samples.to, window.to);
  if (to <= from) return 0.0;
  return static_cast<double>(r.fit_whitening->count()) * static_cast<double>(to - from) /
         static_cast<double>(window.size());
}

bool leaves_rest(const IdentificationProblem& problem, const Fit& fit) { return left_by(problem, fit).by_time.found(); }

/// Σ r² − n over the whole record.
double power_beyond_noise(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  double beyond = 0.0;
  for (const StretchPower& s : stretch_powers(problem, read_all(problem, hypothesis), thresholds::event_stretch)) {
    for (std::size_t c = 0; c < problem.channels().size(); ++c) {
      const Power power = s.of_channel(c);
      beyond += power.squares - power.count;
    }
  }
  return beyond;
}

/// True if two events, or two times for one, lie in the same recording and have an instant in common.
bool overlap(const ExternalEvent& a, const ExternalEvent& b) {
  return a.recording == b.recording && a.from < b.to && a.to > b.from;
}

/// A stretch that is not used any more [s], and the event in it.
struct UnusedStretch {
  double from, to;
  ExternalEvent event;
};

/// Stretches that were left out; they may overlap.
struct LeftOut {
  std::vector<UnusedStretch> stretches;
  CandidateModel model;   ///< fitted again to all others
  double price = 0.0;     ///< of (1), without the residuals
  bool held_out = false;  ///< one of them lies in a part that is held out
};

/// Without what overlaps.
std::vector<UnusedStretch> united(std::vector<UnusedStretch> stretches) {
  std::sort(stretches.begin(), stretches.end(), [](const UnusedStretch& a, const UnusedStretch& b) {
    return a.event.recording != b.event.recording ? a.event.recording < b.event.recording : a.from < b.from;
  });
  std::vector<UnusedStretch> whole;
  for (const UnusedStretch& next : stretches) {
    if (whole.empty() || whole.back().event.recording != next.event.recording || next.from > whole.back().to) {
      whole.push_back(next);
    } else {
      whole.back().to = std::max(whole.back().to, next.to);
    }
  }
  return whole;
}

/// Residuals that are left out: n of (1).
double residuals_in(const IdentificationProblem& problem, const std::vector<UnusedStretch>& stretches) {
  double sum = 0.0;
  for (const UnusedStretch& stretch : united(stretches)) {
    const PreparedRecording& recording = problem.samples()[stretch.event.recording];
    sum += residuals_in(problem, stretch.event.recording, samples_of_stretch(recording, stretch.from, stretch.to));
  }
  return sum;
}

/// Leaves out the loudest stretch of what the hypothesis leaves. false: none stands out.
bool leave_out_loudest(const firmware::RigDescription& description, IdentificationProblem& problem,
                       const Hypothesis& hypothesis, LeftOut& out) {
  const std::optional<LoudStretches> loud = loud_stretches(problem, hypothesis);
  if (!loud) return false;
  const PreparedRecording& recording = problem.samples()[loud->recording];
  TimeSpan span{loud->from, loud->peak_to};
  const TimeSpan within{loud->from - thresholds::event_stretch, loud->to};
  const std::vector<TimeSpan> sharp = Balances(description, recording).disturbed(within);
  if (!sharp.empty()) span = sharp.front();
  // At its tapered end a stretch does not show the beginning of an event.
  const double from = std::min(loud->from, span.from - thresholds::event_margin);
  const Window samples = samples_of_stretch(recording, from, loud->to);
  out.price += price_of(span.to - span.from);
  out.held_out = out.held_out || samples.to > problem.recordings()[loud->recording].fitted.to;
  out.stretches.push_back({from, loud->to, {loud->recording, span.from, span.to, 0.0}});
  problem.leave_out(loud->recording, samples);
  return true;
}

/// Leaves out a little more behind each event: slow motion that it left is weak in every short stretch. false: too
/// little would be left.
bool leave_out_tails(IdentificationProblem& problem, LeftOut& out) {
  std::vector<UnusedStretch> longer = out.stretches;
  for (UnusedStretch& stretch : longer) stretch.to += thresholds::event_tail;
  double unused = 0.0, whole = 0.0;
  for (const UnusedStretch& stretch : united(longer)) unused += stretch.to - stretch.from;
  for (const PreparedRecording& r : problem.samples()) whole += r.recording.time.back() - r.recording.time.front();
  if (unused > thresholds::most_left_out_in_all * whole) return false;
  for (const UnusedStretch& stretch : longer) {
    const PreparedRecording& recording = problem.samples()[stretch.event.recording];
    problem.leave_out(stretch.event.recording, samples_of_stretch(recording, stretch.from, stretch.to));
  }
  out.stretches = std::move(longer);
  return true;
}

/// The recording less what the model reads. The balances between channels hold for the difference as for the whole, and
/// where something acted from outside no motion of the road covers it. Channels that drive the simulation are zero.
PreparedRecording beside_model(const PreparedRecording& recording, const Response& readings) {
  PreparedRecording beside = recording;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const model::Channel channel = model::channel_at(c);
    if (!recording.recording.has(channel)) continue;
    std::vector<double>& samples = beside.recording[channel];
    const bool explained = recording.explains(channel);
    for (std::size_t k = 0; k < samples.size(); ++k) samples[k] = explained ? samples[k] - readings[c][k] : 0.0;
  }
  return beside;
}

/// True if a stretch begins where another one ends.
bool is_tail(const LeftOut& out, const UnusedStretch& stretch) {
  return std::any_of(out.stretches.begin(), out.stretches.end(), [&](const UnusedStretch& other) {
    return &other != &stretch && other.event.recording == stretch.event.recording && other.from < stretch.from &&
           other.to > stretch.from - thresholds::event_stretch;
  });
}

/// When the events were, by the balances of what the model leaves; none where balances can be drawn up and all of them
/// hold: then nothing acted, and the model is wrong where the motion is large. Two in one stretch are told apart; none
/// where they are more than thresholds::most_events. Where no balance fails, it is what the event before left; or, with
/// none before, keeps its time.
std::vector<ExternalEvent> timed(const firmware::RigDescription& description, const IdentificationProblem& problem,
                                 const Hypothesis& hypothesis, const LeftOut& out) {
  const std::vector<Response> readings = read_all(problem, hypothesis);
  std::map<std::size_t, Balances> balances;  // of the recordings with events
  for (const UnusedStretch& stretch : out.stretches) {
    const std::size_t i = stretch.event.recording;
    if (!balances.contains(i))
      balances.emplace(i, Balances(description, beside_model(problem.samples()[i], readings[i])));
  }
  std::vector<ExternalEvent> events;
  bool holds = balances.begin()->second.can_be_drawn_up();
  for (const UnusedStretch& stretch : out.stretches) {
    const ExternalEvent& event = stretch.event;
    std::vector<TimeSpan> spans =
        balances.at(event.recording).disturbed({stretch.from - thresholds::event_stretch, stretch.to});
    holds = holds && spans.empty();
    if (spans.empty() && !is_tail(out, stretch)) spans = {{event.from, event.to}};
    for (const TimeSpan& span : spans) {
      const ExternalEvent sharp{event.recording, span.from, span.to, 0.0};
      const auto same = [&](const ExternalEvent& other) { return overlap(sharp, other); };
      if (std::none_of(events.begin(), events.end(), same)) events.push_back(sharp);
    }
  }
  return holds || events.size() > thresholds::most_events ? std::vector<ExternalEvent>{} : events;
}

/// (2) of external_event.hpp: what stands out, one after the other, each time with what is left fitted again.
LeftOut leave_out_all(const firmware::RigDescription& description, IdentificationProblem& problem,
                      const SearchSpace& space, const CandidateModel& model) {
  const SelectionCriterion criterion;
  LeftOut out;
  out.model = model;
  while (out.stretches.size() < thresholds::most_events &&
         (out.stretches.empty() || leaves_rest(problem, out.model.fit)) &&
         leave_out_loudest(description, problem, out.model.fit.hypothesis, out)) {
    out.model = ModelFitter::refitted_in(problem, space, criterion, out.model);
  }
  return out;
}

/// Leaves out the slow motion behind the events too, a piece at a time, until the model leaves nothing but noise to
/// `leaves_more`.
void leave_out_what_lasts(IdentificationProblem& problem, const SearchSpace& space,
                          bool (*leaves_more)(const IdentificationProblem&, const Fit&), LeftOut& out) {
  while (leaves_more(problem, out.model.fit) && leave_out_tails(problem, out)) {
    out.model = ModelFitter::refitted_in(problem, space, SelectionCriterion(), out.model);
  }
}

/// The same for the model that was selected beside the events: the body's motion long after a push is too weak for
/// every stretch of time, and shows in the band of its resonance. Effects that explained it go. Taken back where more
/// is left than such motion; not tried where described values were freed, which this refit would bind again.
void leave_out_what_lasts(IdentificationProblem& problem, const SearchSpace& space, const ProgressCallback& progress,
                          LeftOut& out, SearchResult& found) {
  const auto leaves_more = [](const IdentificationProblem& p, const Fit& fit) { return left_by(p, fit).any(); };
  if (!found.freed.empty() || !leaves_more(problem, found.best.fit)) return;
  IdentificationProblem shorter = problem;
  LeftOut longer = out;
  longer.model = found.best;
  leave_out_what_lasts(shorter, space, leaves_more, longer);
  if (leaves_more(shorter, longer.model.fit)) return;
  problem = std::move(shorter);
  out = std::move(longer);
  refit_on(problem, space, SelectionCriterion(), found);
  compare(problem, space, {{}, true, progress}, found);
  find_constancy(problem, found);
}

/// The model selected again, `without` what was left out, takes the place of the other where it is better by (1) and
/// (2) of external_event.hpp. false: it is not.
bool select_without(const firmware::RigDescription& description, IdentificationProblem& problem,
                    IdentificationProblem without, LeftOut out, const SearchSpace& space,
                    const ProgressCallback& progress, SearchResult& found) {
  SearchResult again = select_in_noise(without, space, progress);
  if (leaves_rest(without, again.best.fit)) return false;
  leave_out_what_lasts(without, space, progress, out, again);
  const SelectionCriterion criterion;
  const double gain = found.best.penalised_chi_squared(criterion) - again.best.penalised_chi_squared(criterion) -
                      residuals_in(problem, out.stretches) - out.price;
  // What is held out has no part in (1): the event is believed since the rest went away with it.
  if (!(gain > 0.0) && !out.held_out) return false;
  again.events = timed(description, problem, again.best.fit.hypothesis, out);
  if (again.events.empty()) return false;
  for (ExternalEvent& event : again.events) event.gain = std::max(gain, 0.0);
  found = std::move(again);
  problem = std::move(without);
  return true;
}

}  // namespace

void leave_out_events(const firmware::RigDescription& description, IdentificationProblem& problem,
                      const SearchSpace& space, const ProgressCallback& progress, SearchResult& found) {
  if (!leaves_rest(problem, found.best.fit)) return;
  // No effect explains a push: however bent, the best model leaves it, and it is most of what that leaves.
  IdentificationProblem beside_effects = problem;
  LeftOut of_best = leave_out_all(description, beside_effects, space, found.best);
  if (of_best.stretches.empty()) return;
  leave_out_what_lasts(beside_effects, space, leaves_rest, of_best);
  const double left = power_beyond_noise(beside_effects, of_best.model.fit.hypothesis);
  if (left > thresholds::left_beside_events * power_beyond_noise(problem, found.best.fit.hypothesis)) return;
  if (!leaves_rest(beside_effects, of_best.model.fit) &&
      select_without(description, problem, std::move(beside_effects), of_best, space, progress, found)) {
    return;
  }
  // Effects may have been bent to explain an event: the same without any.
  IdentificationProblem bare = problem;
  const LeftOut of_nothing = leave_out_all(description, bare, space, found.nothing);
  const auto is_there = [&](const UnusedStretch& stretch) {
    return std::any_of(of_best.stretches.begin(), of_best.stretches.end(),
                       [&](const UnusedStretch& other) { return overlap(stretch.event, other.event); });
  };
  if (std::none_of(of_nothing.stretches.begin(), of_nothing.stretches.end(), is_there)) return;
  select_without(description, problem, std::move(bare), of_nothing, space, progress, found);
}

}  // namespace host_sim::identification
