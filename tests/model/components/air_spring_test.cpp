// The air spring by itself: its thermodynamics against the first law, closed forms and finite differences.
#include "model/components/air_spring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace air_spring_test {
namespace {

using Spring = model::AirSpring<double>;
using Parameters = Spring::Parameters;
using Condition = model::AirSpringCondition<double>;

constexpr double kappa = 1.4;
constexpr double pi = 3.14159265358979323846;

/// The set of paper_hil_aas.toml.
Parameters paper() {
  Parameters p;
  p.fitted = true;
  p.pressure = 7e5;
  p.area = 40.64e-4;
  p.volume = 0.588e-3;
  return p;
}

/// Two bellows, an area that grows with stroke, a volume that grows with the area: nothing is zero.
Parameters elaborate() {
  Parameters p = paper();
  p.area_per_stroke = 0.01;
  p.volume_per_area = 5e-5;
  p.counter_pressure = 2e5;
  p.counter_area = 20e-4;
  p.counter_volume = 0.4e-3;
  p.actuator_stroke = 0.5;
  return p;
}

Spring spring_of(const Parameters& p, double period, Condition condition = {.polytropic_exponent = kappa}) {
  return {p, condition, period};
}

/// Force at a deflection and a held area, on the adiabat of rest.
double adiabatic_force(const Parameters& p, double s, double u) {
  const Spring spring = spring_of(p, 1e-3, {.polytropic_exponent = kappa, .stuck = true, .stuck_at = u});
  return spring.total_force(spring.start(s, false));
}

// Point. Against the C library, over the whole range: the header says 2e-15.
TEST(PowerOfAGas, IsThatOfTheLibrary) {
  for (double v = 0.25; v <= 4.0; v += 1e-3) {
    for (const double a : {-1.0, 0.0, 0.2, 0.4, 0.67, 1.0}) {
      EXPECT_NEAR(model::gas::power(v, a) / std::pow(v, a), 1.0, 2e-15) << v << " " << a;
    }
  }
}

// Golden. Numbers of the set that carries the paper's body: 31.5 kN/m, 2845 N, 28.4 N for 1 % of the area.
TEST(AirSpring, HasTheNumbersOfThePapersBody) {
  EXPECT_NEAR(Spring::stiffness(paper(), kappa), 31.5e3, 50.0);
  EXPECT_NEAR(Spring::load(paper()), 290.0 * 9.81, 1.0);
  EXPECT_NEAR(0.01 * Spring::force_per_area(paper(), kappa), 28.4, 0.05);
}

// Point (9), (10). Central differences of (1) with an error of third order: 1e-4 m leaves (s/V)² ~ 1e-6.
TEST(AirSpring, HasTheSlopesOfItsForce) {
  for (const Parameters& p : {paper(), elaborate()}) {
    const double d = 1e-4;
    EXPECT_NEAR((adiabatic_force(p, d, 0.0) - adiabatic_force(p, -d, 0.0)) / (2.0 * d) / Spring::stiffness(p, kappa),
                1.0, 1e-5);
    EXPECT_NEAR(
        (adiabatic_force(p, 0.0, d) - adiabatic_force(p, 0.0, -d)) / (2.0 * d) / Spring::force_per_area(p, kappa), 1.0,
        1e-5);
  }
}

// Point (10). A larger area that also takes volume loses authority, and has none at V_u = (p₀ − p_a) V/(κ p₀).
TEST(AirSpring, LosesAuthorityToTheVolumeOfItsArea) {
  Parameters p = paper();
  const double whole = Spring::force_per_area(p, kappa);
  const double none = 7e5 * p.volume / (kappa * 801325.0);
  p.volume_per_area = 0.5 * none;
  EXPECT_NEAR(Spring::force_per_area(p, kappa) / whole, 0.5, 1e-12);
  p.volume_per_area = 1.5 * none;
  EXPECT_LT(Spring::force_per_area(p, kappa), 0.0);
}

// Law. Equal bellows against each other carry nothing, and opposite changes of area double the authority.
TEST(AirSpring, OfTwoEqualBellowsHasTwiceTheAuthority) {
  Parameters p = paper();
  const double single = Spring::force_per_area(p, kappa), stiffness = Spring::stiffness(p, kappa);
  p.counter_pressure = p.pressure;
  p.counter_area = p.area;
  p.counter_volume = p.volume;
  EXPECT_NEAR(Spring::force_per_area(p, kappa) / single, 2.0, 1e-12);
  EXPECT_NEAR(Spring::stiffness(p, kappa) / stiffness, 2.0, 1e-12);
  EXPECT_NEAR(Spring::load(p), 0.0, 1e-9);
}

// Law. First law of the gas: what it stores is the heat that came in less the work that it did, while stroke and area
// both move. The trapezium's error falls as dt²: 4 for half the step.
TEST(AirSpring, StoresHeatLessWork) {
  const auto imbalance = [](double dt) {
    Parameters p = elaborate();
    p.heat_time = 0.3;
    const Spring spring = spring_of(p, dt);
    const double p1 = p.pressure + p.ambient_pressure, p2 = p.counter_pressure + p.ambient_pressure;
    const auto energy = [&](const Spring::State& x) {
      return (spring.pressure(x) * spring.volume(x) + spring.counter_pressure(x) * spring.counter_volume(x)) /
             (kappa - 1.0);
    };
    const auto heat = [&](const Spring::State& x) {
      return (p1 * p.volume - spring.pressure(x) * spring.volume(x) + p2 * p.counter_volume -
              spring.counter_pressure(x) * spring.counter_volume(x)) /
             ((kappa - 1.0) * p.heat_time);
    };
    Spring::State x = spring.start(0.0, true);
    const double stored = energy(x);
    double balance = 0.0, moved = 0.0;
    for (int i = 1; i <= std::lround(1.7 / dt); ++i) {
      const Spring::State before = x;
      x.command = 0.05 * std::sin(9.0 * i * dt);
      spring.step(x, 0.03 * std::sin(7.0 * i * dt));
      const double work =
          0.5 * ((spring.pressure(x) + spring.pressure(before)) * (spring.volume(x) - spring.volume(before)) +
                 (spring.counter_pressure(x) + spring.counter_pressure(before)) *
                     (spring.counter_volume(x) - spring.counter_volume(before)));
      balance += 0.5 * (heat(x) + heat(before)) * dt - work;
      moved += std::abs(work);
    }
    return std::abs(energy(x) - stored - balance) / moved;
  };
  const double coarse = imbalance(1e-3), fine = imbalance(5e-4);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);
}

// Law. F/s of a small sine is k − k_r/(1 + jωT): a Maxwell branch, whose loss angle is at most 9.6° and largest at
// √(1/κ)/T; never a dashpot, whose loss would grow with frequency.
TEST(AirSpring, LosesHeatLikeAMaxwellBranch) {
  const Parameters p = paper();
  const double k = Spring::stiffness(p, kappa), branch = Spring::heat_stiffness(p, kappa);
  double largest = 0.0;
  for (const double omega_t : {0.1, 0.845, 5.0, 30.0}) {
    const double omega = omega_t / p.heat_time, dt = 2.0 * pi / omega / 2000.0;
    const Spring spring = spring_of(p, dt);
    Spring::State x = spring.start(0.0, true);
    std::complex<double> response = 0.0;
    const int settled = 2000 * (omega_t < 1.0 ? 2 : 40);
    for (int i = 1; i <= settled + 2000; ++i) {
      spring.step(x, 1e-5 * std::sin(omega * i * dt));
      if (i > settled) response += spring.total_force(x) * std::polar(1.0, -omega * i * dt);
    }
    response *= std::complex<double>(0.0, 2.0 / 2000.0 / 1e-5);
    const std::complex<double> expected = k - branch / std::complex<double>(1.0, omega_t);
    EXPECT_NEAR(std::abs(response / expected - 1.0), 0.0, 1e-3) << omega_t;
    largest = std::max(largest, std::arg(response) * 180.0 / pi);
  }
  EXPECT_NEAR(largest, 9.6, 0.05);
}

// Law. Compressed and held, the gas ends on the isotherm: p V = p₀ V₀.
TEST(AirSpring, EndsIsothermal) {
  const Parameters p = paper();
  const Spring spring = spring_of(p, 1e-2);
  Spring::State x = spring.start(0.0, true);
  for (int i = 0; i < 10000; ++i) spring.step(x, 0.02);
  EXPECT_NEAR(spring.pressure(x) * spring.volume(x) / (801325.0 * p.volume), 1.0, 1e-12);
}

// Point (6). After 1/ω of a step a first-order actuator has gone 1 − 1/e of it; a damped second-order one overshoots by
// e^(−πζ/√(1−ζ²)).
TEST(AirSpring, MovesItsAreaLikeALag) {
  Parameters p = paper();
  p.actuator_stroke = 0.2;
  const double dt = 1e-4;
  const auto highest = [&](const Parameters& q, int steps) {
    const Spring spring = spring_of(q, dt);
    Spring::State x = spring.start(0.0, true);
    x.command = 0.1;
    double most = 0.0;
    for (int i = 0; i < steps; ++i) {
      spring.step(x, 0.0);
      most = std::max(most, x.area);
    }
    return most;
  };
  EXPECT_NEAR(highest(p, static_cast<int>(std::lround(1.0 / (2.0 * pi * 5.0) / dt))), 0.1 * (1.0 - std::exp(-1.0)),
              1e-4);
  p.actuator_damping = 0.5;
  EXPECT_NEAR(highest(p, 5000), 0.1 * (1.0 + std::exp(-pi * 0.5 / std::sqrt(0.75))), 1e-5);
  p.actuator_rate = 0.05;
  EXPECT_NEAR(highest(p, 10000), 0.05, 5e-5);  // 1 s at this rate; the start takes a millisecond
  p.actuator_rate = 0.0;
  p.actuator_stroke = 0.03;
  EXPECT_NEAR(highest(p, 5000), 0.03, 1e-15);
}

// Fault. A stuck actuator stays where it is, whatever is commanded.
TEST(AirSpring, StaysStuck) {
  const Spring spring = spring_of(paper(), 1e-3, {.polytropic_exponent = kappa, .stuck = true, .stuck_at = 0.02});
  Spring::State x = spring.start(0.0, true);
  x.command = -0.1;
  for (int i = 0; i < 1000; ++i) spring.step(x, 0.0);
  EXPECT_EQ(x.area, 0.02);
  EXPECT_NEAR(spring.total_force(x), 0.02 * 2844.8, 1e-6);
}

// Law. A leak loses leak · m₀ a second at p₀, and at constant volume and temperature the pressure with it: e^(−leak t).
TEST(AirSpring, LosesWhatLeaks) {
  Parameters p = paper();
  p.heat_time = 1e-2;
  const Spring spring = spring_of(p, 1e-3, {.polytropic_exponent = kappa, .leak = 1e-3});
  Spring::State x = spring.start(0.0, true);
  for (int i = 0; i < 10000; ++i) spring.step(x, 0.0);
  EXPECT_NEAR(1.0 + x.mass, std::exp(-1e-2), 2e-7);  // the gas is cooler by leak · κ T: 1e-5 of the pressure
  EXPECT_NEAR(spring.pressure(x) / 801325.0, std::exp(-1e-2), 2e-5);
}

// Point (2), (3). ∂V/∂s = −A at every stroke: V = V₀ − A s − ½ A′ s², and of the second bellows V₂₀ + A₂ s.
TEST(AirSpring, DisplacesWhatItsAreaSweeps) {
  const Parameters p = elaborate();
  const Spring spring = spring_of(p, 1e-3);
  const double s = 0.04;
  const Spring::State x = spring.start(s, false);
  EXPECT_NEAR(spring.volume(x), p.volume - p.area * s - 0.5 * 0.01 * s * s, 1e-15);
  EXPECT_NEAR(spring.counter_volume(x), p.counter_volume + p.counter_area * s, 1e-15);
}

// Law. Gas that leaves takes its enthalpy along: without heat from the walls p/p₀ = (m/m₀)^κ.
TEST(AirSpring, CoolsWhatStaysWhenItLeaks) {
  Parameters p = paper();
  p.heat_time = 1e6;
  const Spring spring = spring_of(p, 1e-3, {.polytropic_exponent = kappa, .leak = 1e-2});
  Spring::State x = spring.start(0.0, true);
  for (int i = 0; i < 10000; ++i) spring.step(x, 0.0);
  EXPECT_LT(x.mass, -0.08);
  EXPECT_NEAR(spring.pressure(x) / 801325.0 / std::pow(1.0 + x.mass, kappa), 1.0, 1e-5);
}

// Point (8). Within its band the levelling leaves the body alone; beyond twice the band it works at its full rate.
TEST(AirSpring, LevelsOutsideItsBandOnly) {
  Parameters p = paper();
  p.levelling_rate = 0.01;
  const Spring spring = spring_of(p, 1e-2);
  for (const auto& [share, mass] :
       {std::pair(0.9, 0.0), std::pair(-0.9, 0.0), std::pair(1.5, 0.005), std::pair(3.0, 0.01)}) {
    Spring::State x = spring.start(share * p.levelling_band, true);
    for (int i = 0; i < 100; ++i) spring.step(x, share * p.levelling_band);
    EXPECT_NEAR(x.mass, mass, 1e-9) << share;
  }
}

// Law (8). A body that sits too low is lifted by gas that comes in, and no more once it is within the band.
TEST(AirSpring, LevelsWhatSinks) {
  Parameters p = paper();
  p.levelling_rate = 0.02;
  p.levelling_time = 0.1;
  p.heat_time = 0.1;
  const Spring spring = spring_of(p, 1e-2);
  Spring::State x = spring.start(0.0, true);
  const double load = 300.0;  // more than at rest [N]
  double s = 0.0;
  for (int i = 0; i < 20000; ++i) {
    s += (load - spring.total_force(x)) / Spring::stiffness(p, 1.0) * 0.1;
    spring.step(x, s);
  }
  EXPECT_GT(x.mass, 0.0);
  EXPECT_GT(s, 0.0);
  EXPECT_LE(s, 1.05 * p.levelling_band);
  EXPECT_GT(load / Spring::stiffness(p, 1.0), 4.0 * p.levelling_band);  // where it would sit without
}

// Law. At rest nothing moves and nothing pushes: exact zeros.
TEST(AirSpring, RestsWithoutAForce) {
  const Spring spring = spring_of(elaborate(), 1e-3);
  Spring::State x = spring.start(0.0, true);
  for (int i = 0; i < 100; ++i) spring.step(x, 0.0);
  EXPECT_EQ(x.force, 0.0);
  EXPECT_EQ(x.first.excess, 0.0);
}

}  // namespace
}  // namespace air_spring_test
