#include "host_sim/plan/rehearsal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/prepare/prepare.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/plan/thresholds.hpp"

namespace host_sim::plan {

using identification::Fit;
using identification::FreeParameter;
using identification::Hypothesis;
using model::Channel;

namespace {

double rms_of(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// Eight sums beside each other: one sum waits for each of its additions.
double inner(const Eigen::VectorXf& a, const Eigen::VectorXf& b) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> sums{};
  const float *const x = a.data(), *const y = b.data();
  const auto n = static_cast<std::size_t>(a.size());
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) sums[k] += static_cast<double>(x[i + k]) * static_cast<double>(y[i + k]);
  }
  for (; i < n; ++i) sums[0] += static_cast<double>(x[i]) * static_cast<double>(y[i]);
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

/// A road that begins in motion fades in over a second: the described rig starts from rest, and so do its sensors.
firmware::FootPointMotion from_rest(const firmware::FootPointMotion& motion, double rate) {
  if (motion.empty() || std::abs(motion.front().velocity) < 1e-9) return motion;
  std::vector<double> positions;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const double t = std::min(1.0, static_cast<double>(k) / rate);
    const double share = t * t * t * (10.0 - t * (15.0 - 6.0 * t));
    positions.push_back(motion.front().position + share * (motion[k].position - motion.front().position));
  }
  return firmware::through_samples(positions, rate);
}

/// The recording of a run, without the noise of its sensors or with it.
firmware::Recording run(const firmware::RigDescription& description, const Setting& setting,
                        firmware::SimulatedRig::Noise noise) {
  RunOptions options;
  options.seed = setting.seed;
  options.noise = noise;
  Run made = run_closed_loop(description, from_rest(setting.motion, description.sample_rate), options);
  if (firmware::is_fault(made.trip.reason)) {
    throw firmware::InputError(description.source, 0,
                               "the firmware stops this run: " + std::string(firmware::name(made.trip.reason)),
                               "an excitation that the rig can follow");
  }
  made.recording.source = description.source;
  return std::move(made.recording);
}

void take_steps(std::vector<identification::PreparedRecording>& recordings, double step) {
  for (identification::PreparedRecording& r : recordings) {
    r.substeps = std::max(1, static_cast<int>(std::lround(r.input.period / step)));
  }
}

/// A channel that the run does not record, as the described rig moves.
std::vector<double> added_channel(const firmware::RigDescription& description, const firmware::Recording& recording,
                                  Channel channel) {
  const auto rig = identification::explained_part(description.rig);
  const SimulationInput input = simulation_input(rig, recording);
  return simulate(rig, input, resting(rig, input))[index(channel)];
}

/// True if a channel comes from a sensor whose readings are compared. The virtual car of a hil rig is computed, not
/// measured.
bool is_compared(const model::RigParameters<double>& rig, const firmware::Recording& recording, Channel channel) {
  if (rig.kind == model::RigKind::driven_mass) return channel == Channel::x_act || channel == Channel::zdd_b;
  if (rig.kind != model::RigKind::quarter_car) return channel == Channel::x_act || channel == Channel::F;
  const bool foot_point = channel == Channel::z_r || channel == Channel::zdd_r;
  if (foot_point) return recording.has(Channel::z_cmd);
  return channel != Channel::z_cmd && channel != Channel::F_act;
}

/// The description with noise for every channel that is compared; remarks on what was assumed.
void declare_noise(firmware::RigDescription& description, const firmware::Recording& silent,
                   std::vector<std::string>& remarks) {
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const Channel channel = model::channel_at(c);
    if (silent.channels[c].empty() || !is_compared(description.rig, silent, channel)) continue;
    if (description.noise[c] && *description.noise[c] > 0.0) continue;
    const double rms = rms_of(silent.channels[c]);
    if (!(rms > 0.0)) continue;
    description.noise[c] = identification::thresholds::new_sensor_noise * rms;
    remarks.push_back("noise of " + std::string(model::name(channel)) + " is not declared: 1 % of its rms is assumed");
  }
}

}  // namespace

Rehearsal::Rehearsal(const firmware::RigDescription& description, const Setting& setting)
    : description_(description), setting_(setting) {
  firmware::RigDescription& noisy = description_;
  firmware::Recording silent = run(noisy, setting, firmware::SimulatedRig::Noise::none);
  if (setting.added && !silent.has(*setting.added)) {
    silent[*setting.added] = added_channel(description, silent, *setting.added);
  }
  declare_noise(noisy, silent, remarks_);
  firmware::Recording recording = run(noisy, setting, firmware::SimulatedRig::Noise::as_described);
  if (setting.added) recording[*setting.added] = silent[*setting.added];
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (!recording.channels[c].empty()) recorded_.push_back(model::channel_at(c));
  }
  for (const Channel channel : setting.without) recording[channel].clear();
  std::vector<identification::Record> records;
  records.push_back({std::move(recording), identification::Use::shared});
  identification::PreparedData data = identification::prepare(noisy, std::move(records));
  take_steps(data.recordings, thresholds::step_with_corners);
  for (identification::PreparedRecording& r : data.recordings) {  // as declared: one run's luck is no plan
    for (const Channel channel : r.channels) r.noise[index(channel)] = noisy.noise[index(channel)].value_or(0.0);
  }
  Hypothesis given = identification::described_hypothesis(noisy, data.recordings);
  problem_.emplace(std::move(data.recordings), given);
  space_ = identification::search_space(noisy, problem_->samples(), given);
  scales_ = identification::scales_of(problem_->samples(), given, read_all(*problem_, given));
  base_.hypothesis = std::move(given);
  base_ = described_with(space_.common);
  Eigen::MatrixXd h = base_.jacobian.transpose() * base_.jacobian;
  for (Eigen::Index i = 0; i < h.rows(); ++i) {
    const FreeParameter& parameter = base_.parameters[static_cast<std::size_t>(i)];
    const double width = parameter.upper - parameter.lower;
    h(i, i) += 1e-12 * h(i, i) + 1e-30;
    if (parameter.role == FreeParameter::Role::tolerated) h(i, i) += 12.0 / (width * width);
  }
  tolerances_.compute(h);
}

/// J by central differences: the error of one-sided ones would determine what nothing determines.
Fit Rehearsal::described_with(const std::vector<FreeParameter>& parameters) const {
  Fit fit;
  fit.hypothesis = base_.hypothesis;
  fit.parameters = parameters;
  fit.prediction = identification::predict(*problem_, fit.hypothesis);
  fit.residual = identification::residuals(*problem_, fit.prediction);
  identification::refresh_jacobian(*problem_, fit);
  const Eigen::MatrixXd forward = fit.jacobian;
  for (FreeParameter& parameter : fit.parameters) parameter.difference = -parameter.difference;
  identification::refresh_jacobian(*problem_, fit);
  fit.jacobian = 0.5 * (forward + fit.jacobian);
  fit.parameters = parameters;
  return fit;
}

std::optional<Eigen::VectorXf> Rehearsal::residuals_with(const firmware::PlacedEffect& effect) const {
  Hypothesis other = base_.hypothesis;
  put_effect(other.rig, effect);
  if (firmware::find_rig_fault(other.rig, problem_->sample_period())) return std::nullopt;
  const Eigen::VectorXd residual = identification::residuals(
      *problem_,
      effect.channel ? predict_sensor(*problem_, other, base_.prediction, *effect.channel) : predict(*problem_, other));
  if (!residual.allFinite()) return std::nullopt;
  return residual.cast<float>();
}

std::optional<Change> Rehearsal::change(const firmware::PlacedEffect& effect, const Eigen::VectorXf* absent) const {
  std::optional<Eigen::VectorXf> residual = residuals_with(effect);
  if (!residual) return std::nullopt;
  if (absent != nullptr) {
    *residual -= *absent;
  } else {
    *residual -= base_.residual.cast<float>();
  }
  Change change{std::move(*residual), {}};
  change.tolerated = base_.jacobian.transpose() * change.whitened.cast<double>();
  return change;
}

bool Rehearsal::leaves_a_rest(const firmware::PlacedEffect& hidden) const {
  Setting setting = setting_;
  setting.motion.resize(std::min(setting.motion.size(),
                                 static_cast<std::size_t>(thresholds::rehearsed_diagnosis * description_.sample_rate)));
  firmware::RigDescription with = description_;
  put_effect(with.rig, hidden);
  for (int noise = 0; noise < thresholds::rehearsed_noises; ++noise) {
    ++setting.seed;
    std::vector<identification::Record> records;
    try {
      records.push_back({run(with, setting, firmware::SimulatedRig::Noise::as_described), identification::Use::shared});
      for (const Channel channel : setting.without) records.front().recording[channel].clear();
      identification::PreparedData data = identification::prepare(description_, std::move(records));
      take_steps(data.recordings, thresholds::step_of_diagnosis);
      const Hypothesis given = identification::described_hypothesis(description_, data.recordings);
      identification::IdentificationProblem problem(std::move(data.recordings), given);
      const identification::SearchSpace space = identification::search_space(description_, problem.samples(), given);
      if (!identification::leaves_a_rest(problem, identification::search(problem, space, {}))) return false;
    } catch (const firmware::InputError&) {  // the rig cannot be driven with it
      return false;
    }
  }
  return true;
}

Change Rehearsal::as_change(const Eigen::VectorXd& whitened) const {
  return {whitened.cast<float>(), base_.jacobian.transpose() * whitened};
}

Eigen::MatrixXd Rehearsal::jacobian(const std::vector<FreeParameter>& parameters) const {
  return described_with(parameters).jacobian;
}

double Rehearsal::product(const Change& a, const Change& b) const {
  const double whole = inner(a.whitened, b.whitened);
  return a.tolerated.size() == 0 ? whole : whole - a.tolerated.dot(tolerances_.solve(b.tolerated));
}

double Rehearsal::significance(const Change& d) const { return std::sqrt(std::max(0.0, product(d, d))); }

std::optional<Stretch> stretch_of(const firmware::RigDescription& description, const Setting& setting) {
  const double rate = description.sample_rate;
  const auto samples = [rate](double seconds) { return static_cast<std::size_t>(std::lround(seconds * rate)); };
  const std::size_t whole = setting.motion.size(), length = samples(thresholds::stretch);
  if (!setting.stationary || whole < length + length / 2) return std::nullopt;
  const firmware::Recording made = run(description, setting, firmware::SimulatedRig::Noise::none);
  const std::size_t fitted = length - length / 4, faded = samples(1.0);  // three quarters are fitted
  std::vector<const std::vector<double>*> compared;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const bool is_used = is_compared(description.rig, made, model::channel_at(c)) && rms_of(made.channels[c]) > 0.0;
    if (is_used) compared.push_back(&made.channels[c]);
  }
  if (compared.empty()) return std::nullopt;
  const auto peak = [](const std::vector<double>& y, std::size_t from, std::size_t to) {
    double highest = 0.0;
    for (std::size_t k = from; k < std::min(to, y.size()); ++k) highest = std::max(highest, std::abs(y[k]));
    return highest;
  };
  std::size_t best = 0;
  double nearest = -1.0;
  for (std::size_t from = 0; from + length <= whole; from += faded) {
    double sum = 0.0;
    for (const auto* y : compared) {
      sum += std::min(1.0, peak(*y, from + faded, from + fitted) / peak(*y, 0, whole - whole / 4));
    }
    if (sum <= nearest) continue;
    nearest = sum;
    best = from;
  }
  double ratio = 0.0;
  for (const auto* y : compared) {
    const auto energy = [y](std::size_t from, std::size_t to) {
      double squares = 0.0;
      for (std::size_t k = from; k < std::min(to, y->size()); ++k) squares += (*y)[k] * (*y)[k];
      return squares;
    };
    ratio += energy(0, whole) / energy(best, best + length) / static_cast<double>(compared.size());
  }
  Stretch stretch{setting, static_cast<double>(best) / rate};
  const auto begin = setting.motion.begin() + static_cast<std::ptrdiff_t>(best);
  stretch.setting.motion.assign(begin, begin + static_cast<std::ptrdiff_t>(length));
  stretch.growth = std::sqrt(std::min(static_cast<double>(whole) / static_cast<double>(length), ratio));
  return stretch;
}

std::vector<std::unique_ptr<const Rehearsal>> within_tolerances(const firmware::RigDescription& description,
                                                                const Setting& setting) {
  const std::vector<FreeParameter> tolerated = identification::tolerated_parameters(description);
  std::vector<std::unique_ptr<const Rehearsal>> rigs;
  if (tolerated.empty()) return rigs;
  std::mt19937 random(static_cast<std::uint32_t>(setting.seed));
  for (int i = 0; i < thresholds::rigs_within_tolerances; ++i) {
    Hypothesis moved;
    moved.rig = description.rig;
    for (const FreeParameter& parameter : tolerated) {
      parameter.put(moved, random() % 2 == 0 ? parameter.lower : parameter.upper);
    }
    firmware::RigDescription other = description;
    other.rig = moved.rig;
    try {
      rigs.push_back(std::make_unique<const Rehearsal>(other, setting));
    } catch (const firmware::InputError&) {  // it is stopped, or grows without bound
    }
  }
  return rigs;
}

std::vector<Channel> unrecorded_channels(const Rehearsal& rehearsal) {
  const auto& recorded = rehearsal.recorded();
  std::vector<Channel> channels;
  for (const Channel channel :
       response_channels(rehearsal.given().rig.kind, rehearsal.problem().samples().front().input)) {
    if (std::find(recorded.begin(), recorded.end(), channel) == recorded.end()) channels.push_back(channel);
  }
  return channels;
}

}  // namespace host_sim::plan
