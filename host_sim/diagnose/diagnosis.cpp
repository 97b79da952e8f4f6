#include "host_sim/diagnose/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/diagnose/carried_noise.hpp"
#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/intake.hpp"
#include "host_sim/diagnose/parallel.hpp"
#include "host_sim/diagnose/piece.hpp"
#include "host_sim/diagnose/rest.hpp"
#include "host_sim/diagnose/second_look.hpp"
#include "host_sim/diagnose/virtual_car.hpp"
#include "host_sim/input_error.hpp"

namespace host_sim::diagnose {
namespace {

using model::Channel;

std::vector<CarriedNoise> carried_noises(const std::vector<Evidence>& evidence, const Hypothesis& hypothesis) {
  std::vector<CarriedNoise> noises(evidence.size());
  for_all(evidence.size(), [&](std::size_t r) {
    const Evidence& e = evidence[r];
    noises[r] = carried_noise(e, hypothesis, hypothesis.starts[r], e.fit.size() > 0 ? e.fit : e.judge);
  });
  return noises;
}

void whiten(Case& all, const std::vector<CarriedNoise>& noises) {
  all.fit.clear();
  all.judge.clear();
  all.fitted.clear();
  all.judged.clear();
  for (std::size_t r = 0; r < all.evidence.size(); ++r) {
    const Evidence& e = all.evidence[r];
    if (e.fit.size() > 0) {
      all.fit.emplace_back(e, e.fit, noises[r].spectrum, all.model_error);
      all.fitted.push_back(r);
    }
    if (e.judge.size() > 0) {
      all.judge.emplace_back(e, e.judge, noises[r].spectrum, all.model_error);
      all.judged.push_back(r);
    }
  }
}

/// The share of what was left over beyond noise that effects explain; χ² per residual, of so many residuals.
double explained_share(double refit, double after, double count) {
  return 1.0 - std::max(after - 1.0, 0.0) / std::max(refit - 1.0, 1.0 / count);
}

/// Below this share of the power explained, what is found is not the whole of it.
constexpr double all_but_noise = 0.97;
/// Below this, comparing with rivals has never made it the whole (tests/confusion): a second look comes before it.
constexpr double far_from_all = 0.9;

/// Of a long recording the beginning is fitted and the end held out: minutes say what hours would, and fit into memory.
std::vector<std::string> without_the_middle(std::vector<Record>& records) {
  constexpr double longest_fitted = 300.0, longest_judged = 100.0;  // [s]
  std::vector<std::string> remarks;
  std::vector<Record> ends;
  for (Record& record : records) {
    Recording& r = record.recording;
    const std::size_t n = r.size();
    const auto samples = [&](double seconds) { return static_cast<std::size_t>(seconds / r.sample_period); };
    const auto kept = record.use == Use::held_out ? samples(longest_judged) : samples(longest_fitted);
    const std::size_t end = record.use == Use::shared ? samples(longest_judged) : 0;
    if (n <= kept + end) continue;
    char words[128];
    std::snprintf(words, sizeof words, ": of %.0f s the first %.0f s are %s", static_cast<double>(n) * r.sample_period,
                  static_cast<double>(kept) * r.sample_period, record.use == Use::held_out ? "held out" : "fitted");
    remarks.push_back(r.source + words);
    if (end > 0) {
      ends.push_back({cut(r, n - end, n), Use::held_out});
      std::snprintf(words, sizeof words, ", the last %.0f s held out", static_cast<double>(end) * r.sample_period);
      remarks.back() += words;
      record.use = Use::fitted;
    }
    record.recording = cut(r, 0, kept);
  }
  for (Record& record : ends) records.push_back(std::move(record));
  return remarks;
}

/// What a reader of the verdict must know beside it.
std::vector<std::string> remarks_of(const Case& all, const RigDescription& description) {
  std::vector<std::string> remarks;
  for (const Evidence& e : all.evidence) {
    for (const Channel channel : e.channels) {
      const auto c = index(channel);
      if (!e.clipped[c].empty()) {
        const auto count = std::count(e.clipped[c].begin(), e.clipped[c].end(), true) -
                           std::count(e.recording.filled.begin(), e.recording.filled.end(), true);
        if (count > 0) {
          remarks.push_back(e.recording.source + ": " + std::to_string(count) + " clipped samples of " +
                            std::string(model::name(channel)) + " are left out");
        }
      }
      if (!description.noise[c]) {
        char text[160];
        std::snprintf(text, sizeof text, "%s: noise of %s not given, estimated as %.3g %s rms",
                      e.recording.source.c_str(), std::string(model::name(channel)).c_str(), e.noise[c],
                      std::string(model::unit(channel)).c_str());
        remarks.emplace_back(text);
      }
    }
    if (e.inputs_disagree) {
      remarks.push_back(e.recording.source +
                        ": z_r and zdd_r do not tell of one motion; the foot point follows z_r alone");
    }
  }
  if (description.rig.kind == model::RigKind::hil) {
    remarks.emplace_back(
        "hil: machine and component are judged on the recorded x_cmd; the car is a number of the program");
  }
  return remarks;
}

}  // namespace

std::string_view name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> names{"no_discrepancy", "named", "ambiguous", "unexplained"};
  return names[static_cast<std::size_t>(verdict)];
}

Diagnosis diagnose(const RigDescription& description, std::vector<Record> records, const Tell& tell) {
  const std::vector<std::string> shortened = without_the_middle(records);
  std::vector<Recording*> recordings;
  for (Record& record : records) recordings.push_back(&record.recording);
  const std::vector<std::string> taken_in = take_in(description, recordings);
  // What one recording shows of the sensors holds for all: they are explained with the same channels.
  const bool disagree = std::any_of(records.begin(), records.end(), [&](const Record& record) {
    return inputs_disagree(description, record.recording);
  });
  Case all;
  for (Record& record : records) {
    all.evidence.push_back(evidence_of(description, std::move(record.recording), record.use, disagree));
  }
  for (const Evidence& e : all.evidence) {
    if (e.channels != all.evidence.front().channels) {
      throw InputError(e.recording.source, 0, "measures other channels than " + all.evidence.front().recording.source,
                       "recordings of the same channels");
    }
  }
  Diagnosis result;
  Hypothesis given{explained_part(description.rig), {}};
  for (const Evidence& e : all.evidence) {
    given.starts.push_back(e.at_rest ? resting(given.rig, e.drive)
                                     : estimated_start(given.rig, e.drive, e.recording, description.range));
  }
  const auto tolerated = tolerated_unknowns(description);
  const auto starts = start_unknowns(description, all.evidence);
  std::vector<CarriedNoise> noises = carried_noises(all.evidence, given);
  whiten(all, noises);
  if (all.fit.empty()) throw InputError(description.source, 0, "every recording is held out", "one to be explained");
  result.relations = redundancy(description, all.evidence);

  const Price price;
  const auto rewhiten = [&](const Hypothesis& hypothesis) {
    if (noises.front().spectrum.empty()) return false;
    noises = carried_noises(all.evidence, hypothesis);
    whiten(all, noises);
    return true;
  };
  const auto shorten = [&](double share) {
    Case part = all;
    for (Evidence& e : part.evidence) {
      const auto least = static_cast<std::size_t>(2.0 / e.drive.period);
      const auto wanted = static_cast<std::size_t>(share * static_cast<double>(e.fit.size()));
      e.fit.to = e.fit.from + std::min(e.fit.size(), std::max(wanted, least));
    }
    whiten(part, noises);
    return part;
  };
  Findings findings = search(all, given, tolerated, starts, {price, rewhiten, shorten, tell});
  const auto count = static_cast<double>(findings.best.fit.residual.size());
  /// Whether more is left than noise, and at least so much.
  const auto lacks = [&](double share) {
    const double explained =
        explained_share(findings.nothing.fit.chi_squared / count, findings.best.fit.chi_squared / count, count);
    return explained < share && rest_of(all, findings.best.fit.hypothesis).significant;
  };
  const auto compare_all = [&] { compare(all, tolerated, starts, {price, rewhiten, shorten, tell}, findings); };
  const bool far = lacks(far_from_all);
  if (!far) compare_all();
  if (far || lacks(all_but_noise)) {
    all.model_error = pooled_error(all, findings.best.fit.hypothesis);
    whiten(all, noises);
    constexpr double enough = 24.0;  // [s]: errors of the model differ from one second to the next, unlike noise
    const double share = telling_share(all, enough / static_cast<double>(all.fitted.size()));
    const Look look = [&](const Price& smaller, const auto& is_worth_comparing) {
      Case part = shorten(share);
      // What steps get wrong is small beside the error allowed for.
      for (Evidence& e : part.evidence) e.fine = (e.fine + 1) / 2;
      const auto rewhiten_part = [&](const Hypothesis& hypothesis) {
        const bool depends = rewhiten(hypothesis);
        if (depends) whiten(part, noises);
        return depends;
      };
      const Tools tools{smaller, rewhiten_part, {}, tell};
      Findings some = search(part, given, tolerated, starts, tools);
      if (is_worth_comparing) {
        Findings whole = some;
        settle_on(all, tolerated, starts, smaller, whole);
        if (!is_worth_comparing(whole)) return whole;
      }
      compare(part, tolerated, starts, tools, some);
      settle_on(all, tolerated, starts, smaller, some);
      return some;
    };
    const std::vector<CarriedNoise> noises_found = noises;
    const bool replaced = second_look(all, findings, all.model_error, look, result.remarks);
    all.model_error = 0.0;
    if (!replaced) noises = noises_found;
    whiten(all, noises);
    if (far && !replaced) compare_all();
  }
  result.simulations = findings.simulations;
  result.candidates = findings.tried;

  // Recordings held out begin in a state of their own, which what was found knows best.
  for (std::size_t r = 0; r < all.evidence.size(); ++r) {
    const Evidence& e = all.evidence[r];
    if (e.fit.size() > 0 || e.at_rest) continue;
    for (Explanation* one : {&findings.nothing, &findings.best}) {
      Hypothesis& hypothesis = one->fit.hypothesis;
      hypothesis.starts[r] = estimated_start(hypothesis.rig, e.drive, e.recording, description.range);
    }
  }

  const Fit& fit = findings.best.fit;
  const auto power_left = [&](const Hypothesis& hypothesis) {
    return residuals(all, predict(all, hypothesis)).squaredNorm() / count;
  };
  result.chi_squared_before = power_left(given);
  result.chi_squared_refit = power_left(findings.nothing.fit.hypothesis);
  result.chi_squared_after = power_left(fit.hypothesis);

  const Rest rest = rest_of(all, fit.hypothesis);
  result.unexplained = rest.significant;
  result.rest = rest.words;
  const double explained = explained_share(result.chi_squared_refit, result.chi_squared_after, count);
  const auto shrinks = [&] {
    const double refit = pooled_error(all, findings.nothing.fit.hypothesis);
    return std::max(1.0 - pooled_error(all, fit.hypothesis) / std::max(refit, 1e-300), 0.0);
  };
  // Where a rest is left, a name is worth what it explains: nearly all of the power, or at most half of a certainty for
  // the share of the error that goes away.
  const double worth =
      result.unexplained ? std::max((explained - all_but_noise) / (1.0 - all_but_noise), 0.5 * shrinks()) : 1.0;
  const double temper = std::max(1.0, fit.chi_squared / count);

  const Certainty certainty{worth, temper, seen_from(all, count)};
  const std::vector<Interval> unknowns = intervals(fit, temper);
  for (std::size_t i = 0; i < tolerated.size(); ++i) result.parameters[tolerated[i].path] = unknowns[i];
  const VirtualCar car_of_program = virtual_car(description, all.evidence);
  for (const auto& [path, car] : car_of_program.parameters) {
    result.parameters[path] = {car.value, car.value - 1.96 * car.error, car.value + 1.96 * car.error};
  }
  result.effects = named_effects(all, findings, price, unknowns, certainty);
  const bool close = std::any_of(result.effects.begin(), result.effects.end(), has_close_rival);
  // What the program itself computes is known without noise.
  for (const TyreEffect& tyre : car_of_program.effects) {
    NamedEffect named{tyre.effect, {}, 0.999, {}};
    for (const Estimate& e : tyre.parameters) {
      named.parameters.push_back({e.value, e.value - 1.96 * e.error, e.value + 1.96 * e.error});
    }
    result.effects.push_back(std::move(named));
    const double left = car_of_program.effects.back().after;
    result.gap[Channel::F_w] = {car_of_program.effects.front().before, car_of_program.effects.front().before, left,
                                left};
  }
  if (result.effects.empty()) {
    // What drives the simulation, or is a number of the program, shows in the redundancy alone.
    for (const Residue& r : result.relations) {
      if (!r.loud()) continue;
      result.unexplained = true;
      result.rest.append(result.rest.empty() ? "" : "; ").append(r.relation).append(" does not hold");
      if (!r.looks.empty()) result.rest.append(", ").append(r.looks);
    }
  }
  if (result.effects.empty()) {
    result.verdict = result.unexplained ? Verdict::unexplained : Verdict::no_discrepancy;
  } else if (result.unexplained && explained < all_but_noise) {
    result.verdict = Verdict::unexplained;
  } else {
    result.verdict = close ? Verdict::ambiguous : Verdict::named;
  }

  result.left_by_refit = band_powers(all, findings.nothing.fit.hypothesis);
  result.left_after = band_powers(all, fit.hypothesis);
  result.where = places(result.left_by_refit, findings, likely_place(result.relations));
  if (!car_of_program.effects.empty()) {
    const double other = result.where.empty() ? 0.0 : 0.5;
    for (Place& place : result.where) place.share *= other;
    result.where.push_back({Channel::F_w, 0.0, 0.5 / all.evidence.front().drive.period, "tyre", 1.0 - other});
  }
  result.gap.merge(gaps(all, noises, given, findings.nothing.fit.hypothesis, fit.hypothesis));
  result.overlays = overlays_of(all, given, findings.nothing.fit.hypothesis, fit.hypothesis);
  const auto remarks = remarks_of(all, description);
  result.remarks.insert(result.remarks.begin(), shortened.begin(), shortened.end());
  result.remarks.insert(result.remarks.begin(), taken_in.begin(), taken_in.end());
  result.remarks.insert(result.remarks.end(), remarks.begin(), remarks.end());
  result.rig = description;
  for (const auto& [path, value] : result.parameters) {
    if (double* const parameter = find_parameter(result.rig.rig, path)) *parameter = value.value;
  }
  for (const NamedEffect& named : result.effects) put_effect(result.rig.rig, named.effect);
  return result;
}

}  // namespace host_sim::diagnose
