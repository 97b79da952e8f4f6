#include "host_sim/identification/select/fault_candidates.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "host_sim/identification/common/golden_section.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/noise/recorder_filter.hpp"
#include "host_sim/identification/select/linear_refit.hpp"
#include "host_sim/identification/select/thresholds.hpp"
#include "host_sim/signal/line.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using Group = std::uint32_t;  ///< bit c: the problem's channel c

std::vector<Channel> channels_in(const IdentificationProblem& problem, Group group) {
  std::vector<Channel> channels;
  for (std::size_t c = 0; c < problem.channels().size(); ++c) {
    if ((group >> c & 1U) != 0) channels.push_back(problem.channels()[c]);
  }
  return channels;
}

bool holds_kind(const Hypothesis& hypothesis, FaultKind kind) {
  return std::any_of(hypothesis.faults.begin(), hypothesis.faults.end(),
                     [kind](const PlacedFault& fault) { return fault.kind == kind; });
}

/// One scan: a fit and what everything in it does to a new direction.
class FaultScan {
 public:
  FaultScan(const IdentificationProblem& problem, const Fit& base) : problem_(problem), base_(base), others_(base) {}

  void add_clocks_and_filters(std::vector<FaultCandidate>& list) const;
  void add_hum(std::vector<FaultCandidate>& list) const;
  /// `simulates`: also parameters that the fit does not hold, each by a simulation.
  /// Returns the χ² that a constant change of a parameter promises, of those that are exact or at a bound.
  double add_drifts(bool simulates, std::vector<FaultCandidate>& list) const;

  /// Change of the residuals by faults that differ from those of the fit on these channels only.
  [[nodiscard]] Eigen::VectorXd change(const std::vector<PlacedFault>& faults,
                                       const std::vector<Channel>& channels) const {
    Hypothesis other = base_.hypothesis;
    other.faults = faults;
    return residuals(problem_, predict_readings(problem_, other, base_.prediction, channels)) - base_.residual;
  }
  [[nodiscard]] const LinearRefit& others() const { return others_; }

 private:
  struct GroupGain {
    Group group;
    double gain, offset_gain;  ///< of offset and rate together; of the offset alone
    double offset, rate;
  };
  [[nodiscard]] std::vector<GroupGain> group_gains() const;
  void add_filter(Group group, std::vector<FaultCandidate>& list) const;
  [[nodiscard]] std::vector<double> raw_residual(std::size_t recording, std::size_t channel) const;
  [[nodiscard]] std::optional<FaultCandidate> drift_of(const std::string& path,
                                                       const Eigen::VectorXd& derivative) const;
  using TimeWeight = std::function<double(double)>;
  [[nodiscard]] Eigen::VectorXd weighted_by_time(const Eigen::VectorXd& column, const TimeWeight& weight) const;
  [[nodiscard]] bool is_one_drift(const Eigen::VectorXd& derivative) const;

  const IdentificationProblem& problem_;
  const Fit& base_;
  LinearRefit others_;
};

std::vector<FaultScan::GroupGain> FaultScan::group_gains() const {
  const std::size_t m = problem_.channels().size();
  Eigen::MatrixXd d(base_.residual.size(), static_cast<Eigen::Index>(2 * m));
  for_all(2 * m, [&](std::size_t i) {
    const std::vector<Channel> channel{problem_.channels()[i / 2]};
    const double step = thresholds::fault_difference * (i % 2 == 0 ? thresholds::offset_scale : thresholds::rate_scale);
    std::vector<PlacedFault> faults = base_.hypothesis.faults;
    faults.push_back(clock_fault(channel, i % 2 == 0 ? step : 0.0, i % 2 == 0 ? 0.0 : step));
    d.col(static_cast<Eigen::Index>(i)) = change(faults, channel) / thresholds::fault_difference;
  });
  if (!d.allFinite()) return {};
  const LinearRefit::Directions all = others_.directions(d);
  std::vector<GroupGain> gains;
  for (Group group = 1; group < (Group{1} << m); ++group) {
    Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < 2 * m; ++i) {
      if ((group >> (i / 2) & 1U) == 0) continue;
      const auto row = static_cast<Eigen::Index>(i);
      gradient(row % 2) += all.gradient(row);
      for (std::size_t j = 0; j < 2 * m; ++j) {
        if ((group >> (j / 2) & 1U) == 0) continue;
        const auto column = static_cast<Eigen::Index>(j);
        matrix(row % 2, column % 2) += all.matrix(row, column);
      }
    }
    matrix.diagonal() *= 1.0 + 1e-9;
    if (!(matrix(0, 0) > 0.0 && matrix.determinant() > 0.0)) continue;
    const Eigen::Vector2d step = -(matrix.inverse() * gradient);
    gains.push_back({group, -gradient.dot(step), gradient(0) * gradient(0) / matrix(0, 0),
                     step(0) * thresholds::offset_scale, step(1) * thresholds::rate_scale});
  }
  return gains;
}

void FaultScan::add_clocks_and_filters(std::vector<FaultCandidate>& list) const {
  const bool has_clock = holds_kind(base_.hypothesis, FaultKind::clock);
  const bool has_filter = holds_kind(base_.hypothesis, FaultKind::common_filter);
  if (has_clock && has_filter) return;
  std::vector<GroupGain> gains = group_gains();
  const auto best = [&gains](std::size_t count, auto gain) {
    std::sort(gains.begin(), gains.end(), [&](const GroupGain& a, const GroupGain& b) { return gain(a) > gain(b); });
    return std::vector<GroupGain>(
        gains.begin(), gains.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(count, gains.size())));
  };
  const auto bounded = [](double value, double bound) { return std::clamp(value, -0.9 * bound, 0.9 * bound); };
  if (!has_clock) {
    for (const GroupGain& g : best(thresholds::tried_groups, [](const GroupGain& x) { return x.gain; })) {
      list.push_back({clock_fault(channels_in(problem_, g.group), bounded(g.offset, thresholds::largest_offset),
                                  bounded(g.rate, thresholds::largest_rate)),
                      g.gain});
    }
  }
  if (has_filter) return;
  for (const PlacedFault& seen : filters_seen(problem_)) {
    std::vector<PlacedFault> faults = base_.hypothesis.faults;
    faults.push_back(seen);
    const Eigen::VectorXd d = change(faults, seen.channels);
    if (d.allFinite()) list.push_back({seen, others_.gain(d)});
  }
  // A filter is late, and one channel's own is an effect of its sensor.
  std::erase_if(gains, [](const GroupGain& g) { return std::popcount(g.group) < 2 || g.offset_gain < 10.0; });
  for (const GroupGain& g : best(thresholds::tried_groups, [](const GroupGain& x) { return x.offset_gain; })) {
    add_filter(g.group, list);
  }
}

void FaultScan::add_filter(Group group, std::vector<FaultCandidate>& list) const {
  const std::vector<Channel> channels = channels_in(problem_, group);
  for (const int order : {1, 2}) {
    FaultCandidate best;
    for (const double corner : thresholds::filter_corners) {
      std::vector<PlacedFault> faults = base_.hypothesis.faults;
      faults.push_back(filter_fault(channels, corner, order));
      const Eigen::VectorXd d = change(faults, channels);
      const double gain = d.allFinite() ? others_.gain(d) : 0.0;
      if (gain > best.gain) best = {faults.back(), gain};
    }
    if (best.gain > 0.0) list.push_back(std::move(best));
  }
}

/// Measured minus predicted of one channel in the fitted window.
std::vector<double> FaultScan::raw_residual(std::size_t recording, std::size_t channel) const {
  const ProblemRecording& r = problem_.recordings()[recording];
  const Channel of = problem_.channels()[channel];
  return measured_minus_read(
      r, of, sensor_readings(base_.hypothesis, *r.samples, of, (*base_.prediction.truth[recording])[index(of)]));
}

void FaultScan::add_hum(std::vector<FaultCandidate>& list) const {
  if (holds_kind(base_.hypothesis, FaultKind::mains_hum)) return;
  const std::size_t m = problem_.channels().size();
  std::size_t first = 0;
  while (first < problem_.recordings().size() && !problem_.recordings()[first].is_fitted()) ++first;
  if (first == problem_.recordings().size()) return;
  const ProblemRecording& r = problem_.recordings()[first];
  const Whitening& whitening = *r.fit_whitening;
  for (const double mains : thresholds::mains_frequencies) {
    // The strongest line near the mains' frequency, in units of noise, beside its neighbourhood.
    double strongest = 0.0, around = 0.0, count = 0.0, frequency = 0.0;
    for (std::size_t k = 0; k < whitening.bins(); ++k) {
      const double f = whitening.frequency(k);
      if (std::abs(f - mains) > 4.0 * thresholds::hum_range) continue;
      const double power =
          base_.residual.segment(static_cast<Eigen::Index>(2 * m * k), static_cast<Eigen::Index>(2 * m)).squaredNorm();
      around += power;
      count += 1.0;
      if (std::abs(f - mains) > thresholds::hum_range || power <= strongest) continue;
      strongest = power;
      frequency = f;
    }
    const double noise = std::max(2.0 * static_cast<double>(m), (around - strongest) / std::max(count - 1.0, 1.0));
    if (!(strongest > thresholds::line_above_neighbours * noise)) continue;
    const double period = r.samples->compared_period();
    const double begin = static_cast<double>(whitening.window().from) * r.samples->input.period;
    std::vector<std::vector<double>> left;
    for (std::size_t c = 0; c < m; ++c) left.push_back(raw_residual(first, c));
    const auto minus_power = [&](double f) {
      double sum = 0.0;
      for (std::size_t c = 0; c < m; ++c) {
        const double sigma = std::max(r.samples->noise[index(problem_.channels()[c])], 1e-300);
        sum -= std::norm(line_in(left[c], f, period, begin)) / (sigma * sigma);
      }
      return sum;
    };
    const double bin = whitening.frequency(1);
    const LowestPoint peak = golden_section(minus_power, frequency - bin, frequency + bin, 12);
    PlacedFault fault;
    fault.kind = FaultKind::mains_hum;
    fault.values = {peak.at};
    for (std::size_t c = 0; c < m; ++c) {
      const std::complex<double> z = line_in(left[c], peak.at, period, begin);
      const double sigma = std::max(r.samples->noise[index(problem_.channels()[c])], 1e-300);
      // The amplitude's standard deviation is about σ √(3/N) through a Hann window.
      const double least = thresholds::least_line * sigma * std::sqrt(3.0 / static_cast<double>(left[c].size()));
      if (std::abs(z) < least) continue;
      fault.channels.push_back(problem_.channels()[c]);
      fault.values.insert(fault.values.end(), {z.real(), -z.imag()});
    }
    if (fault.channels.empty()) continue;
    fault.fitted.assign(fault.values.size(), true);
    std::vector<PlacedFault> faults = base_.hypothesis.faults;
    faults.push_back(fault);
    const Eigen::VectorXd d = change(faults, fault.channels);
    if (d.allFinite()) list.push_back({std::move(fault), others_.gain(d)});
  }
}

/// F{ w(t/T) F⁻¹{column} }, recording by recording, row by row of the whitened channels.
Eigen::VectorXd FaultScan::weighted_by_time(const Eigen::VectorXd& column, const TimeWeight& weight) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(column.size());
  const auto m = static_cast<Eigen::Index>(problem_.channels().size());
  Eigen::Index at = 0;
  for (const ProblemRecording& r : problem_.recordings()) {
    if (!r.is_fitted()) continue;
    const Whitening& whitening = *r.fit_whitening;
    const auto bins = static_cast<Eigen::Index>(whitening.bins());
    // A signal of 2·bins samples over the window has these bins as its half spectrum.
    const std::size_t length = good_fft_size(2 * whitening.bins());
    RealTransform transform(length);
    const auto whole = static_cast<double>(r.samples->size());
    const double from = static_cast<double>(whitening.window().from) / whole;
    const double share = static_cast<double>(whitening.window().size()) / whole;
    for (Eigen::Index c = 0; c < m; ++c) {
      // x_n = Re Σ_k X_k e^{2πi kn/N} by two real transforms: Re and Im of X are even and odd.
      std::vector<double> even(length, 0.0), odd(length, 0.0);
      for (Eigen::Index k = 0; k < bins; ++k) {
        even[static_cast<std::size_t>(k)] = column(at + 2 * (k * m + c));
        odd[static_cast<std::size_t>(k)] = column(at + 2 * (k * m + c) + 1);
      }
      // Σ_k a_k e^{−2πi kn/N} for real a: bins n = 0 … N/2; beyond, conjugates.
      std::vector<double> signal(length);
      const auto fill = [&](const std::vector<double>& part, bool imaginary) {
        const auto sums = transform(part);
        for (std::size_t n = 0; n < length; ++n) {
          const bool high = n > length / 2;
          const std::complex<double> s = high ? std::conj(sums[length - n]) : sums[n];
          // Re{(e + i o) e^{+iφ}} = e cos φ − o sin φ;  the sum with e^{−iφ} has Re = Σ a cos φ, Im = −Σ a sin φ.
          signal[n] += imaginary ? s.imag() : s.real();
        }
      };
      fill(even, false);
      fill(odd, true);
      for (std::size_t n = 0; n < length; ++n) {
        const double t = from + share * (static_cast<double>(n) + 0.5) / static_cast<double>(length);
        signal[n] *= weight(t) * 2.0 / static_cast<double>(length);
      }
      const auto spectrum = transform(signal);
      for (Eigen::Index k = 0; k < bins; ++k) {
        result(at + 2 * (k * m + c)) = spectrum[static_cast<std::size_t>(k)].real();
        result(at + 2 * (k * m + c) + 1) = spectrum[static_cast<std::size_t>(k)].imag();
      }
    }
    at += static_cast<Eigen::Index>(whitening.count());
  }
  return result;
}

/// (2) of fault_candidates.hpp.
bool FaultScan::is_one_drift(const Eigen::VectorXd& derivative) const {
  constexpr auto pieces = static_cast<Eigen::Index>(thresholds::drift_pieces);
  Eigen::MatrixXd free(derivative.size(), pieces);
  double end = 0.0;  // of what is fitted, as a share of the recording
  for (const ProblemRecording& r : problem_.recordings()) {
    if (!r.is_fitted()) continue;
    end = std::max(end, static_cast<double>(r.fit_whitening->window().to) / static_cast<double>(r.samples->size()));
  }
  // Hats, which add up to 1.
  const double width = end / static_cast<double>(pieces - 1);
  for (Eigen::Index i = 0; i < pieces; ++i) {
    free.col(i) = weighted_by_time(
        derivative, [&](double t) { return std::max(0.0, 1.0 - std::abs(t / width - static_cast<double>(i))); });
  }
  const LinearRefit::Directions all = others_.directions(free);
  Eigen::MatrixXd matrix = all.matrix;
  matrix.diagonal() *= 1.0 + 1e-6;  // where a constant size is fitted already, their sum is no direction
  const double free_gain = all.gradient.dot(matrix.ldlt().solve(all.gradient));
  double gain = 0.0;
  for (const double kappa : thresholds::drift_curvatures) {
    Eigen::VectorXd sizes(pieces);
    for (Eigen::Index i = 0; i < pieces; ++i) {
      const double s = width * static_cast<double>(i);
      sizes(i) = kappa == 0.0 ? s : std::expm1(-kappa * s) / std::expm1(-kappa);
    }
    // A size at the beginning of its own, and a change.
    Eigen::MatrixXd two(pieces, 2);
    two.col(0).setOnes();
    two.col(1) = sizes;
    Eigen::Matrix2d m = two.transpose() * matrix * two;
    m.diagonal() *= 1.0 + 1e-6;
    const Eigen::Vector2d g = two.transpose() * all.gradient;
    gain = std::max(gain, g.dot(m.ldlt().solve(g)));
  }
  return free_gain - gain < std::max(thresholds::drift_of_noise, thresholds::drift_remainder * gain);
}

/// d of (1) in fault_candidates.hpp as a candidate; `derivative`: ∂r/∂p · p.
std::optional<FaultCandidate> FaultScan::drift_of(const std::string& path, const Eigen::VectorXd& derivative) const {
  const Eigen::MatrixXd d = weighted_by_time(derivative, [](double t) { return t; }) * thresholds::drift_scale;
  if (!d.allFinite()) return std::nullopt;
  const LinearRefit::Directions direction = others_.directions(d);
  if (!(direction.matrix(0, 0) > 1e-8 * d.squaredNorm())) return std::nullopt;
  if (!is_one_drift(derivative)) return std::nullopt;
  const double step = -direction.gradient(0) / direction.matrix(0, 0) * thresholds::drift_scale;
  PlacedFault fault;
  fault.kind = FaultKind::drift;
  fault.path = path;
  fault.values = {std::clamp(step, -0.5 * thresholds::largest_drift, 0.5 * thresholds::largest_drift), 0.0};
  fault.fitted = {true, false};
  return FaultCandidate{std::move(fault), direction.gradient(0) * direction.gradient(0) / direction.matrix(0, 0)};
}

double FaultScan::add_drifts(bool simulates, std::vector<FaultCandidate>& list) const {
  if (base_.jacobian.cols() != static_cast<Eigen::Index>(base_.parameters.size())) return 0.0;
  std::vector<FreeParameter> parameters = base_.parameters;
  const auto is_known = [&](const FreeParameter& p) {
    return std::any_of(base_.parameters.begin(), base_.parameters.end(),
                       [&](const FreeParameter& known) { return known.path == p.path; });
  };
  if (simulates) {
    for (FreeParameter& exact : parameters_of_part(base_.hypothesis.rig)) {
      if (!is_known(exact)) parameters.push_back(std::move(exact));
    }
  }
  std::vector<std::optional<FaultCandidate>> drifts(parameters.size());
  std::vector<double> constant(parameters.size(), 0.0);
  for_all(parameters.size(), [&](std::size_t i) {
    const FreeParameter& parameter = parameters[i];
    const bool of_rig = parameter.role == FreeParameter::Role::tolerated ||
                        (parameter.role == FreeParameter::Role::effect && !parameter.sensor);
    const auto drifts_already = [&](const PlacedFault& fault) {
      return fault.kind == FaultKind::drift && fault.path == parameter.path;
    };
    const auto& faults = base_.hypothesis.faults;
    if (!of_rig || std::any_of(faults.begin(), faults.end(), drifts_already)) return;
    const double u = parameter.get(base_.hypothesis), value = parameter.value(u);
    const double unit = parameter.logarithmic ? value : parameter.scale;  // ∂value/∂u
    if (!(std::abs(value) > 0.0)) return;
    if (i < base_.parameters.size()) {
      const bool bound = parameter.role == FreeParameter::Role::tolerated && parameter.at_bound(base_.hypothesis);
      if (bound) constant[i] = others_.free_gain(base_.jacobian.col(static_cast<Eigen::Index>(i)));
      drifts[i] = drift_of(parameter.path, base_.jacobian.col(static_cast<Eigen::Index>(i)) * (value / unit));
      return;
    }
    Hypothesis moved = base_.hypothesis;
    parameter.put(moved, u + parameter.difference);
    const Eigen::VectorXd change = residuals(problem_, predict(problem_, moved)) - base_.residual;
    if (!change.allFinite()) return;
    constant[i] = others_.free_gain(change);
    drifts[i] = drift_of(parameter.path, change * (value / unit / parameter.difference));
  });
  for (auto& drift : drifts) {
    if (drift && drift->gain > 0.0) list.push_back(std::move(*drift));
  }
  return constant.empty() ? 0.0 : *std::max_element(constant.begin(), constant.end());
}

void sort_by_gain(std::vector<FaultCandidate>& list) {
  std::sort(list.begin(), list.end(), [](const FaultCandidate& a, const FaultCandidate& b) { return a.gain > b.gain; });
}

}  // namespace

std::vector<FaultCandidate> fault_candidates(const IdentificationProblem& problem, const Fit& base, bool only_noise) {
  const FaultScan scan(problem, base);
  std::vector<FaultCandidate> list;
  if (!only_noise) scan.add_clocks_and_filters(list);
  if (!only_noise) scan.add_hum(list);
  const double parameter_off = scan.add_drifts(!only_noise, list);
  std::erase_if(list, [=](const FaultCandidate& candidate) { return candidate.gain <= parameter_off; });
  sort_by_gain(list);
  return list;
}

std::vector<PlacedFault> filters_seen(const IdentificationProblem& problem) {
  const PreparedRecording& r = problem.samples().front();
  std::vector<PlacedFault> list;
  for (const RecorderFilter& seen : recorder_filters(problem, thresholds::alike_filters)) {
    const auto has = [&](Channel channel) {
      return std::find(seen.channels.begin(), seen.channels.end(), channel) != seen.channels.end();
    };
    std::vector<Channel> inside, outside;
    for (const Channel channel : problem.channels()) (has(channel) ? inside : outside).push_back(channel);
    const bool of_input = has(r.input.channel);
    PlacedFault fault = filter_fault(of_input ? outside : inside, seen.corner, seen.order);
    fault.digital = seen.digital;
    fault.inverse = of_input;
    fault.seen = true;
    // One channel's low-pass of first order is a lag of its sensor, which acts on its noise as well.
    const bool of_sensor = fault.order == 1 && inside.size() == 1 && !of_input;
    if (!fault.channels.empty() && !of_sensor) list.push_back(std::move(fault));
  }
  return list;
}

std::vector<FaultCandidate> neighbouring_groups(const IdentificationProblem& problem, const Fit& base,
                                                std::size_t fault, double least) {
  const PlacedFault& present = base.hypothesis.faults[fault];
  std::vector<FaultCandidate> list;
  if (present.kind != FaultKind::clock && present.kind != FaultKind::common_filter) return list;
  const FaultScan scan(problem, base);
  for (const Channel channel : problem.channels()) {
    if (present.seen && shows_its_colour(problem, channel)) continue;
    std::vector<PlacedFault> faults = base.hypothesis.faults;
    std::vector<Channel>& group = faults[fault].channels;
    if (present.acts_on(channel)) {
      if (group.size() == 1) continue;
      std::erase(group, channel);
    } else {
      group.push_back(channel);
    }
    const Eigen::VectorXd d = scan.change(faults, {channel});
    const double gain = d.allFinite() ? scan.others().gain(d) : 0.0;
    if (gain >= least) list.push_back({faults[fault], gain});
  }
  sort_by_gain(list);
  return list;
}

}  // namespace host_sim::identification
