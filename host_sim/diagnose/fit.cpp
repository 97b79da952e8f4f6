#include "host_sim/diagnose/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/diagnose/parallel.hpp"

namespace host_sim::diagnose {

namespace {

/// Of the fitted recording i.
void predict_recording(const Case& all, const Hypothesis& hypothesis, std::size_t i, Steps steps,
                       Prediction& prediction) {
  const std::size_t r = all.fitted[i];
  const Evidence& e = all.evidence[r];
  const Whitening& whitening = all.fit[i];
  auto truth = std::make_shared<const Response>(
      true_channels(hypothesis.rig, e, e.drive, hypothesis.starts[r], whitening.window().to, steps));
  Spectra seen;
  for (std::size_t c = 0; c < e.channels.size(); ++c) {
    const auto& values = (*truth)[index(e.channels[c])];
    const bool affected = has_sensor_effect(hypothesis.rig, e.channels[c]);
    seen.push_back(whitening.spectrum(e, c, affected ? readings(hypothesis, e, e.channels[c], values) : values));
  }
  prediction.truth[i] = std::move(truth);
  prediction.seen[i] = std::move(seen);
}

}  // namespace

Prediction predict(const Case& all, const Hypothesis& hypothesis, Steps steps) {
  Prediction prediction;
  prediction.truth.resize(all.fitted.size());
  prediction.seen.resize(all.fitted.size());
  for (std::size_t i = 0; i < all.fitted.size(); ++i) predict_recording(all, hypothesis, i, steps, prediction);
  return prediction;
}

Prediction predict_sensor(const Case& all, const Hypothesis& hypothesis, const Prediction& base,
                          model::Channel channel) {
  Prediction prediction = base;
  for (std::size_t i = 0; i < all.fitted.size(); ++i) {
    const Evidence& e = all.evidence[all.fitted[i]];
    for (std::size_t c = 0; c < e.channels.size(); ++c) {
      if (e.channels[c] != channel) continue;
      prediction.seen[i][c] =
          all.fit[i].spectrum(e, c, readings(hypothesis, e, channel, (*base.truth[i])[index(channel)]));
    }
  }
  return prediction;
}

Eigen::VectorXd residuals(const Case& all, const Prediction& prediction) {
  std::size_t count = 0;
  for (const Whitening& w : all.fit) count += w.count();
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  double* out = values.data();
  for (std::size_t i = 0; i < all.fit.size(); ++i) {
    all.fit[i].whiten(prediction.seen[i], out);
    out += all.fit[i].count();
  }
  return values;
}

std::vector<Response> respond(const Case& all, const Hypothesis& hypothesis) {
  std::vector<Response> responses(all.evidence.size());
  for_all(all.evidence.size(), [&](std::size_t r) {
    responses[r] = read_channels(hypothesis, all.evidence[r], all.evidence[r].drive, hypothesis.starts[r]);
  });
  return responses;
}

Box box_of(const std::vector<Unknown>& unknowns, const Hypothesis& hypothesis, double trust) {
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  Box box{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Unknown& unknown = unknowns[static_cast<std::size_t>(i)];
    const Unknown::Room room = unknown.room(unknown.get(hypothesis), trust);
    box.lower(i) = room.lower;
    box.upper(i) = room.upper;
  }
  return box;
}

Eigen::VectorXd bounded_step(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Box& box) {
  const auto& [lower, upper] = box;
  const Eigen::Index n = g.size();
  enum class At : unsigned char { inside, bottom, top };
  std::vector<At> at(static_cast<std::size_t>(n), At::inside);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < 4 * static_cast<int>(n) + 4; ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i) {
      const At where = at[static_cast<std::size_t>(i)];
      if (where == At::inside) free.push_back(i);
      if (where == At::bottom) d(i) = lower(i);
      if (where == At::top) d(i) = upper(i);
    }
    const auto m = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd reduced(m, m);
    Eigen::VectorXd right(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index a = free[static_cast<std::size_t>(i)];
      right(i) = -g(a);
      for (Eigen::Index j = 0; j < n; ++j) {
        if (at[static_cast<std::size_t>(j)] != At::inside) right(i) -= h(a, j) * d(j);
      }
      for (Eigen::Index j = 0; j < m; ++j) reduced(i, j) = h(a, free[static_cast<std::size_t>(j)]);
      reduced(i, i) += 1e-12 * h(a, a) + 1e-30;
    }
    const Eigen::VectorXd step = m > 0 ? Eigen::VectorXd(reduced.ldlt().solve(right)) : Eigen::VectorXd();
    // The bound that is passed by most becomes active.
    Eigen::Index worst = -1;
    double most = 1e-12;
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index a = free[static_cast<std::size_t>(i)];
      d(a) = step(i);
      const double beyond = std::max(lower(a) - d(a), d(a) - upper(a));
      const double relative = beyond / (upper(a) - lower(a) + 1e-30);
      if (relative > most) {
        most = relative;
        worst = a;
      }
    }
    if (worst >= 0) {
      at[static_cast<std::size_t>(worst)] = d(worst) < lower(worst) ? At::bottom : At::top;
      continue;
    }
    // A bound that holds back nothing becomes free again.
    const Eigen::VectorXd slope = h * d + g;
    Eigen::Index released = -1;
    double strongest = 1e-9 * (g.cwiseAbs().maxCoeff() + 1e-30);
    for (Eigen::Index i = 0; i < n; ++i) {
      const At where = at[static_cast<std::size_t>(i)];
      const double pull = where == At::bottom ? -slope(i) : (where == At::top ? slope(i) : 0.0);
      if (pull > strongest) {
        strongest = pull;
        released = i;
      }
    }
    if (released < 0) return d;
    at[static_cast<std::size_t>(released)] = At::inside;
  }
  return d.cwiseMax(lower).cwiseMin(upper);
}

namespace {

Hypothesis moved(const Hypothesis& from, const Unknown& unknown, double u) {
  Hypothesis hypothesis = from;
  unknown.put(hypothesis, u);
  return hypothesis;
}

/// What slopes are differences from: a fit's prediction, with half of the steps.
struct Base {
  const Prediction& prediction;
  const Eigen::VectorXd& residual;
};

/// Column of J by a one-sided difference.
Eigen::VectorXd slope_of(const Case& all, const Fit& at, const Base& base, const Unknown& unknown) {
  const double u = unknown.get(at.hypothesis);
  double step = u + unknown.step > unknown.upper ? -unknown.step : unknown.step;
  Hypothesis other = moved(at.hypothesis, unknown, u + step);
  if (find_rig_fault(other.rig, all.evidence.front().drive.period)) {  // a delay as long as its line
    step = -step;
    other = moved(at.hypothesis, unknown, u + step);
  }
  if (unknown.sensor) {
    return (residuals(all, predict_sensor(all, other, at.prediction, *unknown.sensor)) - at.residual) / step;
  }
  if (unknown.role == Unknown::Role::start) {  // which begins one recording only
    Prediction prediction = base.prediction;
    for (std::size_t i = 0; i < all.fitted.size(); ++i) {
      if (all.fitted[i] == unknown.recording) predict_recording(all, other, i, Steps::half, prediction);
    }
    return (residuals(all, prediction) - base.residual) / step;
  }
  return (residuals(all, predict(all, other, Steps::half)) - base.residual) / step;
}

/// Columns of J from `first` on.
void find_slopes(const Case& all, Fit& at, Eigen::Index first) {
  const bool simulates = std::any_of(at.unknowns.begin() + first, at.unknowns.end(),
                                     [](const Unknown& unknown) { return !unknown.sensor; });
  const bool anew = simulates && has_corners(at.hypothesis.rig);  // without corners that is the fit's own
  Prediction halved;
  Eigen::VectorXd halved_residual;
  if (anew) {
    halved = predict(all, at.hypothesis, Steps::half);
    halved_residual = residuals(all, halved);
    ++at.simulations;
  }
  const Base base{anew ? halved : at.prediction, anew ? halved_residual : at.residual};
  for_all(at.unknowns.size() - static_cast<std::size_t>(first), [&](std::size_t i) {
    const std::size_t column = i + static_cast<std::size_t>(first);
    at.slope.col(static_cast<Eigen::Index>(column)) = slope_of(all, at, base, at.unknowns[column]);
  });
  for (auto i = static_cast<std::size_t>(first); i < at.unknowns.size(); ++i) {
    at.simulations += at.unknowns[i].sensor ? 0 : 1;
  }
}

}  // namespace

void refresh_slope(const Case& all, Fit& fit) {
  fit.slope.resize(fit.residual.size(), static_cast<Eigen::Index>(fit.unknowns.size()));
  find_slopes(all, fit, 0);
}

Eigen::MatrixXd Fit::covariance() const {
  Eigen::MatrixXd h = slope.transpose() * slope;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    h(k, k) += 1e-12 * h(k, k) + 1e-30;
    // Inside of its tolerance a parameter is anywhere: the variance of that, where the data say less.
    const double width = unknowns[i].upper - unknowns[i].lower;
    if (unknowns[i].role == Unknown::Role::tolerated) h(k, k) += 12.0 / (width * width);
    if (unknowns[i].at_bound(hypothesis)) h(k, k) += 1e12 * (h(k, k) + 1.0);
  }
  return h.ldlt().solve(Eigen::MatrixXd::Identity(h.rows(), h.cols()));
}

Fit fit(const Case& all, Hypothesis start, std::vector<Unknown> unknowns, int most,
        const Eigen::MatrixXd& known_slope) {
  Fit result;
  result.hypothesis = std::move(start);
  result.unknowns = std::move(unknowns);
  const auto n = static_cast<Eigen::Index>(result.unknowns.size());
  result.prediction = predict(all, result.hypothesis);
  result.residual = residuals(all, result.prediction);
  ++result.simulations;
  result.chi_squared = result.residual.squaredNorm();
  result.slope.resize(result.residual.size(), n);
  const Eigen::Index known = known_slope.cols();
  if (known > 0) result.slope.leftCols(known) = known_slope;

  double trust = 1.0;  // share of what a slope may be believed for
  int age = -1;        // steps for which the slopes have been kept; −1: they are to be found
  for (int step = 0; step < most && n > 0; ++step) {
    if (age < 0) {
      find_slopes(all, result, known);
      if (!result.slope.allFinite()) break;
      age = 0;
    }
    const Eigen::MatrixXd h = result.slope.transpose() * result.slope;
    const Eigen::VectorXd g = result.slope.transpose() * result.residual;
    const Box box = box_of(result.unknowns, result.hypothesis, trust);
    const Eigen::VectorXd d = bounded_step(h, g, box);
    const double promised = -2.0 * g.dot(d) - d.dot(h * d);
    const double before = result.chi_squared;
    const double enough = 0.01 + 1e-6 * before;
    double share = 1.0;
    bool better = false;
    for (int attempt = 0; attempt < 5 && promised > 0.1 * enough; ++attempt, share *= 0.35) {
      Hypothesis next = result.hypothesis;
      for (Eigen::Index i = 0; i < n; ++i) {
        const Unknown& unknown = result.unknowns[static_cast<std::size_t>(i)];
        unknown.put(next, unknown.get(result.hypothesis) + share * d(i));
      }
      if (find_rig_fault(next.rig, all.evidence.front().drive.period)) continue;
      Prediction prediction = predict(all, next);
      Eigen::VectorXd r = residuals(all, prediction);
      ++result.simulations;
      const double chi = r.squaredNorm();
      if (chi < before) {
        result.prediction = std::move(prediction);
        result.hypothesis = std::move(next);
        result.residual = std::move(r);
        result.chi_squared = chi;
        better = true;
        break;
      }
      if (age > 0) break;  // with slopes of another place: better look here first
    }
    const double gained = before - result.chi_squared;
    const bool kept = age > 0;
    ++age;
    if (better && gained > enough) {
      if (share < 1.0) trust = std::max(0.05, trust * 0.5);
      if (gained < 0.7 * promised) age = -1;
      continue;
    }
    if (!kept) break;
    age = -1;  // slopes that were kept end where they are right, which need not be the minimum
  }
  return result;
}

}  // namespace host_sim::diagnose
