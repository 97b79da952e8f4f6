#include "host_sim/diagnose/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/diagnose/carried_noise.hpp"
#include "host_sim/diagnose/experiment.hpp"
#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/intake.hpp"
#include "host_sim/diagnose/parallel.hpp"
#include "host_sim/diagnose/piece.hpp"
#include "host_sim/diagnose/readings.hpp"
#include "host_sim/diagnose/rest.hpp"
#include "host_sim/diagnose/story.hpp"
#include "host_sim/diagnose/virtual_car.hpp"
#include "host_sim/input_error.hpp"
#include "host_sim/spectrum.hpp"

namespace host_sim::diagnose {
namespace {

using model::Channel;

/// Odds below which two explanations count as not told apart. (A simpler effect that is a limit of its rival wins by
/// the price of a parameter, e^5.)
constexpr double too_close = 20.0;

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

/// Sums of squares over a window, clipped samples left out.
struct Misfit {
  double error = 0.0, data = 0.0;

  void add(const Evidence& e, Channel channel, const Response& response, Window window) {
    const auto c = index(channel);
    window = e.known(channel, window);
    for (std::size_t k = window.from; k < window.to; ++k) {
      if (!e.clipped[c].empty() && e.clipped[c][k]) continue;
      const double measured = e.recording[channel][k];
      error += std::pow(response[c][k] - measured, 2);
      data += measured * measured;
    }
  }
};

/// rms of the error ÷ rms of the channel over the fitted windows, root mean square over channels and recordings.
double pooled_error(const Case& all, const Hypothesis& hypothesis) {
  double sum = 0.0, terms = 0.0;
  for (const std::size_t r : all.fitted) {
    const Evidence& e = all.evidence[r];
    const Response response = read_channels(hypothesis, e, e.drive, hypothesis.starts[r], e.fit.to);
    for (const Channel channel : e.channels) {
      Misfit misfit;
      misfit.add(e, channel, response, e.fit);
      if (!(misfit.data > 0.0)) continue;
      sum += misfit.error / misfit.data;
      terms += 1.0;
    }
  }
  return terms > 0.0 ? std::sqrt(sum / terms) : 0.0;
}

/// The share of what was left over beyond noise that effects explain; χ² per residual, of so many residuals.
double explained_share(double refit, double after, double count) {
  return 1.0 - std::max(after - 1.0, 0.0) / std::max(refit - 1.0, 1.0 / count);
}

/// Below this share of the power explained, what is found is not the whole of it.
constexpr double all_but_noise = 0.97;

/// A rig that is not all in the catalogue: in units of noise, details of what cannot be explained outweigh the effects
/// that matter. Looks again, with smaller steps; the case allows for an error of the model as large as `left`.
Findings second_look(const Case& all, Findings found, double left, const std::function<Findings(const Price&)>& look,
                     std::vector<std::string>& remarks) {
  Price smaller;
  smaller.later_share = 0.1;
  smaller.beam = 1;
  smaller.tried = 5;
  smaller.compared = 3;
  // Sensors last: several of them bend any channel into place, but what a rig does has one cause for all channels.
  double least = 0.98 * left;
  for (const bool sensors : {false, true}) {
    smaller.sensors = sensors;
    smaller.compare = !sensors;
    Findings again = look(smaller);
    double error = pooled_error(all, again.best.fit.hypothesis);
    if (sensors && error < least) {
      smaller.compare = true;
      again = look(smaller);
      error = pooled_error(all, again.best.fit.hypothesis);
    }
    again.simulations += found.simulations;
    again.tried += found.tried;
    if (error < least) {
      found = std::move(again);
      left = error;
      least = 0.75 * error;
      continue;
    }
    found.simulations = again.simulations;
    found.tried = again.tried;
    if (!sensors || error >= 0.98 * left) continue;
    std::vector<std::string> names;
    for (const PlacedEffect& effect : again.best.effects) names.push_back(words(effect));
    char change[64];
    std::snprintf(change, sizeof change, " would leave an error of %.3g %%, instead of %.3g %%", 100.0 * error,
                  100.0 * left);
    remarks.push_back(joined(names) + change + ": rivals of what is listed, which has fewer causes in sensors");
  }
  return found;
}

/// How likely it is that something which is not in the catalogue looks like an effect that gained so much of χ².
///
/// Were the law a neighbour of the effect's that shares all but q of its power, q gain of χ² would be left over, and be
/// seen from `seen` on. Of rigs that have something to find so many have something that is not in the catalogue, and
/// before anything is known its q is as likely to be around 0.001 as around 0.1 (uniform in log q, 0.001 … 1).
double outside_chance(double gain, double seen) {
  constexpr double outside = 0.2, closest = 1e-3;
  return outside * std::clamp(std::log(seen / (std::max(gain, 1e-9) * closest)) / std::log(1.0 / closest), 0.0, 1.0);
}

/// rms of the error over the held-out windows, by channel, relative to the rms of the channel.
std::map<Channel, double> errors(const Case& all, const Hypothesis& hypothesis) {
  const auto responses = respond(all, hypothesis);
  std::map<Channel, double> result;
  for (const Channel channel : all.evidence.front().channels) {
    Misfit misfit;
    for (const std::size_t r : all.judged) misfit.add(all.evidence[r], channel, responses[r], all.evidence[r].judge);
    result[channel] = misfit.data > 0.0 ? std::sqrt(misfit.error / misfit.data) : 0.0;
  }
  return result;
}

std::map<Channel, double> noise_floors(const Case& all, const std::vector<CarriedNoise>& noises) {
  std::map<Channel, double> result;
  for (const Channel channel : all.evidence.front().channels) {
    const auto c = index(channel);
    double noise = 0.0, data = 0.0;
    for (const std::size_t r : all.judged) {
      const Evidence& e = all.evidence[r];
      const Window judge = e.known(channel, e.judge);
      for (std::size_t k = judge.from; k < judge.to; ++k) data += std::pow(e.recording[channel][k], 2);
      double variance = e.noise[c] * e.noise[c] + noises[r].variance[c];
      // z_r alone does not tell of faster motion than this.
      if (channel == Channel::zdd_r) {
        variance += variance_above(acceleration_edge * e.acceleration_known, e.recording[channel], judge, e.noise[c],
                                   e.drive.period);
      }
      noise += variance * static_cast<double>(judge.size());
    }
    result[channel] = data > 0.0 ? std::sqrt(noise / data) : 0.0;
  }
  return result;
}

/// 95 % of a fitted coordinate, widened by what the model leaves unexplained. Standard deviations: 1.96 for noise that
/// is known; what carries it through the rig is itself known to some per cent only, which over the recordings of
/// tests/confusion takes 1.2 times as much.
Interval interval(const Unknown& unknown, double u, double variance, double temper) {
  constexpr double deviations = 1.2 * 1.96;
  const double half = deviations * std::sqrt(std::max(variance, 0.0) * temper);
  const double low = std::max(u - half, unknown.lower), high = std::min(u + half, unknown.upper);
  return {unknown.value(u), unknown.value(low), unknown.value(high)};
}

std::string subsystem_of(const PlacedEffect& effect) {
  std::string place(model::name(effect.entry->place));
  if (effect.channel) place += " " + std::string(model::name(*effect.channel));
  return place;
}

/// Where a channel's disagreement sits when nothing is named for it.
std::string subsystem_of(Channel channel, model::RigKind kind) {
  if (kind == model::RigKind::component_bench) return channel == Channel::x_act ? "machine" : "suspension";
  switch (channel) {
    case Channel::F_w:
    case Channel::dz_w:
      return "tyre";
    case Channel::zdd_w:
    case Channel::z_w:
      return "wheel";
    default:
      return "suspension";
  }
}

std::vector<Place> places(const std::vector<BandPower>& left, const Findings& findings, const std::string& likely) {
  std::vector<Place> result;
  const auto excesses = channel_excesses(left);
  double total = 0.0;
  for (const ChannelExcess& e : excesses) total += e.excess;
  for (const ChannelExcess& e : excesses) {
    if (!(e.significance > significant) || !(e.excess > 0.005 * total)) continue;
    std::string subsystem = subsystem_of(e.channel, findings.best.fit.hypothesis.rig.kind);
    const PlacedEffect* named = nullptr;
    for (const PlacedEffect& effect : findings.best.effects) {
      if (effect.channel == e.channel) named = &effect;
      if (!effect.channel && named == nullptr) named = &effect;
    }
    if (named != nullptr) {
      subsystem = subsystem_of(*named);
    } else if (!likely.empty()) {
      subsystem = likely;
    }
    result.push_back({e.channel, e.lowest, e.highest, std::move(subsystem), e.excess / total});
  }
  std::sort(result.begin(), result.end(), [](const Place& a, const Place& b) { return a.share > b.share; });
  return result;
}

std::vector<Overlay> overlays_of(const Case& all, const Hypothesis& given, const Hypothesis& refit,
                                 const Hypothesis& after) {
  const std::size_t r = all.judged.empty() ? all.fitted.front() : all.judged.front();
  const Evidence& e = all.evidence[r];
  const Window window = e.judge.size() > 0 ? e.judge : e.fit;
  const auto respond_with = [&](const Hypothesis& h) { return read_channels(h, e, e.drive, h.starts[r], window.to); };
  const Response before_response = respond_with(given), refit_response = respond_with(refit),
                 after_response = respond_with(after);
  const double rate = 1.0 / e.drive.period;
  const auto segment = static_cast<std::size_t>(2.0 * rate), shown = static_cast<std::size_t>(1.5 * rate);
  std::vector<Overlay> overlays;
  for (const Channel channel : e.channels) {
    const auto c = index(channel);
    const auto& data = e.recording[channel];
    Overlay overlay;
    overlay.channel = channel;
    const auto cut = [&](const std::vector<double>& values) {
      return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(window.from),
                                 values.begin() + static_cast<std::ptrdiff_t>(window.to));
    };
    const auto density = [&](std::vector<double> values) {
      const PowerSpectrum spectrum = welch(values, rate, segment);
      overlay.frequency = spectrum.frequency;
      return spectrum.density;
    };
    const auto error = [&](const Response& response) {
      std::vector<double> values = cut(data);
      for (std::size_t k = 0; k < values.size(); ++k) values[k] -= response[c][window.from + k];
      return density(std::move(values));
    };
    overlay.data = density(cut(data));
    overlay.error_before = error(before_response);
    overlay.error_refit = error(refit_response);
    overlay.error_after = error(after_response);
    std::size_t count = 0;
    while (count < overlay.frequency.size() && overlay.frequency[count] <= Whitening::highest) ++count;
    for (auto* values :
         {&overlay.frequency, &overlay.data, &overlay.error_before, &overlay.error_refit, &overlay.error_after}) {
      values->resize(count);
      if (!values->empty()) values->erase(values->begin());  // no place for 0 Hz on a logarithmic axis
    }
    overlay.noise = 2.0 * e.noise[c] * e.noise[c] / rate;
    const std::size_t from = window.from + (window.size() - std::min(shown, window.size())) / 2;
    for (std::size_t k = from; k < std::min(from + shown, window.to); ++k) {
      overlay.time.push_back(e.recording.time[k]);
      overlay.measured.push_back(data[k]);
      overlay.refit.push_back(refit_response[c][k]);
      overlay.after.push_back(after_response[c][k]);
    }
    overlays.push_back(std::move(overlay));
  }
  return overlays;
}

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
  Findings findings = search(all, given, tolerated, starts, price, rewhiten, shorten, tell);
  const auto count = static_cast<double>(findings.best.fit.residual.size());
  if (rest_of(all, findings.best.fit.hypothesis).significant &&
      explained_share(findings.nothing.fit.chi_squared / count, findings.best.fit.chi_squared / count, count) <
          all_but_noise) {
    all.model_error = pooled_error(all, findings.best.fit.hypothesis);
    whiten(all, noises);
    constexpr double enough = 24.0;  // [s]: errors of the model differ from one second to the next, unlike noise
    const double share = telling_share(all, enough / static_cast<double>(all.fitted.size()));
    const auto look = [&](const Price& smaller) {
      Case part = shorten(share);
      // What steps get wrong is small beside the error allowed for.
      for (Evidence& e : part.evidence) e.fine = (e.fine + 1) / 2;
      const auto rewhiten_part = [&](const Hypothesis& hypothesis) {
        const bool depends = rewhiten(hypothesis);
        if (depends) whiten(part, noises);
        return depends;
      };
      Findings some = search(part, given, tolerated, starts, smaller, rewhiten_part, {}, tell);
      settle_on(all, tolerated, starts, smaller, some);
      return some;
    };
    findings = second_look(all, std::move(findings), all.model_error, look, result.remarks);
    all.model_error = 0.0;
    whiten(all, noises);
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

  const Eigen::MatrixXd covariance = fit.covariance();
  std::size_t at = tolerated.size() + starts.size();
  for (std::size_t i = 0; i < tolerated.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    result.parameters[tolerated[i].path] =
        interval(fit.unknowns[i], fit.unknowns[i].get(fit.hypothesis), covariance(k, k), temper);
  }
  const VirtualCar car_of_program = virtual_car(description, all.evidence);
  for (const auto& [path, car] : car_of_program.parameters) {
    result.parameters[path] = {car.value, car.value - 1.96 * car.error, car.value + 1.96 * car.error};
  }
  // A rest in two bands of one channel: what must be left over to be seen.
  const double per_band = 2.0 * count / static_cast<double>(noise_bands * all.evidence.front().channels.size());
  const double seen = std::max(significant * std::sqrt(2.0 * per_band), loud_share * per_band);
  bool close = false;
  for (std::size_t i = 0; i < findings.best.effects.size(); ++i) {
    NamedEffect named{findings.best.effects[i], {}, 0.0, {}};
    const std::size_t unknown = effect_unknowns(named.effect).size();
    for (std::size_t p = 0; p < unknown; ++p, ++at) {
      const auto k = static_cast<Eigen::Index>(at);
      named.parameters.push_back(
          interval(fit.unknowns[at], fit.unknowns[at].get(fit.hypothesis), covariance(k, k), temper));
    }
    if (unknown == 0 && !named.effect.values.empty()) {
      const HoldPeriod period = hold_period(all.evidence, *named.effect.channel).value();
      named.parameters.push_back({period.value, period.value - period.half_width, period.value + period.half_width});
    }
    double against = 0.0;
    for (const Rival& rival : findings.rivals[i]) {
      const double apart = rival.cost - findings.best.cost(price);
      const double odds = std::exp(std::min(apart / (2.0 * temper), 300.0));
      against += 1.0 / odds;
      if (named.alternatives.size() == 5) continue;
      Alternative alternative{rival.effect, odds, {}};
      if (odds < too_close) {
        close = true;
        alternative.separate_by = best_experiment(all, fit.hypothesis, rival.hypothesis);
      }
      named.alternatives.push_back(std::move(alternative));
    }
    // A hold is seen in the values themselves.
    const bool certain = is_hold(*named.effect.entry);
    const double known_law = certain ? 1.0 : 1.0 - outside_chance(findings.gains[i] / temper, seen);
    named.confidence = 0.999 / (1.0 + against) * worth * known_law;
    result.effects.push_back(std::move(named));
  }
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
  if (!all.judged.empty()) {
    const auto before = errors(all, given), refit = errors(all, findings.nothing.fit.hypothesis),
               after = errors(all, fit.hypothesis), floors = noise_floors(all, noises);
    for (const auto& [channel, error] : before) {
      result.gap[channel] = {error, refit.at(channel), after.at(channel), floors.at(channel)};
    }
  }
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
