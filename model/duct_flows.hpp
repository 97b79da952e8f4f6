// The flows of the single ducts.
#pragma once

#include <array>
#include <cstddef>

#include "model/exact_discretisation.hpp"
#include "model/fdva.hpp"

namespace model {

/// A quantity now and at the two samples before: what a third-order explicit step needs of a nonlinear load.
template <class S>
struct Recent {
  S now{}, before{}, earlier{};

  constexpr void start(S value) { now = before = earlier = value; }
  constexpr void push(S value) {
    earlier = before;
    before = now;
    now = value;
  }
};

/// Adds columns · [now, before, earlier] to x.
template <class S, int N>
void add_continued(Column<S, N>& x, const Block<S, N, 3>& columns, const Recent<S>& load) {
  x += columns.col(0) * load.now;
  x += columns.col(1) * load.before;
  x += columns.col(2) * load.earlier;
}

/// Flows q_j = A_p u/n + δ_j of the open ducts: the mean follows the piston, the deviations (8b) of Fdva are kept here.
///
/// Opening and closing keeps every flow that goes on, ends the flow of a closing duct and starts an opening one at
/// zero; the piston then moves with what still flows. Kinetic energy ½ I Σ q_j² can only fall by it.
template <class S>
class DuctFlows {
 public:
  /// One period of (8b): exact in its linear part, third order in the losses.
  struct Step {
    S decay{};                    ///< e^{−R h/I} [1]
    std::array<S, 3> per_loss{};  ///< by which q|q| of now, before, earlier enters [s/m³]
    S per_velocity{};             ///< A_p [m²]
  };

  [[nodiscard]] static Step step_of(const typename Fdva<S>::Parameters& p, const typename Fdva<S>::Duct& duct,
                                    S period) {
    const Block<S, 1, 1> rate(-duct.laminar_loss / duct.inertance);
    const ExactDiscretisation<S, 1> exact(rate, period);
    const Block<S, 1, 3> columns = exact.continued(Column<S, 1>(-duct.minor_loss / duct.inertance));
    return {exact.transition()(0), {columns(0), columns(1), columns(2)}, p.piston_area};
  }

  /// Everything at rest, `open` ducts open.
  void start(OpenDucts open) {
    *this = DuctFlows{};
    set_list(open);
  }

  [[nodiscard]] int open_count() const { return count_; }
  [[nodiscard]] OpenDucts open() const { return open_; }
  [[nodiscard]] const Recent<S>& losses() const { return losses_; }  ///< Σ_j q_j|q_j| [m⁶/s²]

  /// Flow of duct j = 0 … 5 [m³/s] when the piston moves at `velocity`.
  [[nodiscard]] S flow(std::size_t j, S velocity, const Step& step) const {
    return ((open_ >> j) & 1) != 0 ? mean(velocity, step) + deviation_[j] : S(0);
  }

  /// Opens and closes ducts; returns the piston velocity afterwards [m/s].
  [[nodiscard]] S switch_to(OpenDucts open, S velocity, const Step& step) {
    std::array<S, duct_capacity> flow{};
    S sum = S(0);
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      const bool stays = ((open_ >> j) & (open >> j) & 1) != 0;
      flow[j] = stays ? this->flow(j, velocity, step) : S(0);
      sum += flow[j];
      if (!stays) loss_[j] = Recent<S>{};
    }
    set_list(open);
    const S after = sum / step.per_velocity;
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      deviation_[j] = ((open >> j) & 1) != 0 ? flow[j] - mean(after, step) : S(0);
    }
    losses_ = Recent<S>{};
    for (const auto& loss : loss_) {
      losses_.now += loss.now;
      losses_.before += loss.before;
      losses_.earlier += loss.earlier;
    }
    return after;
  }

  /// (8b) over one period, then the losses at the new piston velocity.
  void advance(S velocity, const Step& step) {
    const S share = share_;
    const S flow = mean(velocity, step);
    S sum = S(0);
    for (int i = 0; i < count_; ++i) {
      const auto j = list_[static_cast<std::size_t>(i)];
      Recent<S>& loss = loss_[j];
      const S deviation = step.decay * deviation_[j] + step.per_loss[0] * (loss.now - losses_.now * share) +
                          step.per_loss[1] * (loss.before - losses_.before * share) +
                          step.per_loss[2] * (loss.earlier - losses_.earlier * share);
      const S q = flow + deviation;
      const S lost = q * (q < S(0) ? -q : q);
      deviation_[j] = deviation;
      loss.push(lost);
      sum += lost;
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

  /// Sets everything below `least` to zero.
  void flush(S least) {
    for (S& d : deviation_) {
      if (d < least && d > -least) d = S(0);
    }
  }

 private:
  [[nodiscard]] S mean(S velocity, const Step& step) const { return step.per_velocity * velocity * share_; }

  void set_list(OpenDucts open) {
    open_ = open;
    count_ = 0;
    for (std::size_t j = 0; j < duct_capacity; ++j) {
      if (((open >> j) & 1) != 0) list_[static_cast<std::size_t>(count_++)] = static_cast<unsigned char>(j);
    }
    share_ = count_ == 0 ? S(0) : S(1) / S(count_);
  }

  std::array<S, duct_capacity> deviation_{};
  std::array<Recent<S>, duct_capacity> loss_{};
  Recent<S> losses_{};
  S share_{};
  std::array<unsigned char, duct_capacity> list_{};
  int count_ = 0;
  OpenDucts open_ = 0;
};

}  // namespace model
