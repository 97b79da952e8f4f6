#include "host_sim/transfer/predict/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"

namespace host_sim::transfer {

using Rig = model::RigParameters<double>;

namespace {

/// Uniform and normal numbers of one purpose.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint32_t stream) : normal_(seed, stream) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U), stream + 1000U};
    engine_.seed(words);
  }
  double normal() { return normal_(); }
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  Complex complex_normal() {  ///< E|z|² = 1
    const double re = normal_() * std::sqrt(0.5);
    return {re, normal_() * std::sqrt(0.5)};
  }

 private:
  firmware::Gaussian normal_;
  std::mt19937_64 engine_;
};

/// The second rig's own parameters, anywhere within their tolerances.
void draw_own_parameters(const firmware::RigDescription& to, Dice& dice, Rig& rig) {
  for (const auto& [path, bound] : to.tolerance) {
    const double share = bound * (2.0 * dice.uniform() - 1.0);
    if (travels(path)) continue;
    if (double* const value = firmware::find_parameter(rig, path)) *value *= 1.0 + share;
  }
}

/// Tolerated parameters of the component that no fit has moved: a duct that was closed, an excitation that shows
/// nothing of it. They are anywhere in their tolerance still.
void draw_unlearned(const firmware::RigDescription& from, const ComponentModel& model, Dice& dice, Rig& rig) {
  Rig described = from.rig;
  for (const auto& tolerance : from.tolerance) {
    const std::string& path = tolerance.first;
    const double share = tolerance.second * (2.0 * dice.uniform() - 1.0);
    const bool learned =
        std::any_of(model.parameters.begin(), model.parameters.end(), [&](const auto& p) { return p.path == path; });
    if (learned || !travels(path)) continue;
    double* const value = firmware::find_parameter(rig, path);
    const double* const nominal = firmware::find_parameter(described, path);
    if (value != nullptr && nominal != nullptr) *value += *nominal * share;
  }
}

std::vector<Outcome> outcomes_of(const SecondRig& second, const std::vector<Rig>& rigs) {
  std::vector<Outcome> outcomes(rigs.size());
  constexpr std::size_t chunk = 64;  // a run of a minute and three channels takes 1.4 MB
  for (std::size_t first = 0; first < rigs.size(); first += chunk) {
    const std::vector<Rig> some(rigs.begin() + static_cast<std::ptrdiff_t>(first),
                                rigs.begin() + static_cast<std::ptrdiff_t>(std::min(first + chunk, rigs.size())));
    const auto runs = second.run(some);
    identification::for_all(some.size(), [&](std::size_t i) { outcomes[first + i] = second.analysis->of(runs[i]); });
  }
  return outcomes;
}

bool is_finite(const Outcome& outcome) { return std::isfinite(outcome.quantity[0]); }

/// Response and spectrum of the stroke, which an Outcome does not have: as the second response of the result.
Outcome stroke_of(const Analysis& analysis, std::vector<Response> runs) {
  for (Response& run : runs) run[index(model::Channel::zdd_b)] = run[index(model::Channel::dz_b)];
  return analysis.of(runs);
}

/// A force that acts beside the component, with a corner of 30 Hz that keeps it where the lines are; one for each
/// drive.
std::vector<std::vector<double>> probe_forces(const SecondRig& second, double size) {
  Dice dice(1, 81);
  std::vector<std::vector<double>> forces;
  for (const auto& drive : second.drives) {
    std::vector<double> force(drive.input.size());
    double slow = 0.0;
    const double share = std::min(1.0, 2.0 * std::numbers::pi * 30.0 * drive.input.period);
    for (double& f : force) f = slow += share * (size * dice.normal() / std::sqrt(share) - slow);
    forces.push_back(std::move(force));
  }
  return forces;
}

/// (1), (2): G_y by a probe of the actuator force. `own_damping`: of the second rig beside the component.
ForceEffect force_effect_of(const SecondRig& second, const Rig& rig, double own_damping, const Outcome& centre) {
  const auto probes =
      probe_forces(second, 0.1 * rig.suspension.stiffness *
                               std::max(centre.quantity[static_cast<std::size_t>(Quantity::rms_dz_b)], 1e-6));
  SecondRig probed = second;
  for (std::size_t d = 0; d < probed.drives.size(); ++d) {
    std::vector<double>& force = probed.drives[d].input.actuator_force;
    if (force.empty()) force.assign(probes[d].size(), 0.0);
    for (std::size_t k = 0; k < force.size(); ++k) force[k] += probes[d][k];
  }
  const auto without = second.run({rig}).front();
  std::vector<Response> differences = probed.run({rig}).front();
  for (std::size_t d = 0; d < differences.size(); ++d) {
    for (const model::Channel channel : outcome_channels) {
      auto& values = differences[d][index(channel)];
      for (std::size_t k = 0; k < values.size(); ++k) values[k] -= without[d][index(channel)][k];
    }
  }
  const Analysis analysis(probes, 1.0 / second.drives.front().input.period, 1.0);
  const Outcome gains = analysis.of(differences), stroke_gain = stroke_of(analysis, differences),
                stroke = stroke_of(*second.analysis, without);
  ForceEffect effect;
  effect.stroke_density = stroke.density[1];
  for (std::size_t k = 0; k < stroke.response[1].size(); ++k) {
    const Complex velocity =
        Complex(0.0, 2.0 * std::numbers::pi * second.analysis->frequencies()[k]) * stroke.response[1][k];
    const Complex force = rig.body.mass * centre.response[1][k] - own_damping * velocity;
    for (std::size_t i = 0; i < 2; ++i) effect.response[i].push_back(gains.response[i][k] * force);
    effect.stroke.push_back(stroke_gain.response[1][k] * force / stroke.response[1][k]);
  }
  return effect;
}

/// √(Σ S |factor|² ÷ Σ S): what lines that change make of an rms value.
class ChangeOfRms {
 public:
  void add(double density, Complex factor) {
    before_ += density;
    after_ += density * std::norm(factor);
  }
  [[nodiscard]] double ratio() const { return before_ > 0.0 ? std::sqrt(after_ / before_) : 1.0; }

 private:
  double before_ = 0.0, after_ = 0.0;
};

/// (1)–(3).
void add_discrepancy(const Discrepancy& discrepancy, const Analysis& analysis, const ForceEffect& effect, Dice& dice,
                     Outcome& outcome) {
  std::vector<Complex> delta;
  for (const auto& band : discrepancy.bands) delta.push_back(band.relative * dice.complex_normal());
  const auto delta_at = [&](double frequency) {
    for (std::size_t b = 0; b < delta.size(); ++b) {
      if (frequency >= discrepancy.bands[b].lowest && frequency < discrepancy.bands[b].highest) return delta[b];
    }
    return Complex(0.0);
  };
  ChangeOfRms load, body, weighted, stroke;
  for (std::size_t k = 0; k < analysis.frequencies().size(); ++k) {
    const double f = analysis.frequencies()[k];
    const Complex own = delta_at(f);
    std::array<Complex, 2> factor;
    for (std::size_t i = 0; i < 2; ++i) {
      factor[i] = 1.0 + own * effect.response[i][k] / outcome.response[i][k];
      outcome.response[i][k] *= factor[i];
    }
    load.add(outcome.density[0][k], factor[0]);
    body.add(outcome.density[1][k], factor[1]);
    weighted.add(std::pow(vertical_weighting(f), 2) * outcome.density[1][k], factor[1]);
    stroke.add(effect.stroke_density[k], 1.0 + own * effect.stroke[k]);
    for (std::size_t i = 0; i < 2; ++i) outcome.density[i][k] *= std::norm(factor[i]);
  }
  const auto scale = [&](Quantity quantity, const ChangeOfRms& change) {
    outcome.quantity[static_cast<std::size_t>(quantity)] *= change.ratio();
  };
  scale(Quantity::rms_F_w, load);
  scale(Quantity::dynamic_load_coefficient, load);
  scale(Quantity::rms_zdd_b, body);
  scale(Quantity::weighted_zdd_b, weighted);
  scale(Quantity::rms_dz_b, stroke);
  scale(Quantity::peak_dz_b, stroke);
}

void add_simulation_error(Dice& dice, Outcome& outcome) {
  for (auto& response : outcome.response) {
    for (Complex& h : response) h *= 1.0 + thresholds::simulation_error * dice.complex_normal();
  }
}

void add_noise(const SecondRig& second, Dice& dice, Outcome& outcome) {
  const Analysis& analysis = *second.analysis;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < outcome.response[i].size(); ++k) {
      const double noise = second.noise_density[i][k], averages = std::max(analysis.averages(), 1.0);
      outcome.response[i][k] +=
          std::sqrt(noise / (std::max(analysis.foot_power()[k], 1e-300) * averages)) * dice.complex_normal();
      const double scatter = std::sqrt((2.0 * outcome.density[i][k] * noise + noise * noise) / averages);
      outcome.density[i][k] = std::max(0.0, outcome.density[i][k] + noise + scatter * dice.normal());
    }
  }
  // In the weighted acceleration noise counts in the lines; the others hold all of it.
  for (std::size_t q = 0; q < quantity_count; ++q) {
    if (static_cast<Quantity>(q) == Quantity::peak_dz_b) continue;
    const std::size_t c = quantity_channel[q] == model::Channel::F_w     ? 0
                          : quantity_channel[q] == model::Channel::zdd_b ? 1
                                                                         : 2;
    double variance = second.noise_variance[c];
    if (static_cast<Quantity>(q) == Quantity::weighted_zdd_b) {
      variance = 0.0;
      for (std::size_t k = 0; k < analysis.frequencies().size(); ++k) {
        variance += std::pow(vertical_weighting(analysis.frequencies()[k]), 2) * second.noise_density[1][k] *
                    analysis.line_width();
      }
    }
    if (static_cast<Quantity>(q) == Quantity::dynamic_load_coefficient) {
      variance /= analysis.static_load() * analysis.static_load();
    }
    const double rms = outcome.quantity[q];
    double samples = 0.0;  // independent ones: at least two for each line
    for (const auto& drive : second.drives) {
      samples += 2.0 * thresholds::highest_frequency * drive.input.period * static_cast<double>(drive.size());
    }
    const double scatter = std::sqrt(std::max(0.0, 4.0 * rms * rms * variance / std::max(samples, 1.0)));
    outcome.quantity[q] = std::sqrt(std::max(0.0, rms * rms + variance + scatter * dice.normal()));
  }
}

/// (4)
void add_calibration(const SecondRig& second, Dice& dice, Outcome& outcome) {
  const auto error_of = [&](model::Channel channel) {
    const auto& calibration = second.description.calibration[model::index(channel)];
    return calibration ? calibration->standard_gain() * dice.normal() : 0.0;
  };
  const double drive = second.is_measured() ? error_of(model::Channel::z_r) : 0.0;
  std::array<double, outcome_channels.size()> factor{};
  for (std::size_t c = 0; c < factor.size(); ++c) factor[c] = (1.0 + error_of(outcome_channels[c])) / (1.0 + drive);
  for (std::size_t i = 0; i < outcome.response.size(); ++i) {
    if (factor[i] == 1.0) continue;
    for (Complex& h : outcome.response[i]) h *= factor[i];
    for (double& density : outcome.density[i]) density *= factor[i] * factor[i];
  }
  for (std::size_t q = 0; q < quantity_count; ++q) {
    const auto* const of = std::find(outcome_channels.begin(), outcome_channels.end(), quantity_channel[q]);
    const double of_channel = factor[static_cast<std::size_t>(of - outcome_channels.begin())];
    if (of_channel != 1.0) outcome.quantity[q] *= of_channel;
  }
}

const ComponentModel& chosen(const Posterior& posterior, double uniform) {
  for (const ComponentModel& model : posterior.models) {
    if (uniform < model.probability) return model;
    uniform -= model.probability;
  }
  return posterior.diagnosed();
}

/// A draw of a model, spread over all of its draws.
Eigen::VectorXd draw_of(const ComponentModel& model, Dice& dice) {
  const auto count = static_cast<double>(model.draws.cols());
  return model.draws.col(static_cast<Eigen::Index>(std::min(count - 1.0, std::floor(count * dice.uniform()))));
}

using Values = std::array<double, quantity_count>;

/// Variance of the quantities and of |H| over outcomes with weights.
struct Variances {
  Values quantity{};
  std::array<std::vector<double>, 2> response;
};
Variances variances_of(const std::vector<Outcome>& outcomes, const std::vector<double>& weights) {
  Variances result;
  double sum = 0.0;
  for (const double w : weights) sum += w;
  const auto variance = [&](const auto& value) {
    double mean = 0.0, square = 0.0;
    for (std::size_t i = 0; i < outcomes.size(); ++i) mean += weights[i] * value(outcomes[i]) / sum;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      square += weights[i] * std::pow(value(outcomes[i]) - mean, 2) / sum;
    }
    return square;
  };
  if (outcomes.empty()) return result;
  for (std::size_t q = 0; q < quantity_count; ++q) {
    result.quantity[q] = variance([q](const Outcome& o) { return o.quantity[q]; });
  }
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t k = 0; k < outcomes.front().response[r].size(); ++k) {
      result.response[r].push_back(variance([r, k](const Outcome& o) { return std::abs(o.response[r][k]); }));
    }
  }
  return result;
}

Budget shares(const std::array<double, source_count>& variances) {
  Budget budget{};
  double sum = 0.0;
  for (const double v : variances) sum += std::isfinite(v) ? v : 0.0;
  if (!(sum > 0.0)) return budget;
  for (std::size_t s = 0; s < source_count; ++s) budget[s] = std::isfinite(variances[s]) ? variances[s] / sum : 0.0;
  return budget;
}

void set_budget(const std::array<Variances, source_count>& sources, Prediction& prediction) {
  for (std::size_t q = 0; q < quantity_count; ++q) {
    std::array<double, source_count> variances{};
    for (std::size_t s = 0; s < source_count; ++s) variances[s] = sources[s].quantity[q];
    prediction.budget[q] = shares(variances);
  }
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t k = 0; k < prediction.centre.response[r].size(); ++k) {
      std::array<double, source_count> variances{};
      for (std::size_t s = 0; s < source_count; ++s) {
        if (k < sources[s].response[r].size()) variances[s] = sources[s].response[r][k];
      }
      prediction.response_budget[r].push_back(shares(variances));
    }
  }
}

template <class Get>
std::vector<Bands> bands_by_line(const std::vector<Outcome>& draws, std::size_t lines, const Get& get) {
  std::vector<Bands> bands;
  for (std::size_t k = 0; k < lines; ++k) {
    std::vector<double> values;
    for (const Outcome& o : draws) values.push_back(get(o, k));
    bands.push_back(bands_of(std::move(values)));
  }
  return bands;
}

}  // namespace

Bands Prediction::quantity(Quantity which) const {
  std::vector<double> values;
  for (const Outcome& o : draws) values.push_back(o.quantity[static_cast<std::size_t>(which)]);
  return bands_of(std::move(values));
}

std::vector<Bands> Prediction::response(std::size_t which) const {
  return bands_by_line(draws, centre.response[which].size(),
                       [which](const Outcome& o, std::size_t k) { return std::abs(o.response[which][k]); });
}

std::vector<Bands> Prediction::density(std::size_t which) const {
  return bands_by_line(draws, centre.density[which].size(),
                       [which](const Outcome& o, std::size_t k) { return o.density[which][k]; });
}

Prediction predict_second_rig(const firmware::RigDescription& from, const Posterior& posterior, const SecondRig& second,
                              std::uint64_t seed, std::size_t draws, std::size_t source_draws) {
  const firmware::RigDescription& to = second.description;
  const ComponentModel& diagnosed = posterior.diagnosed();
  const Rig centre_rig = with_component(to.rig, from.rig, diagnosed.hypothesis);
  Prediction prediction;
  prediction.centre = outcomes_of(second, {centre_rig}).front();
  prediction.force_effect =
      force_effect_of(second, centre_rig, to.rig.suspension.damping - from.rig.suspension.damping, prediction.centre);
  Dice dice(seed, 82);
  const auto disturb = [&](Outcome& outcome) {
    if (posterior.discrepancy.any()) {
      add_discrepancy(posterior.discrepancy, *second.analysis, prediction.force_effect, dice, outcome);
    }
    add_simulation_error(dice, outcome);
    add_calibration(second, dice, outcome);
    add_noise(second, dice, outcome);
  };
  const auto normal = [&dice] { return dice.normal(); };
  const auto learned_rig = [&](const ComponentModel& model, bool calibrated) {
    Eigen::VectorXd u = draw_of(model, dice);
    if (calibrated) u = model.with_calibration(std::move(u), normal);
    Rig rig = with_component(to.rig, from.rig, model.at(u));
    draw_unlearned(from, model, dice, rig);
    return rig;
  };

  std::vector<Rig> rigs;
  for (std::size_t i = 0; i < draws; ++i) {
    rigs.push_back(learned_rig(chosen(posterior, dice.uniform()), true));
    draw_own_parameters(to, dice, rigs.back());
  }
  prediction.draws = outcomes_of(second, rigs);
  std::erase_if(prediction.draws, [](const Outcome& o) { return !is_finite(o); });
  for (Outcome& outcome : prediction.draws) disturb(outcome);

  std::array<Variances, source_count> sources;
  const auto keep = [&](Source source, const std::vector<Outcome>& outcomes, const std::vector<double>& weights) {
    sources[static_cast<std::size_t>(source)] = variances_of(outcomes, weights);
  };
  const std::vector<double> equal(source_draws, 1.0);
  std::vector<Rig> varied;
  for (std::size_t i = 0; i < source_draws; ++i) varied.push_back(learned_rig(diagnosed, false));
  keep(Source::component, outcomes_of(second, varied), equal);
  varied.assign(source_draws, centre_rig);
  for (Rig& rig : varied) draw_own_parameters(to, dice, rig);
  keep(Source::rig, outcomes_of(second, varied), equal);
  varied.clear();
  std::vector<double> probabilities;
  for (const ComponentModel& model : posterior.models) {
    varied.push_back(with_component(to.rig, from.rig, model.hypothesis));
    probabilities.push_back(model.probability);
  }
  if (varied.size() > 1) keep(Source::rival_effects, outcomes_of(second, varied), probabilities);
  std::vector<Outcome> disturbed(source_draws, prediction.centre);
  if (posterior.discrepancy.any()) {
    for (Outcome& o : disturbed) {
      add_discrepancy(posterior.discrepancy, *second.analysis, prediction.force_effect, dice, o);
    }
    keep(Source::discrepancy, disturbed, equal);
  }
  disturbed.assign(source_draws, prediction.centre);
  for (Outcome& o : disturbed) {
    add_simulation_error(dice, o);
    add_noise(second, dice, o);
  }
  keep(Source::noise, disturbed, equal);
  const bool second_calibrated = std::any_of(to.calibration.begin(), to.calibration.end(),
                                             [](const auto& calibration) { return calibration.has_value(); });
  if (diagnosed.calibration.cols() > 0 || second_calibrated) {
    varied.clear();
    for (std::size_t i = 0; i < source_draws; ++i) {
      const Eigen::VectorXd u = diagnosed.with_calibration(diagnosed.mode, normal);
      varied.push_back(with_component(to.rig, from.rig, diagnosed.at(u)));
    }
    disturbed = outcomes_of(second, varied);
    for (Outcome& o : disturbed) add_calibration(second, dice, o);
    keep(Source::calibration, disturbed, equal);
  }
  set_budget(sources, prediction);
  return prediction;
}

Prediction predict_naively(const firmware::RigDescription& from, const ComponentModel& model, const SecondRig& second,
                           std::size_t draws) {
  Dice dice(1, 83);
  Prediction prediction;
  std::vector<Rig> rigs{with_component(second.description.rig, from.rig, model.hypothesis)};
  for (std::size_t i = 0; i < draws; ++i) {
    rigs.push_back(with_component(second.description.rig, from.rig, model.at(draw_of(model, dice))));
  }
  prediction.draws = outcomes_of(second, rigs);
  prediction.centre = prediction.draws.front();
  prediction.draws.erase(prediction.draws.begin());
  std::erase_if(prediction.draws, [](const Outcome& o) { return !is_finite(o); });
  for (Outcome& outcome : prediction.draws) {
    add_simulation_error(dice, outcome);
    add_noise(second, dice, outcome);
  }
  return prediction;
}

Sensitivity sensitivity_of(const firmware::RigDescription& from, const Posterior& posterior, const SecondRig& second) {
  const ComponentModel& model = posterior.diagnosed();
  Sensitivity sensitivity;
  std::vector<Rig> rigs;
  std::vector<double> steps;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    if (!travels(model.parameters[i], model.hypothesis)) continue;
    const auto k = static_cast<Eigen::Index>(i);
    sensitivity.parameters.push_back(i);
    const double step = std::sqrt(model.covariance(k, k));
    for (const double sign : {-1.0, 1.0}) {
      Eigen::VectorXd u = model.mode;
      u(k) = std::clamp(u(k) + sign * step, model.parameters[i].lower, model.parameters[i].upper);
      rigs.push_back(with_component(second.description.rig, from.rig, model.at(u)));
      steps.push_back(u(k));
    }
  }
  if (rigs.empty()) return sensitivity;
  const std::vector<Outcome> outcomes = outcomes_of(second, rigs);
  const auto values_of = [](const Outcome& o) {
    std::vector<double> values;
    for (const double q : o.quantity) values.push_back(std::log(std::max(q, 1e-300)));
    for (const auto& response : o.response) {
      for (const Complex& h : response) values.push_back(std::log(std::max(std::abs(h), 1e-300)));
    }
    return values;
  };
  const auto rows = static_cast<Eigen::Index>(values_of(outcomes.front()).size());
  sensitivity.gradient.resize(rows, static_cast<Eigen::Index>(sensitivity.parameters.size()));
  for (Eigen::Index j = 0; j < sensitivity.gradient.cols(); ++j) {
    const auto below = static_cast<std::size_t>(2 * j), above = below + 1;
    const std::vector<double> low = values_of(outcomes[below]), high = values_of(outcomes[above]);
    for (Eigen::Index i = 0; i < rows; ++i) {
      sensitivity.gradient(i, j) = (high[static_cast<std::size_t>(i)] - low[static_cast<std::size_t>(i)]) /
                                   std::max(steps[above] - steps[below], 1e-300);
    }
  }
  return sensitivity;
}

}  // namespace host_sim::transfer
