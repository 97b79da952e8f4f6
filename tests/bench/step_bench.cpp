// What a step costs: against the least a linear model of six states can cost, and against a general integrator.
//
//   step/hil_fdva        one full nonlinear step of the hil rig (quarter car, FDVA with two ducts, machine, 10 ms delay
//                        line) and all its sensors; at most 2.5 × limit_matvec6 and at most 0.5 × odeint_rk4
//   step/limit_matvec6   x = A x + B u, A 6×6, B 6×2
//   step/odeint_rk4      the same equations without delay and sensors by Boost.odeint's runge_kutta4
//   step/hil_fdva_silent the same rig after minutes of a flat road; costs no more than the shaken one
//   step/hil_linear, step/quarter_car_linear, step/quarter_car_fdva, step/quarter_car_effects: for comparison
//   step/laws_*          quarter_car_linear with laws from tables: its damper as a curve of 33 points, a curve of the
//                        spring beside it, a surface, one and eight branches; wanted is 6 ns a curve, 3 ns a branch
//
// The least of the repetitions of one run is compared, which main.cpp prints:
//   rigtwin_bench --benchmark_filter=step/ --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "model/components/road_filter.hpp"
#include "model/rig/rig_model.hpp"

namespace {

using Rig = model::RigModel<>;
using model::Motion;

constexpr double period = 1e-3;
constexpr std::size_t road_samples =
    256;  // stays in the first-level cache beside the model: what is measured is a step

std::vector<Motion<double>> class_b_road() {
  const model::RoadFilter<double> filter({64e-6, 100.0 / 3.6, 0.01, 100.0}, period);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0.0, std::sqrt(0.5 / period));
  auto state = model::RoadFilter<double>::State::Zero().eval();
  std::vector<Motion<double>> road(road_samples);
  for (auto& sample : road) {
    state = filter.step(state, noise(generator));
    sample = filter.motion(state);
  }
  return road;
}

model::RigParameters<double> reference_rig(model::RigKind kind, bool with_fdva) {
  model::RigParameters<double> rig;
  rig.kind = kind;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, with_fdva ? 0.0 : 1140.0};
  if (kind == model::RigKind::hil) {
    rig.machine.virtual_damping = 1140.0;
    rig.effects.add(model::ActuatorDelay<double>{0.010});
  }
  rig.has_fdva = with_fdva;
  if (with_fdva) rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

void run_rig(benchmark::State& state, const model::RigParameters<double>& rig, bool shaken) {
  const Rig model(rig, period);
  auto road = class_b_road();
  Rig::State x = model.start();
  Rig::Input in;
  for (const auto& sample : road) {
    in.foot_point = sample;
    model.step(x, in);
  }
  if (!shaken) {
    std::fill(road.begin(), road.end(), Motion<double>{});
    in = {};
    for (int i = 0; i < 600'000; ++i) model.step(x, in);
  }
  std::size_t i = 0;
  for (auto _ : state) {
    in.foot_point = road[i];
    model.step(x, in);
    auto sensors = model.measured(x);
    benchmark::DoNotOptimize(sensors);
    i = (i + 1) % road_samples;
  }
}

void hil_fdva(benchmark::State& state) { run_rig(state, reference_rig(model::RigKind::hil, true), true); }
void hil_fdva_silent(benchmark::State& state) { run_rig(state, reference_rig(model::RigKind::hil, true), false); }
void hil_linear(benchmark::State& state) { run_rig(state, reference_rig(model::RigKind::hil, false), true); }
void quarter_car_linear(benchmark::State& state) {
  run_rig(state, reference_rig(model::RigKind::quarter_car, false), true);
}
void quarter_car_fdva(benchmark::State& state) {
  run_rig(state, reference_rig(model::RigKind::quarter_car, true), true);
}
void quarter_car_effects(benchmark::State& state) {
  auto rig = reference_rig(model::RigKind::quarter_car, true);
  rig.effects.add(model::CoulombFriction<double>{50.0});
  rig.effects.add(model::TyreLiftOff<double>{});
  rig.effects.add(model::ForceSensorInertia<double>{5.0});
  run_rig(state, rig, true);
}

/// A digressive damper, lopsided, of 33 points up to 1.6 m/s, or a bump stop over the deflection.
model::CurveTable<double> table(model::LawOver over) {
  model::CurveTable<double> curve{.over = over, .count = model::curve_points};
  for (std::size_t i = 0; i < model::curve_points; ++i) {
    const double x = (static_cast<double>(i) - 16.0) / 16.0;
    curve.at[i] = (over == model::LawOver::velocity ? 1.6 : 0.08) * x;
    curve.value[i] =
        over == model::LawOver::velocity ? (x > 0.0 ? 3000.0 : 1500.0) * x / (0.3 + std::abs(x)) : 900.0 * x * x * x;
  }
  return curve;
}

model::RigParameters<double> rig_with_laws(int curves, int surfaces, int branches) {
  auto rig = reference_rig(model::RigKind::quarter_car, false);
  if (curves + surfaces > 0) rig.suspension.damping = 0.0;
  if (curves > 0) rig.laws.curves[rig.laws.curve_count++] = table(model::LawOver::velocity);
  if (curves > 1) rig.laws.curves[rig.laws.curve_count++] = table(model::LawOver::deflection);
  if (surfaces > 0) {
    auto& surface = rig.laws.surfaces[rig.laws.surface_count++];
    surface.rows = surface.columns = model::surface_points;
    for (std::size_t i = 0; i < model::surface_points; ++i) {
      surface.deflection[i] = 0.01 * (static_cast<double>(i) - 8.0);
      surface.velocity[i] = 0.2 * (static_cast<double>(i) - 8.0);
    }
    for (std::size_t i = 0; i < model::surface_points; ++i) {
      for (std::size_t j = 0; j < model::surface_points; ++j) {
        surface.value[i][j] =
            1100.0 * surface.velocity[j] * (1.0 + 20.0 * surface.deflection[i] * surface.deflection[i]);
      }
    }
  }
  for (int i = 0; i < branches; ++i) {
    auto& branch = rig.laws.branches[rig.laws.branch_count++];
    branch.stiffness = 1000.0 * (i + 1);
    (i % 2 == 0 ? branch.slip_force : branch.time_constant) = i % 2 == 0 ? 5.0 + i : 0.01 * i;
  }
  return rig;
}
template <int curves, int surfaces, int branches>
void laws(benchmark::State& state) {
  run_rig(state, rig_with_laws(curves, surfaces, branches), true);
}

void limit_matvec6(benchmark::State& state) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const auto road = class_b_road();
  Matrix6 a;
  Eigen::Matrix<double, 6, 2> b;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) a(r, c) = r == c ? 0.9 : 0.01 * (r - c);  // decays, so that no number grows or dies
    for (int c = 0; c < 2; ++c) b(r, c) = 0.1 * (r + c + 1);
  }
  benchmark::DoNotOptimize(a);
  benchmark::DoNotOptimize(b);
  Vector6 x = Vector6::Ones();
  std::size_t i = 0;
  for (auto _ : state) {
    const Eigen::Vector2d u(road[i].position, road[i].velocity);
    x = (a * x + b * u).eval();
    benchmark::DoNotOptimize(x);
    i = (i + 1) % road_samples;
  }
}

/// (1)–(9) of physics: z_w, ż_w, z_b, ż_b, y, q₁, q₂; the foot point goes straight from sample to sample.
struct CarOnTwoDucts {
  using State = std::array<double, 7>;
  double m_b, m_w, k_t, b_t, k_b, b_b, virtual_damping, k_c, area, inertance, laminar, minor;
  Motion<double> from, to;

  void operator()(const State& x, State& rate, double t) const {
    const double s = t / period;
    const double z_r = from.position + s * (to.position - from.position);
    const double v_r = from.velocity + s * (to.velocity - from.velocity);
    const double dz_b = x[0] - x[2], v_rel = x[1] - x[3];
    const double f_c = k_c * (dz_b - x[4]);
    const double f_s = k_b * dz_b + (b_b + virtual_damping) * v_rel + f_c;
    const double f_w = k_t * (z_r - x[0]) + b_t * (v_r - x[1]);
    const double pressure = f_c / area;
    rate[0] = x[1];
    rate[1] = (f_w - f_s) / m_w;
    rate[2] = x[3];
    rate[3] = f_s / m_b;
    rate[4] = (x[5] + x[6]) / area;
    rate[5] = (pressure - laminar * x[5] - minor * x[5] * std::abs(x[5])) / inertance;
    rate[6] = (pressure - laminar * x[6] - minor * x[6] * std::abs(x[6])) / inertance;
  }
};

void odeint_rk4(benchmark::State& state) {
  const auto road = class_b_road();
  const auto rig = reference_rig(model::RigKind::hil, true);
  const auto duct = model::Fdva<double>::duct(rig.fdva);
  CarOnTwoDucts car{rig.body.mass,
                    rig.wheel.mass,
                    rig.tyre.stiffness,
                    rig.tyre.damping,
                    rig.suspension.stiffness,
                    rig.suspension.damping,
                    rig.machine.virtual_damping,
                    rig.fdva.coupling_stiffness,
                    rig.fdva.piston_area,
                    duct.inertance,
                    duct.laminar_loss,
                    duct.minor_loss,
                    {},
                    {}};
  boost::numeric::odeint::runge_kutta4<CarOnTwoDucts::State> stepper;
  CarOnTwoDucts::State x{};
  std::size_t i = 0;
  for (auto _ : state) {
    car.from = car.to;
    car.to = road[i];
    stepper.do_step(std::cref(car), x, 0.0, period);
    benchmark::DoNotOptimize(x);
    i = (i + 1) % road_samples;
  }
}

double least(const std::vector<double>& times) { return *std::min_element(times.begin(), times.end()); }

BENCHMARK(limit_matvec6)->Name("step/limit_matvec6")->ComputeStatistics("min", least);
BENCHMARK(hil_fdva)->Name("step/hil_fdva")->ComputeStatistics("min", least);
BENCHMARK(odeint_rk4)->Name("step/odeint_rk4")->ComputeStatistics("min", least);
BENCHMARK(hil_fdva_silent)->Name("step/hil_fdva_silent")->ComputeStatistics("min", least);
BENCHMARK(hil_linear)->Name("step/hil_linear")->ComputeStatistics("min", least);
BENCHMARK(quarter_car_linear)->Name("step/quarter_car_linear")->ComputeStatistics("min", least);
BENCHMARK(quarter_car_fdva)->Name("step/quarter_car_fdva")->ComputeStatistics("min", least);
BENCHMARK(quarter_car_effects)->Name("step/quarter_car_effects")->ComputeStatistics("min", least);
BENCHMARK(laws<1, 0, 0>)->Name("step/laws_curve")->ComputeStatistics("min", least);
BENCHMARK(laws<2, 0, 0>)->Name("step/laws_two_curves")->ComputeStatistics("min", least);
BENCHMARK(laws<0, 1, 0>)->Name("step/laws_surface")->ComputeStatistics("min", least);
BENCHMARK(laws<0, 0, 1>)->Name("step/laws_branch")->ComputeStatistics("min", least);
BENCHMARK(laws<0, 0, 8>)->Name("step/laws_eight_branches")->ComputeStatistics("min", least);

}  // namespace
