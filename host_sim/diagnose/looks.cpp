#include "host_sim/diagnose/looks.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

namespace host_sim::diagnose {

std::string looks_of(const Signal& motion, const std::vector<ResidualSeries>& residual,
                     const std::vector<Recording>& recordings, const SmoothWindow& window) {
  std::vector<Eigen::VectorXd> rows;  // r, 1, d, ḋ, d̈
  std::vector<double> loudness, error;
  for (std::size_t at = 0; at < recordings.size(); ++at) {
    const Recording& recording = recordings[at];
    std::array<std::vector<double>, 3> moved;
    for (int order = 0; order < 3; ++order) {
      moved[static_cast<std::size_t>(order)] = samples_of(recording, derived(motion, order), &window);
    }
    const auto second = static_cast<std::size_t>(1.0 / recording.sample_period);
    double speed = 0.0, squares = 0.0;
    std::size_t inside = 0;
    for (std::size_t k = 0; k < recording.size(); ++k) {
      if (!residual[at].trusted[k]) continue;
      const double r = residual[at].values[k], v = moved[1][k];
      speed += v * v;
      squares += r * r;
      if (++inside == second) {
        loudness.push_back(speed);
        error.push_back(squares);
        speed = squares = 0.0;
        inside = 0;
      }
      if (k % 4 != 0) continue;
      Eigen::VectorXd row(5);
      row << r, 1.0, moved[0][k], v, moved[2][k];
      rows.push_back(row);
    }
  }
  if (rows.size() < 100 || loudness.size() < 4) return "";
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd linear(n, 4);
  Eigen::VectorXd whole(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    whole(k) = rows[static_cast<std::size_t>(k)](0);
    linear.row(k) = rows[static_cast<std::size_t>(k)].tail(4);
  }
  for (Eigen::Index j = 0; j < 4; ++j) linear.col(j) /= std::max(linear.col(j).norm(), 1e-300);
  const Eigen::LDLT<Eigen::MatrixXd> normal(linear.transpose() * linear);
  const auto beyond = [&](const Eigen::VectorXd& y) -> Eigen::VectorXd {
    return y - linear * normal.solve(linear.transpose() * y);
  };
  const Eigen::VectorXd left = beyond(whole);
  const double of_motion = 1.0 - left.squaredNorm() / whole.squaredNorm();

  struct Law {
    const char* words;
    std::function<double(double d, double v)> value;
  };
  const std::vector<Law> laws{
      {"the direction of the velocity, as dry friction", [](double, double v) { return v > 0.0 ? 1.0 : -1.0; }},
      {"the square of the velocity", [](double, double v) { return v * std::abs(v); }},
      {"the cube of the velocity", [](double, double v) { return v * v * v; }},
      {"the size of the velocity, whichever its direction", [](double, double v) { return std::abs(v); }},
      {"the cube of the deflection", [](double d, double) { return d * d * d; }},
      {"the square of the deflection, whichever its direction", [](double d, double) { return d * d; }}};
  double best = 0.0;
  const char* words = "";
  for (const Law& law : laws) {
    Eigen::VectorXd y(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& row = rows[static_cast<std::size_t>(k)];
      y(k) = law.value(row(2), row(3));
    }
    const Eigen::VectorXd z = beyond(y);
    const double share = std::pow(z.dot(left), 2) / std::max(z.squaredNorm() * whole.squaredNorm(), 1e-300);
    if (share <= best) continue;
    best = share;
    words = law.words;
  }
  char text[200];
  std::string looks;
  const auto say = [&](const std::string& what) { looks += (looks.empty() ? "" : "; ") + what; };
  if (of_motion > 0.3) {
    std::snprintf(text, sizeof text, "%.0f %% follow the motion linearly", 100.0 * of_motion);
    say(text);
  }
  if (best > 0.2) {
    std::snprintf(text, sizeof text, "%.0f %% go with %s", 100.0 * best, words);
    say(text);
  }
  // ln of the residual over ln of the motion, second by second; and what is left of it through the record.
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto count = static_cast<double>(loudness.size());
  for (std::size_t k = 0; k < loudness.size(); ++k) {
    const double a = 0.5 * std::log(std::max(loudness[k], 1e-300)), b = 0.5 * std::log(std::max(error[k], 1e-300));
    x += a / count, y += b / count, xx += a * a / count, xy += a * b / count;
  }
  if (xx - x * x > 0.02) {
    std::snprintf(text, sizeof text, "grows with the motion's power %.1f", (xy - x * y) / (xx - x * x));
    say(text);
  }
  const std::size_t third = loudness.size() / 3;
  double early = 0.0, early_motion = 0.0, late = 0.0, late_motion = 0.0;
  for (std::size_t k = 0; k < third; ++k) {
    early += error[k], early_motion += loudness[k];
    late += error[error.size() - 1 - k], late_motion += loudness[error.size() - 1 - k];
  }
  const double drift = std::sqrt((late / late_motion) / (early / early_motion));
  if (drift > 1.6 || drift < 1.0 / 1.6) {
    std::snprintf(text, sizeof text, "%.1f times as large at the end as at the beginning", drift);
    say(text);
  }
  return looks;
}

}  // namespace host_sim::diagnose
