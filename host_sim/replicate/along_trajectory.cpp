#include "host_sim/replicate/along_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <utility>

#include "host_sim/replicate/stepped_rig.hpp"
#include "host_sim/replicate/thresholds.hpp"
#include "host_sim/replicate/tracking.hpp"

namespace host_sim::replicate {
namespace {

using TrackedSignals = std::vector<std::vector<double>>;  // by channel

/// A signal `samples` later; negative: earlier. Cubic through the four nearest samples.
std::vector<double> later(const std::vector<double>& signal, double samples) {
  std::vector<double> moved(signal.size());
  const double whole = std::floor(-samples), r = -samples - whole;
  const auto first = static_cast<std::ptrdiff_t>(whole);
  const auto last = static_cast<std::ptrdiff_t>(signal.size()) - 1;
  const auto at = [&](std::ptrdiff_t k) {
    return signal[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  for (std::ptrdiff_t k = 0; k <= last; ++k) {
    const std::ptrdiff_t i = k + first;
    moved[static_cast<std::size_t>(k)] =
        -r * (r - 1.0) * (r - 2.0) / 6.0 * at(i - 1) + (r + 1.0) * (r - 1.0) * (r - 2.0) / 2.0 * at(i) -
        (r + 1.0) * r * (r - 2.0) / 2.0 * at(i + 1) + (r + 1.0) * r * (r - 1.0) / 6.0 * at(i + 2);
  }
  return moved;
}

/// S⁻¹ of (2): sensors that lag or are late, undone where they leave something.
class SensorInverse {
 public:
  SensorInverse(const DriveModel& model, const BandInverse& inverse) : inverse_(inverse) {
    model::RigParameters<double> bare = model.rig();
    bool any = false;
    bare.effects.for_each_sensor([&](auto& slot, model::Channel) {
      any = any || slot.active;
      slot.active = false;
    });
    if (!any) return;
    const std::size_t length = inverse.transform().length();
    const auto with = model.linear_response(length), without = DriveModel(bare, model).linear_response(length);
    for (std::size_t c = 0; c < with.size(); ++c) {
      std::vector<std::complex<double>> ratio(with[c].size(), 1.0);
      for (std::size_t k = 0; k < ratio.size(); ++k) {
        if (std::abs(with[c][k]) > 0.05 * std::abs(without[c][k])) ratio[k] = without[c][k] / with[c][k];
      }
      ratios_.push_back(std::move(ratio));
    }
  }

  [[nodiscard]] std::vector<double> operator()(std::size_t channel, const std::vector<double>& signal) const {
    if (ratios_.empty()) return signal;
    const auto bins = inverse_.transform()(signal);
    std::vector<std::complex<double>> changed(bins.begin(), bins.end());
    for (std::size_t k = 0; k < changed.size(); ++k) changed[k] *= ratios_[channel][k];
    std::vector<double> result = inverse_.transform().inverse(changed);
    result.resize(signal.size());
    return result;
  }

 private:
  const BandInverse& inverse_;
  std::vector<std::vector<std::complex<double>>> ratios_;
};

/// Costs of Tracking, in terms of what a drive makes in the band: M of BandInverse (1).
std::pair<DriveCost, LimitCost> costs(const BandInverse& inverse, const Target& target, const DriveLimits& limits) {
  double lowest = std::numeric_limits<double>::infinity(), highest = 0.0;
  for (const TargetChannel& c : target.channels) {
    lowest = std::min(lowest, c.band.lowest);
    highest = std::max(highest, c.band.highest);
  }
  std::vector<double> position, acceleration;
  LimitCost mean;
  for (std::size_t k = 1; k < inverse.metric().size(); ++k) {
    const double f = inverse.frequency_step() * static_cast<double>(k), omega = full_turn * f, m = inverse.metric()[k];
    if (f < lowest || f > highest) continue;
    position.push_back(m);
    acceleration.push_back(m / std::pow(omega, 4));
    mean.position += m;
    mean.speed += m / (omega * omega);
    mean.acceleration += m / std::pow(omega, 4);
  }
  const auto low = [](std::vector<double>& values) {
    if (values.empty()) return 1.0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 50);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double n = std::max<double>(1.0, static_cast<double>(position.size()));
  mean.position /= n;
  mean.speed /= n;
  mean.acceleration /= n;
  mean.force = 1.0 / std::pow(thresholds::force_excess * limits.force, 2);
  return {{thresholds::position_cost * low(position), thresholds::acceleration_cost * low(acceleration)}, mean};
}

class TrajectorySolver {
 public:
  TrajectorySolver(const DriveModel& model, const Target& target, const BandInverse& inverse,
                   const TrackedSignals& offset)
      : model_(model), target_(target), inverse_(inverse), offset_(offset), sensors_(model, inverse) {}

  void run(const SolveInput& input, const DriveLimits& limits, const SolveProgress& progress) {
    const std::size_t channels = target_.channels.size();
    std::vector<TrackedChannel> tracked;
    TrackedSignals wanted;
    for (std::size_t c = 0; c < channels; ++c) {
      tracked.push_back({target_.channels[c].band, inverse_.weight(c)});
      wanted.push_back(sensors_(c, left(c, {})));
    }
    std::vector<model::Channel> read = model_.channels();
    read.push_back(model_.rig().kind == model::RigKind::quarter_car ? model::Channel::F_w : model::Channel::F);
    const double delay = machine_delay(model_.rig()) / target_.period;
    const auto rig = stepped_rig(model_.rig(), target_.period, read);
    const auto smooth = stepped_rig(with_corners(model_.rig(), 0.0), target_.period, read);
    const auto [own, excess] = costs(inverse_, target_, limits);
    Tracking tracking(*rig, target_.period, std::move(tracked), own, limits);
    const bool anew = input.start.empty();
    tracking.begin(later(anew ? inverse_.drive(wanted) : input.start, delay), wanted);
    tracking.lead_by(*smooth);
    progress_ = progress;
    if (anew && has_corners(model_.rig())) {
      tracking.exchange(*smooth, false);
      for (int i = 0; i < thresholds::smooth_rounds; ++i) round(tracking);
      tracking.exchange(*rig, true);
    }
    improve(tracking, wanted, delay, limits);
    if (limits_used(drive_without_limits_, target_.period, limits).largest() > thresholds::usable_limit) {
      unlimited = errors(answer_without_limits_);
      if (best_ > thresholds::little_cost * best_without_limits_) {
        tracking.charge(excess);
        for (int i = 0; i < thresholds::rounds_of_limits; ++i) {
          for (int j = 0; j < thresholds::rounds_of_multipliers; ++j) round(tracking);
          consider(later(tracking.positions(), -delay), limits);
          tracking.update_multipliers();
        }
      }
    }
  }

  /// Error of an answer, by channel.
  [[nodiscard]] std::vector<double> errors(const TrackedSignals& made) const {
    std::vector<double> errors;
    for (std::size_t c = 0; c < made.size(); ++c)
      errors.push_back(rms_over(target_.events, inverse_.in_band(c, left(c, made[c]))) / inverse_.target_rms(c));
    return errors;
  }

  std::vector<double> drive;
  TrackedSignals answer;
  std::vector<double> unlimited;  ///< error without limits, where one was in the way
  int rounds = 0;

 private:
  /// Target less offset less answer.
  [[nodiscard]] std::vector<double> left(std::size_t c, const std::vector<double>& made) const {
    std::vector<double> e = target_.values[c];
    for (std::size_t k = 0; k < e.size(); ++k)
      e[k] -= (made.empty() ? 0.0 : made[k]) + (offset_.empty() ? 0.0 : offset_[c][k]);
    return e;
  }

  double round(Tracking& tracking) {
    const double gain = tracking.iterate();
    ++rounds;
    if (progress_)
      progress_(std::min(0.99, static_cast<double>(rounds) / thresholds::most_iterations), tracking.error());
    return gain;
  }

  void iterate(Tracking& tracking, int most) {
    int waiting = 0;
    for (int i = 0; i < most && waiting < thresholds::iteration_patience; ++i) {
      const double gain = round(tracking);
      waiting = gain < thresholds::least_gain ? waiting + 1 : 0;
      if (tracking.error() < thresholds::exact) break;
    }
  }

  /// Iterations, and the rounds of (2).
  void improve(Tracking& tracking, TrackedSignals& wanted, double delay, const DriveLimits& limits) {
    for (int outer = 0; outer < thresholds::outer_rounds; ++outer) {
      iterate(tracking, outer == 0 ? thresholds::most_iterations : thresholds::rounds_of_outer);
      const double before = best_without_limits_;
      consider(later(tracking.positions(), -delay), limits);
      if (best_without_limits_ < thresholds::exact || !(best_without_limits_ < (1.0 - thresholds::least_gain) * before))
        return;
      for (std::size_t c = 0; c < wanted.size(); ++c) {
        const std::vector<double> more = sensors_(c, inverse_.in_band(c, left(c, last_answer_[c])));
        for (std::size_t k = 0; k < more.size(); ++k) wanted[c][k] += more[k];
      }
      tracking.retarget(wanted);
    }
  }

  [[nodiscard]] double total(const std::vector<double>& error) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < error.size(); ++c) sum += std::pow(target_.channels[c].weight * error[c], 2);
    return std::sqrt(sum);
  }

  /// Takes a drive, as far as the limits let it, if it is the best.
  void consider(std::vector<double> candidate, const DriveLimits& limits) {
    const double begin = candidate.front();
    for (double& value : candidate) value -= begin;
    last_answer_ = model_.answer(candidate);
    double error = total(errors(last_answer_));
    if (error < best_without_limits_) {
      best_without_limits_ = error;
      answer_without_limits_ = last_answer_;
      drive_without_limits_ = candidate;
    }
    TrackedSignals made = last_answer_;
    if (limits_used(candidate, target_.period, limits).largest() > thresholds::usable_limit) {
      candidate = LimitProjection(inverse_, limits, target_.period)(std::move(candidate));
      made = model_.answer(candidate);
      error = total(errors(made));
    }
    if (!(error < best_)) return;
    best_ = error;
    drive = std::move(candidate);
    answer = std::move(made);
  }

  const DriveModel& model_;
  const Target& target_;
  const BandInverse& inverse_;
  const TrackedSignals& offset_;
  SensorInverse sensors_;
  TrackedSignals last_answer_;
  TrackedSignals answer_without_limits_;
  std::vector<double> drive_without_limits_;
  double best_ = std::numeric_limits<double>::infinity(), best_without_limits_ = best_;
  SolveProgress progress_;
};

}  // namespace

TrajectorySolution solve_along_trajectory(const DriveModel& model, const Target& target, const BandInverse& inverse,
                                          const DriveLimits& limits, const SolveInput& input,
                                          const SolveProgress& progress) {
  TrajectorySolver solver(model, target, inverse, input.offset);
  solver.run(input, limits, progress);
  std::vector<double> error = solver.errors(solver.answer);
  return {std::move(solver.drive), std::move(solver.answer), std::move(error), std::move(solver.unlimited),
          solver.rounds};
}

}  // namespace host_sim::replicate
