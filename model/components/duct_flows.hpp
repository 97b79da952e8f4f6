// Flows of the single ducts.
#pragma once

#include <array>
#include <cstddef>

#include "model/components/fdva.hpp"
#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/pair.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// A nonlinear load at the present and the three previous samples, as an explicit step needs it.
template <class S>
struct Recent {
  S now{}, before{}, earlier{}, earliest{};

  constexpr void start(S value) { now = before = earlier = earliest = value; }
  constexpr void push(S value) {
    earliest = earlier;
    earlier = before;
    before = now;
    now = value;
  }
};

/// The factors of ExactDiscretisation::continued, third and fourth order.
template <class S>
[[nodiscard]] RIGTWIN_INLINE std::array<S, 3> newest_three(const Recent<S>& load) {
  return {load.earlier, load.before, load.now};
}
/// The newest as if it were `more` larger.
template <class S>
[[nodiscard]] RIGTWIN_INLINE std::array<S, 3> newest_three(const Recent<S>& load, S more) {
  return {load.earlier, load.before, load.now + more};
}
template <class S>
[[nodiscard]] RIGTWIN_INLINE std::array<S, 4> newest_four(const Recent<S>& load) {
  return {load.earliest, load.earlier, load.before, load.now};
}

/// Flows q_j = A_p u/n + δ_j of the open ducts: the mean follows the piston, the deviations (8b) of Fdva are kept here.
///
/// Switching keeps the flow of a duct that stays open, ends the flow of a closing duct and starts an opening one at
/// zero. The piston then moves with the remaining flow. The kinetic energy ½ I Σ q_j² never rises.
///
/// The share of a closed duct in the mean is 0: its flow, deviation and losses stay exactly zero without a branch.
template <class S>
class DuctFlows {
 public:
  /// One period of (8b): exact in its linear part, fourth order in the losses.
  struct Step {
    Pair<S> decay{};                    ///< e^{−R h/I} [1]
    std::array<Pair<S>, 4> per_loss{};  ///< by which q|q| − 1/n Σ q|q| of four samples enters, oldest first [s/m³]
    S piston_area{};                    ///< A_p [m²]
  };

  [[nodiscard]] static Step step_of(const typename Fdva<S>::Parameters& p, const typename Fdva<S>::Duct& duct,
                                    S period) {
    const Block<S, 1, 1> rate(-duct.laminar_loss / duct.inertance);
    const ExactDiscretisation<S, 1> exact(rate, period);
    const Block<S, 1, 4> columns = exact.template continued<4>(Column<S, 1>(-duct.minor_loss / duct.inertance));
    const auto both = [](S value) { return Pair<S>::both(value); };
    return {both(exact.transition()(0)),
            {both(columns(0)), both(columns(1)), both(columns(2)), both(columns(3))},
            p.piston_area};
  }

  /// Everything at rest, `open` ducts open.
  void start(OpenDucts open) {
    *this = DuctFlows{};
    share_among(open);
  }

  [[nodiscard]] int open_count() const { return count_; }
  [[nodiscard]] OpenDucts open() const { return open_; }
  [[nodiscard]] const Recent<S>& losses() const { return losses_; }  ///< Σ_j q_j|q_j| [m⁶/s²]

  /// Flow of duct j = 0 … 5 [m³/s] when the piston moves at `velocity`.
  [[nodiscard]] S flow(std::size_t j, S velocity, const Step& step) const {
    return velocity * (step.piston_area * at(share_, j)) + at(deviation_, j);
  }

  /// Opens and closes ducts; returns the piston velocity afterwards [m/s].
  [[nodiscard]] S switch_to(OpenDucts open, S velocity, const Step& step) {
    std::array<S, duct_capacity> flow{};
    std::array<Recent<S>, duct_capacity> loss{};
    Recent<S> losses{};
    S sum = S(0);
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      if (!is_open(j) || ((open >> j) & 1) == 0) continue;
      const S share = at(share_, j);
      flow[j] = this->flow(j, velocity, step);
      loss[j] = {at(loss_, j), at(excess_[2], j) + share * losses_.before, at(excess_[1], j) + share * losses_.earlier,
                 at(excess_[0], j) + share * losses_.earliest};
      sum += flow[j];
      losses.now += loss[j].now;
      losses.before += loss[j].before;
      losses.earlier += loss[j].earlier;
      losses.earliest += loss[j].earliest;
    }
    start(open);
    losses_ = losses;
    const S after = sum / step.piston_area;
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      if (!is_open(j)) continue;
      const S share = at(share_, j);
      set(deviation_, j, flow[j] - this->flow(j, after, step));
      set(loss_, j, loss[j].now);
      set(excess_[2], j, loss[j].before - share * losses_.before);
      set(excess_[1], j, loss[j].earlier - share * losses_.earlier);
      set(excess_[0], j, loss[j].earliest - share * losses_.earliest);
    }
    return after;
  }

  /// (8b) over one period, then the losses at the new piston velocity.
  RIGTWIN_INLINE void advance(S velocity, const Step& step) {
    const Pair<S> moved = Pair<S>::both(velocity * step.piston_area);
    const Pair<S> lost_together = Pair<S>::both(losses_.now);
    S sum = S(0);
    for (std::size_t i = 0; i < used_pairs_; ++i) {
      const Pair<S> excess = loss_[i] - lost_together * share_[i];
      const Pair<S> deviation = step.decay * deviation_[i] + step.per_loss[0] * excess_[0][i] +
                                step.per_loss[1] * excess_[1][i] + step.per_loss[2] * excess_[2][i] +
                                step.per_loss[3] * excess;
      const Pair<S> q = moved * share_[i] + deviation;
      const Pair<S> loss = q * abs(q);
      deviation_[i] = deviation;
      excess_[0][i] = excess_[1][i];
      excess_[1][i] = excess_[2][i];
      excess_[2][i] = excess;
      loss_[i] = loss;
      sum += loss[0] + loss[1];
    }
    losses_.push(sum);
  }

  /// ½ I Σ q_j² [J]
  [[nodiscard]] S energy(S velocity, const Step& step, S inertance) const {
    S sum = S(0);
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      const S q = flow(j, velocity, step);
      sum += q * q;
    }
    return S(0.5) * inertance * sum;
  }

  /// Sets deviations below `least` [m³/s] to zero, losses below its square.
  void flush(S least) {
    const auto flush_one = [](S& value, S threshold) {
      value = select(value < threshold && value > -threshold, S(0), value);
    };
    const auto flush_each = [&](PerDuct& values, S threshold) {
      for (std::size_t j = 0; j < duct_capacity; ++j) {
        S value = at(values, j);
        flush_one(value, threshold);
        set(values, j, value);
      }
    };
    flush_each(deviation_, least);
    flush_each(loss_, least * least);
    for (PerDuct& excess : excess_) flush_each(excess, least * least);
    for (S* loss : {&losses_.now, &losses_.before, &losses_.earlier, &losses_.earliest})
      flush_one(*loss, least * least);
  }

 private:
  using PerDuct = std::array<Pair<S>, duct_capacity / 2>;

  [[nodiscard]] bool is_open(std::size_t j) const { return ((open_ >> j) & 1) != 0; }
  [[nodiscard]] static S at(const PerDuct& values, std::size_t j) { return values[j / 2][j % 2]; }
  static void set(PerDuct& values, std::size_t j, S value) {
    Pair<S>& pair = values[j / 2];
    pair = j % 2 == 0 ? Pair<S>(value, pair[1]) : Pair<S>(pair[0], value);
  }

  /// The open ducts carry equal parts of the mean.
  void share_among(OpenDucts open) {
    open_ = open;
    count_ = model::count(open);
    used_pairs_ = 0;
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      set(share_, j, is_open(j) ? S(1) / S(count_) : S(0));
      if (is_open(j)) used_pairs_ = j / 2 + 1;
    }
  }

  PerDuct share_{};                  ///< 1/n of an open duct, 0 of a closed one
  PerDuct deviation_{};              ///< δ_j [m³/s]
  PerDuct loss_{};                   ///< q_j|q_j| now [m⁶/s²]
  std::array<PerDuct, 3> excess_{};  ///< q_j|q_j| − 1/n Σ q|q| at the three samples before, oldest first [m⁶/s²]
  Recent<S> losses_{};
  std::size_t used_pairs_ = 0;  ///< pairs of ducts up to the last open one
  int count_ = 0;
  OpenDucts open_ = 0;
};

}  // namespace model
