#include "host_sim/plan/separation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/plan/thresholds.hpp"

namespace host_sim::plan {
namespace {

bool either_sign(const Subject& subject) {
  return std::all_of(subject.entry->parameters.begin(), subject.entry->parameters.end(),
                     [](const model::EffectParameter& p) { return p.lower < 0.0; });
}

/// Squared (1) of one direction.
double squared_left(const Rehearsal& rehearsal, const Change& a, double whole, const Direction& b) {
  if (!(b.square > 0.0)) return whole;
  const double along = rehearsal.product(a, b.change);
  if (along <= 0.0 && !b.of_either_sign) return whole;
  return whole - along * along / b.square;
}

/// Fits the parameters of one effect to a change. Coordinates are zero at the start: logarithms of values that have one
/// sign, shares of the distance to the neutral value of others. Slopes are secants, one for each parameter at the start;
/// each further simulation corrects them along its step (C. G. Broyden, Math. Comp. 19, 1965).
class RivalFit {
 public:
  RivalFit(const Rehearsal& rehearsal, const Change& wanted, const Direction& start, const Eigen::VectorXf* absent)
      : rehearsal_(rehearsal),
        wanted_(wanted),
        start_(*start.effect),
        absent_(absent),
        at_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(start_.values.size()))),
        rest_(difference(wanted, start.change)) {}

  /// Least squares that were reached.
  [[nodiscard]] double least() {
    double squares = rehearsal_.product(rest_, rest_), damping = first_damping;
    if (!take_secants()) return squares;
    for (int i = 0; i < thresholds::refit_steps; ++i) {
      const double before = squares;
      for (int trial = 0; trial < trials && squares == before; ++trial) {
        const Eigen::VectorXd step = step_with(damping);
        std::optional<Change> there = step.allFinite() ? rest_at(at_ + step) : std::nullopt;
        const double reached = there ? rehearsal_.product(*there, *there) : before;
        damping *= reached < before ? 0.2 : 5.0;
        if (there) correct(step, *there);
        if (!(reached < before)) continue;
        at_ += step;
        rest_ = std::move(*there);
        squares = reached;
      }
      if (squares > before * (1.0 - thresholds::refit_gain)) break;
    }
    return squares;
  }

 private:
  /// Half and twice: no difference for the rigs of host_sim/rigs.
  static constexpr double secant = 0.05;
  static constexpr double first_damping = 1e-2, longest_step = 1.6;  // a factor of five
  static constexpr int trials = 4;

  [[nodiscard]] std::optional<Change> rest_at(const Eigen::VectorXd& at) const {
    firmware::PlacedEffect effect = start_;
    for (std::size_t p = 0; p < effect.values.size(); ++p) {
      const model::EffectParameter& card = effect.entry->parameters[p];
      const double by = at[static_cast<Eigen::Index>(p)], start = start_.values[p];
      const double value = card.lower < 0.0 ? card.neutral + (1.0 + by) * (start - card.neutral) : start * std::exp(by);
      effect.values[p] = std::clamp(value, card.lower, card.upper);
    }
    const std::optional<Change> made = rehearsal_.change(effect, absent_);
    if (!made) return std::nullopt;
    return difference(wanted_, *made);
  }

  /// b′, a column each. A law with a corner has no derivatives.
  [[nodiscard]] bool take_secants() {
    for (Eigen::Index p = 0; p < at_.size(); ++p) {
      Eigen::VectorXd beside = at_;
      beside[p] += secant;
      std::optional<Change> there = rest_at(beside);
      if (!there) return false;
      columns_.push_back(difference(rest_, *there));
      columns_.back().whitened /= static_cast<float>(secant);
      columns_.back().tolerated /= secant;
    }
    return true;
  }

  /// Gauss–Newton's step, damped.
  [[nodiscard]] Eigen::VectorXd step_with(double damping) const {
    Eigen::MatrixXd h(at_.size(), at_.size());
    Eigen::VectorXd along(at_.size());
    for (Eigen::Index p = 0; p < at_.size(); ++p) {
      const Change& own = columns_[static_cast<std::size_t>(p)];
      along[p] = rehearsal_.product(own, rest_);
      for (Eigen::Index q = 0; q <= p; ++q) {
        h(p, q) = h(q, p) = rehearsal_.product(own, columns_[static_cast<std::size_t>(q)]);
      }
      h(p, p) += 1e-12 * h(p, p) + 1e-30;  // a parameter that does nothing stays
    }
    h.diagonal() *= 1.0 + damping;
    return h.ldlt().solve(along).cwiseMax(-longest_step).cwiseMin(longest_step);
  }

  /// Of all columns nearest to those before, the ones that say what the step did.
  void correct(const Eigen::VectorXd& step, const Change& there) {
    Change wrong = difference(rest_, there);
    for (Eigen::Index p = 0; p < step.size(); ++p) {
      const Change& own = columns_[static_cast<std::size_t>(p)];
      wrong.whitened -= static_cast<float>(step[p]) * own.whitened;
      wrong.tolerated -= step[p] * own.tolerated;
    }
    for (Eigen::Index p = 0; p < step.size(); ++p) {
      const double share = step[p] / step.squaredNorm();
      columns_[static_cast<std::size_t>(p)].whitened += static_cast<float>(share) * wrong.whitened;
      columns_[static_cast<std::size_t>(p)].tolerated += share * wrong.tolerated;
    }
  }

  const Rehearsal& rehearsal_;
  const Change& wanted_;
  firmware::PlacedEffect start_;
  const Eigen::VectorXf* absent_;
  Eigen::VectorXd at_;
  Change rest_;
  std::vector<Change> columns_{};
};

}  // namespace

double left_of(const Rehearsal& rehearsal, const Change& a, double whole, const std::vector<Direction>& rival) {
  double least = whole;
  for (const Direction& b : rival) least = std::min(least, squared_left(rehearsal, a, whole, b));
  return std::sqrt(std::max(0.0, least));
}

double left_of_several(const Rehearsal& rehearsal, Change a, const std::vector<const Rival*>& rivals, int times) {
  double whole = rehearsal.product(a, a);
  for (int i = 0; i < times; ++i) {
    const Direction* nearest = nullptr;
    double least = whole;
    for (const Rival* rival : rivals) {
      for (const Direction& b : rival->directions) {
        const double left = squared_left(rehearsal, a, whole, b);
        if (left >= least) continue;
        least = left;
        nearest = &b;
      }
    }
    if (nearest == nullptr) break;
    const double size = rehearsal.product(a, nearest->change) / nearest->square;
    a.whitened -= static_cast<float>(size) * nearest->change.whitened;
    a.tolerated -= size * nearest->change.tolerated;
    whole = least;
  }
  return std::sqrt(std::max(0.0, whole));
}

double left_when_refitted(const Rehearsal& rehearsal, const Change& a, const Rival& rival) {
  const double whole = rehearsal.product(a, a);
  double least = whole;
  const Direction* nearest = nullptr;
  for (const Direction& b : rival.directions) {
    const double left = squared_left(rehearsal, a, whole, b);
    if (left >= least || !b.effect) continue;
    least = left;
    nearest = &b;
  }
  const bool alike = least < thresholds::unlike * thresholds::unlike * whole;
  if (nearest != nullptr && alike && !nearest->effect->values.empty()) {
    RivalFit fit(rehearsal, a, *nearest, rival.without ? &*rival.without : nullptr);
    least = std::min(least, fit.least());
  }
  return std::sqrt(std::max(0.0, least));
}

std::optional<Change> strong_change(const Rehearsal& rehearsal, const Rival& rival) {
  if (!rival.strong) return std::nullopt;
  if (!rival.absent) return rehearsal.change(*rival.strong);
  const auto absent = rehearsal.residuals_with(*rival.absent);
  return absent ? rehearsal.change(*rival.strong, &*absent) : std::nullopt;
}

void add_directions(const Rehearsal& rehearsal, Rival& rival) {
  const bool signs = either_sign(rival.subject);
  if (rival.absent) rival.without = rehearsal.residuals_with(*rival.absent);
  const auto add = [&](const firmware::PlacedEffect& effect) {
    if (auto change = rehearsal.change(effect, rival.without ? &*rival.without : nullptr)) {
      const double square = rehearsal.product(*change, *change);
      rival.directions.push_back({std::move(*change), signs, square, effect});
    }
  };
  if (rival.strong) add(*rival.strong);
  add(rival.subject.placed());
  if (rival.subject.values.size() > 1) {
    for (const auto& values : rival.subject.starts) add({rival.subject.entry, rival.subject.channel, values});
  }
}

}  // namespace host_sim::plan
