#include "host_sim/diagnose/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/diagnose/carried_noise.hpp"
#include "host_sim/diagnose/intake.hpp"
#include "host_sim/diagnose/rest.hpp"
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
  std::vector<CarriedNoise> noises;
  for (std::size_t r = 0; r < evidence.size(); ++r) {
    const Evidence& e = evidence[r];
    noises.push_back(carried_noise(e, hypothesis, hypothesis.starts[r], e.fit.size() > 0 ? e.fit : e.judge));
  }
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
      all.fit.emplace_back(e, e.fit, noises[r].spectrum);
      all.fitted.push_back(r);
    }
    if (e.judge.size() > 0) {
      all.judge.emplace_back(e, e.judge, noises[r].spectrum);
      all.judged.push_back(r);
    }
  }
}

/// rms of the error over the held-out windows, by channel, relative to the rms of the channel.
std::map<Channel, double> errors(const Case& all, const Hypothesis& hypothesis) {
  const auto responses = respond(all, hypothesis);
  std::map<Channel, double> result;
  for (const Channel channel : all.evidence.front().channels) {
    double error = 0.0, data = 0.0;
    for (const std::size_t r : all.judged) {
      const Evidence& e = all.evidence[r];
      const auto c = index(channel);
      for (std::size_t k = e.judge.from; k < e.judge.to; ++k) {
        if (!e.clipped[c].empty() && e.clipped[c][k]) continue;
        const double measured = e.recording[channel][k];
        error += std::pow(responses[r][c][k] - measured, 2);
        data += measured * measured;
      }
    }
    result[channel] = data > 0.0 ? std::sqrt(error / data) : 0.0;
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
      for (std::size_t k = e.judge.from; k < e.judge.to; ++k) data += std::pow(e.recording[channel][k], 2);
      noise += (e.noise[c] * e.noise[c] + noises[r].variance[c]) * static_cast<double>(e.judge.size());
    }
    result[channel] = data > 0.0 ? std::sqrt(noise / data) : 0.0;
  }
  return result;
}

/// 95 % of a fitted coordinate, widened by what the model leaves unexplained.
Interval interval(const Unknown& unknown, double u, double variance, double temper) {
  const double half = 1.96 * std::sqrt(std::max(variance, 0.0) * temper);
  const double low = std::max(u - half, unknown.lower), high = std::min(u + half, unknown.upper);
  return {unknown.value(u), unknown.value(low), unknown.value(high)};
}

/// An experiment that can be computed.
struct Experiment {
  std::string words;
  double level = 1.0;
  std::optional<int> open_ducts;
};

/// By how many whitened units two hypotheses differ in an experiment.
double separation(const Case& all, const Hypothesis& one, const Hypothesis& other, const Experiment& experiment) {
  double sum = 0.0;
  for (std::size_t i = 0; i < all.fitted.size(); ++i) {
    const Evidence& e = all.evidence[all.fitted[i]];
    Drive drive = e.drive;
    for (auto& m : drive.motion) {
      m.position *= experiment.level;
      m.velocity *= experiment.level;
      m.acceleration *= experiment.level;
    }
    std::array<Response, 2> responses;
    const std::array<const Hypothesis*, 2> hypotheses{&one, &other};
    for (std::size_t h = 0; h < 2; ++h) {
      auto rig = hypotheses[h]->rig;
      if (experiment.open_ducts) {
        rig.fdva.open_ducts = *experiment.open_ducts;
        drive.ducts.clear();
      }
      responses[h] = host_sim::respond(rig, drive, resting(rig, drive), e.fit.to);
    }
    for (const Channel channel : e.channels) {
      const auto c = index(channel);
      double squares = 0.0;
      for (std::size_t k = e.fit.from; k < e.fit.to; ++k)
        squares += std::pow(responses[0][c][k] - responses[1][c][k], 2);
      sum += squares / std::max(e.noise[c] * e.noise[c], 1e-30);
    }
  }
  return sum;
}

std::string best_experiment(const Case& all, const Hypothesis& one, const Hypothesis& other) {
  std::vector<Experiment> experiments{{"three times the level of excitation", 3.0, {}},
                                      {"a third of the level of excitation", 1.0 / 3.0, {}}};
  if (one.rig.has_fdva) {
    for (int open = 0; open <= one.rig.fdva.ducts; ++open) {
      if (open == one.rig.fdva.open_ducts) continue;
      experiments.push_back({std::to_string(open) + (open == 1 ? " duct open" : " ducts open"), 1.0, open});
    }
  }
  const double now = separation(all, one, other, {});
  std::string best = "a sensor at another place, or a longer recording";
  double most = 2.0 * now;
  for (const Experiment& experiment : experiments) {
    const double apart = separation(all, one, other, experiment);
    if (!(apart > most)) continue;
    most = apart;
    char factor[64];
    std::snprintf(factor, sizeof factor, " (separates %.2g times as well)", apart / std::max(now, 1.0));
    best = experiment.words + factor;
  }
  return best;
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

std::vector<Place> places(const Case& all, const Findings& findings, const std::string& likely) {
  std::vector<Place> result;
  const auto excesses = channel_excesses(all, findings.nothing.fit.hypothesis);
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
  const auto respond_with = [&](const Hypothesis& h) {
    return host_sim::respond(h.rig, e.drive, h.starts[r], window.to);
  };
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

/// What a reader of the verdict must know beside it.
std::vector<std::string> remarks_of(const Case& all, const RigDescription& description) {
  std::vector<std::string> remarks;
  for (const Evidence& e : all.evidence) {
    for (const Channel channel : e.channels) {
      const auto c = index(channel);
      if (!e.clipped[c].empty()) {
        const auto count = std::count(e.clipped[c].begin(), e.clipped[c].end(), true);
        remarks.push_back(e.recording.source + ": " + std::to_string(count) + " clipped samples of " +
                          std::string(model::name(channel)) + " are left out");
      }
      if (!description.noise[c]) {
        char text[160];
        std::snprintf(text, sizeof text, "%s: noise of %s not given, estimated as %.3g %s rms",
                      e.recording.source.c_str(), std::string(model::name(channel)).c_str(), e.noise[c],
                      std::string(model::unit(channel)).c_str());
        remarks.emplace_back(text);
      }
    }
    if (e.disagreement > 0.0 && e.input_noise.acceleration == 0.0) {
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
  std::vector<Recording*> recordings;
  for (Record& record : records) recordings.push_back(&record.recording);
  const std::vector<std::string> taken_in = take_in(description, recordings);
  Case all;
  for (Record& record : records) {
    all.evidence.push_back(evidence_of(description, std::move(record.recording), record.use));
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
  if (tell) tell(0.02, "refit of tolerated parameters");

  const Price price;
  Findings findings = search(all, given, tolerated, starts, price, tell);
  // What noise of the input makes of the channels depends on the effects; a second look with what was found.
  if (!findings.best.effects.empty() && !noises.front().spectrum.empty()) {
    if (tell) tell(0.9, "noise of the input, with what was found");
    noises = carried_noises(all.evidence, findings.best.fit.hypothesis);
    whiten(all, noises);
    findings = polish(all, findings, tolerated, starts, price);
  }
  result.simulations = findings.simulations;

  const Fit& fit = findings.best.fit;
  const auto count = static_cast<double>(fit.residual.size());
  result.chi_squared_before = residuals(all, given).squaredNorm() / count;
  result.chi_squared_refit = findings.nothing.fit.chi_squared / count;
  result.chi_squared_after = fit.chi_squared / count;

  const Rest rest = rest_of(all, fit.hypothesis);
  result.unexplained = rest.significant;
  result.rest = rest.words;
  if (findings.best.effects.empty()) {
    // What drives the simulation, or is a number of the program, shows in the redundancy alone.
    for (const Residue& r : result.relations) {
      if (!r.loud()) continue;
      result.unexplained = true;
      result.rest +=
          (result.rest.empty() ? "" : "; ") + r.relation + " does not hold" + (r.looks.empty() ? "" : ", " + r.looks);
    }
  }
  const double left_at_first = std::max(findings.nothing.fit.chi_squared - count, 1.0);
  const double explained = 1.0 - std::max(fit.chi_squared - count, 0.0) / left_at_first;
  const double temper = std::max(1.0, fit.chi_squared / count);

  const Eigen::MatrixXd covariance = fit.covariance();
  std::size_t at = tolerated.size() + starts.size();
  for (std::size_t i = 0; i < tolerated.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    result.parameters[tolerated[i].path] =
        interval(fit.unknowns[i], fit.unknowns[i].get(fit.hypothesis), covariance(k, k), temper);
  }
  for (const auto& [path, car] : virtual_car(description, all.evidence)) {
    result.parameters[path] = {car.value, car.value - 1.96 * car.error, car.value + 1.96 * car.error};
  }
  bool close = false;
  for (std::size_t i = 0; i < findings.best.effects.size(); ++i) {
    NamedEffect named{findings.best.effects[i], {}, 0.0, {}};
    for (std::size_t p = 0; p < named.effect.values.size(); ++p, ++at) {
      const auto k = static_cast<Eigen::Index>(at);
      named.parameters.push_back(
          interval(fit.unknowns[at], fit.unknowns[at].get(fit.hypothesis), covariance(k, k), temper));
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
    named.confidence = 0.999 / (1.0 + against);
    // Where a rest is left, a name is worth what it explains.
    if (result.unexplained) named.confidence *= std::clamp((explained - 0.97) / 0.03, 0.0, 1.0);
    result.effects.push_back(std::move(named));
  }
  if (findings.best.effects.empty()) {
    result.verdict = result.unexplained ? Verdict::unexplained : Verdict::no_discrepancy;
  } else if (result.unexplained && explained < 0.97) {
    result.verdict = Verdict::unexplained;
  } else {
    result.verdict = close ? Verdict::ambiguous : Verdict::named;
  }

  result.where = places(all, findings, likely_place(result.relations));
  if (!all.judged.empty()) {
    const auto before = errors(all, given), refit = errors(all, findings.nothing.fit.hypothesis),
               after = errors(all, fit.hypothesis), floors = noise_floors(all, noises);
    for (const auto& [channel, error] : before) {
      result.gap[channel] = {error, refit.at(channel), after.at(channel), floors.at(channel)};
    }
  }
  result.overlays = overlays_of(all, given, findings.nothing.fit.hypothesis, fit.hypothesis);
  result.remarks = remarks_of(all, description);
  result.remarks.insert(result.remarks.begin(), taken_in.begin(), taken_in.end());
  result.rig = description;
  for (const auto& [path, value] : result.parameters) {
    if (double* const parameter = find_parameter(result.rig.rig, path)) *parameter = value.value;
  }
  for (const PlacedEffect& effect : findings.best.effects) put_effect(result.rig.rig, effect);
  return result;
}

}  // namespace host_sim::diagnose
