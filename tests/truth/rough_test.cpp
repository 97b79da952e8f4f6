// Each part of a rough recording against a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "tests/truth/recorder.hpp"
#include "tests/truth/rig.hpp"
#include "tests/truth/signal.hpp"
#include "tests/truth/truth.hpp"

namespace rough_test {
namespace {

using truth::Fineness;
using truth::Kind;
using truth::Motion;
using truth::Record;
using truth::Recorder;
using truth::RecordPlan;
using truth::Signal;
using truth::Truth;
constexpr double pi = std::numbers::pi;
constexpr Fineness silent{20, false};
constexpr double fine = 5e-5;  // [s] step of the generator

/// A spring and a damper on a machine without faults, 4 s.
Truth bench() {
  Truth t;
  t.kind = Kind::component_bench;
  t.nominal = t.actual = {{"suspension.stiffness", 31500.0}, {"suspension.damping", 1140.0}};
  t.noise = {{"F", 10.0}, {"x_act", 2e-5}};
  RecordPlan plan;
  plan.duration = 4.0;
  plan.level = 0.006;
  t.records = {plan};
  return t;
}

Truth outside(const std::map<std::string, double>& parameters) {
  Truth t = bench();
  t.unknown = "a law";
  t.unknown_parameters = parameters;
  return t;
}

std::vector<double> channel(const Truth& t, const std::string& name, const Fineness& fineness = silent) {
  return truth::simulate(t, fineness).front().channels.at(name);
}

/// Velocity of the bench's command at a row [m/s].
double velocity(const Truth& t, std::size_t row) {
  static const Signal command(t.records.front(), true);  // all benches have the same
  return command.at(static_cast<double>(row) * 1e-3).velocity;
}

/// Force that a law adds to the bench, row by row.
std::vector<double> added(const Truth& with) {
  std::vector<double> force = channel(with, "F");
  Truth plain = bench();
  plain.records = with.records;
  const std::vector<double> without = channel(plain, "F");
  for (std::size_t i = 0; i < force.size(); ++i) force[i] -= without[i];
  return force;
}

// Point. At its corner a low-pass lets 1/√2 of a sine through; noise of one value a sample loses all but
// (1 − a)/(1 + a) of its power behind order 1, a = e^{−2π f_c/f_s}.
TEST(TruthRecorder, FiltersLikeItsFormula) {
  for (const int order : {1, 2, 3, 4}) {
    truth::LowPass filter(100.0, order, 5e-5);
    double largest = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const double shown = filter.push(std::sin(2.0 * pi * 100.0 * i * 5e-5));
      if (i > 10000) largest = std::max(largest, std::abs(shown));
    }
    EXPECT_NEAR(largest, std::sqrt(0.5), 1e-3) << order;
  }
  const double a = std::exp(-2.0 * pi * 120.0 / 1000.0);
  EXPECT_NEAR(truth::noise_behind({.corner = 120.0}, 1000.0), std::sqrt((1.0 - a) / (1.0 + a)), 5e-3);
  EXPECT_NEAR(truth::noise_behind({.corner = 50.0, .order = 2}, 1000.0), std::sqrt(1.1107 * 2.0 * 50.0 / 1000.0), 5e-3);
  // Computed from samples, order 1: k/(1 + k) of the power, k = tan(π f_c/f_s).
  const double k = std::tan(pi * 0.12);
  EXPECT_NEAR(truth::noise_behind({.corner = 120.0, .digital = true}, 1000.0), std::sqrt(k / (1.0 + k)), 1e-6);
}

// Point. A clock that is late by 3 ms and loses 1000 ppm shows at t what was there at t − 3 ms − t/1000.
TEST(TruthRecorder, IsLateByItsClock) {
  Truth t = bench();
  const std::vector<double> clean = channel(t, "F");
  t.rough.recorder["F"] = {.late = 3e-3};
  const std::vector<double> late = channel(t, "F");
  for (std::size_t i = 100; i < clean.size(); ++i) ASSERT_NEAR(late[i], clean[i - 3], 1e-6);
  t.rough.recorder["F"].drift = 1e-3;
  const std::vector<double> later = channel(t, "F");
  EXPECT_NEAR(later[1000], clean[1000 - 4], 0.05);
  EXPECT_NEAR(later[3000], clean[3000 - 6], 0.05);
}

// Point. Hum is a sine of its amplitude; rounding leaves multiples of its step; outliers are as many as asked for.
TEST(TruthRecorder, AddsWhatItSays) {
  Truth t = bench();
  const std::vector<double> clean = channel(t, "F");
  t.rough.recorder["F"] = {.hum = 30.0};
  std::vector<double> shown = channel(t, "F");
  double power = 0.0;
  for (std::size_t i = 0; i < clean.size(); ++i) power += (shown[i] - clean[i]) * (shown[i] - clean[i]);
  EXPECT_NEAR(power / static_cast<double>(clean.size()), 450.0, 1e-6);

  t.rough.recorder["F"] = {.step = 25.0};
  for (const double value : channel(t, "F")) ASSERT_NEAR(value / 25.0, std::round(value / 25.0), 1e-9);

  t.rough.recorder["F"] = {.outliers = 7, .outlier = 1000.0};
  shown = channel(t, "F");
  int far = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) far += std::abs(shown[i] - clean[i]) > 400.0 ? 1 : 0;
  EXPECT_EQ(far, 7);
}

// Point. What a recording lacks, it lacks by the share that was asked for; the description says what it shall say.
TEST(TruthRough, LeavesOutWhatItSays) {
  Truth t = bench();
  const Record record = truth::simulate(t).front();
  const auto rows = [&] {
    std::istringstream text(truth::csv(t, record));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  };
  EXPECT_EQ(rows().size(), 4001U);
  t.rough.gaps = 2;
  t.rough.gap_share = 0.04;
  EXPECT_EQ(rows().size(), 4001U - 160U);
  t.rough.gaps = 0;
  t.rough.not_a_number = 0.01;
  const auto with_nan = rows();
  const auto bad = std::count_if(with_nan.begin(), with_nan.end(),
                                 [](const std::string& row) { return row.find("nan") != std::string::npos; });
  EXPECT_NEAR(static_cast<double>(bad), 40.0, 1.0);
  t.rough.missing = {"x_cmd"};
  EXPECT_EQ(rows().front(), "t,x_act,F");

  EXPECT_NE(truth::rig_toml(t).find("F = 10.0"), std::string::npos);
  t.rough.declared["F"] = 0.5;
  t.rough.described_rate = 500.0;
  EXPECT_NE(truth::rig_toml(t).find("F = 5.0"), std::string::npos);
  EXPECT_NE(truth::rig_toml(t).find("sample_rate = 500.0"), std::string::npos);
  t.rough.noise_absent = t.rough.tolerance_absent = true;
  EXPECT_EQ(truth::rig_toml(t).find("[noise]"), std::string::npos);
  EXPECT_EQ(truth::rig_toml(t).find("[tolerance]"), std::string::npos);
}

// Point. Laws of velocity near those of the catalogue, against the velocity of the command.
TEST(TruthNeighbours, FollowTheirLaw) {
  const Truth power = outside({{"power", 600.0}, {"exponent", 1.5}});
  const std::vector<double> by_power = added(power);
  const Truth smooth = outside({{"smooth_friction", 50.0}, {"smooth_velocity", 0.02}});
  const std::vector<double> by_friction = added(smooth);
  for (std::size_t i = 1500; i < 4000; i += 250) {
    const double v = velocity(power, i);
    EXPECT_NEAR(by_power[i], std::copysign(600.0 * std::pow(std::abs(v), 1.5), v), 1e-6);
    EXPECT_NEAR(by_friction[i], 50.0 * std::tanh(v / 0.02), 1e-6);
  }
}

// Law. Bristles never bear more than their largest force; sliding fast they bear the sliding force.
TEST(TruthNeighbours, BristlesSlideAtTheirForce) {
  const Truth lugre =
      outside({{"bristle", 40.0}, {"bristle_excess", 20.0}, {"bristle_stiffness", 1e5}, {"bristle_velocity", 0.02}});
  const std::vector<double> force = added(lugre);
  int fast = 0;
  for (std::size_t i = 1500; i < force.size(); ++i) {
    EXPECT_LE(std::abs(force[i]), 60.0 + 1e-6);
    const double v = velocity(lugre, i);
    if (std::min(std::abs(v), velocity(lugre, i - 10) * std::copysign(1.0, v)) < 0.3) continue;  // slid 3 mm
    EXPECT_NEAR(force[i], std::copysign(40.0, v), 0.5);
    ++fast;
  }
  EXPECT_GT(fast, 100);
}

/// Force of a component that is moved along a sine, node by node; every law but those of `numbers` is off.
std::vector<double> force_along_sine(truth::Numbers numbers, double amplitude, double frequency, double seconds) {
  numbers.kind = truth::Kind::component_bench;
  std::vector<Motion> knots;
  const double omega = 2.0 * pi * frequency;
  for (double t = 0.0; t < seconds + 2e-3; t += 1e-3)
    knots.push_back({amplitude * std::sin(omega * t), amplitude * omega * std::cos(omega * t),
                     -amplitude * omega * omega * std::sin(omega * t)});
  const Signal command(std::move(knots));
  truth::Rig rig(numbers, command, fine, seconds, nullptr);
  std::vector<double> force{rig.values().force};
  for (int node = 1; node <= static_cast<int>(std::lround(seconds / fine)); ++node) {
    rig.step();
    force.push_back(rig.values().force);
  }
  return force;
}

// Point. A fractional derivative of a sine is c ω^α sin(ωt + απ/2). What the start leaves falls as t^(−1−α): at 5 s
// 1e-3 of it; the branches, a factor of two apart, ripple by 4 exp(−2π²/ln 2) → 0, the two ends cost 1e-3.
TEST(TruthNeighbours, DifferentiateByAFraction) {
  for (const double alpha : {0.3, 0.6}) {
    truth::Numbers numbers;
    numbers.fractional = 800.0, numbers.fractional_exponent = alpha;
    const std::vector<double> force = force_along_sine(numbers, 0.01, 3.0, 6.0);
    const double omega = 2.0 * pi * 3.0, size = 8.0 * std::pow(omega, alpha);
    for (double t = 5.0; t < 6.0; t += 0.05) {
      EXPECT_NEAR(force[static_cast<std::size_t>(std::lround(t / fine))], size * std::sin(omega * t + 0.5 * pi * alpha),
                  3e-3 * size)
          << alpha << " at " << t;
    }
  }
}

// Point. Eight sliders that slip at i/8 of a travel w bear, at the first travel x ≤ w, F/8 Σ min(1, 8x/(i w)); from w
// on F. Coming back from there each needs twice its travel. A step is 1e-5 of a travel.
TEST(TruthNeighbours, SlidersSlipOneAfterTheOther) {
  truth::Numbers numbers;
  numbers.iwan = 80.0, numbers.iwan_travel = 8e-3;
  const std::vector<double> force = force_along_sine(numbers, 0.012, 0.5, 1.5);
  const auto at = [&](double t) { return force[static_cast<std::size_t>(std::lround(t / fine))]; };
  const auto travel = [](double t) { return 0.012 * std::sin(pi * t); };
  for (double t = 0.02; t < 0.5; t += 0.02) {
    double first = 0.0, back = 0.0;
    for (int i = 1; i <= 8; ++i) {
      first += 10.0 * std::min(1.0, travel(t) / (1e-3 * i));
      back += 10.0 * std::max(-1.0, 1.0 - (0.012 - travel(t + 0.5)) / (1e-3 * i));
    }
    EXPECT_NEAR(at(t), first, 0.05) << t;
    EXPECT_NEAR(at(t + 0.5), back, 0.05) << t;
  }
}

// Point. A degressive damper by hand.
TEST(TruthNeighbours, DampsLessAndLess) {
  const Truth valve = outside({{"degressive", 500.0}, {"degressive_velocity", 0.1}});
  const std::vector<double> force = added(valve);
  for (std::size_t i = 1500; i < 4000; i += 250) {
    const double v = velocity(valve, i);
    EXPECT_NEAR(force[i], 500.0 * v / (1.0 + std::abs(v) / 0.1), 1e-6);
  }
}

// Law. Behind play of width w the machine is never further than w/2 from its command, and turns later than it.
TEST(TruthNeighbours, PlayOfTheMachineIsAsWideAsItSays) {
  const Truth play = outside({{"machine_play", 1e-3}});
  const Record record = truth::simulate(play, silent).front();
  double largest = 0.0;
  for (std::size_t i = 0; i < record.time.size(); ++i)
    largest = std::max(largest, std::abs(record.channels.at("x_cmd")[i] - record.channels.at("x_act")[i]));
  EXPECT_NEAR(largest, 0.5e-3, 1e-9);
}

// Point. A push on the load cell is a half sine; a push on the body leaves its momentum: J = 2 F T / π.
TEST(TruthRough, PushesAsHardAsItSays) {
  Truth t = bench();
  t.rough.events = {{"F", 2.0, 2.5, 100.0}};
  const std::vector<double> force = added(t);
  EXPECT_NEAR(force[2250], 100.0, 1e-9);
  EXPECT_NEAR(force[2125], 100.0 * std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(force[1999] + force[2501], 0.0, 1e-9);

  truth::Numbers car;
  car.body = 290.0, car.wheel = 40.0, car.tyre = 200e3, car.spring = 31500.0;
  car.events = {{"body", 0.0, 2e-3, 500.0}};
  const Signal still(std::vector<Motion>(10));
  truth::Rig rig(car, still, 5e-5, 1.0, nullptr);
  for (int i = 0; i < 40; ++i) rig.step();
  EXPECT_NEAR(rig.state()[truth::Rig::vb], 2.0 * 500.0 * 2e-3 / pi / 290.0, 1e-6);
}

// Point. Parameters that drift have changed by the whole share at the end.
TEST(TruthRough, DriftsByItsShare) {
  Truth t = bench();
  t.rough.drift = {{"suspension.stiffness", 0.1}, {"suspension.damping", -0.2}};
  const std::vector<double> force = added(t);
  const Signal command(t.records.front(), true);
  for (std::size_t i = 1500; i < 4000; i += 500) {
    const double at = static_cast<double>(i) * 1e-3;
    const Motion x = command.at(at);
    EXPECT_NEAR(force[i], at / 4.0 * (0.1 * 31500.0 * x.position - 0.2 * 1140.0 * x.velocity), 1e-6);
  }
}

// Law. Velocity and acceleration of every form of road are the derivatives of its position.
TEST(TruthSignal, FormsAreSmooth) {
  for (const char* form : {"sweep", "steps", "stepped_sines", "multisine"}) {
    RecordPlan plan;
    plan.form = form;
    plan.duration = 6.0;
    const Signal road(plan, false);
    double size = 0.0;
    constexpr double h = 1e-3;
    for (double t = 0.1; t < 5.9; t += 0.0137) {
      const double at = std::round(t / h) * h;
      const double before = road.at(at - h).position, now = road.at(at).position, after = road.at(at + h).position;
      size = std::max(size, std::abs(now));
      EXPECT_NEAR((after - before) / (2.0 * h), road.at(at).velocity, 5e-3) << form << at;
      EXPECT_NEAR((after - 2.0 * now + before) / (h * h), road.at(at).acceleration, 1.0) << form << at;
    }
    EXPECT_GT(size, 3e-3) << form;
    EXPECT_LT(size, 0.1) << form;
  }
  RecordPlan unknown;
  unknown.form = "triangle";
  EXPECT_THROW(Signal(unknown, false), std::invalid_argument);
}

// Law. Same condition and seed, same truth. Seeds take turns with nothing, one and two effects.
TEST(TruthRough, DrawsEveryCondition) {
  EXPECT_EQ(truth::conditions().size(), 14U);
  EXPECT_THROW((void)truth::draw_rough("weather", 1), std::invalid_argument);
  for (const std::string& condition : truth::conditions()) {
    const Truth t = truth::draw_rough(condition, 3);
    EXPECT_EQ(truth::truth_json(t), truth::truth_json(truth::draw_rough(condition, 3)));
    EXPECT_EQ(t.rough.condition, condition);
    EXPECT_EQ(t.effects.size(), condition == "many" ? 3U : 0U) << condition;
    EXPECT_EQ(!t.unknown.empty(), condition == "neighbour_laws");
    for (const auto& [channel, factor] : t.rough.declared) EXPECT_TRUE(factor > 0.02 && factor < 3.0);
    for (const std::string& path : t.rough.off) {
      const double change = std::abs(t.actual.at(path) / t.nominal.at(path) - 1.0);
      EXPECT_GE(change, 0.049);
      const bool bound = !t.rough.tolerance_absent && t.tolerance.contains(path);
      EXPECT_GE(change, bound ? 2.49 * t.tolerance.at(path) : 0.0);
    }
    EXPECT_LE(t.rough.gap_share, 0.05);
    if (condition == "events") {
      EXPECT_NEAR(t.rough.faults.front().parameters.at("from_s"), t.records.front().start + t.rough.events.front().from,
                  1e-12);
    }
  }
  EXPECT_EQ(truth::draw_rough("noise_absent", 4).effects.size(), 1U);
  EXPECT_EQ(truth::draw_rough("noise_absent", 5).effects.size(), 2U);
  EXPECT_EQ(truth::draw_rough("many", 5).effects.size(), 5U);
}

}  // namespace
}  // namespace rough_test
