#include "host_sim/replicate/tracking.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/replicate/thresholds.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::replicate {
namespace {

/// What x is beyond ± limit.
double beyond(double x, double limit) { return x - std::clamp(x, -limit, limit); }

}  // namespace

/// Butterworth of fourth order, bilinear with the edges where they are: two sections for each edge.
std::vector<Tracking::Section> Tracking::sections_of(const FrequencyBand& band, double period) {
  std::vector<Section> sections;
  const std::array<double, 2> quality{1.0 / (2.0 * std::cos(0.0625 * full_turn)),
                                      1.0 / (2.0 * std::cos(0.1875 * full_turn))};
  const auto add = [&](double frequency, bool high) {
    const double c = std::tan(0.5 * full_turn * frequency * period);
    for (const double q : quality) {
      const double scale = 1.0 / (1.0 + c / q + c * c);
      const double b = high ? scale : c * c * scale;
      sections.push_back({b, high ? -2.0 * b : 2.0 * b, b, 2.0 * (c * c - 1.0) * scale, (1.0 - c / q + c * c) * scale});
    }
  };
  const double lowest = (1.0 - thresholds::band_edge) * band.lowest,
               highest = (1.0 + thresholds::band_edge) * band.highest;
  if (lowest > 0.0) add(lowest, true);
  if (highest * period < 0.4) add(highest, false);
  return sections;
}

double Tracking::filtered(const Filter& filter, double error, double* states) const {
  double x = error;
  double* z = states;
  for (const Section& section : filter.sections) {
    const double y = section.b0 * x + z[0];
    z[0] = section.b1 * x - section.a1 * y + z[1];
    z[1] = section.b2 * x - section.a2 * y;
    x = y;
    z += 2;
  }
  return x;
}

Tracking::Tracking(SteppedRig& rig, double period, std::vector<TrackedChannel> channels, const DriveCost& cost,
                   const DriveLimits& limits)
    : rig_(&rig), h_(period), channels_(std::move(channels)), own_(cost), limits_(limits) {
  const double most = thresholds::usable_limit;
  piece_ = std::max<std::size_t>(8, static_cast<std::size_t>(thresholds::choosing_piece / h_));
  limits_ = {most * limits.stroke, most * limits.speed, most * limits.acceleration, most * limits.force};
  for (const TrackedChannel& channel : channels_) {
    Filter filter{sections_of(channel.band, h_), 0, {}, {}, 0.0};
    filters_.push_back(std::move(filter));
  }
}

double Tracking::stage(std::size_t k, const double* outputs, const double* s, double w, double& excess) const {
  double cost = 0.5 * own_.acceleration * w * w;
  for (std::size_t c = 0; c < channels_.size(); ++c) cost += 0.5 * channels_[c].weight * outputs[c] * outputs[c];
  const double p = s[rig_states_ - 2], v = s[rig_states_ - 1], f = outputs[channels_.size()];
  cost += 0.5 * own_.position * p * p;
  const auto limited = [&](double x, double limit, double sigma, const std::vector<double>& multiplier) {
    const double over = beyond(x + multiplier[k], limit);
    cost += 0.5 * sigma * over * over;
    excess = std::max(excess, std::abs(x) / limit - 1.0);
  };
  limited(p, limits_.stroke, limit_cost_.position, multipliers_.position);
  limited(v, limits_.speed, limit_cost_.speed, multipliers_.speed);
  limited(w, limits_.acceleration, limit_cost_.acceleration, multipliers_.acceleration);
  limited(f, limits_.force, limit_cost_.force, multipliers_.force);
  return cost;
}

void Tracking::begin(const std::vector<double>& positions, const std::vector<std::vector<double>>& target) {
  size_ = positions.size();
  target_ = target;
  const std::size_t steps = size_ - 1;
  // Follows the positions: with the acceleration that they have, and a feedback of what is left.
  std::vector<double> w(steps), reached(size_, 0.0);
  DrivePoint at;
  const double omega = 0.3 / h_;
  const auto sample = [&](std::size_t k) { return positions[std::min(k, size_ - 1)] - positions.front(); };
  for (std::size_t k = 0; k < steps; ++k) {
    const double before = k == 0 ? 0.0 : sample(k - 1), now = sample(k), next = sample(k + 1), after = sample(k + 2);
    const double velocity = (next - before) / (2.0 * h_);
    const double acceleration = (after - next - now + before) / (2.0 * h_ * h_);
    w[k] = acceleration + omega * omega * (now - at.position) + 1.6 * omega * (velocity - at.velocity);
    at = moved(at, w[k], h_);
  }
  // Which entries of the state move at all.
  rig_->start();
  std::vector<double> x(rig_->states()), rest(rig_->states());
  rig_->state(rest.data());
  std::vector<bool>& unused = unused_;
  unused.assign(x.size(), true);
  for (std::size_t k = 0; k < steps; ++k) {
    rig_->step(w[k]);
    rig_->state(x.data());
    for (std::size_t i = 0; i < x.size(); ++i) unused[i] = unused[i] && x[i] == rest[i];
  }
  unused.resize(x.size() - 2);
  rig_->drop(unused);
  rig_states_ = rig_->states();
  n_ = rig_states_;
  for (Filter& filter : filters_) {
    filter.first = n_;
    const std::size_t order = 2 * filter.sections.size();
    n_ += order;
    filter.input.assign(order, 0.0);
    filter.through = filtered(filter, 1.0, filter.input.data());
    filter.at.assign(order * (order + 1), 0.0);  // rows: where each state goes; last: the output
    for (std::size_t j = 0; j < order; ++j) {
      std::vector<double> z(order, 0.0);
      z[j] = 1.0;
      filter.at[order * order + j] = filtered(filter, 0.0, z.data());
      for (std::size_t i = 0; i < order; ++i) filter.at[i * order + j] = z[i];
    }
  }
  const std::size_t outputs = channels_.size() + 1;
  multipliers_.position.assign(steps, 0.0);
  multipliers_.speed = multipliers_.acceleration = multipliers_.force = multipliers_.position;
  w_ = std::move(w);
  gain_.assign(steps * n_, 0.0);
  feed_.assign(steps, 0.0);
  s_.assign(size_ * n_, 0.0);
  step_s_ = s_;
  step_w_.assign(steps, 0.0);
  leading_.assign(n_, 0.0);
  a_of_.resize(steps * rig_states_ * (rig_states_ + 1));
  y_of_.resize(steps * (channels_.size()) * (rig_states_ + 1));
  outputs_.assign(steps * outputs, 0.0);
  next_w_ = w_;
  next_s_ = s_;
  next_outputs_ = outputs_;
  answer_.assign(channels_.size(), std::vector<double>(size_, 0.0));
  next_answer_ = answer_;
  set_ = 0;
  damping_ = 0.0;
  run_again(false);
}

void Tracking::exchange(SteppedRig& rig, bool led) {
  rig_ = &rig;
  if (rig_->states() != rig_states_) rig_->drop(unused_);
  damping_ = 0.0;
  run_again(led);
}

void Tracking::lead_by(SteppedRig& linear) {
  constexpr double longest = 8.0;  // [s]: the slowest mode that a band from 0.5 Hz on sees is settled
  if (linear.states() != rig_states_) linear.drop(unused_);
  linear.start();
  prepare_backward();
  LinearStep step;
  linear.derive(0.0, step);
  CostToGo go{std::vector<double>(n_ * n_, 0.0), std::vector<double>(n_, 0.0)};
  const std::size_t at = size_ - 2;
  for (std::size_t k = 0; k < static_cast<std::size_t>(longest / h_); ++k) back_step(at, step, go);
  leading_.assign(gain_.begin() + static_cast<std::ptrdiff_t>(at * n_),
                  gain_.begin() + static_cast<std::ptrdiff_t>((at + 1) * n_));
}

void Tracking::retarget(const std::vector<std::vector<double>>& target) {
  target_ = target;
  begin_from_best();
}

std::size_t Tracking::pieces() const { return (size_ - 1 + piece_ - 1) / piece_; }

/// The motion that w_ makes, led along the motion before or not: what is deviated from.
void Tracking::run_again(bool led) {
  const std::vector<double> leading = leading_;
  if (!led) std::fill(leading_.begin(), leading_.end(), 0.0);
  std::fill(step_w_.begin(), step_w_.end(), 0.0);
  std::fill(step_s_.begin(), step_s_.end(), 0.0);
  rig_->start();
  std::vector<double> s(n_, 0.0);
  rig_->state(s.data());
  cost_ = excess_ = 0.0;
  for (std::size_t piece = 0; piece < pieces(); ++piece) {
    rig_->keep(slot(set_ ^ 1U, piece));
    cost_ += run_piece(piece, 0.0, 0.0, s, excess_);
  }
  leading_ = leading;
  accept();
  keep_best();
}

void Tracking::keep_best() {
  best_cost_ = cost_;
  best_w_ = w_;
  positions_.resize(size_);
  for (std::size_t k = 0; k < size_; ++k) positions_[k] = s_[k * n_ + rig_states_ - 2];
}

/// From the best drive on, with other costs.
void Tracking::begin_from_best() {
  w_ = best_w_;
  damping_ = 0.0;
  run_again(false);
}

void Tracking::accept() {
  w_.swap(next_w_);
  s_.swap(next_s_);
  outputs_.swap(next_outputs_);
  answer_.swap(next_answer_);
  set_ ^= 1U;
}

double Tracking::run_piece(std::size_t piece, double before, double alpha, std::vector<double>& s, double& excess) {
  const std::size_t outputs = channels_.size() + 1;
  const std::size_t from = piece * piece_, to = std::min(from + piece_, size_ - 1);
  double cost = 0.0;
  std::array<double, 16> y{};
  if (from == 0) {
    std::copy(s.begin(), s.end(), next_s_.begin());
    rig_->read(y.data());
    for (std::size_t c = 0; c < channels_.size(); ++c) next_answer_[c][0] = y[c];
  }
  for (std::size_t k = from; k < to; ++k) {
    const double share = before + (alpha - before) * static_cast<double>(k - from) / static_cast<double>(to - from);
    double w = w_[k] + share * step_w_[k];
    const double *about = &s_[k * n_], *moves = &step_s_[k * n_];
    for (std::size_t i = 0; i < n_; ++i) w += leading_[i] * (s[i] - about[i] - share * moves[i]);
    rig_->step(w);
    rig_->state(s.data());
    rig_->read(y.data());
    double* const o = &next_outputs_[k * outputs];
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      next_answer_[c][k + 1] = y[c];
      o[c] = filtered(filters_[c], target_[c][k + 1] - y[c], s.data() + filters_[c].first);
    }
    o[channels_.size()] = y[channels_.size()];
    next_w_[k] = w;
    std::copy(s.begin(), s.end(), next_s_.begin() + static_cast<std::ptrdiff_t>((k + 1) * n_));
    cost += stage(k, o, s.data(), w, excess);
  }
  return std::isfinite(cost) ? cost : INFINITY;
}

/// Runs with the feedback, each piece with the share of the step that is best for it and those behind it, where the rig
/// is led back.
bool Tracking::forward() {
  rig_->start();
  std::vector<double> s(n_, 0.0);
  rig_->state(s.data());
  std::vector<double> costs(pieces()), shares(pieces());
  double excess = 0.0, share = 0.0;
  for (std::size_t piece = 0; piece < pieces(); ++piece) {
    rig_->keep(slot(set_ ^ 1U, piece));
    shares[piece] = best_share(piece, share, s);
    costs[piece] = run_piece(piece, share, shares[piece], s, excess);
    share = shares[piece];
  }
  return take(costs, excess);
}

bool Tracking::take(const std::vector<double>& costs, double excess) {
  double sum = 0.0;
  for (const double cost : costs) sum += cost;
  if (!(sum < thresholds::borne_cost * best_cost_)) return false;
  cost_ = sum;
  excess_ = excess;
  accept();
  if (sum < best_cost_) keep_best();
  return true;
}

double Tracking::best_share(std::size_t piece, double share, const std::vector<double>& start) {
  const std::size_t at = slot(set_ ^ 1U, piece), end = std::min(pieces(), piece + 1 + thresholds::pieces_ahead);
  double best = INFINITY, best_share = 0.0, ignored = 0.0;
  for (const double candidate : thresholds::shares_of_step) {
    std::vector<double> s = start;
    double total = run_piece(piece, share, candidate, s, ignored), before = candidate;
    for (std::size_t next = piece + 1; next < end && total < best; ++next) {
      total += run_piece(next, before, 0.0, s, ignored);
      before = 0.0;
    }
    if (total < best) {
      best = total;
      best_share = candidate;
    }
    rig_->return_to(at);
  }
  return best_share;
}

/// Adds the cost of the state at the end of step k to `go`; qww_ and qw_ begin with that of its acceleration.
void Tracking::add_own_cost(std::size_t k, CostToGo& go) {
  const std::size_t n = n_;
  const double* const s = &s_[(k + 1) * n];
  const auto limited = [](double x, double limit, double sigma, double multiplier, double& curvature, double& slope) {
    const double over = beyond(x + multiplier, limit);
    if (over == 0.0) return;
    curvature += sigma;
    slope += sigma * over;
  };
  const std::size_t ip = rig_states_ - 2, iv = rig_states_ - 1;
  go.p[ip * n + ip] += own_.position;
  go.q[ip] += own_.position * s[ip];
  limited(s[ip], limits_.stroke, limit_cost_.position, multipliers_.position[k], go.p[ip * n + ip], go.q[ip]);
  limited(s[iv], limits_.speed, limit_cost_.speed, multipliers_.speed[k], go.p[iv * n + iv], go.q[iv]);
  qww_ = own_.acceleration;
  qw_ = own_.acceleration * w_[k];
  limited(w_[k], limits_.acceleration, limit_cost_.acceleration, multipliers_.acceleration[k], qww_, qw_);
}

/// A and B: the rows of the rig, and below them those of the filters.
void Tracking::fill_step(const LinearStep& step) {
  const std::size_t n = n_, r = rig_states_;
  std::fill(a_.begin(), a_.end(), 0.0);
  for (std::size_t i = 0; i < r; ++i) {
    std::copy_n(&step.a[i * r], r, &a_[i * n]);
    b_[i] = step.b[i];
  }
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const Filter& f = filters_[c];
    const std::size_t order = f.input.size();
    for (std::size_t i = 0; i < order; ++i) {
      double* const row = &a_[(f.first + i) * n];
      for (std::size_t j = 0; j < r; ++j) row[j] = -f.input[i] * step.c[c * r + j];
      std::copy_n(&f.at[i * order], order, row + f.first);
      b_[f.first + i] = -f.input[i] * step.d[c];
    }
  }
}

/// visit(from, to) for the blocks of a row of A that are not zero.
template <class Visit>
void Tracking::blocks_of_row(std::size_t row, const Visit& visit) const {
  visit(std::size_t{0}, rig_states_);
  if (row < rig_states_) return;
  for (const Filter& f : filters_) {
    if (row >= f.first && row < f.first + f.input.size()) visit(f.first, f.first + f.input.size());
  }
}

/// AᵀPA, BᵀPA, BᵀPB, Aᵀq and Bᵀq of (3).
void Tracking::carry_back(const CostToGo& go) {
  const std::size_t n = n_;
  std::fill(pa_.begin(), pa_.end(), 0.0);
  for (std::size_t l = 0; l < n; ++l) {
    const double* const row = &a_[l * n];
    blocks_of_row(l, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = 0; i < n; ++i) {
        const double factor = go.p[l * n + i];
        double* const sum = &pa_[i * n];
        for (std::size_t j = from; j < to; ++j) sum[j] += factor * row[j];
      }
    });
  }
  std::fill(qxx_.begin(), qxx_.end(), 0.0);
  std::fill(qx_.begin(), qx_.end(), 0.0);
  std::fill(qwx_.begin(), qwx_.end(), 0.0);
  for (std::size_t l = 0; l < n; ++l) {
    const double *const row = &a_[l * n], *const sum = &pa_[l * n];
    double pb = 0.0;
    for (std::size_t i = 0; i < n; ++i) pb += go.p[l * n + i] * b_[i];
    qww_ += b_[l] * pb;
    qw_ += b_[l] * go.q[l];
    for (std::size_t j = 0; j < n; ++j) qwx_[j] += b_[l] * sum[j];
    blocks_of_row(l, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        const double factor = row[i];
        double* const out = &qxx_[i * n];
        for (std::size_t j = 0; j < n; ++j) out[j] += factor * sum[j];
        qx_[i] += factor * go.q[l];
      }
    });
  }
}

/// Adds the cost weight/2 · y² of an output y = e·s + f w that has this value.
void Tracking::add_output_cost(double f, double weight, double value) {
  const std::size_t n = n_;
  const std::vector<double>& e = error_row_;
  for (std::size_t i = 0; i < n; ++i) {
    if (e[i] == 0.0) continue;
    const double factor = weight * e[i];
    for (std::size_t j = 0; j < n; ++j) qxx_[i * n + j] += factor * e[j];
    qx_[i] += factor * value;
    qwx_[i] += factor * f;
  }
  qww_ += weight * f * f;
  qw_ += weight * f * value;
}

/// (3), (4) of step k; `go`: cost to go from its end, then from its start.
void Tracking::back_step(std::size_t k, const LinearStep& step, CostToGo& go) {
  const std::size_t n = n_, r = rig_states_, m = channels_.size();
  const double* const o = &outputs_[k * (m + 1)];
  add_own_cost(k, go);
  fill_step(step);
  carry_back(go);
  for (std::size_t c = 0; c < m; ++c) {
    const Filter& f = filters_[c];
    const std::size_t order = f.input.size();
    std::fill(error_row_.begin(), error_row_.end(), 0.0);
    for (std::size_t j = 0; j < r; ++j) error_row_[j] = -f.through * step.c[c * r + j];
    std::copy_n(&f.at[order * order], order, &error_row_[f.first]);
    add_output_cost(-f.through * step.d[c], channels_[c].weight, o[c]);
  }
  const double over = beyond(o[m] + multipliers_.force[k], limits_.force);
  if (over != 0.0) {
    std::fill(error_row_.begin(), error_row_.end(), 0.0);
    std::copy_n(&step.c[m * r], r, error_row_.data());
    add_output_cost(step.d[m], limit_cost_.force, over);
  }
  qww_ *= 1.0 + damping_;
  double* const gain = &gain_[k * n];
  for (std::size_t i = 0; i < n; ++i) gain[i] = -qwx_[i] / qww_;
  feed_[k] = -qw_ / qww_;
  for (std::size_t i = 0; i < n; ++i) {
    go.q[i] = qx_[i] + qwx_[i] * feed_[k];
    for (std::size_t j = 0; j < n; ++j) go.p[i * n + j] = 0.5 * (qxx_[i * n + j] + qxx_[j * n + i]) + qwx_[i] * gain[j];
  }
}

void Tracking::prepare_backward() {
  const std::size_t n = n_;
  a_.assign(n * n, 0.0);
  pa_ = qxx_ = a_;
  b_.assign(n, 0.0);
  qx_ = qwx_ = error_row_ = b_;
}

void Tracking::backward() {
  prepare_backward();
  CostToGo go{std::vector<double>(n_ * n_, 0.0), std::vector<double>(n_, 0.0)};
  LinearStep step;
  const std::size_t inside = 2 * pieces();
  for (std::size_t piece = pieces(); piece-- > 0;) {
    const std::size_t from = piece * piece_, to = std::min(from + piece_, size_ - 1);
    rig_->return_to(slot(set_, piece));
    for (std::size_t k = from; k < to; ++k) {
      rig_->keep(inside + k - from);
      if (k + 1 < to) rig_->step(w_[k]);
    }
    for (std::size_t k = to; k-- > from;) {
      rig_->return_to(inside + k - from);
      rig_->derive(w_[k], step);
      back_step(k, step, go);
      keep_step(k, step);
    }
  }
}

void Tracking::keep_step(std::size_t k, const LinearStep& step) {
  const std::size_t r = rig_states_, m = channels_.size();
  float* a = &a_of_[k * r * (r + 1)];
  for (std::size_t i = 0; i < r * r; ++i) *a++ = static_cast<float>(step.a[i]);
  for (std::size_t i = 0; i < r; ++i) *a++ = static_cast<float>(step.b[i]);
  float* y = &y_of_[k * m * (r + 1)];
  for (std::size_t i = 0; i < m * r; ++i) *y++ = static_cast<float>(step.c[i]);
  for (std::size_t i = 0; i < m; ++i) *y++ = static_cast<float>(step.d[i]);
}

/// The step that (4) makes of the linear form: its accelerations and its states.
void Tracking::linear_run() {
  const std::size_t r = rig_states_, m = channels_.size();
  std::fill_n(step_s_.begin(), n_, 0.0);
  for (std::size_t k = 0; k + 1 < size_; ++k) {
    const double *s = &step_s_[k * n_], *gain = &gain_[k * n_];
    double* const next = &step_s_[(k + 1) * n_];
    double w = feed_[k];
    for (std::size_t i = 0; i < n_; ++i) w += gain[i] * s[i];
    step_w_[k] = w;
    const float *a = &a_of_[k * r * (r + 1)], *b = a + r * r;
    for (std::size_t i = 0; i < r; ++i) {
      double sum = b[i] * w;
      for (std::size_t j = 0; j < r; ++j) sum += a[i * r + j] * s[j];
      next[i] = sum;
    }
    const float *c = &y_of_[k * m * (r + 1)], *d = c + m * r;
    for (std::size_t i = 0; i < m; ++i) {
      double y = d[i] * w;
      for (std::size_t j = 0; j < r; ++j) y += c[i * r + j] * s[j];
      const Filter& f = filters_[i];
      std::copy_n(s + f.first, f.input.size(), next + f.first);
      filtered(f, -y, next + f.first);
    }
  }
}

double Tracking::iterate() {
  const double before = best_cost_;
  backward();
  linear_run();
  if (!forward())
    damping_ = std::max(0.1, 4.0 * damping_);
  else
    damping_ = damping_ < 0.05 ? 0.0 : 0.25 * damping_;
  return before > 0.0 ? 1.0 - best_cost_ / before : 0.0;
}

void Tracking::charge(const LimitCost& cost) {
  limit_cost_ = cost;
  multipliers_.position.assign(size_ - 1, 0.0);
  multipliers_.speed = multipliers_.acceleration = multipliers_.force = multipliers_.position;
  begin_from_best();
}

double Tracking::error() const {
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < size_; ++k) {
    for (std::size_t c = 0; c < channels_.size(); ++c)
      sum += channels_[c].weight * std::pow(outputs_[k * (channels_.size() + 1) + c], 2);
  }
  return std::sqrt(sum / static_cast<double>(size_ - 1));
}

void Tracking::update_multipliers() {
  const auto update = [](double x, double limit, double& multiplier) { multiplier = beyond(x + multiplier, limit); };
  for (std::size_t k = 0; k + 1 < size_; ++k) {
    const double* const s = &s_[(k + 1) * n_];
    update(s[rig_states_ - 2], limits_.stroke, multipliers_.position[k]);
    update(s[rig_states_ - 1], limits_.speed, multipliers_.speed[k]);
    update(w_[k], limits_.acceleration, multipliers_.acceleration[k]);
    update(outputs_[k * (channels_.size() + 1) + channels_.size()], limits_.force, multipliers_.force[k]);
  }
  count_cost();
  keep_best();
}

void Tracking::count_cost() {
  cost_ = excess_ = 0.0;
  for (std::size_t k = 0; k + 1 < size_; ++k)
    cost_ += stage(k, &outputs_[k * (channels_.size() + 1)], &s_[(k + 1) * n_], w_[k], excess_);
}

}  // namespace host_sim::replicate
