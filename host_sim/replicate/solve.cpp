#include "host_sim/replicate/solve.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "host_sim/replicate/along_trajectory.hpp"
#include "host_sim/replicate/motion_inverse.hpp"
#include "host_sim/replicate/thresholds.hpp"

namespace host_sim::replicate {
namespace {

using Signals = std::vector<std::vector<double>>;  // by channel

/// The pieces of a drive: Hann windows that overlap by half.
class Pieces {
 public:
  Pieces(std::size_t size, double period)
      : half_(std::max<std::size_t>(16, static_cast<std::size_t>(0.5 * thresholds::piece / period))), size_(size) {}

  [[nodiscard]] std::size_t count() const { return size_ / half_ + 2; }
  /// Samples of piece j.
  [[nodiscard]] Part part(std::size_t j) const {
    const std::size_t from = j == 0 ? 0 : (j - 1) * half_;
    return {std::min(from, size_), std::min((j + 1) * half_, size_)};
  }
  [[nodiscard]] double weight(std::size_t j, std::size_t k) const {
    const double x =
        (static_cast<double>(k) - static_cast<double>(j) * static_cast<double>(half_)) / static_cast<double>(half_);
    return 0.5 + 0.5 * std::cos(0.5 * full_turn * std::clamp(x, -1.0, 1.0));
  }

 private:
  std::size_t half_, size_;
};

struct Secant {
  std::vector<double> drive;
  Signals error;
};

/// The best that was found for a piece, with the step length that it bears.
struct PieceState {
  double cost = INFINITY;
  double damping = 1.0;
  int failures = 0;
  std::vector<double> drive;
  Signals error;
};

class Iteration {
 public:
  Iteration(const DriveModel& model, const Target& target, const BandInverse& inverse, const MotionInverse* motion,
            LimitProjection* limits, const Signals& offset)
      : model_(model),
        target_(target),
        inverse_(inverse),
        motion_(motion),
        limits_(limits),
        offset_(offset),
        pieces_(target.size(), target.period) {}

  /// Rounds on the rig with its corners at `share`.
  void run(double share, int most, int patience, const SolveProgress& progress) {
    const auto rig = with_corners(model_.rig(), share);
    secants_.clear();
    states_.assign(pieces_.count(), {});
    has_last_ = false;
    best_cost_ = INFINITY;
    double at_stop = INFINITY;
    int waiting = 0;
    for (int round = 0; round < most; ++round, ++rounds) {
      evaluate(rig);
      if (cost_ < best_cost_) {
        best = drive;
        best_answer = answer_;
        best_cost_ = cost_;
      }
      if (progress) progress(static_cast<double>(round) / most, std::sqrt(cost_));
      if (best_cost_ < at_stop * (1.0 - thresholds::least_gain) * (1.0 - thresholds::least_gain)) {
        at_stop = best_cost_;
        waiting = 0;
      } else if (++waiting >= patience) {
        break;
      }
      if (std::sqrt(best_cost_) < thresholds::exact) break;
      if (round + 1 < most) step(rig);
    }
    drive = best;
  }

  std::vector<double> drive;
  DriveModel::Answer best_answer;
  std::vector<double> best;
  int rounds = 0;

 private:
  void evaluate(const model::RigParameters<double>& rig) {
    answer_ = model_.answer(rig, drive);
    Signals error(answer_.size());
    cost_ = 0.0;
    for (std::size_t c = 0; c < answer_.size(); ++c) {
      std::vector<double> e = target_.values[c];
      for (std::size_t k = 0; k < e.size(); ++k) e[k] -= answer_[c][k] + (offset_.empty() ? 0.0 : offset_[c][k]);
      error[c] = inverse_.in_band(c, e);
      const double rms = rms_over(target_.events, error[c]);
      cost_ += inverse_.weight(c) * rms * rms;
    }
    if (!std::isfinite(cost_)) cost_ = INFINITY;
    if (has_last_ && std::isfinite(cost_)) {
      Secant secant{drive, error};
      for (std::size_t k = 0; k < drive.size(); ++k) secant.drive[k] -= last_drive_[k];
      for (std::size_t c = 0; c < error.size(); ++c) {
        for (std::size_t k = 0; k < drive.size(); ++k) secant.error[c][k] -= error_[c][k];
      }
      secants_.push_back(std::move(secant));
      if (secants_.size() > thresholds::secants) secants_.pop_front();
    }
    error_ = std::move(error);
    last_drive_ = drive;
    has_last_ = true;
    judge_pieces();
  }

  /// Each piece keeps its best drive. One that fails thrice gives it up: its neighbours have changed since.
  void judge_pieces() {
    for (std::size_t j = 0; j < pieces_.count(); ++j) {
      const Part part = pieces_.part(j);
      PieceState& state = states_[j];
      double cost = 0.0;
      for (std::size_t c = 0; c < error_.size(); ++c) {
        for (std::size_t k = part.from; k < part.to; ++k) {
          cost += inverse_.weight(c) * std::pow(pieces_.weight(j, k) * error_[c][k], 2);
        }
      }
      const bool better = cost < state.cost;
      if (!better && ++state.failures < thresholds::most_failures) {
        state.damping = std::max(0.1, 0.5 * state.damping);
        continue;
      }
      state.damping = better ? std::min(1.0, 1.5 * state.damping) : state.damping;
      state.failures = 0;
      state.cost = cost;
      state.drive.assign(drive.begin() + static_cast<std::ptrdiff_t>(part.from),
                         drive.begin() + static_cast<std::ptrdiff_t>(part.to));
      state.error.resize(error_.size());
      for (std::size_t c = 0; c < error_.size(); ++c) {
        state.error[c].assign(error_[c].begin() + static_cast<std::ptrdiff_t>(part.from),
                              error_[c].begin() + static_cast<std::ptrdiff_t>(part.to));
      }
    }
  }

  void step(const model::RigParameters<double>& rig) {
    Signals left(error_.size(), std::vector<double>(drive.size(), 0.0));
    std::vector<double> next(drive.size(), 0.0);
    const auto m = static_cast<Eigen::Index>(secants_.size());
    for (std::size_t j = 0; j < pieces_.count(); ++j) {
      const Part part = pieces_.part(j);
      if (part.from >= part.to) continue;
      const PieceState& state = states_[j];
      const auto length = static_cast<Eigen::Index>(part.to - part.from);
      Eigen::VectorXd weight(length);
      for (Eigen::Index k = 0; k < length; ++k) weight(k) = pieces_.weight(j, part.from + static_cast<std::size_t>(k));
      const Eigen::VectorXd gamma = m > 0 ? coefficients(part, state, weight) : Eigen::VectorXd();
      for (std::size_t k = part.from; k < part.to; ++k) {
        const std::size_t at = k - part.from;
        const double w = weight(static_cast<Eigen::Index>(at));
        next[k] += w * state.drive[at];
        for (std::size_t c = 0; c < left.size(); ++c) left[c][k] += w * state.damping * state.error[c][at];
      }
      for (Eigen::Index i = 0; i < gamma.size(); ++i) {
        const Secant& secant = secants_[static_cast<std::size_t>(i)];
        for (std::size_t k = part.from; k < part.to; ++k) {
          const double share = state.damping * weight(static_cast<Eigen::Index>(k - part.from)) * gamma(i);
          next[k] -= share * secant.drive[k];
          for (std::size_t c = 0; c < left.size(); ++c) left[c][k] -= share * secant.error[c][k];
        }
      }
    }
    const std::vector<double> correction = motion_ != nullptr ? motion_->drive(rig, next, left) : inverse_.drive(left);
    for (std::size_t k = 0; k < drive.size(); ++k) drive[k] = next[k] + correction[k];
    if (limits_ != nullptr) drive = (*limits_)(std::move(drive));
  }

  /// γ of (2). Secants differ in size by orders of magnitude: each is scaled to one, the ridge is relative to that.
  [[nodiscard]] Eigen::VectorXd coefficients(const Part& part, const PieceState& state,
                                             const Eigen::VectorXd& weight) const {
    const auto m = static_cast<Eigen::Index>(secants_.size());
    const Eigen::Index length = weight.size();
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(m, m), columns(length, m);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(m);
    for (std::size_t c = 0; c < error_.size(); ++c) {
      for (Eigen::Index i = 0; i < m; ++i) {
        const double* const values = secants_[static_cast<std::size_t>(i)].error[c].data() + part.from;
        columns.col(i) = Eigen::Map<const Eigen::VectorXd>(values, length).cwiseProduct(weight);
      }
      const Eigen::VectorXd wanted =
          Eigen::Map<const Eigen::VectorXd>(state.error[c].data(), length).cwiseProduct(weight);
      gram += inverse_.weight(c) * columns.transpose() * columns;
      right += inverse_.weight(c) * columns.transpose() * wanted;
    }
    Eigen::VectorXd scale = gram.diagonal().cwiseSqrt();
    for (Eigen::Index i = 0; i < m; ++i) scale(i) = scale(i) > 0.0 ? 1.0 / scale(i) : 0.0;
    gram = scale.asDiagonal() * gram * scale.asDiagonal();
    gram.diagonal().array() += thresholds::ridge;
    const Eigen::VectorXd gamma = scale.asDiagonal() * gram.ldlt().solve(scale.asDiagonal() * right);
    return gamma.allFinite() ? gamma : Eigen::VectorXd::Zero(m);
  }

  const DriveModel& model_;
  const Target& target_;
  const BandInverse& inverse_;
  const MotionInverse* motion_;
  LimitProjection* limits_;
  const Signals& offset_;
  Pieces pieces_;
  DriveModel::Answer answer_;
  Signals error_;
  double cost_ = INFINITY, best_cost_ = INFINITY;
  std::vector<double> last_drive_;
  bool has_last_ = false;
  std::deque<Secant> secants_;
  std::vector<PieceState> states_;
};

std::vector<double> errors_of(const Target& target, const BandInverse& inverse, const Signals& answer,
                              const Signals& offset) {
  std::vector<double> errors;
  for (std::size_t c = 0; c < answer.size(); ++c) {
    std::vector<double> e = target.values[c];
    for (std::size_t k = 0; k < e.size(); ++k) e[k] -= answer[c][k] + (offset.empty() ? 0.0 : offset[c][k]);
    errors.push_back(rms_over(target.events, inverse.in_band(c, e)) / inverse.target_rms(c));
  }
  return errors;
}

}  // namespace

Solution solve(const DriveModel& model, const Target& target, const BandInverse& inverse, const DriveLimits& limits,
               const SolveInput& input, const SolveProgress& progress) {
  Signals wanted = target.values;
  for (std::size_t c = 0; c < wanted.size() && !input.offset.empty(); ++c) {
    for (std::size_t k = 0; k < wanted[c].size(); ++k) wanted[c][k] -= input.offset[c][k];
  }
  std::vector<double> start = input.start.empty() ? inverse.drive(wanted) : input.start;
  LimitProjection projection(inverse, limits, target.period);
  std::optional<MotionInverse> motion;
  if (MotionInverse::possible(model)) motion.emplace(model, inverse);
  Iteration iteration(model, target, inverse, motion ? &*motion : nullptr, &projection, input.offset);
  iteration.drive = projection(start);
  if (input.start.empty() && has_corners(model.rig())) {
    for (const double share : thresholds::corner_shares)
      iteration.run(share, thresholds::rounds_of_share, thresholds::patience, progress);
  }
  iteration.run(1.0, thresholds::most_rounds, thresholds::patience, progress);
  Solution solution;
  solution.drive = iteration.best;
  solution.answer = iteration.best_answer;
  solution.rounds = iteration.rounds;
  solution.error = errors_of(target, inverse, solution.answer, input.offset);
  const auto total = [&](const std::vector<double>& error) {
    double sum = 0.0;
    for (std::size_t c = 0; c < error.size(); ++c) sum += std::pow(target.channels[c].weight * error[c], 2);
    return std::sqrt(sum);
  };
  std::vector<double> unlimited_along;
  if (!(total(solution.error) < thresholds::secants_fail) && has_corners(model.rig())) {
    TrajectorySolution along = solve_along_trajectory(model, target, inverse, limits, input, progress);
    solution.rounds += along.rounds;
    if (!along.drive.empty() && total(along.error) < total(solution.error)) {
      solution.drive = std::move(along.drive);
      solution.answer = std::move(along.answer);
      solution.error = std::move(along.error);
      unlimited_along = std::move(along.error_unlimited);
    }
  }
  solution.used = limits_used(solution.drive, target.period, limits);
  const model::Channel force =
      model.rig().kind == model::RigKind::quarter_car ? model::Channel::F_w : model::Channel::F;
  const Response loads = model.response(solution.drive, {force});
  for (const double f : loads[index(force)])
    solution.used.force = std::max(solution.used.force, std::abs(f) / limits.force);
  if (projection.acted()) {
    Iteration free(model, target, inverse, motion ? &*motion : nullptr, nullptr, input.offset);
    free.drive = std::move(start);
    free.run(1.0, thresholds::most_rounds, thresholds::patience, {});
    solution.error_unlimited = errors_of(target, inverse, free.best_answer, input.offset);
    if (!unlimited_along.empty() && total(unlimited_along) < total(solution.error_unlimited))
      solution.error_unlimited = std::move(unlimited_along);
    if (total(solution.error_unlimited) > total(solution.error)) solution.error_unlimited = solution.error;
  }
  return solution;
}

}  // namespace host_sim::replicate
