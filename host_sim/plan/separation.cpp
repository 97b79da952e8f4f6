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
double squared_left(const Rehearsal& rehearsal, const Change& a, const Direction& b) {
  const double whole = rehearsal.product(a, a);
  const double along = rehearsal.product(a, b.change), square = rehearsal.product(b.change, b.change);
  if (!(square > 0.0) || (along <= 0.0 && !b.of_either_sign)) return whole;
  return whole - along * along / square;
}

/// Fits the parameters of one effect to a change. Coordinates are zero at the start: logarithms of values that have one
/// sign, shares of the distance to the neutral value of others.
class RivalFit {
 public:
  RivalFit(const Rehearsal& rehearsal, const Change& wanted, firmware::PlacedEffect start,
           const Eigen::VectorXf* absent)
      : rehearsal_(rehearsal), wanted_(wanted), start_(std::move(start)), absent_(absent) {}

  /// Least squares that were reached; nullopt: the model refuses the start.
  [[nodiscard]] std::optional<double> least() const {
    Eigen::VectorXd at = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(start_.values.size()));
    std::optional<Change> rest = rest_at(at);
    if (!rest) return std::nullopt;
    double squares = rehearsal_.product(*rest, *rest), damping = first_damping;
    for (int i = 0; i < thresholds::refit_steps; ++i) {
      const std::optional<Slopes> slopes = slopes_at(at, *rest);
      if (!slopes) break;
      const double before = squares;
      for (int trial = 0; trial < trials && squares == before; ++trial) {
        Eigen::MatrixXd h = slopes->square;
        h.diagonal() *= 1.0 + damping;
        const Eigen::VectorXd next = at + h.ldlt().solve(slopes->along).cwiseMax(-longest_step).cwiseMin(longest_step);
        std::optional<Change> there = next.allFinite() ? rest_at(next) : std::nullopt;
        const double reached = there ? rehearsal_.product(*there, *there) : before;
        damping *= reached < before ? 0.2 : 5.0;
        if (!(reached < before)) continue;
        at = next;
        rest = std::move(there);
        squares = reached;
      }
      if (squares > before * (1.0 - thresholds::refit_gain)) break;
    }
    return squares;
  }

 private:
  /// Secants, not derivatives: a law with a corner has none. Half and twice: no difference for the rigs of
  /// host_sim/rigs.
  static constexpr double secant = 0.05;
  static constexpr double first_damping = 1e-2, longest_step = 1.6;  // a factor of five
  static constexpr int trials = 4;

  struct Slopes {
    Eigen::MatrixXd square;  ///< ⟨b′, b′⟩
    Eigen::VectorXd along;   ///< ⟨b′, a − b⟩
  };

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

  [[nodiscard]] std::optional<Slopes> slopes_at(const Eigen::VectorXd& at, const Change& rest) const {
    std::vector<Change> columns;
    for (Eigen::Index p = 0; p < at.size(); ++p) {
      Eigen::VectorXd beside = at;
      beside[p] += secant;
      std::optional<Change> there = rest_at(beside);
      if (!there) return std::nullopt;
      columns.push_back(difference(rest, *there));
      columns.back().whitened /= static_cast<float>(secant);
      columns.back().tolerated /= secant;
    }
    Slopes slopes{Eigen::MatrixXd(at.size(), at.size()), Eigen::VectorXd(at.size())};
    for (Eigen::Index p = 0; p < at.size(); ++p) {
      const Change& own = columns[static_cast<std::size_t>(p)];
      slopes.along[p] = rehearsal_.product(own, rest);
      for (Eigen::Index q = 0; q <= p; ++q) {
        slopes.square(p, q) = slopes.square(q, p) = rehearsal_.product(own, columns[static_cast<std::size_t>(q)]);
      }
      slopes.square(p, p) += 1e-12 * slopes.square(p, p) + 1e-30;  // a parameter that does nothing stays
    }
    return slopes;
  }

  const Rehearsal& rehearsal_;
  const Change& wanted_;
  firmware::PlacedEffect start_;
  const Eigen::VectorXf* absent_;
};

}  // namespace

double left_of(const Rehearsal& rehearsal, const Change& a, const std::vector<Direction>& rival) {
  double least = rehearsal.product(a, a);
  for (const Direction& b : rival) least = std::min(least, squared_left(rehearsal, a, b));
  return std::sqrt(std::max(0.0, least));
}

double left_when_refitted(const Rehearsal& rehearsal, const Change& a, const Rival& rival) {
  const double whole = rehearsal.product(a, a);
  double least = whole;
  const Direction* nearest = nullptr;
  for (const Direction& b : rival.directions) {
    const double left = squared_left(rehearsal, a, b);
    if (left >= least || !b.effect) continue;
    least = left;
    nearest = &b;
  }
  const bool alike = least < thresholds::unlike * thresholds::unlike * whole;
  if (nearest != nullptr && alike && !nearest->effect->values.empty()) {
    std::optional<Eigen::VectorXf> absent;
    if (rival.absent) absent = rehearsal.residuals_with(*rival.absent);
    const RivalFit fit(rehearsal, a, *nearest->effect, absent ? &*absent : nullptr);
    if (const std::optional<double> reached = fit.least()) least = std::min(least, *reached);
  }
  return std::sqrt(std::max(0.0, least));
}

std::optional<Change> strong_change(const Rehearsal& rehearsal, const Rival& rival) {
  if (!rival.strong) return std::nullopt;
  if (!rival.absent) return rehearsal.change(*rival.strong);
  const auto absent = rehearsal.residuals_with(*rival.absent);
  return absent ? rehearsal.change(*rival.strong, &*absent) : std::nullopt;
}

std::vector<Direction> directions_of(const Rehearsal& rehearsal, const Rival& rival) {
  std::vector<Direction> directions;
  const bool signs = either_sign(rival.subject);
  std::optional<Eigen::VectorXf> absent;
  if (rival.absent) absent = rehearsal.residuals_with(*rival.absent);
  const auto add = [&](const firmware::PlacedEffect& effect) {
    if (auto change = rehearsal.change(effect, absent ? &*absent : nullptr)) {
      directions.push_back({std::move(*change), signs, effect});
    }
  };
  if (rival.strong) add(*rival.strong);
  add(rival.subject.placed());
  if (rival.subject.values.size() > 1) {
    for (const auto& values : rival.subject.starts) add({rival.subject.entry, rival.subject.channel, values});
  }
  return directions;
}

}  // namespace host_sim::plan
