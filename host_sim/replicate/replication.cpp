#include "host_sim/replicate/replication.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/description/version.hpp"
#include "host_sim/comparison/refit.hpp"
#include "host_sim/replicate/thresholds.hpp"
#include "host_sim/report/formatted.hpp"
#include "host_sim/signal/bands.hpp"

namespace host_sim::replicate {
namespace {

using model::Channel;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::vector<Channel> channels_of(const Target& target) {
  std::vector<Channel> channels;
  for (const TargetChannel& c : target.channels) channels.push_back(c.channel);
  return channels;
}

/// A quarter car whose machine is not described follows its command as nothing does; so does a bench.
void demand_machine(const firmware::RigDescription& description) {
  model::MachinePath<double> path{};
  description.rig.effects.act_on(path);
  if (path.delay > 0.0 || path.lag > 0.0 || path.resonance_frequency > 0.0) return;
  throw firmware::InputError(
      description.source, 0, "no machine is described between the command and what moves",
      "[effects.actuator_lag], actuator_delay or actuator_resonance: record a sweep with the column " +
          std::string(model::name(drive_channel(driven_part(description).rig.kind))) + " and run rigtwin diagnose");
}

/// Two targets of which one is in g: their shapes fit, their sizes are 9.81 apart.
void check_units(const DriveModel& model, const Target& target, const BandInverse& inverse,
                 const std::vector<firmware::Recording>& recordings) {
  constexpr double apart = 0.5,
                   fits = 0.4;  // of what one drive cannot make, and of that, what is left in the right unit
  if (target.channels.size() < 2) return;
  const auto sum = [](const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); };
  const double before = sum(inverse.unreachable());
  if (!(before > apart)) return;
  for (std::size_t c = 0; c < target.channels.size(); ++c) {
    if (model::unit(target.channels[c].channel) != "m/s²") continue;
    Target other = target;
    for (double& v : other.values[c]) v *= 9.80665;
    const BandInverse right(model, other);
    if (!(sum(right.unreachable()) < fits * before)) continue;
    const std::string name(model::name(target.channels[c].channel));
    throw firmware::InputError(recordings.front().source, 0,
                               name + " looks as if it were in g: beside the other channels it is 9.81 times too small",
                               name + " in m/s², or \"[g]\" in its heading");
  }
}

}  // namespace

std::string_view name(Stop stop) {
  constexpr std::array<std::string_view, 6> names{"", "goal", "noise", "limits", "unreachable", "model"};
  return names[static_cast<std::size_t>(stop)];
}

Replication::Replication(firmware::RigDescription description, const TargetRequest& request,
                         std::vector<firmware::Recording> recordings, double goal)
    : description_(driven_part(description)),
      refined_(description_),
      target_(make_target(description_, request, recordings)),
      recordings_(std::move(recordings)),
      goal_(goal),
      limits_(limits_of(description_)) {
  demand_machine(description_);
  prepare_model();
  check_units(*model_, target_, *inverse_, recordings_);
}

void Replication::prepare_model() {
  model_.emplace(refined_, channels_of(target_));
  inverse_.emplace(*model_, target_);
}

std::vector<double> Replication::in_band(std::size_t channel, const std::vector<double>& signal) const {
  return inverse_->in_band(channel, signal);
}

double Replication::error_of(const RunResult& result) const {
  double sum = 0.0, weights = 0.0;
  for (std::size_t c = 0; c < result.error.size(); ++c) {
    if (!std::isfinite(result.error[c])) continue;
    sum += std::pow(target_.channels[c].weight * result.error[c], 2);
    weights += std::pow(target_.channels[c].weight, 2);
  }
  return weights > 0.0 ? std::sqrt(sum / weights) : unknown;
}

std::size_t Replication::best() const {
  std::size_t best = runs_.size();
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const double error = error_of(results_[r]);
    if (std::isfinite(error) && (best == runs_.size() || error < error_of(results_[best]))) best = r;
  }
  return best;
}

void Replication::solve(const Progress& progress) {
  SolveInput input;
  std::vector<std::string> remarks = std::move(remarks_);
  remarks_.clear();
  if (!runs_.empty()) {
    Correction correction(description_, target_, *inverse_);
    std::vector<std::vector<double>> until_best;
    const std::size_t best_run = best();
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      correction.take(runs_[r], model_->answer(drives_[r].values));
      if (r == best_run) until_best = correction.offset();
    }
    input.offset = correction.offset();
    noise_ = correction.noise();
    const std::size_t newest = runs_.size() - 1;
    const std::size_t from = best_run < runs_.size() ? best_run : newest;
    if (from != newest && error_of(results_[newest]) > thresholds::worse * error_of(results_[from])) {
      for (std::size_t c = 0; c < input.offset.size(); ++c) {
        for (std::size_t k = 0; k < input.offset[c].size(); ++k)
          input.offset[c][k] = 0.5 * (input.offset[c][k] + until_best[c][k]);
      }
      remarks.push_back(
          formatted("run %zu came out worse than run %zu: taken back, with half of the step", newest + 1, from + 1));
    }
    input.start = drives_[from].values;
  }
  const Solution solution =
      replicate::solve(*model_, target_, *inverse_, limits_, input, [&](double share, double error) {
        if (progress) progress(share, formatted("error on the model %.2f %%", 100.0 * error));
      });
  RunResult result;
  result.error.assign(target_.channels.size(), unknown);
  result.predicted = solution.error;
  result.damage.assign(target_.channels.size(), {unknown, unknown, unknown});
  result.used = solution.used;
  result.unlimited = solution.error_unlimited;
  result.remarks = std::move(remarks);
  predicted_ = solution.answer;
  for (std::size_t c = 0; c < input.offset.size(); ++c) {
    for (std::size_t k = 0; k < predicted_[c].size(); ++k) predicted_[c][k] += input.offset[c][k];
  }
  drives_.push_back({solution.drive, "drive_" + std::to_string(drives_.size() + 1) + ".csv", {}});
  results_.push_back(std::move(result));
}

void Replication::judge(const RunRecord& run, RunResult& result) const {
  std::vector<Part> parts;
  for (const Part& part : target_.events) {
    if (std::min(part.to, run.samples) > part.from) parts.push_back({part.from, std::min(part.to, run.samples)});
  }
  result.error.assign(target_.channels.size(), unknown);
  result.damage.assign(target_.channels.size(), {unknown, unknown, unknown});
  for (std::size_t c = 0; c < target_.channels.size(); ++c) {
    if (run.measured[c].empty()) continue;
    std::vector<double> e = target_.values[c];
    for (std::size_t k = 0; k < e.size(); ++k) e[k] = k < run.samples ? e[k] - run.measured[c][k] : 0.0;
    const std::vector<double> wanted = in_band(c, target_.values[c]), reached = in_band(c, run.measured[c]);
    result.error[c] = rms_over(parts, in_band(c, e)) / rms_over(parts, wanted);
    for (std::size_t i = 0; i < damage_exponents.size(); ++i) {
      double of_target = 0.0, of_run = 0.0;
      for (const Part& part : parts) {
        const std::span<const double> t(wanted.data() + part.from, part.to - part.from),
            r(reached.data() + part.from, part.to - part.from);
        of_target += pseudo_damage(rainflow(t), damage_exponents[i]);
        of_run += pseudo_damage(rainflow(r), damage_exponents[i]);
      }
      result.damage[c][i] = of_target > 0.0 ? of_run / of_target : unknown;
    }
  }
  for (const std::string& remark : run.remarks) result.remarks.push_back(remark);
}

void Replication::take(const firmware::Recording& recording) {
  RunRecord run = read_run(description_, target_, drives_, recording);
  judge(run, results_.back());
  runs_.push_back(std::move(run));
  run_recordings_.push_back(recording);
}

void Replication::refine() {
  if (!run_recordings_.empty()) refine_on(run_recordings_.back(), StartChoice::rest);
}

void Replication::refine_on(firmware::Recording part, StartChoice choice) {
  if (refined_.tolerance.empty()) return;
  const auto remark = [this](const std::string& text) {
    (results_.empty() ? remarks_ : results_.back().remarks).push_back(text);
  };
  const auto most = static_cast<std::size_t>(30.0 / target_.period);  // [s]: 17 numbers, then 0.3 % of z̈_w are left
  if (part.size() > most) {
    part.time.resize(most);
    for (auto& column : part.channels) column.resize(std::min(column.size(), most));
    for (auto& column : part.ducts) column.resize(std::min(column.size(), most));
  }
  try {
    std::vector<ComparedRecording> compared;
    compared.emplace_back(description_, part, choice);
    // Within the tolerances of the description, not of what it was refined to.
    firmware::RigDescription described = refined_;
    for (const auto& [path, bound] : described.tolerance) {
      const double* const given = firmware::find_parameter(description_.rig, path);
      double* const now = firmware::find_parameter(described.rig, path);
      if (given != nullptr && now != nullptr) *now = *given;
    }
    const Refit fitted = refit(described, compared);
    if (!(fitted.pooled_after < fitted.pooled_before)) return;
    refined_.rig = fitted.rig;
    prepare_model();
    remark(
        formatted("%zu tolerated parameters were fitted to the run: its error against the model as described falls "
                  "from %.3g to %.3g %%",
                  fitted.parameters.size(), 100.0 * fitted.pooled_before, 100.0 * fitted.pooled_after));
  } catch (const firmware::InputError& error) {
    remark(std::string("the tolerated parameters were not fitted: ") + error.what());
  }
}

void Replication::refine(firmware::RigDescription refined, const std::string& found) {
  refined_.rig = refined.rig;
  refined_.laws = refined.laws;
  prepare_model();
  results_.back().remarks.push_back(found);
}

Floor Replication::floor() const {
  Floor floor;
  for (std::size_t c = 0; c < target_.channels.size(); ++c) {
    const auto declared = description_.noise[index(target_.channels[c].channel)];
    double share = 0.0;  // of the noise's power in the band
    const double rate = 1.0 / target_.period;
    const FrequencyBand& band = target_.channels[c].band;
    share = (band.highest - band.lowest) / (0.5 * rate);
    const double noise = declared ? *declared * std::sqrt(share) / inverse_->target_rms(c) : 0.0;
    const double predicted = results_.empty() ? 0.0 : results_.back().predicted[c];
    floor.noise.push_back(noise);
    floor.predicted.push_back(predicted);
    floor.total.push_back(std::hypot(noise, predicted));
  }
  return floor;
}

Stop Replication::stop() const {
  if (runs_.empty() || runs_.size() != results_.size()) return Stop::none;
  const RunResult& last = results_.back();
  bool reached = true;
  for (const double error : last.error) reached = reached && !(error > goal_);
  if (reached && std::isfinite(error_of(last))) return Stop::goal;
  if (runs_.size() < 2) return Stop::none;
  const double before = error_of(results_[results_.size() - 2]), now = error_of(last);
  if (!(now > (1.0 - thresholds::significant_gain) * before)) return Stop::none;
  const Floor left = floor();
  double noise = 0.0, unreachable = 0.0;
  for (std::size_t c = 0; c < left.noise.size(); ++c) {
    noise = std::max(noise, left.noise[c]);
    unreachable = std::max(unreachable, inverse_->unreachable()[c]);
  }
  if (!last.unlimited.empty()) return Stop::limits;
  if (unreachable > 0.5 * now) return Stop::unreachable;
  if (noise > 0.5 * now) return Stop::noise;
  return runs_.size() < 3 ? Stop::none : Stop::model;
}

WorstBand Replication::worst_band() const {
  WorstBand worst;
  double largest = -1.0;
  if (runs_.empty()) return worst;
  for (std::size_t c = 0; c < target_.channels.size(); ++c) {
    const auto& measured = runs_.back().measured[c];
    if (measured.empty()) continue;
    std::vector<double> e = target_.values[c];
    for (std::size_t k = 0; k < e.size(); ++k) e[k] = k < runs_.back().samples ? e[k] - measured[k] : 0.0;
    e = in_band(c, e);
    const double rate = 1.0 / target_.period;
    const auto bands = resolved_bands(e.size(), rate);
    const BandRms rms = band_rms(e, rate, bands);
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const double relative = rms.rms[b] / inverse_->target_rms(c);
      if (relative > largest) {
        largest = relative;
        worst = {target_.channels[c].channel, {bands[b].lower, bands[b].upper}};
      }
    }
  }
  return worst;
}

void Replication::restore(std::vector<Drive> drives, std::vector<RunResult> results,
                          std::vector<firmware::Recording> runs, std::optional<firmware::RigDescription> refined) {
  if (refined) {
    refined_ = std::move(*refined);
    prepare_model();
  }
  drives_.clear();
  for (std::size_t r = 0; r < drives.size(); ++r) {
    drives_.push_back(std::move(drives[r]));
    if (r < runs.size()) {
      runs_.push_back(read_run(description_, target_, drives_, runs[r]));
      run_recordings_.push_back(std::move(runs[r]));
    }
  }
  results_ = std::move(results);
  for (std::size_t r = 0; r < results_.size(); ++r) {
    if (results_[r].predicted.size() != target_.channels.size())
      results_[r].predicted.assign(target_.channels.size(), unknown);
    if (r >= runs_.size()) {
      results_[r].error.assign(target_.channels.size(), unknown);
      results_[r].damage.assign(target_.channels.size(), {unknown, unknown, unknown});
      continue;
    }
    RunResult judged;
    judge(runs_[r], judged);
    results_[r].error = judged.error;
    results_[r].damage = judged.damage;
  }
  if (!drives_.empty()) predicted_ = model_->answer(drives_.back().values);
}

firmware::Recording drive_recording(const Replication& replication, std::size_t drive) {
  firmware::Recording recording;
  const auto& values = replication.drives()[drive].values;
  recording.sample_period = replication.target().period;
  recording.time = firmware::sample_times(values.size(), replication.description().sample_rate);
  const Channel channel = drive_channel(replication.description().rig.kind);
  recording[channel] = values;
  recording.comments.push_back(
      "drive " + std::to_string(drive + 1) + " of rigtwin replicate; the target begins at t = " +
      firmware::shortest(replication.target().period * static_cast<double>(replication.target().events.front().from)) +
      " s");
  return recording;
}

namespace {

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

nlohmann::ordered_json to_json(const Replication& replication) {
  nlohmann::ordered_json json{{"schema", "rigtwin/replicate/1"}, {"version", firmware::version}};
  const Target& target = replication.target();
  const auto by_channel = [&](const auto& value_of) {
    nlohmann::ordered_json values = nlohmann::ordered_json::object();
    for (std::size_t c = 0; c < target.channels.size(); ++c)
      values[std::string(model::name(target.channels[c].channel))] = value_of(c);
    return values;
  };
  auto& runs = json["runs"] = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < replication.results().size(); ++r) {
    const RunResult& result = replication.results()[r];
    nlohmann::ordered_json run{
        {"run", r + 1}, {"drive", replication.drives()[r].file}, {"sha256", replication.drives()[r].sha256}};
    run["error"] = by_channel([&](std::size_t c) { return number(result.error[c]); });
    run["predicted_error"] = by_channel([&](std::size_t c) { return number(result.predicted[c]); });
    run["unreachable"] = by_channel([&](std::size_t c) { return number(replication.inverse().unreachable()[c]); });
    run["damage_ratio"] = by_channel([&](std::size_t c) {
      nlohmann::ordered_json ratios = nlohmann::ordered_json::object();
      for (std::size_t i = 0; i < damage_exponents.size(); ++i)
        ratios[std::to_string(damage_exponents[i])] = number(result.damage[c][i]);
      return ratios;
    });
    run["limits_used"] = {{"stroke", result.used.stroke},
                          {"speed", result.used.speed},
                          {"acceleration", result.used.acceleration},
                          {"force", result.used.force}};
    if (!result.unlimited.empty())
      run["predicted_error_without_limits"] = by_channel([&](std::size_t c) { return number(result.unlimited[c]); });
    run["measured"] = r < replication.runs().size();
    run["remarks"] = result.remarks;
    runs.push_back(std::move(run));
  }
  const Stop stop = replication.stop();
  json["stopped"] = stop == Stop::none ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(name(stop));
  if (!replication.runs().empty()) {
    const WorstBand worst = replication.worst_band();
    json["largest_error"] = {{"channel", model::name(worst.channel)},
                             {"band_hz", {worst.band.lowest, worst.band.highest}}};
  }
  const Floor floor = replication.floor();
  json["floor"] = by_channel([&](std::size_t c) { return number(floor.total[c]); });
  json["floor_noise"] = by_channel([&](std::size_t c) { return number(floor.noise[c]); });
  auto& settings = json["settings"];
  settings["goal"] = replication.goal();
  settings["rig"] = replication.description().source;
  settings["target_from_s"] = target.period * static_cast<double>(target.events.front().from);
  settings["events"] = target.events.size();
  settings["channels"] = nlohmann::ordered_json::array();
  for (const TargetChannel& c : target.channels) {
    settings["channels"].push_back({{"channel", model::name(c.channel)},
                                    {"weight", c.weight},
                                    {"band_hz", {c.band.lowest, c.band.highest}},
                                    {"remark", c.remark}});
  }
  return json;
}

}  // namespace host_sim::replicate
