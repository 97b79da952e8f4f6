// What the diagnosis is made of: noise, fusion of two sensors, whitening, bounded steps, the virtual car.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/diagnose/decimation.hpp"
#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/diagnose/fit.hpp"
#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/golden_section.hpp"
#include "host_sim/diagnose/readings.hpp"
#include "host_sim/diagnose/virtual_car.hpp"
#include "host_sim/diagnose/whitening.hpp"
#include "tests/support/reference_road.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using namespace host_sim;
using model::Channel;

constexpr double period = 1e-3;

std::vector<double> sine(double amplitude, double hz, std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t k = 0; k < count; ++k) {
    values[k] = amplitude * std::sin(2.0 * std::numbers::pi * hz * period * static_cast<double>(k));
  }
  return values;
}

// Point. Sixth differences of a sine leave (2 sin(ωh/2))⁶ of it: nothing at 20 Hz and 1 kHz. The median of K variances
// from 64 samples each scatters by some 1.25 √(2/64)/√K, and lies 1 % low; 5 % are many times that.
TEST(EstimatedNoise, SeesNoiseUnderASignal) {
  auto signal = sine(1.0, 20.0, 60'000);
  support::NormalNoise noise(7);
  for (double& v : signal) v += 1e-3 * noise();
  EXPECT_NEAR(diagnose::estimated_noise(signal) / 1e-3, 1.0, 0.05) << "seed 7";
}

// Point. Without noise both sensors say the same sine; the fusion keeps it up to (ωh)⁴/240 = 5e-6 at 30 Hz and the
// ends.
TEST(FusedDisplacement, KeepsWhatBothSensorsSay) {
  constexpr std::size_t n = 4000;
  const double hz = 30.0, omega = 2.0 * std::numbers::pi * hz;
  const auto z = sine(1e-3, hz, n);
  auto a = z;
  for (double& v : a) v *= -omega * omega;
  const auto fused = diagnose::fused_displacement(z, a, 2e-5, 0.05, period);
  for (std::size_t k = 200; k + 200 < n; ++k) EXPECT_NEAR(fused[k], z[k], 2e-5 * 1e-3);
  EXPECT_FALSE(diagnose::disagree(z, a, 2e-5, 0.05, period));
}

// Law. The error of the fusion has the spectrum 1/(1/σ_z² + ω⁴/σ_a²) a sample: its variance over all frequencies, a
// tenth of σ_z² here, is reached within the scatter of 60 000 samples correlated over some 20.
TEST(FusedDisplacement, IsAsGoodAsBothSensorsTogether) {
  constexpr std::size_t n = 60'000;
  support::NormalNoise noise(11);
  const double sz = 2e-5, sa = 0.05;
  std::vector<double> z(n), a(n);
  for (double& v : z) v = sz * noise();
  for (double& v : a) v = sa * noise();
  const auto fused = diagnose::fused_displacement(z, a, sz, sa, period);
  double variance = 0.0;
  for (const double v : fused) variance += v * v / static_cast<double>(n);
  double expected = 0.0;
  constexpr int steps = 100'000;
  for (int i = 0; i < steps; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / steps;
    const double d2 = std::pow(2.0 * std::sin(0.5 * angle), 2), m = 1.0 - d2 / 12.0;
    const double w = std::pow(sz / (period * period * sa), 2);
    // z = (Z + κ h² G M A)/(1 + κ G²): from both noises
    const double below = 1.0 + w * d2 * d2;
    expected += (sz * sz + std::pow(w * period * period * d2 * m * sa, 2)) / (below * below) / steps;
  }
  EXPECT_LT(expected, 0.1 * sz * sz);
  EXPECT_NEAR(variance / expected, 1.0, 5.0 * std::sqrt(2.0 * 40.0 / n)) << "seed 11";
  EXPECT_FALSE(diagnose::disagree(z, a, sz, sa, period)) << "seed 11";
}

// A sensor that is 2 % wrong is no second opinion.
TEST(FusedDisplacement, NoticesSensorsThatDisagree) {
  const auto z = sine(5e-3, 5.0, 20'000);
  auto a = z;
  const double omega = 2.0 * std::numbers::pi * 5.0;
  for (double& v : a) v *= -1.02 * omega * omega;
  EXPECT_TRUE(diagnose::disagree(z, a, 2e-5, 0.05, period));
}

diagnose::Evidence two_channels(std::uint64_t seed, double correlated) {
  constexpr std::size_t n = 20'000;
  support::NormalNoise noise(seed);
  diagnose::Evidence e;
  e.recording.sample_period = e.drive.period = period;
  e.recording.time = sample_times(n, 1.0 / period);
  e.channels = {Channel::x_act, Channel::F};
  e.noise[index(Channel::x_act)] = 2e-5;
  e.noise[index(Channel::F)] = 10.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double common = correlated * noise();
    e.recording[Channel::x_act].push_back(2e-5 * (noise() + common));
    e.recording[Channel::F].push_back(10.0 * (noise() - 2.0 * common));
  }
  e.fit = {0, n};
  return e;
}

// Law. Up to the highest frequency of interest a sine keeps its amplitude; one that would be folded there is gone.
TEST(Decimation, KeepsWhatMattersAndFoldsNothing) {
  const diagnose::Decimation decimation(1000.0, 90.0);
  ASSERT_EQ(decimation.factor(), 4U);
  for (const double f : {0.0, 10.0, 89.0, 161.0, 255.0, 337.0, 420.0}) {
    std::vector<double> cosine(4000);
    for (std::size_t k = 0; k < cosine.size(); ++k) {
      cosine[k] = std::cos(2.0 * std::numbers::pi * f * period * static_cast<double>(k));
    }
    const auto fewer = decimation(cosine);
    ASSERT_EQ(fewer.size(), 1000U);
    for (std::size_t k = 50; k < 950; ++k) {  // zeros around the signal are 38 samples away at most
      EXPECT_NEAR(fewer[k], f < 90.0 ? cosine[4 * k] : 0.0, 2.0 * diagnose::Decimation::ripple) << f << " Hz, " << k;
    }
  }
}

// At a low sample rate nothing is dropped.
TEST(Decimation, LeavesSlowRecordingsAlone) {
  const diagnose::Decimation decimation(400.0, 90.0);
  EXPECT_EQ(decimation.factor(), 1U);
  EXPECT_EQ(decimation({1.0, -2.0, 3.0}), (std::vector<double>{1.0, -2.0, 3.0}));
}

/// A recording whose F is renewed every `samples` (not whole), begun in the middle of a turn.
diagnose::Evidence held_recording(double samples) {
  constexpr std::size_t n = 6000;
  diagnose::Evidence e;
  e.recording.sample_period = e.drive.period = period;
  e.channels = {Channel::F};
  double last = 7.0, due = 0.6 * samples;
  for (std::size_t k = 0; k < n; ++k) {
    if (static_cast<double>(k) >= due) {
      last = static_cast<double>(k);
      due += samples;
    }
    e.recording[Channel::F].push_back(last);
  }
  e.renewals[index(Channel::F)] = diagnose::renewals_of(e.recording[Channel::F]);
  return e;
}

// The phase of a hold is read off the recording: readings are renewed exactly where it was.
TEST(Readings, AreRenewedWhereTheRecordingIs) {
  const diagnose::Evidence e = held_recording(4.3);
  diagnose::Hypothesis hypothesis;
  hypothesis.rig.kind = model::RigKind::component_bench;
  hypothesis.rig.effects.add(Channel::F, model::SensorHold<double>{0.0043});
  std::vector<double> truth;
  for (std::size_t k = 0; k < e.size(); ++k) truth.push_back(static_cast<double>(k));
  const auto read = diagnose::readings(hypothesis, e, Channel::F, truth);
  for (std::size_t k = 3; k < e.size(); ++k) ASSERT_EQ(read[k], e.recording[Channel::F][k]) << k;  // 3: the first turn
  // By a clock of its own it takes its value before it shows: at 2.58 + 4.3 n, which the turns leave little doubt
  // about.
  hypothesis.clocks[index(Channel::F)].own = true;
  const auto own = diagnose::readings(hypothesis, e, Channel::F, truth);
  for (std::size_t k = 3; k < e.size(); ++k) {
    const double taken = 2.58 + 4.3 * std::floor((static_cast<double>(k) - 2.58) / 4.3 + 1e-9);
    ASSERT_NEAR(own[k], taken, 0.11) << k;  // turns of 4.3 come at ten places between samples
  }
}

// Its period too: turns at ten places between samples, over some 1395 of them, leave it less than 2 · 0.1/1395 samples.
TEST(HoldPeriod, IsReadOffTheRenewals) {
  const std::vector<diagnose::Evidence> evidence{held_recording(4.3)};
  const auto held = diagnose::hold_period(evidence, Channel::F);
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->value, 4.3e-3, held->half_width);
  EXPECT_LT(held->half_width, 0.2 / 1395.0 * period);
  EXPECT_FALSE(diagnose::hold_period(evidence, Channel::x_act));
  // What a limit cuts off repeats itself, too, most of the time even; but it is new with every sample in between.
  auto limited = sine(1.0, 3.0, 6000);
  for (double& v : limited) v = std::clamp(v, -0.4, 0.4);
  EXPECT_FALSE(diagnose::renewals_of(limited));
  // Turns of 1 and 2, or of 2 and 3 samples, of which none is the period.
  for (const double samples : {1.7, 2.5}) {
    const diagnose::Evidence fast = held_recording(samples);
    ASSERT_TRUE(fast.renewals[index(Channel::F)]) << samples;
    EXPECT_TRUE(fast.renewals[index(Channel::F)]->regular) << samples;
    EXPECT_NEAR(fast.renewals[index(Channel::F)]->period, samples, 1e-3) << samples;
  }
}

// Law. Known noise becomes χ² = n; noise with a known common source too, and its channels become independent.
TEST(Whitening, MakesKnownNoiseWhite) {
  for (const double correlated : {0.0, 3.0}) {
    const diagnose::Evidence e = two_channels(5, correlated);
    Eigen::MatrixXcd common(2, 2);
    const Eigen::Vector2cd source(2e-5 * correlated, -20.0 * correlated);
    common = source * source.adjoint();
    const diagnose::Whitening whitening(e, e.fit, std::vector<Eigen::MatrixXcd>(91, common));
    Response nothing;
    for (const Channel c : e.channels) nothing[index(c)].assign(e.size(), 0.0);
    std::vector<double> r(whitening.count());
    whitening.whiten(whitening.spectra(e, nothing), r.data());
    double squares = 0.0, across = 0.0;
    for (std::size_t i = 0; i + 3 < r.size(); i += 4) {
      squares += r[i] * r[i] + r[i + 1] * r[i + 1] + r[i + 2] * r[i + 2] + r[i + 3] * r[i + 3];
      across += r[i] * r[i + 2] + r[i + 1] * r[i + 3];
    }
    const double n = static_cast<double>(r.size());
    EXPECT_NEAR(squares / n, 1.0, 5.0 * std::sqrt(2.0 / n)) << "seed 5, " << correlated;
    EXPECT_NEAR(across / (0.5 * n), 0.0, 5.0 / std::sqrt(0.5 * n)) << "seed 5, " << correlated;
  }
}

// Law. n rounds of golden section leave 0.618ⁿ of the range around the lowest point, also where that is an end.
TEST(GoldenSection, ClosesInOnTheLowestPoint) {
  for (const double lowest : {-1.0, -0.37, 0.002, 0.61, 2.0}) {
    const auto valley = [lowest](double x) { return std::abs(x - lowest) + 0.5; };
    for (const int rounds : {0, 5, 30}) {
      const diagnose::LowestPoint found = diagnose::golden_section(valley, -1.0, 2.0, rounds);
      EXPECT_NEAR(found.at, lowest, 3.0 * std::pow(0.6180339887498949, rounds + 1) + 1e-9) << lowest << " " << rounds;
      EXPECT_EQ(found.value, valley(found.at));
    }
  }
}

// Law. The step is the minimum inside the box: no point of a fine grid over it is lower.
TEST(BoundedStep, IsTheMinimumInsideTheBounds) {
  support::NormalNoise noise(3);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Matrix2d a;
    a << noise(), noise(), noise(), noise();
    const Eigen::Matrix2d h = a.transpose() * a + 0.01 * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d g(noise(), noise()), lower(-0.5, -0.3), upper(0.4, 0.6);
    const Eigen::VectorXd d = diagnose::bounded_step(h, g, {lower, upper});
    const auto cost = [&](const Eigen::Vector2d& v) { return 0.5 * v.dot(h * v) + g.dot(v); };
    ASSERT_TRUE((d.array() >= lower.array() - 1e-12).all() && (d.array() <= upper.array() + 1e-12).all());
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        const Eigen::Vector2d v(lower(0) + (upper(0) - lower(0)) * i / 40.0,
                                lower(1) + (upper(1) - lower(1)) * j / 40.0);
        EXPECT_GE(cost(v), cost(d) - 1e-9) << "seed 3, trial " << trial;
      }
    }
  }
}

// Point. Numbers that obey (1)–(3) give the parameters they were made with, inside their tolerances.
TEST(VirtualCar, IsReadFromWhatTheProgramRecorded) {
  RigDescription description = parse_rig(support::hil_text, "rig");
  description.tolerance = {{"body.mass", 0.05}, {"wheel.mass", 0.05}, {"tyre.stiffness", 0.05}};
  const double m_b = 1.02 * description.rig.body.mass, m_w = 0.97 * description.rig.wheel.mass;
  const double k_t = 1.01 * description.rig.tyre.stiffness, b_v = description.rig.machine.virtual_damping;
  constexpr std::size_t n = 8000;
  diagnose::Evidence e;
  Recording& r = e.recording;
  r.sample_period = period;
  r.time = sample_times(n, 1.0 / period);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = period * static_cast<double>(k), w1 = 9.0, w2 = 70.0;
    const double x = 5e-3 * std::sin(w1 * t) + 2e-3 * std::sin(w2 * t);
    const double v = 5e-3 * w1 * std::cos(w1 * t) + 2e-3 * w2 * std::cos(w2 * t);
    const double force = 300.0 * std::sin(w1 * t + 0.5) + 200.0 * std::sin(w2 * t + 1.0);
    const double tyre = 1e-3 * std::sin(w1 * t + 0.2) + 3e-3 * std::sin(w2 * t + 2.0);
    const double rate = 1e-3 * w1 * std::cos(w1 * t + 0.2) + 3e-3 * w2 * std::cos(w2 * t + 2.0);
    const double load = k_t * tyre + description.rig.tyre.damping * rate;
    r[Channel::x_cmd].push_back(x);
    r[Channel::F].push_back(force);
    r[Channel::zdd_b].push_back((force + b_v * v) / m_b);
    r[Channel::F_w].push_back(load);
    r[Channel::zdd_w].push_back((load - force - b_v * v) / m_w);
    r[Channel::z_w].push_back(-tyre);
    r[Channel::z_r].push_back(0.0);
  }
  e.fit = {0, n};
  const auto found = diagnose::virtual_car(description, {e}).parameters;
  ASSERT_EQ(found.size(), 3U);
  // Velocities by differences of fourth order are off by (ωh)⁴/30 = 8e-7.
  EXPECT_NEAR(found.at("body.mass").value / m_b, 1.0, 1e-5);
  EXPECT_NEAR(found.at("wheel.mass").value / m_w, 1.0, 1e-5);
  EXPECT_NEAR(found.at("tyre.stiffness").value / k_t, 1.0, 1e-5);
  description.tolerance = {{"body.mass", 0.01}};
  EXPECT_NEAR(diagnose::virtual_car(description, {e}).parameters.at("body.mass").value,
              1.01 * description.rig.body.mass, 1e-6);
  EXPECT_TRUE(diagnose::virtual_car(parse_rig(support::bench_text, "rig"), {e}).parameters.empty());
}

/// A hil recording of a virtual tyre F_w = k_t dz_w + b_t ḋz_w + k₃ dz_w³, never below `lowest`.
diagnose::Evidence tyre_recording(const RigDescription& description, double cubic, double lowest) {
  diagnose::Evidence e;
  Recording& r = e.recording;
  r.sample_period = period;
  r.time = sample_times(8000, 1.0 / period);
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double t = period * static_cast<double>(k), w1 = 9.0, w2 = 70.0;
    const double tyre = 6e-3 * std::sin(w1 * t + 0.2) + 12e-3 * std::sin(w2 * t + 2.0);
    const double rate = 6e-3 * w1 * std::cos(w1 * t + 0.2) + 12e-3 * w2 * std::cos(w2 * t + 2.0);
    const double load =
        description.rig.tyre.stiffness * tyre + description.rig.tyre.damping * rate + cubic * tyre * tyre * tyre;
    r[Channel::F_w].push_back(std::max(load, lowest));
    r[Channel::z_w].push_back(-tyre);
    r[Channel::z_r].push_back(0.0);
  }
  e.fit = {0, r.size()};
  return e;
}

// Point. Effects of a tyre that is a number are read off its numbers; a linear one has none. Velocities by differences
// are off by 8e-7 of b_t ḋz_w, some 1e-8 of the cubic's part.
TEST(VirtualCar, ReadsTheEffectsOfItsTyre) {
  RigDescription description = parse_rig(support::hil_text, "rig");
  description.tolerance = {{"tyre.stiffness", 0.03}};
  constexpr double never = -1e9;
  EXPECT_TRUE(diagnose::virtual_car(description, {tyre_recording(description, 0.0, never)}).effects.empty());

  const auto cubic = diagnose::virtual_car(description, {tyre_recording(description, -4e8, never)}).effects;
  ASSERT_EQ(cubic.size(), 1U);
  EXPECT_EQ(cubic[0].effect.entry->name, "progressive_tyre");
  EXPECT_NEAR(cubic[0].effect.values[0] / -4e8, 1.0, 1e-4);
  EXPECT_LT(cubic[0].after, 0.01 * cubic[0].before);

  const double weight = 9.81 * (description.rig.body.mass + description.rig.wheel.mass);
  const auto lifted = diagnose::virtual_car(description, {tyre_recording(description, 0.0, -weight)}).effects;
  ASSERT_EQ(lifted.size(), 1U);
  EXPECT_EQ(lifted[0].effect.entry->name, "tyre_lift_off");

  const auto both = diagnose::virtual_car(description, {tyre_recording(description, 4e8, -weight)}).effects;
  ASSERT_EQ(both.size(), 2U);
  EXPECT_NEAR(both[1].effect.values.at(0) / 4e8, 1.0, 1e-4);
}

// Law. What is known of z̈_r ends where z_r sinks into its noise; below, smoothing leaves a sine alone (a Hann-windowed
// filter of ± 0.1 s has a gain of 1 within 1 % that far inside its band), above it takes the noise away.
TEST(FootPoint, KnowsItsAccelerationAsFarAsItsDisplacementIsAboveNoise) {
  auto z = sine(2e-3, 12.0, 20'000);
  support::NormalNoise noise(3);
  auto noisy = z;
  for (double& v : noisy) v += 2e-5 * noise();
  const double known = diagnose::known_up_to(noisy, 2e-5, period);
  EXPECT_NEAR(known, 12.0, 3.0) << "seed 3";  // bins of 1 Hz, a Hann window's main lobe of ± 2
  FootPointMotion motion = through_samples(z, 1.0 / period), rough = through_samples(noisy, 1.0 / period);
  diagnose::smooth_acceleration(motion, 30.0, period);
  diagnose::smooth_acceleration(rough, 30.0, period);
  const double amplitude = 2e-3 * std::pow(2.0 * std::numbers::pi * 12.0, 2);
  double error = 0.0;
  for (std::size_t k = 200; k + 200 < z.size(); ++k) {
    const double truth = -std::pow(2.0 * std::numbers::pi * 12.0, 2) * z[k];
    ASSERT_NEAR(motion[k].acceleration, truth, 0.01 * amplitude) << k;
    error += std::pow(rough[k].acceleration - truth, 2) / static_cast<double>(z.size());
  }
  // White noise of σ_z through ω² up to 30 … 40 Hz: σ_z (2π 35)² √(2 · 35/1000/5) = 0.11 m/s²; second differences: 49.
  EXPECT_LT(std::sqrt(error), 0.3);

  // Above 40 Hz a sine of 60 Hz counts with half the square of its amplitude (the filter's edge is ± 10 Hz wide), one
  // of 12 Hz and white noise with nothing; the variance of 20 000 samples of that scatters by 1 %.
  auto shaken = sine(3.0, 60.0, 20'000);
  const auto slow = sine(5.0, 12.0, 20'000);
  for (std::size_t k = 0; k < shaken.size(); ++k) shaken[k] += slow[k] + 0.5 * noise();
  const diagnose::Window all{0, shaken.size()};
  EXPECT_NEAR(diagnose::variance_above(40.0, shaken, all, 0.5, period), 4.5, 0.1) << "seed 3";
}

}  // namespace
