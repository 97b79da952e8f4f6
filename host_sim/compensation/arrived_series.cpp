#include "host_sim/compensation/arrived_series.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/description/compensation_setup.hpp"
#include "host_sim/compensation/ideal_machine.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::compensation {
namespace {

using firmware::compensation::Coefficients;
using firmware::compensation::Settings;

/// Each frequency times this is the next. Twice the step: a peak of 1 % damping has three points, a₁ moves by 1e-4.
constexpr double finer_grid = 1.01;
/// Of (1), each with the motion that the last coefficients make. The paper's rig: 1e-3 of a₁ behind two, 1e-6 behind
/// five.
constexpr int series_rounds = 6;

struct SeriesLine {
  stability::Complex s, machine;  ///< jω; M
  stability::Complex loop;        ///< e^{−sτ} Q/P
  double power{};                 ///< |G ω x|² of the loop without a machine, times |1 + Q₀/P₀|² and df
};

std::vector<SeriesLine> lines_of(const model::RigParameters<double>& rig, double bandwidth) {
  const stability::LinearRig ideal = stability::linearise(without_delay(rig)), real = stability::linearise(rig);
  const stability::RoadResponse road(ideal, 0.0, 0.0);
  const auto [over, under] = real.machine_response();
  std::vector<SeriesLine> lines;
  for (double hz = lowest_hz; hz < highest_hz; hz *= finer_grid) {
    const double omega = full_turn * hz;
    const stability::Complex s(0.0, omega);
    const stability::Complex x = road(model::Channel::x_cmd, omega) * (1.0 + ideal.q(s) / ideal.p(s));
    const double filter = 1.0 / (1.0 + std::pow(hz / bandwidth, 8.0));
    lines.push_back({s, over(s) / under(s) * std::polar(1.0, -omega * real.machine_delay),
                     real.q(s) / real.p(s) * std::polar(1.0, -omega * real.delay()), std::norm(x) * filter * hz});
  }
  return lines;
}

}  // namespace

void keep_within_bounds(Settings& settings) {
  for (std::size_t i = 0; i < settings.given.size(); ++i) {
    settings.given[i] = std::clamp(settings.given[i], settings.lowest[i], settings.highest[i]);
  }
}

Coefficients arrived_series(const Settings& settings, const model::RigParameters<double>& rig) {
  model::MachinePath<double> path;
  rig.effects.act_on(path);
  const Eigen::Index count = settings.order + 1;
  const double unit = full_turn * settings.bandwidth;
  Settings found = settings;
  found.given = settings.order <= 2 ? firmware::compensation::inverse_at(path, 1.0, firmware::wheel_mode(rig))
                                    : firmware::compensation::inverse_series(path, 1.0);
  keep_within_bounds(found);
  const std::vector<SeriesLine> lines = lines_of(rig, settings.bandwidth);
  for (int round = 0; round < series_rounds; ++round) {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (const SeriesLine& line : lines) {
      Eigen::VectorXcd powers(count);  // of jω/unit
      stability::Complex series;
      stability::Complex power = 1.0;
      for (Eigen::Index i = 0; i < count; ++i, power *= line.s / unit) {
        powers(i) = power;
        series += found.given[static_cast<std::size_t>(i)] * std::pow(unit, static_cast<double>(i)) * power;
      }
      const double weight = line.power / std::norm(1.0 + line.loop * series);  // (2)
      const stability::Complex reached = line.machine * series;
      products += weight * (powers.conjugate() * (reached * powers).transpose()).real();
      right += weight * (powers.conjugate() * series).real();
    }
    const Eigen::VectorXd solved = products.colPivHouseholderQr().solve(right);
    for (Eigen::Index i = 0; i < count; ++i) {
      found.given[static_cast<std::size_t>(i)] = solved(i) / std::pow(unit, static_cast<double>(i));
    }
    keep_within_bounds(found);
  }
  return found.given;
}

}  // namespace host_sim::compensation
