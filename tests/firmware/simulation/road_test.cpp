// Roads: as rough as ISO 8608 says, at every frequency, from every seed.
#include "firmware/simulation/road.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "model/rig/rig_model.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::drive_over;
using firmware::FootPointMotion;
using firmware::IsoRoad;
using firmware::road_density;
using model::Channel;

constexpr double pi = 3.141592653589793;

/// Spectrum of the motion that drive_over makes: the standard's, through the Butterworth low-pass of fourth order, of
/// noise that is held for a period h: sinc²(f h).
double expected_density(const IsoRoad& road, double sample_rate, double f) {
  const double low_pass = 1.0 / (1.0 + std::pow(f / road.bandwidth, 8));
  const double x = pi * f / sample_rate;
  const double hold = std::sin(x) / x;
  return road_density(road.roughness, road.speed, f, road.cut_off) * low_pass * hold * hold;
}

// Point. Class B at 100 km/h and 1 Hz by hand: 64e-6 m³ · (0.1 1/m)² · 27.78 m/s / (1 Hz)² = 1.77792e-5 m²/Hz.
TEST(Road, HasTheDensityOfTheStandard) {
  EXPECT_NEAR(road_density(64e-6, 27.78, 1.0), 1.77792e-5, 1e-19);
  EXPECT_NEAR(road_density(64e-6, 27.78, 10.0), 1.77792e-7, 1e-21);
  EXPECT_NEAR(road_density(64e-6, 27.78, 0.05, 0.05), 1.77792e-5 / (2.0 * 0.05 * 0.05), 1e-16);
}

// Point. Geometric means of the classes [10⁻⁶ m³]: A 16, then four times the one before (ISO 8608, table C.1).
TEST(Road, KnowsEightClasses) {
  double mean = 16e-6;
  for (const char* letter : {"A", "B", "C", "D", "E", "F", "G", "H"}) {
    EXPECT_DOUBLE_EQ(firmware::class_roughness(letter), mean) << letter;
    mean *= 4.0;
  }
  for (const char* none : {"", "I", "b", "@", "AB", "B "}) {
    EXPECT_THROW(static_cast<void>(firmware::class_roughness(none)), firmware::UsageError) << none;
  }
}

// Law. The spectrum of 260 s against the formula from 2.5 Hz (ten bins: below, Welch's window smears a 1/f² spectrum by
// more than 1/10²) to 100 Hz, every third bin (Hann bins further apart are independent). With the relative standard
// error ε of each bin that host_sim::welch states:
//   · Σ((S/E − 1)/ε)² over N bins is N ± √(2N); five of them, and 5 % for the window
//   · the mean of S/E is 1 ± ε/√N; four of them, and 0.5 % for the window and for what folds back at 500 Hz
// Noise of variance 1/h, the frequent mistake, makes the mean 2.
TEST(Road, IsAsRoughAsTheStandardSaysAtEveryFrequency) {
  constexpr double rate = 1000.0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    IsoRoad road;
    road.cut_off = 0.5;  // forgets its flat beginning within a second
    road.seed = seed;
    const FootPointMotion motion = drive_over(road, rate, 265000);
    std::vector<double> z;
    for (std::size_t k = 5000; k < motion.size(); ++k) z.push_back(motion[k].position);
    const auto spectrum = host_sim::welch(z, rate, 4096);
    ASSERT_LT(spectrum.relative_standard_error, 0.12);
    double chi2 = 0.0, mean = 0.0, n = 0.0;
    for (std::size_t k = 11; spectrum.frequency[k] < 100.0; k += 3) {
      const double ratio = spectrum.density[k] / expected_density(road, rate, spectrum.frequency[k]);
      const double deviation = (ratio - 1.0) / spectrum.relative_standard_error;
      chi2 += deviation * deviation;
      mean += ratio;
      n += 1.0;
    }
    mean /= n;
    ASSERT_GT(n, 100.0);
    EXPECT_NEAR(chi2, n, 5.0 * std::sqrt(2.0 * n) + 0.05 * n) << "seed " << seed;
    EXPECT_NEAR(mean, 1.0, 4.0 * spectrum.relative_standard_error / std::sqrt(n) + 0.005) << "seed " << seed;
  }
}

// Law. Below the cut-off the spectrum is flat: the displacement's variance is that of (1), a first-order process,
// π/2 · G_d n₀² v / f_c, whose rms has the relative standard error 1/√(2 · 2π f_c T) (time constant 1/(2π f_c)).
TEST(Road, StaysWithinAFiniteHeight) {
  IsoRoad road;
  road.cut_off = 0.5;
  double squares = 0.0, n = 0.0;
  for (const auto& m : drive_over(road, 1000.0, 405000)) {
    if (n++ < 5000.0) continue;
    squares += m.position * m.position;
  }
  const double expected = std::sqrt(0.5 * pi * 64e-6 * 0.01 * 27.78 / 0.5);
  const double standard_error = 1.0 / std::sqrt(2.0 * 2.0 * pi * 0.5 * 400.0);
  EXPECT_NEAR(std::sqrt(squares / (n - 5000.0)) / expected, 1.0, 4.0 * standard_error);
}

// A run is a function of the seed.
TEST(Road, FollowsFromItsSeed) {
  const auto positions = [](std::uint64_t seed) {
    std::vector<double> z;
    IsoRoad road;
    road.seed = seed;
    for (const auto& m : drive_over(road, 1000.0, 2000)) z.push_back(m.position);
    return z;
  };
  EXPECT_EQ(positions(1), positions(1));
  EXPECT_NE(positions(1), positions(2));
  EXPECT_NE(positions(1), positions(1 + (std::uint64_t{1} << 32U))) << "all 64 bits of a seed count";
  EXPECT_EQ(positions(1).front(), 0.0) << "begins flat";
}

// Law. All motion grows with √(G_d v) and nothing else: four times as rough is twice as high, to rounding.
TEST(Road, GrowsWithTheRootOfRoughnessTimesSpeed) {
  IsoRoad b, c, fast;
  c.roughness = 4.0 * b.roughness;
  fast.speed = 4.0 * b.speed;
  const auto z_b = drive_over(b, 1000.0, 500), z_c = drive_over(c, 1000.0, 500), z_fast = drive_over(fast, 1000.0, 500);
  for (std::size_t k = 0; k < 500; ++k) {
    EXPECT_NEAR(z_c[k].position, 2.0 * z_b[k].position, 1e-15);
    EXPECT_NEAR(z_fast[k].acceleration, 2.0 * z_b[k].acceleration, 1e-10);
  }
}

// Law. Velocity and acceleration are the derivatives of the position. The held noise makes the fourth derivative jump
// between samples; the trapezium's error per step is below h³/12 max|z⃛|: at 30 Hz 1e-12 m against travels of 1e-4 m.
TEST(Road, HasVelocitiesAndAccelerationsThatBelongToIt) {
  IsoRoad road;
  road.bandwidth = 30.0;
  const double h = 1e-3;
  const auto m = drive_over(road, 1000.0, 5000);
  double velocity_scale = 0.0, acceleration_scale = 0.0;
  for (const auto& x : m) {
    velocity_scale = std::max(velocity_scale, std::abs(x.velocity));
    acceleration_scale = std::max(acceleration_scale, std::abs(x.acceleration));
  }
  for (std::size_t k = 1; k < m.size(); ++k) {
    const double way = m[k].position - m[k - 1].position;
    ASSERT_NEAR(way, 0.5 * h * (m[k].velocity + m[k - 1].velocity), 0.005 * h * velocity_scale);
    const double change = m[k].velocity - m[k - 1].velocity;
    ASSERT_NEAR(change, 0.5 * h * (m[k].acceleration + m[k - 1].acceleration), 0.02 * h * acceleration_scale);
  }
}

// What a step can follow: a fifth of the rate; what hardware can follow: 30 Hz.
TEST(Road, LeavesOutWhatNobodyFollows) {
  using model::RigKind;
  EXPECT_EQ(firmware::default_bandwidth(RigKind::hil, 1000.0), 100.0);
  EXPECT_EQ(firmware::default_bandwidth(RigKind::quarter_car, 1000.0), 30.0);
  EXPECT_EQ(firmware::default_bandwidth(RigKind::component_bench, 1000.0), 30.0);
  EXPECT_EQ(firmware::default_bandwidth(RigKind::hil, 200.0), 40.0);
  EXPECT_EQ(firmware::default_bandwidth(RigKind::quarter_car, 100.0), 20.0);
}

// physics.md, section 4: linear component, class B at 100 km/h, 0.1–50 Hz: rms F_w 493 N, z̈_b 1.02 m/s², travel
// 7.1 mm. 1000 s in ten roads. An rms of a narrow-band signal has the relative standard error 1/(2√(B T)), B its
// noise bandwidth: travel sits in the body mode (pole −1.48 ± 9.6j: B = π · 1.48/π = 1.5 Hz → 1.3 %), F_w in the wheel
// mode (pole −16: B = 16 Hz → 0.4 %), z̈_b in both (1 %). Three of them and half of the last digit.
TEST(Road, ShakesThePaperCarAsComputedElsewhere) {
  const auto rig = firmware::parse_rig(support::quarter_car_text, "RIG.toml");
  const model::RigModel<> model(rig.rig, 1e-3);
  constexpr std::size_t settling = 10000, samples = 110000;
  double load = 0.0, acceleration = 0.0, travel = 0.0;
  constexpr int roads = 10;
  for (int seed = 1; seed <= roads; ++seed) {
    IsoRoad road;
    road.seed = static_cast<std::uint64_t>(seed);
    road.cut_off = 0.01;
    const auto motion = drive_over(road, 1000.0, samples);
    auto x = model.start();
    std::vector<double> F_w, zdd_b, dz_b;
    for (std::size_t k = 1; k < samples; ++k) {
      model.step(x, {.foot_point = motion[k]});
      if (k < settling) continue;
      const auto signals = model.signals(x);
      F_w.push_back(signals[index(Channel::F_w)]);
      zdd_b.push_back(signals[index(Channel::zdd_b)]);
      dz_b.push_back(signals[index(Channel::dz_b)]);
    }
    const auto power = [](const std::vector<double>& signal) {  // 0.1 … 50 Hz
      const auto spectrum = host_sim::welch(signal, 1000.0, 20000);
      double sum = 0.0;
      for (std::size_t k = 0; k < spectrum.frequency.size(); ++k) {
        if (spectrum.frequency[k] >= 0.1 && spectrum.frequency[k] <= 50.0) sum += spectrum.density[k];
      }
      return sum * spectrum.frequency[1];
    };
    load += power(F_w) / roads;
    acceleration += power(zdd_b) / roads;
    travel += power(dz_b) / roads;
  }
  EXPECT_NEAR(std::sqrt(load), 493.0, 493.0 * 3.0 * 0.004 + 0.5);
  EXPECT_NEAR(std::sqrt(acceleration), 1.02, 1.02 * 3.0 * 0.010 + 0.005);
  EXPECT_NEAR(std::sqrt(travel), 7.1e-3, 7.1e-3 * 3.0 * 0.013 + 0.05e-3);
}

// A rig with a foot point gets the road itself.
TEST(Road, GoesStraightToAFootPoint) {
  const auto rig = firmware::parse_rig(support::quarter_car_text, "RIG.toml");
  const auto road = drive_over({}, 1000.0, 100);
  const auto motion = firmware::excitation(rig.rig, road, 1000.0);
  for (std::size_t k = 0; k < road.size(); ++k) EXPECT_EQ(motion[k].position, road[k].position);
}

// A component on the bench is deflected as in its car: the deflection of that car, stepped by itself; without the
// effects of the bench; on the car of the description where there is one.
TEST(Road, DeflectsABenchAsItsCarWould) {
  const std::string effect = "[effects.coulomb_friction]\nforce = 500\n";
  const auto bench = firmware::parse_rig(std::string(support::bench_text) + effect, "RIG.toml");
  auto text = support::with(support::quarter_car_text, "damping = 1140.0", "damping = 2280.0");
  const auto road = drive_over({.bandwidth = 30.0}, 1000.0, 3000);
  const auto expect_deflections_of = [&](const firmware::RigDescription& rig, const std::string& car_text) {
    const auto motion = firmware::excitation(rig.rig, road, 1000.0);
    const model::RigModel<> car(firmware::parse_rig(car_text, "CAR.toml").rig, 1e-3);
    auto x = car.start();
    for (std::size_t k = 0; k < road.size(); ++k) {
      car.step(x, {.foot_point = road[k]});
      const auto signals = car.signals(x);
      ASSERT_EQ(motion[k].position, signals[index(Channel::dz_b)]) << k;
      ASSERT_EQ(motion[k].velocity, car.deflection(x).velocity) << k;
      ASSERT_EQ(motion[k].acceleration, signals[index(Channel::zdd_w)] - signals[index(Channel::zdd_b)]) << k;
    }
  };
  expect_deflections_of(bench, text);
  const std::string own = "[body]\nmass = 200\n[wheel]\nmass = 30\n[tyre]\nstiffness = 150e3\ndamping = 0\n";
  text = support::with(support::with(text, "290.0", "200"), "40.0", "30");
  text = support::with(support::with(text, "200e3", "150e3"), "damping = 100.0", "damping = 0");
  expect_deflections_of(firmware::parse_rig(std::string(support::bench_text) + own, "RIG.toml"), text);
  EXPECT_TRUE(firmware::excitation(bench.rig, {}, 1000.0).empty());
}

// Order. Velocities through samples of a sine: the error of the inner points falls as h⁴ (formula: h⁴/30 |z⁽⁵⁾|), that
// of the accelerations as h⁴/90 |z⁽⁶⁾|.
TEST(Road, DifferentiatesSamplesToFourthOrder) {
  const double omega = 2.0 * pi * 3.0;
  const auto worst = [omega](double rate) {
    std::vector<double> z;
    for (int k = 0; k <= static_cast<int>(rate); ++k) z.push_back(std::sin(omega * k / rate));
    const auto m = firmware::through_samples(z, rate);
    std::pair<double, double> error{};
    for (std::size_t k = 2; k + 2 < z.size(); ++k) {
      const double t = static_cast<double>(k) / rate;
      error.first = std::max(error.first, std::abs(m[k].velocity - omega * std::cos(omega * t)));
      error.second = std::max(error.second, std::abs(m[k].acceleration + omega * omega * std::sin(omega * t)));
    }
    return error;
  };
  const auto coarse = worst(100.0), fine = worst(200.0);
  EXPECT_NEAR(coarse.first, std::pow(0.01, 4) / 30.0 * std::pow(omega, 5), 0.03 * coarse.first);
  EXPECT_NEAR(coarse.second, std::pow(0.01, 4) / 90.0 * std::pow(omega, 6), 0.03 * coarse.second);
  EXPECT_NEAR(coarse.first / fine.first, 16.0, 0.5);
  EXPECT_NEAR(coarse.second / fine.second, 16.0, 0.5);
}

// Exact for parabolas up to the ends, where neighbours are missing, and for as few samples as there may be.
TEST(Road, DifferentiatesParabolasExactlyToTheEnds) {
  for (std::size_t n = 3; n <= 8; ++n) {
    std::vector<double> z;
    for (std::size_t k = 0; k < n; ++k) {
      const double t = 0.1 * static_cast<double>(k);
      z.push_back(1.0 + 2.0 * t - 3.0 * t * t);
    }
    const auto m = firmware::through_samples(z, 10.0);
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_NEAR(m[k].velocity, 2.0 - 0.6 * static_cast<double>(k), 1e-12) << n << " samples, " << k;
      EXPECT_NEAR(m[k].acceleration, -6.0, 1e-11) << n << " samples, " << k;
    }
  }
  // A signal that rests does so exactly, whatever its value: friction sees the sign of a velocity.
  for (const auto& m : firmware::through_samples(std::vector<double>(8, 0.1), 1000.0)) {
    EXPECT_EQ(m.velocity, 0.0);
    EXPECT_EQ(m.acceleration, 0.0);
  }
  const auto two = firmware::through_samples({1.0, 3.0}, 10.0);
  EXPECT_EQ(two[0].velocity, 20.0);
  EXPECT_EQ(two[1].velocity, 20.0);
  EXPECT_EQ(firmware::through_samples({1.0}, 10.0)[0].velocity, 0.0);
  EXPECT_TRUE(firmware::through_samples({}, 10.0).empty());
}

}  // namespace
