// What a period of the Kalman filter and of the rollout costs.
//
//   estimator/kalman       11 states (car, absorber, road), 7 channels, fresh samples: two passes a period
//   estimator/kalman_late  the same with a channel 5 ms late: seven passes
//   estimator/rollout      the choice among 0 … 6 ducts, valves 20 ms late
//   estimator/covariance   for comparison: one pass of a filter that carries its covariance along, P ← Φ P Φᵀ + Q and a
//                          Joseph update for each channel, by Eigen with vectors; kalman takes at most 0.5 of it
//
//   rigtwin_bench --benchmark_filter=estimator/ --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <array>
#include <memory>

#include "firmware/loop/duct_control/duct_policy.hpp"
#include "firmware/loop/kalman/kalman_filter.hpp"

namespace {

using model::Channel;

constexpr double filter_period = 1e-3;
constexpr std::array filter_channels{Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b,
                                     Channel::F_w, Channel::dz_w,  Channel::dz_b};
constexpr std::array filter_noise{2e-5, 0.05, 0.05, 0.05, 10.0, 5e-5, 5e-5};

model::RigParameters<double> rig() {
  model::RigParameters<double> rig;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, 1140.0};
  rig.has_fdva = true;
  rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

firmware::KalmanSettings settings(double age) {
  firmware::KalmanSettings settings;
  for (std::size_t i = 0; i < filter_channels.size(); ++i)
    settings.noise[model::index(filter_channels[i])] = filter_noise[i];
  settings.age[model::index(Channel::dz_b)] = age;
  return settings;
}

void filter(benchmark::State& state, double age) {
  const firmware::EstimatorEquations equations(settings(age), rig());
  const auto gains = std::make_unique<firmware::SteadyGains>(equations, filter_period);
  const auto filter = std::make_unique<firmware::KalmanFilter>(equations, *gains, filter_period);
  filter->switch_to(hal::Openings::first(2));
  hal::Frame frame;
  hal::Time now{};
  double value = 1e-3;
  for (auto _ : state) {
    now += hal::milliseconds(1);
    for (const Channel c : filter_channels) {
      const bool late = c == Channel::dz_b && age > 0.0;
      frame.channels[model::index(c)] = {value, late ? now - hal::seconds(age) : now, hal::Quality::good};
    }
    filter->step(frame, 0, now);
    value = -value;
    benchmark::DoNotOptimize(filter->state()(0));
  }
}
void kalman(benchmark::State& state) { filter(state, 0.0); }
void kalman_late(benchmark::State& state) { filter(state, 5e-3); }

void rollout(benchmark::State& state) {
  const firmware::EstimatorEquations equations(settings(0.0), rig());
  const auto gains = std::make_unique<firmware::SteadyGains>(equations, filter_period);
  firmware::DuctPolicySettings policy;
  policy.policy = firmware::DuctPolicyKind::rollout;
  policy.delay = 0.020;
  const auto ducts = std::make_unique<firmware::DuctPolicy>(equations, *gains, policy, filter_period);
  firmware::EstimatorVector x = firmware::EstimatorVector::Constant(1e-3);
  for (auto _ : state) {
    x = -x;
    ducts->told(ducts->choose(x, {}));
    benchmark::DoNotOptimize(ducts->standing());
  }
}

void covariance(benchmark::State& state) {
  constexpr int n = 11;
  using Matrix = Eigen::Matrix<double, n, n>;
  using Vector = Eigen::Matrix<double, n, 1>;
  const firmware::EstimatorEquations equations(settings(0.0), rig());
  const auto gains = std::make_unique<firmware::SteadyGains>(equations, filter_period);
  gains->compute(2);
  const Matrix phi = gains->transition().topLeftCorner<n, n>(), q = gains->noise().topLeftCorner<n, n>();
  Matrix p = gains->posterior().topLeftCorner<n, n>();
  Vector x = Vector::Constant(1e-3);
  std::array<Vector, filter_channels.size()> rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = equations.row(equations.channel(static_cast<int>(i)), 2, true).head<n>();
  }
  for (auto _ : state) {
    x = (phi * x).eval();
    p = (phi * p * phi.transpose() + q).eval();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double variance = filter_noise[i] * filter_noise[i];
      const Vector k = p * rows[i] / (rows[i].dot(p * rows[i]) + variance);
      x += k * (1e-3 - rows[i].dot(x));
      const Matrix left = Matrix::Identity() - k * rows[i].transpose();
      p = (left * p * left.transpose() + k * variance * k.transpose()).eval();
    }
    benchmark::DoNotOptimize(x);
  }
}

BENCHMARK(kalman)->Name("estimator/kalman");
BENCHMARK(kalman_late)->Name("estimator/kalman_late");
BENCHMARK(rollout)->Name("estimator/rollout");
BENCHMARK(covariance)->Name("estimator/covariance");

}  // namespace
