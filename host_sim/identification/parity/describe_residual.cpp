#include "host_sim/identification/parity/describe_residual.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/identification/parity/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Samples of the residual and the motion, and their squares second by second.
struct ExcessSeries {
  std::vector<std::array<double, 4>> rows;        ///< r, d, ḋ, d̈ of every fourth sample
  std::vector<double> motion_power, error_power;  ///< Σ ḋ², Σ r² of each second
};

void add_recording(const Signal& motion, const ResidualSeries& residual, const firmware::Recording& recording,
                   const SmoothWindow& window, ExcessSeries& series) {
  std::array<std::vector<double>, 3> moved;
  for (int order = 0; order < 3; ++order) {
    moved[static_cast<std::size_t>(order)] = samples_of(recording, derived(motion, order), &window);
  }
  const auto second = static_cast<std::size_t>(1.0 / recording.sample_period);
  double speed = 0.0, squares = 0.0;
  std::size_t inside = 0;
  for (std::size_t k = 0; k < recording.size(); ++k) {
    if (!residual.trusted[k]) continue;
    const double r = residual.values[k], v = moved[1][k];
    speed += v * v;
    squares += r * r;
    if (++inside == second) {
      series.motion_power.push_back(speed);
      series.error_power.push_back(squares);
      speed = squares = 0.0;
      inside = 0;
    }
    if (k % 4 == 0) series.rows.push_back({r, moved[0][k], v, moved[2][k]});
  }
}

/// (1) and (2)
struct Dependence {
  double linear = 0.0, law = 0.0;  ///< shares
  const char* law_words = "";
};
Dependence dependence(const ExcessSeries& series) {
  struct Law {
    const char* words;
    double (*value)(double d, double v);
  };
  constexpr std::array<Law, 6> laws{
      {{"the direction of the velocity, as dry friction", [](double, double v) { return v > 0.0 ? 1.0 : -1.0; }},
       {"the square of the velocity", [](double, double v) { return v * std::abs(v); }},
       {"the cube of the velocity", [](double, double v) { return v * v * v; }},
       {"the size of the velocity, whichever its direction", [](double, double v) { return std::abs(v); }},
       {"the cube of the deflection", [](double d, double) { return d * d * d; }},
       {"the square of the deflection, whichever its direction", [](double d, double) { return d * d; }}}};
  const auto n = static_cast<Eigen::Index>(series.rows.size());
  Eigen::MatrixXd linear(n, 4);
  Eigen::VectorXd whole(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& [r, d, v, a] = series.rows[static_cast<std::size_t>(k)];
    whole(k) = r;
    linear.row(k) << 1.0, d, v, a;
  }
  for (Eigen::Index j = 0; j < 4; ++j) linear.col(j) /= std::max(linear.col(j).norm(), 1e-300);
  const Eigen::LDLT<Eigen::MatrixXd> normal(linear.transpose() * linear);
  const auto beyond = [&](const Eigen::VectorXd& y) -> Eigen::VectorXd {
    return y - linear * normal.solve(linear.transpose() * y);
  };
  const Eigen::VectorXd left = beyond(whole);
  Dependence found;
  found.linear = 1.0 - left.squaredNorm() / whole.squaredNorm();
  for (const Law& law : laws) {
    Eigen::VectorXd y(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& row = series.rows[static_cast<std::size_t>(k)];
      y(k) = law.value(row[1], row[2]);
    }
    const Eigen::VectorXd z = beyond(y);
    const double share = std::pow(z.dot(left), 2) / std::max(z.squaredNorm() * whole.squaredNorm(), 1e-300);
    if (share <= found.law) continue;
    found.law = share;
    found.law_words = law.words;
  }
  return found;
}

/// (3), where the motion varies enough to tell.
struct Growth {
  double variation = 0.0, power = 0.0;
};
Growth growth(const ExcessSeries& series) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto count = static_cast<double>(series.motion_power.size());
  for (std::size_t k = 0; k < series.motion_power.size(); ++k) {
    const double a = 0.5 * std::log(std::max(series.motion_power[k], 1e-300));
    const double b = 0.5 * std::log(std::max(series.error_power[k], 1e-300));
    x += a / count, y += b / count, xx += a * a / count, xy += a * b / count;
  }
  const double variation = xx - x * x;
  return {variation, variation > 0.0 ? (xy - x * y) / variation : 0.0};
}

/// (4)
double drift(const ExcessSeries& series) {
  const std::size_t n = series.motion_power.size(), third = n / 3;
  double early = 0.0, early_motion = 0.0, late = 0.0, late_motion = 0.0;
  for (std::size_t k = 0; k < third; ++k) {
    early += series.error_power[k], early_motion += series.motion_power[k];
    late += series.error_power[n - 1 - k], late_motion += series.motion_power[n - 1 - k];
  }
  return std::sqrt((late / late_motion) / (early / early_motion));
}

}  // namespace

std::string describe_residual(const Signal& motion, const std::vector<ResidualSeries>& residual,
                              const std::vector<firmware::Recording>& recordings, const SmoothWindow& window) {
  ExcessSeries series;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    add_recording(motion, residual[r], recordings[r], window, series);
  }
  constexpr std::size_t fewest_rows = 100, fewest_seconds = 4;
  if (series.rows.size() < fewest_rows || series.motion_power.size() < fewest_seconds) return "";
  std::string words;
  char text[200];
  const auto say = [&] { words.append(words.empty() ? "" : "; ").append(text); };
  const Dependence found = dependence(series);
  if (found.linear > thresholds::described_linear) {
    std::snprintf(text, sizeof text, "%.0f %% follow the motion linearly", 100.0 * found.linear);
    say();
  }
  if (found.law > thresholds::described_law) {
    std::snprintf(text, sizeof text, "%.0f %% go with %s", 100.0 * found.law, found.law_words);
    say();
  }
  if (const auto [variation, power] = growth(series); variation > thresholds::described_variation) {
    // Slope of ln rms(residual) over ln rms(motion): 0 is friction, 1 a linear force, 2 a quadratic one.
    constexpr double alike = 0.25;
    if (power < -alike) {
      std::snprintf(text, sizeof text, "it is larger where the motion is smaller");
    } else if (power < alike) {
      std::snprintf(text, sizeof text, "it is as large in small motion as in large, as friction is");
    } else if (power < 1.0 - alike) {
      std::snprintf(text, sizeof text, "it grows slower than the motion, as its power %.1f", power);
    } else if (power < 1.0 + alike) {
      std::snprintf(text, sizeof text, "it grows in proportion to the motion");
    } else {
      std::snprintf(text, sizeof text, "it grows faster than the motion, as its power %.1f", power);
    }
    say();
  }
  const double ratio = drift(series);
  if (ratio > thresholds::described_drift || ratio < 1.0 / thresholds::described_drift) {
    std::snprintf(text, sizeof text, "%.1f times as large at the end as at the beginning", ratio);
    say();
  }
  return words;
}

}  // namespace host_sim::identification
