#include "host_sim/identification/parity/relation_fit.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/parity/thresholds.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using Series = std::vector<double>;

/// The component alone, on a bench.
model::RigParameters<double> component_of(const model::RigParameters<double>& rig) {
  model::RigParameters<double> bench = rig;
  bench.kind = model::RigKind::component_bench;
  bench.machine.virtual_damping = 0.0;
  bench.lever = {};
  for (const firmware::PlacedEffect& effect : firmware::effects_of(rig)) {
    if (effect.entry->subsystem != model::Subsystem::suspension && effect.entry->subsystem != model::Subsystem::fdva) {
      firmware::remove_effect(bench, *effect.entry, effect.channel);
    }
  }
  return bench;
}

/// A channel of a bench that is moved by x_cmd or, where the machine is left out, by x_act.
Series simulate_bench(const model::RigParameters<double>& bench, const firmware::Recording& recording,
                      const Series& motion, Channel input_channel, Channel channel) {
  firmware::Recording driven;
  driven.sample_period = recording.sample_period;
  driven.time = recording.time;
  driven.ducts = recording.ducts;
  driven[input_channel] = motion;
  driven[Channel::z_b] = recording[Channel::z_b];
  const SimulationInput input = simulation_input(bench, driven);
  return simulate(bench, input, resting(bench, input))[index(channel)];
}

}  // namespace

RelationFit::RelationFit(const firmware::RigDescription& description,
                         const std::vector<firmware::Recording>& recordings, const SmoothWindow& window,
                         const ParityRelation& relation, double highest)
    : description_(description), recordings_(recordings), window_(window), relation_(relation), highest_(highest) {
  full_gauss_newton_steps(*this, thresholds::parity_steps, thresholds::parity_converged);
}

double RelationFit::power(std::size_t line) const {
  Eigen::VectorXcd combination(theta_.size() + 1);
  combination(0) = 1.0;
  for (Eigen::Index i = 0; i < theta_.size(); ++i) combination(i + 1) = theta_(i);
  return (combination.transpose() * spectra_.cross[line] * combination.conjugate()).value().real();
}

std::vector<ResidualSeries> RelationFit::residual() const {
  std::vector<ResidualSeries> fitted = linear_.residual;
  for (std::size_t r = 0; r < fitted.size(); ++r) {
    for (std::size_t i = 0; i < linear_.change.size(); ++i) {
      for (std::size_t k = 0; k < fitted[r].values.size(); ++k) {
        fitted[r].values[k] += theta_(static_cast<Eigen::Index>(i)) * linear_.change[i][r][k];
      }
    }
  }
  return fitted;
}

bool RelationFit::find_jacobian() {
  linear_ = {};
  Rig bench = component_of(description_.rig);
  for (const auto& [path, part] : relation_.tolerated) {
    if (!(tolerance(path) > 0.0)) continue;
    linear_.lower.push_back(-tolerance(path));
    linear_.upper.push_back(tolerance(path));
  }
  std::vector<double> nominal;
  if (relation_.deflection) add_component_parameters(bench, nominal);
  linear_.change.resize(linear_.lower.size());
  for (const firmware::Recording& recording : recordings_) add_recording(recording, bench, nominal);
  const auto changes = static_cast<Eigen::Index>(linear_.change.size());
  if (theta_.size() != changes) theta_ = Eigen::VectorXd::Zero(changes);  // stays so where no step can be solved for
  find_spectra();
  return has_data();
}

/// The component's tolerated parameters, moved to where they are; `nominal`: as described.
void RelationFit::add_component_parameters(Rig& bench, std::vector<double>& nominal) {
  for (const auto& [path, bound] : description_.tolerance) {
    double* const value = firmware::find_parameter(bench, path);
    const bool of_component = path.starts_with("suspension.") || path.starts_with("fdva.");
    if (!of_component || value == nullptr || *value == 0.0 || !(bound > 0.0)) continue;
    const auto it = deviations_.find(path);
    const double deviation = it == deviations_.end() ? 0.0 : it->second;
    linear_.component_paths.push_back(path);
    linear_.lower.push_back(-bound - deviation);
    linear_.upper.push_back(bound - deviation);
    nominal.push_back(*value);
    *value *= 1.0 + deviation;
  }
}

void RelationFit::add_recording(const firmware::Recording& recording, const Rig& bench,
                                const std::vector<double>& nominal) {
  Series residual = samples_of(recording, relation_.sum, &window_), component_noise;
  std::size_t at = 0;
  for (const auto& [path, part] : relation_.tolerated) {
    if (tolerance(path) > 0.0) linear_.change[at++].push_back(samples_of(recording, part, &window_));
  }
  if (relation_.machine) {
    const Series reached = window_(simulate_bench(explained_part(description_.rig), recording,
                                                  recording[Channel::x_cmd], Channel::x_cmd, Channel::x_act),
                                   0);
    for (std::size_t k = 0; k < residual.size(); ++k) residual[k] -= reached[k];
  }
  if (relation_.deflection) add_component(recording, bench, nominal, residual, component_noise);
  linear_.residual.push_back({std::move(residual), trusted_samples(recording)});
  linear_.component_noise.push_back(std::move(component_noise));
}

/// The component's force on the measured deflection, how it changes with each parameter, and with the deflection's
/// noise.
void RelationFit::add_component(const firmware::Recording& recording, const Rig& bench,
                                const std::vector<double>& nominal, Series& residual, Series& component_noise) {
  const Series motion = samples_of(recording, *relation_.deflection, nullptr);
  const auto force_of = [&](const Rig& rig, const Series& deflection) {
    return simulate_bench(rig, recording, deflection, Channel::x_act, Channel::F);
  };
  const Series force = force_of(bench, motion), smooth = window_(force, 0);
  for (std::size_t k = 0; k < residual.size(); ++k) residual[k] -= smooth[k];
  const auto change = [&](const Series& other, double per) {
    Series difference(force.size());
    for (std::size_t k = 0; k < force.size(); ++k) difference[k] = (other[k] - force[k]) / per;
    return window_(difference, 0);
  };
  const std::size_t first = linear_.change.size() - nominal.size();
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    Rig rig = bench;
    *firmware::find_parameter(rig, linear_.component_paths[i]) += thresholds::parity_difference * nominal[i];
    linear_.change[first + i].push_back(change(force_of(rig, motion), -thresholds::parity_difference));
  }
  Series noisy = motion;
  firmware::Gaussian gaussian(1, 17);
  double variance = 0.0;
  for (const Term& t : *relation_.deflection) variance += std::pow(t.factor * noise_of(recording, t.channel), 2);
  for (double& v : noisy) v += std::sqrt(variance) * gaussian();
  component_noise = change(force_of(bench, noisy), 1.0);
}

/// Not the beginning, where the component settles, nor where the window holds a clipped sample.
std::vector<bool> RelationFit::trusted_samples(const firmware::Recording& recording) const {
  const auto margin = static_cast<std::size_t>(window_.reach() + 1);
  const auto settled = static_cast<std::size_t>(thresholds::parity_settling / recording.sample_period);
  const std::size_t from = std::max(margin, settled), n = recording.size();
  std::vector<bool> trusted(n, true);
  for (std::size_t k = 0; k < n; ++k) trusted[k] = k >= from && k + margin < n;
  Signal all = relation_.sum;
  if (relation_.deflection) all.insert(all.end(), relation_.deflection->begin(), relation_.deflection->end());
  for (const Term& t : all) {
    const auto& range = description_.range[index(t.channel)];
    for (std::size_t k = 0; range && k < n; ++k) {
      if (range->holds(recording[t.channel][k])) continue;
      for (std::size_t i = k - std::min(k, margin); i < std::min(k + margin, n); ++i) trusted[i] = false;
    }
  }
  return trusted;
}

void RelationFit::find_spectra() {
  spectra_ = {};
  const double rate = 1.0 / recordings_.front().sample_period;
  const std::size_t length = good_fft_size(static_cast<std::size_t>(thresholds::parity_block * rate));
  const auto size = static_cast<Eigen::Index>(linear_.change.size()) + 1;
  BlockTransform transform(hann_window(length), Detrend::none);
  const double resolution = rate / static_cast<double>(length);
  const auto bins = std::min(transform.bins(), static_cast<std::size_t>(highest_ / resolution) + 1);
  // Freed from the mean as the window weights it: a constant c is c W₀ at 0 and −c W₀/2 at the next line. The plain
  // mean of a derivative is the difference of its ends, which would carry fast noise down here.
  const auto transformed = [&](const Series& s, std::size_t from) {
    const auto all = transform(std::span(s).subspan(from, length));
    Eigen::VectorXcd line(static_cast<Eigen::Index>(bins));
    std::copy_n(all.begin(), bins, line.begin());
    line(1) += 0.5 * line(0);
    line(0) = 0.0;
    return line;
  };
  std::vector<Eigen::MatrixXcd> cross(bins, Eigen::MatrixXcd::Zero(size, size));
  std::vector<double> component_noise(bins, 0.0);
  const double scale = 2.0 / (rate * transform.window_power());
  double blocks = 0.0;
  for (std::size_t r = 0; r < linear_.residual.size(); ++r) {
    const auto& trusted = linear_.residual[r].trusted;
    for (std::size_t from = 0; from + length <= trusted.size(); from += length / 2) {
      const auto begin = trusted.begin() + static_cast<std::ptrdiff_t>(from);
      const auto end = begin + static_cast<std::ptrdiff_t>(length);
      if (std::find(begin, end, false) != end) continue;
      blocks += 1.0;
      Eigen::MatrixXcd lines(static_cast<Eigen::Index>(bins), size);
      lines.col(0) = transformed(linear_.residual[r].values, from);
      for (Eigen::Index i = 1; i < size; ++i) {
        lines.col(i) = transformed(linear_.change[static_cast<std::size_t>(i) - 1][r], from);
      }
      for (std::size_t k = 0; k < bins; ++k) {
        const auto row = lines.row(static_cast<Eigen::Index>(k));
        cross[k] += scale * (row.transpose() * row.conjugate());
      }
      if (linear_.component_noise[r].empty()) continue;
      const Eigen::VectorXcd line = transformed(linear_.component_noise[r], from);
      for (std::size_t k = 0; k < bins; ++k) {
        component_noise[k] += scale * std::norm(line(static_cast<Eigen::Index>(k)));
      }
    }
  }
  if (blocks == 0.0) return;
  for (auto& matrix : cross) matrix /= blocks;
  for (double& v : component_noise) v /= blocks;
  spectra_ = {std::move(cross), component_noise, component_noise, resolution, blocks};
  add_sensor_noise(spectra_.noise);
}

void RelationFit::add_sensor_noise(std::vector<double>& noise) const {
  const firmware::Recording& r = recordings_.front();
  const double period = r.sample_period;
  std::array<double, model::channel_count> rms{};
  for (const Term& t : relation_.sum) rms[index(t.channel)] = noise_of(r, t.channel);
  for (std::size_t k = 0; k < noise.size(); ++k) {
    const double f = static_cast<double>(k) * spectra_.resolution;
    std::array<std::complex<double>, model::channel_count> gains{};
    for (const Term& t : relation_.sum) gains[index(t.channel)] += t.factor * window_.gain(t.order, f);
    for (std::size_t c = 0; c < gains.size(); ++c) noise[k] += 2.0 * period * std::norm(gains[c]) * rms[c] * rms[c];
  }
  // A share of the largest term's own power, for what the relations themselves are not exact to.
  const Series largest = samples_of(r, {relation_.sum.front()}, &window_);
  const PowerSpectrum power = welch(std::span(largest).subspan(static_cast<std::size_t>(window_.reach())), 1.0 / period,
                                    static_cast<std::size_t>(thresholds::parity_block / period));
  constexpr double error = thresholds::parity_model_error;
  for (std::size_t k = 0; k < std::min(noise.size(), power.density.size()); ++k) {
    noise[k] += error * error * power.density[k];
  }
}

NormalEquations RelationFit::normal_equations() const {
  const auto m = static_cast<Eigen::Index>(linear_.change.size());
  NormalEquations equations{Eigen::MatrixXd::Zero(m, m), Eigen::VectorXd::Zero(m)};
  for (std::size_t k = 1; k < spectra_.noise.size(); ++k) {
    equations.hessian += spectra_.cross[k].bottomRightCorner(m, m).real() / spectra_.noise[k];
    equations.gradient += spectra_.cross[k].bottomLeftCorner(m, 1).real() / spectra_.noise[k];
  }
  equations.hessian.diagonal() *= 1.0 + 1e-9;
  return equations;
}

StepBox RelationFit::box(double) const {
  const auto m = static_cast<Eigen::Index>(linear_.lower.size());
  return {Eigen::Map<const Eigen::VectorXd>(linear_.lower.data(), m),
          Eigen::Map<const Eigen::VectorXd>(linear_.upper.data(), m)};
}

double RelationFit::move(const Eigen::VectorXd& theta) {
  theta_ = theta;
  double moved = 0.0;
  const std::size_t inner = linear_.component_paths.size(), first = linear_.change.size() - inner;
  for (std::size_t i = 0; i < inner; ++i) {
    const double change = theta(static_cast<Eigen::Index>(first + i));
    deviations_[linear_.component_paths[i]] += change;
    moved = std::max(moved, std::abs(change));
  }
  return moved;
}

double RelationFit::noise_of(const firmware::Recording& recording, Channel channel) const {
  return channel == Channel::x_cmd ? 0.0 : sensor_noise(description_, recording, channel);
}

double RelationFit::tolerance(const std::string& path) const {
  const auto it = description_.tolerance.find(path);
  return it == description_.tolerance.end() ? 0.0 : it->second;
}

}  // namespace host_sim::identification
