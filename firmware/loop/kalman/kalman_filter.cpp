#include "firmware/loop/kalman/kalman_filter.hpp"

#include <cmath>

#include "firmware/loop/kalman/square_matrices.hpp"

namespace firmware {
namespace {

using model::Channel;
using model::CoreIndex;
constexpr int slot_count = SteadyGains::lags + 1;

// (5): thresholds in README.md.
constexpr double widest_noise = 5.0;  // m
constexpr double wide_time = 0.05;    // [s] that jumps are expected to go on

}  // namespace

KalmanFilter::KalmanFilter(const EstimatorEquations& equations, SteadyGains& gains, double period)
    : states_(equations.states()),
      channels_(equations.channels()),
      longest_lag_(gains.longest_lag()),
      period_(period),
      monitor_(equations.channels(), period, equations.settings().false_alarms) {
  if (equations.ducts() > 0) flow_step_ = equations.flow_step(period);
  for (int i = 0; i < model::core_states; ++i) core_[static_cast<std::size_t>(i)] = equations.core(i);
  for (int i = 0; i < channels_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    const Channel channel = equations.channel(i);
    channel_[c] = model::index(channel);
    offset_[c] = equations.path(channel).offset;
    gain_[c] = equations.path(channel).gain;
    delay_[c] = equations.path(channel).delay;
    const double rms = equations.settings().noise[channel_[c]];
    variance_[c] = rms * rms;
    feedthrough_[c] = equations.feedthrough(channel);
  }
  const EstimatorVector none = EstimatorVector::Zero();
  for (int open = 0; open <= equations.ducts(); ++open) {
    PerCount& m = by_count_[static_cast<std::size_t>(open)];
    const EstimatorMatrix a = equations.matrix(open);
    {
      const model::ExactDiscretisation<double, estimator_states> step(a, period);
      m.transition = step.transition();
      m.losses = step.continued<4>(equations.rates(none, open, 0.0, 0.0, 1.0));
      m.actuator = step.straight(equations.rates(none, open, 0.0, 1.0));
    }
    gains.compute(open);
    if (gains.unobservable() >= 0 && unobservable_.state < 0) unobservable_ = {gains.unobservable(), open};
    for (int i = 0; i < channels_; ++i) {
      auto& rows = m.rows[static_cast<std::size_t>(i)];
      rows[0] = equations.row(equations.channel(i), open, true);
      for (int order = 1; order < 3; ++order) {
        EstimatorVector& row = rows[static_cast<std::size_t>(order)];
        row.setZero();
        for (int j = 0; j < states_; ++j) {
          for (int k = 0; k < states_; ++k) row(j) += rows[static_cast<std::size_t>(order) - 1](k) * a(k, j);
          row(j) /= order;
        }
      }
    }
    m.noise = gains.noise();
    if (open == 0) describe_jumps(equations, gains.stationary());
    m.linear = open > 0 ? gains.transition() : m.transition;
    const int piston = core_[CoreIndex::piston_velocity];
    for (int j = 0; j < states_ && open == 0 && piston >= 0; ++j) m.linear(piston, j) = m.linear(j, piston) = 0.0;
    for (int lag = 0; lag <= longest_lag_; ++lag) m.priors[static_cast<std::size_t>(lag)] = gains.prior(lag);
  }
  wheel_load_row_ = equations.row(Channel::F_w, 0, false);
  for (int j = 0; j < estimator_states; ++j) {
    foot_velocity_row_(j) = j < states_ ? equations.foot_point_velocity(EstimatorVector::Unit(j)) : 0.0;
  }
}

/// J = T S Tᵀ: S the road's own covariance, T takes heights relative to the foot point, and the foot point's velocity
/// times a period in place of its height. A road of one state has white velocity: its foot point moves by Q.
void KalmanFilter::describe_jumps(const EstimatorEquations& equations, const EstimatorMatrix& stationary) {
  using Road = model::RoadFilter<double>;
  jumps_.setZero();
  const int first = equations.road(), foot = equations.foot_point();
  if (foot == first) {
    jumps_(foot, foot) = by_count_[0].noise(foot, foot);
  } else {
    model::Block<double, estimator_states, Road::states> t;
    t.setZero();
    for (int i = 0; i < Road::states; ++i) t(first + i, i) = 1.0;
    t(first + Road::road, Road::foot_point) = t(first + Road::contact, Road::foot_point) = -1.0;
    t(foot, Road::foot_point) = 0.0;
    t(foot, Road::foot_point_velocity) = period_;
    for (int l = 0; l < Road::states; ++l) {
      for (int k = 0; k < Road::states; ++k) {
        const double covariance = stationary(first + k, first + l);
        for (int j = 0; j < states_; ++j) {
          for (int i = 0; i < states_; ++i) jumps_(i, j) += t(i, k) * covariance * t(j, l);
        }
      }
    }
  }
  for (int i = 0; i < channels_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    const Channel channel = equations.channel(i);
    jumps_seen_[c].setZero();
    if (channel != Channel::z_r && channel != Channel::zdd_r) continue;
    const EstimatorVector row = equations.row(channel, 0, true);
    for (int j = 0; j < states_; ++j) {
      for (int k = 0; k < states_; ++k) jumps_seen_[c](k) += jumps_(k, j) * row(j);
    }
    jumps_variance_[c] = dot(row, jumps_seen_[c]);
  }
}

/// a of the jumps that are expected in this period.
double KalmanFilter::expected_jumps() const { return expected_jumps_ * wide_left_ * period_ / wide_time; }

void KalmanFilter::add_jumps(EstimatorMatrix& p, double factor) const {
  constexpr int first = 4;  // the car's states come first, and J is that of the road
  for (int j = first; j < states_; ++j) {
    for (int i = first; i < states_; ++i) p(i, j) += factor * jumps_(i, j);
  }
}

/// (5), of the anchor and, without memory, of the present.
double KalmanFilter::widen(std::size_t channel, double innovation, double variance, EstimatorMatrix& p,
                           EstimatorVector& projected) const {
  const double seen = jumps_variance_[channel];
  const double excess = innovation * innovation / (widest_noise * widest_noise) - variance;
  const bool jumped = seen > 0.0 && excess > 0.0;
  const double growth = jumped ? excess / seen : 0.0;
  add_jumps(p, growth);
  for (int k = 0; k < states_; ++k) projected(k) += growth * jumps_seen_[channel](k);
  return growth;
}

void KalmanFilter::restart() {
  started_ = false;
  expected_jumps_ = 0.0;
  wide_left_ = 0;
  wide_periods_ = 0;
  anchor_ = newest_ = {};
  nis_ = 0.0;
  innovation_count_ = 0;
  innovation_.fill(0.0);
  expected_.fill(0.0);
  deviation_.fill(0.0);
  too_old_ = 0;
  monitor_.restart();
}

double KalmanFilter::dot(const EstimatorVector& a, const EstimatorVector& b) const {
  double sum = 0.0;
  for (int i = 0; i < states_; ++i) sum += a(i) * b(i);
  return sum;
}

KalmanFilter::Slot& KalmanFilter::slot(int lag) {
  return slots_[static_cast<std::size_t>((newest_slot_ + slot_count - lag) % slot_count)];
}

void KalmanFilter::step(const hal::Frame& frame, std::uint32_t bad, hal::Time now) {
  const auto actuator_index = model::index(Channel::F_act);
  const hal::Reading& actuator = frame.channels[actuator_index];
  const bool acts = actuator.quality == hal::Quality::good && (bad >> actuator_index & 1U) == 0;
  const double force = acts ? actuator.value : 0.0;
  if (!started_) {
    started_ = true;
    for (Slot& s : slots_) s = {.open = first_open_, .actuator = force};
    anchor_.ducts.start(static_cast<model::OpenDucts>(first_open_.bits()));
    covariance_ =
        by_count_[static_cast<std::size_t>(count(first_open_))].priors[static_cast<std::size_t>(longest_lag_)];
    last_taken_.fill(hal::never);
    push(force);
  } else {
    // A late period leaves instants out; the filter does not.
    const double passed = (now - last_).seconds() / period_ + 0.5;
    const int periods = passed < 1.0 ? 1 : passed > longest_history ? longest_history : static_cast<int>(passed);
    for (int i = 1; i < periods; ++i) {
      push(force);
      move_anchor();
    }
    push(force);
  }
  last_ = now;
  place(frame, bad, now);
  move_anchor();
  newest_ = anchor_;
  for (int lag = longest_lag_ - 1; lag >= 0; --lag) {
    advance(newest_, slot(lag + 1), slot(lag));
    work_1_ = by_count_[static_cast<std::size_t>(count(slot(lag).open))].priors[static_cast<std::size_t>(lag)];
    add_jumps(work_1_, expected_jumps());
    correct(newest_.x, work_1_, slot(lag), nullptr);
  }
}

void KalmanFilter::switch_to(hal::Openings open) {
  first_open_ = open;
  slot(0).open = open;
}

void KalmanFilter::push(double actuator) {
  const hal::Openings still = slot(0).open;
  newest_slot_ = (newest_slot_ + 1) % slot_count;
  slot(0) = {.open = still, .actuator = actuator};
}

/// One period on: all samples of that instant are there, or will not come.
void KalmanFilter::move_anchor() {
  advance(anchor_, slot(longest_lag_ + 1), slot(longest_lag_));
  predict_covariance(slot(longest_lag_ + 1));
  add_jumps(covariance_, expected_jumps());
  innovation_.fill(0.0);
  correct(anchor_.x, covariance_, slot(longest_lag_), &monitor_);
  if (wide_left_ == 0) return;
  --wide_left_;
  ++wide_periods_;
}

/// (4)
void KalmanFilter::predict_covariance(const Slot& from) {
  const PerCount& m = by_count_[static_cast<std::size_t>(count(from.open))];
  multiply(work_1_, m.linear, covariance_, states_);
  multiply_transposed(covariance_, work_1_, m.linear, states_);
  for (int j = 0; j < states_; ++j) {
    for (int i = 0; i <= j; ++i) {
      covariance_(i, j) = covariance_(j, i) = 0.5 * (covariance_(i, j) + covariance_(j, i)) + m.noise(i, j);
    }
  }
}

/// By stamp.
void KalmanFilter::place(const hal::Frame& frame, std::uint32_t bad, hal::Time now) {
  for (int i = 0; i < channels_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    const hal::Reading& reading = frame.channels[channel_[c]];
    if (reading.quality != hal::Quality::good || (bad >> channel_[c] & 1U) != 0) continue;
    if (reading.taken == last_taken_[c]) continue;  // shown before
    last_taken_[c] = reading.taken;
    const double age = ((now - reading.taken).seconds() + delay_[c]) / period_;
    const double whole = age < 0.0 ? 0.5 : age + 0.5;
    if (whole >= longest_lag_ + 1) {
      ++too_old_;
      continue;
    }
    const int lag = static_cast<int>(whole);
    Slot& at = slot(lag);
    at.value[c] = (reading.value - offset_[c]) / gain_[c];
    at.offset[c] = (lag - (age < 0.0 ? 0.0 : age)) * period_;
    at.there[c] = true;
  }
}

/// (2) at the instant `from`, then (1).
void KalmanFilter::advance(Estimate& estimate, const Slot& from, const Slot& to) const {
  EstimatorVector& x = estimate.x;
  const int piston = core_[CoreIndex::piston_velocity];
  const auto open = static_cast<model::OpenDucts>(from.open.bits());
  if (piston >= 0 && open != estimate.ducts.open()) x(piston) = estimate.ducts.switch_to(open, x(piston), flow_step_);
  const PerCount& m = by_count_[static_cast<std::size_t>(model::count(open))];
  const std::array<double, 4> losses = model::newest_four(estimate.ducts.losses());
  EstimatorVector next = EstimatorVector::Zero();
  for (int j = 0; j < states_; ++j) {
    const double factor = x(j);
    for (int i = 0; i < states_; ++i) next(i) += m.transition(i, j) * factor;
  }
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < states_; ++i) next(i) += m.losses(i, j) * losses[static_cast<std::size_t>(j)];
  }
  for (int i = 0; i < states_; ++i) {
    next(i) += m.actuator(i, 0) * from.actuator;
    next(i) += m.actuator(i, 1) * to.actuator;
  }
  x = next;
  if (piston >= 0) estimate.ducts.advance(x(piston), flow_step_);
}

/// (3)
void KalmanFilter::correct(EstimatorVector& x, EstimatorMatrix& p, const Slot& at, InnovationMonitor* monitor) {
  const PerCount& m = by_count_[static_cast<std::size_t>(count(at.open))];
  double nis = 0.0;
  int innovations = 0;
  for (int i = 0; i < channels_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    if (!at.there[c]) continue;
    const auto& row = m.rows[c];
    EstimatorVector projected = EstimatorVector::Zero();
    for (int j = 0; j < states_; ++j) {
      const double factor = row[0](j);
      for (int k = 0; k < states_; ++k) projected(k) += p(k, j) * factor;
    }
    double variance = dot(row[0], projected) + variance_[c];
    const double delta = at.offset[c];
    const double expected = dot(row[0], x) + delta * (dot(row[1], x) + delta * dot(row[2], x));
    const double innovation = at.value[c] - expected - feedthrough_[c] * at.actuator;
    const double growth = widen(c, innovation, variance, p, projected);
    variance = dot(row[0], projected) + variance_[c];
    if (monitor != nullptr && growth > 0.0) {
      const double level = expected_jumps();
      expected_jumps_ = growth > level ? growth : level;
      const double periods = wide_time / period_ + 0.5;
      wide_left_ = static_cast<int>(periods);
    }
    EstimatorVector gain = EstimatorVector::Zero();
    for (int j = 0; j < states_; ++j) gain(j) = projected(j) / variance;
    for (int j = 0; j < states_; ++j) {
      x(j) += gain(j) * innovation;
      for (int k = 0; k < states_; ++k) {
        p(k, j) += variance * gain(k) * gain(j) - gain(k) * projected(j) - projected(k) * gain(j);
      }
    }
    if (monitor == nullptr) continue;
    deviation_[c] = std::sqrt(variance);
    const double normalised = innovation / deviation_[c];
    innovation_[c] = normalised;
    expected_[c] = expected / deviation_[c];
    nis += normalised * normalised;
    ++innovations;
    if (wide_left_ > 0) {
      monitor->set_aside(i);
    } else {
      monitor->take(i, normalised);
    }
  }
  if (monitor == nullptr) return;
  nis_ = nis;
  innovation_count_ = innovations;
}

}  // namespace firmware
