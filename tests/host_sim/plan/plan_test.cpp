// The predictions of rigtwin plan against closed forms, and against pairs that physics cannot tell apart.
#include "host_sim/plan/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/plan/plan_json.hpp"
#include "host_sim/plan/plan_report.hpp"
#include "host_sim/plan/rehearsal.hpp"
#include "host_sim/plan/separation.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using namespace host_sim::plan;
using model::Channel;

constexpr double rate = 1000.0;

/// Four sines, 0.9 … 11 Hz, that fade in.
firmware::FootPointMotion sines(double seconds, double level = 1.0) {
  std::vector<double> positions;
  for (std::size_t k = 0; k < static_cast<std::size_t>(seconds * rate); ++k) {
    const double t = static_cast<double>(k) / rate, pi2 = 2.0 * std::numbers::pi, fade = std::min(t, 1.0);
    positions.push_back(level * fade * fade * (3.0 - 2.0 * fade) *
                        (8e-3 * std::sin(pi2 * 0.9 * t) + 4e-3 * std::sin(pi2 * 2.3 * t) +
                         1.5e-3 * std::sin(pi2 * 5.1 * t) + 0.5e-3 * std::sin(pi2 * 11.0 * t)));
  }
  return firmware::through_samples(positions, rate);
}

firmware::RigDescription bench(const std::string& more = "") {
  return firmware::parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 30000.0\ndamping = 1000.0\n"
      "[noise]\nF = 10.0\nx_act = 2e-5\n" +
          more,
      "bench.toml");
}

firmware::RigDescription car() {
  return firmware::parse_rig(
      "kind = 'quarter_car'\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\n"
      "stiffness = 200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n[noise]\nz_r = 2e-5\n"
      "zdd_w = 0.05\nzdd_b = 0.05\nF_w = 10.0\ndz_w = 5e-5\ndz_b = 5e-5\n",
      "car.toml");
}

Setting over(firmware::FootPointMotion motion, std::vector<Channel> without = {}) {
  Setting setting;
  setting.motion = std::move(motion);
  setting.without = std::move(without);
  return setting;
}

const PlannedEffect& find(const Plan& plan, const std::string& name) {
  const auto at = std::find_if(plan.effects.begin(), plan.effects.end(),
                               [&](const PlannedEffect& e) { return words(e.subject) == name; });
  if (at == plan.effects.end()) throw std::runtime_error("the plan has no " + name);
  return *at;
}

double left(const PlannedEffect& effect, const std::string& other) {
  for (const TakenFor& taken : effect.taken_for) {
    if (taken.name == other) return taken.left;
  }
  return 10.0;
}

/// The bench's plan, made once.
const Plan& bench_plan() {
  static const Plan plan = make_plan(bench(), over(sines(12.0)));
  return plan;
}

// Point. A gain g of F changes it by (g − 1) F: (g − 1) √(Σ F²)/σ_F standard deviations over the fitted three quarters,
// F = k x + b ẋ of each sine.
TEST(Plan, ShowsAGainAsTheClosedFormDoes) {
  double power = 0.0;
  const double amplitudes[] = {8e-3, 4e-3, 1.5e-3, 0.5e-3}, frequencies[] = {0.9, 2.3, 5.1, 11.0};
  for (int i = 0; i < 4; ++i) {
    const double force = std::hypot(30000.0, 1000.0 * 2.0 * std::numbers::pi * frequencies[i]) * amplitudes[i];
    power += 0.5 * force * force;
  }
  // The fade-in of 1 s and the cosine tapers of 0.25 s hold 0.37 and 0.37 of their power: 8.3 of 9 s.
  const double sigma = std::sqrt(power * 8.3 * rate) / 10.0;
  const PlannedEffect& gain = find(bench_plan(), "sensor_gain of F");
  ASSERT_TRUE(gain.shows_at);
  EXPECT_NEAR((*gain.shows_at - 1.0) * sigma / 3.0, 1.0, 0.1);
}

// Law. The significance of a linear effect is proportional to its size, and grows with the square root of time.
TEST(Plan, NeedsAHalfOfTheSizeInFourTimesTheTime) {
  const Plan longer = make_plan(bench(), over(sines(48.0)));
  const double before = *find(bench_plan(), "viscous_damping").shows_at,
               after = *find(longer, "viscous_damping").shows_at;
  EXPECT_NEAR(before / after, 2.0, 0.25);
}

// A delay and a lag of some microseconds, a viscous damping and the damping described: nothing tells them apart. So
// there is no size from which they would be named.
TEST(Plan, SaysWhatNobodyTellsApart) {
  const PlannedEffect& delay = find(bench_plan(), "sensor_delay of F");
  ASSERT_FALSE(delay.taken_for.empty());
  EXPECT_EQ(delay.taken_for.front().name, "sensor_lag of F");
  EXPECT_LT(delay.taken_for.front().left, 0.3);
  EXPECT_FALSE(delay.named_at);
  EXPECT_LT(left(find(bench_plan(), "viscous_damping"), "suspension.damping"), 0.1);
  const PlannedEffect& friction = find(bench_plan(), "coulomb_friction");
  EXPECT_GT(friction.taken_for.front().left, 3.0);
  ASSERT_TRUE(friction.named_at);
  EXPECT_GE(*friction.named_at, *friction.shows_at * 3.0);
}

const Subject& subject_named(const std::vector<Subject>& list, const std::string& name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const Subject& s) { return words(s) == name; });
  if (at == list.end()) throw std::runtime_error("no " + name);
  return *at;
}

// A relaxation of 20 ms is none of those that a fit starts from (around the slowest mode): linear in its size each of
// them leaves something, and with its parameters fitted nothing is left, whatever they were. The fit ends where a step
// gains less than 10 % of the squares, so 1 % of the effect is far above its rest.
TEST(Plan, FitsTheParametersOfARival) {
  const Rehearsal rehearsal(bench(), over(sines(12.0)));
  const std::vector<Subject> list = subjects(rehearsal);
  Rival rival;
  rival.subject = subject_named(list, "relaxation");
  rival.strong = rival.subject.placed();
  add_directions(rehearsal, rival);
  firmware::PlacedEffect hidden = rival.subject.placed();
  hidden.values = {2000.0, 0.02};
  const auto change = rehearsal.change(hidden);
  ASSERT_TRUE(change);
  const double whole = rehearsal.significance(*change), square = rehearsal.product(*change, *change);
  const double linear = left_of(rehearsal, *change, square, rival.directions);
  EXPECT_GT(linear, 0.02 * whole);
  EXPECT_LT(left_when_refitted(rehearsal, *change, rival), 0.01 * whole);
  // Next to nothing of Coulomb friction looks like it: there nothing is fitted.
  Rival friction;
  friction.subject = subject_named(list, "coulomb_friction");
  friction.strong = friction.subject.placed();
  add_directions(rehearsal, friction);
  EXPECT_LE(left_when_refitted(rehearsal, *change, friction), left_of(rehearsal, *change, square, friction.directions));
}

// Law. A stretch of a random road stands for the whole, with the growth that (1) of Stretch says: gain, friction and
// damping within 15 % of their significance on all of it, a limit within the difference of the two peaks. A road of
// sines is not stationary by being named so long as nobody says it, and a short one stays whole.
TEST(Plan, StretchOfARandomRoadStandsForTheWhole) {
  const firmware::RigDescription rig = bench();
  Setting setting = over(firmware::excitation(rig.rig, firmware::drive_over({.bandwidth = 30.0}, rate, 60'000), rate));
  EXPECT_FALSE(stretch_of(rig, setting));
  setting.stationary = true;
  const auto stretch = stretch_of(rig, setting);
  ASSERT_TRUE(stretch);
  EXPECT_LT(stretch->setting.motion.size(), setting.motion.size() / 3);
  EXPECT_GT(stretch->growth, 1.5);
  EXPECT_LE(stretch->growth, std::sqrt(60.0 / 16.0) + 1e-9);
  const Rehearsal part(rig, stretch->setting), whole(rig, setting);
  const std::vector<Subject> list = subjects(whole);
  for (const char* const name : {"sensor_gain of F", "coulomb_friction", "viscous_damping"}) {
    const firmware::PlacedEffect effect = subject_named(list, name).placed();
    const double all = whole.significance(*whole.change(effect));
    EXPECT_NEAR(stretch->growth * part.significance(*part.change(effect)) / all, 1.0, 0.15) << name;
  }
  const Subject& limit = subject_named(list, "sensor_saturation of F");
  const double at = SizeSearch(part, limit, 0).with(3.0).value().value;
  EXPECT_NEAR(at / SizeSearch(whole, limit, 0).with(3.0).value().value, 1.0, 0.1);
  setting.motion.resize(20'000);
  EXPECT_FALSE(stretch_of(rig, setting));
}

// Of a law that could imitate others a name is promised where those leave a rest, and no less than it would have to
// leave beside them.
TEST(Plan, PromisesOfAnImitatingLawWhatLeavesARest) {
  const PlannedEffect& damper = find(bench_plan(), "asymmetric_damper");
  ASSERT_TRUE(damper.shows_at && damper.named_at);
  EXPECT_GT(*damper.named_at, *damper.shows_at * 10.0 / 3.0);
  const Rehearsal rehearsal(bench(), over(sines(12.0)));
  firmware::PlacedEffect hidden = damper.subject.placed();
  hidden.values[damper.parameter] = *damper.named_at;
  EXPECT_TRUE(rehearsal.leaves_a_rest(hidden));
  hidden.values[damper.parameter] = 0.5 * *damper.shows_at;
  EXPECT_FALSE(rehearsal.leaves_a_rest(hidden));
}

// A limit that only the highest peak reaches is promised where rigs within the tolerances reach it. On a bench the
// deflection is what the command says; a car moves as its tolerances let it.
TEST(Plan, PromisesALimitWithinTheTolerances) {
  const auto limit_of = [](const std::string& tolerance) {
    firmware::RigDescription rig = car();
    if (!tolerance.empty()) rig.tolerance["suspension.damping"] = 0.2;
    Setting setting = over(sines(8.0, 0.5));
    const Rehearsal rehearsal(rig, setting);
    const std::vector<Subject> list = subjects(rehearsal);
    const Subject& limit = subject_named(list, "sensor_saturation of dz_b");
    SizeSearch search(rehearsal, limit, 0);
    EXPECT_TRUE(search.falls());
    double least = search.with(10.0).value().value;
    for (const auto& other : within_tolerances(rig, setting)) {
      least = std::min(least, SizeSearch(*other, limit, 0).with(10.0).value().value);
    }
    return least;
  };
  EXPECT_LT(limit_of("damping"), 0.99 * limit_of(""));
  EXPECT_TRUE(within_tolerances(car(), over(sines(8.0, 0.5))).empty());
}

// A clearance shows below the travel, a velocity limit below the peak velocity: effects that grow as a value falls.
TEST(Plan, FindsSizesThatFall) {
  const PlannedEffect& stop = find(bench_plan(), "bump_stop");
  ASSERT_TRUE(stop.shows_at);
  EXPECT_LT(*stop.shows_at, 0.014);
  EXPECT_GT(*stop.shows_at, 0.009);
  const PlannedEffect& limit = find(bench_plan(), "sensor_saturation of F");
  ASSERT_TRUE(limit.shows_at && limit.named_at);
  EXPECT_LE(*limit.named_at, *limit.shows_at);
}

// Without a force all masses, stiffnesses and dampings scale together; a force closes that.
TEST(Plan, NamesWhatStaysUndetermined) {
  const Plan plan = make_plan(car(), over(sines(10.0, 0.5), {Channel::F_w, Channel::dz_w, Channel::dz_b}));
  ASSERT_EQ(plan.open.size(), 1U);
  EXPECT_NE(plan.open.front().combination.find("body.mass, wheel.mass"), std::string::npos);
  EXPECT_NE(plan.open.front().combination.find("in one ratio"), std::string::npos) << plan.open.front().combination;
  EXPECT_EQ(plan.open.front().why, "no force is measured");
  for (const PlannedParameter& p : plan.parameters) EXPECT_TRUE(p.open()) << p.path;
  const auto force =
      std::find_if(plan.advice.begin(), plan.advice.end(), [](const Advice& a) { return a.what == "a sensor of F_w"; });
  ASSERT_NE(force, plan.advice.end());
  EXPECT_GT(force->gain, 0.9);  // the two accelerations say the same of all effects
  EXPECT_NE(std::find(force->determines.begin(), force->determines.end(), "body.mass"), force->determines.end());
}

TEST(Plan, SaysHowFarAnEffectIsFromBeingReached) {
  const Plan plan = make_plan(car(), over(sines(10.0, 0.3)));
  EXPECT_TRUE(plan.open.empty());
  const PlannedEffect& flight = find(plan, "tyre_lift_off");
  EXPECT_FALSE(flight.shows_at);
  EXPECT_NE(flight.why.find("needs 3.24e+03 N"), std::string::npos) << flight.why;
  firmware::RigDescription stopped = bench("[effects.bump_stop]\nclearance = 0.06\nstiffness = 1e5\n");
  const Plan with_stop = make_plan(stopped, over(sines(8.0)));
  const auto clearance = std::find_if(with_stop.parameters.begin(), with_stop.parameters.end(),
                                      [](const auto& p) { return p.path == "effects.bump_stop.clearance"; });
  ASSERT_NE(clearance, with_stop.parameters.end());
  EXPECT_TRUE(clearance->why.starts_with("not reached: travel 1") && clearance->why.ends_with("needs 60 mm"))
      << clearance->why;
}

// Tolerances that are refitted hide what they can imitate.
TEST(Plan, CountsToleratedParametersAsFree) {
  const Plan tolerant = make_plan(bench("[tolerance]\n'suspension.damping' = 0.1\n"), over(sines(12.0)));
  EXPECT_GT(*find(tolerant, "viscous_damping").shows_at, 10.0 * *find(bench_plan(), "viscous_damping").shows_at);
  EXPECT_LT(*find(tolerant, "coulomb_friction").shows_at, 3.0 * *find(bench_plan(), "coulomb_friction").shows_at);
}

TEST(Plan, RefusesWhatCannotBePlanned) {
  EXPECT_THROW(static_cast<void>(make_plan(bench(), over(sines(8.0), {Channel::F_w}))), firmware::UsageError);
  EXPECT_THROW(static_cast<void>(make_plan(bench(), over(sines(8.0), {Channel::F, Channel::x_act}))),
               firmware::InputError);
}

void expect_finite(const nlohmann::ordered_json& json) {
  if (json.is_number()) {
    EXPECT_TRUE(std::isfinite(json.get<double>()));
  } else if (json.is_structured()) {
    for (const auto& item : json) expect_finite(item);
  }
  EXPECT_FALSE(json.is_null());
}

TEST(Plan, WritesFiniteNumbersAndAPage) {
  const Plan plan = make_plan(bench(), over(sines(6.0)));
  const nlohmann::ordered_json json = to_json(plan);
  expect_finite(json);
  for (const char* key : {"effects", "parameters", "undetermined", "advice"}) EXPECT_TRUE(json.contains(key)) << key;
  for (const auto& effect : json["effects"]) {
    for (const char* key : {"name", "sigma_at_default", "taken_for"}) EXPECT_TRUE(effect.contains(key)) << effect;
    EXPECT_TRUE(effect.contains("shows_at") || effect.contains("why")) << effect;
  }
  for (const auto& parameter : json["parameters"]) EXPECT_LE(parameter["determined_to"].get<double>(), 1.3);
  const std::string page = report_html(plan, bench(), "four sines");
  EXPECT_NE(page.find("What would help most"), std::string::npos);
  // Five sentences and one picture come before any section; the rows are folded.
  const std::vector<std::string> first = sentences(plan);
  ASSERT_EQ(first.size(), 5U);
  for (const std::string& sentence : first) EXPECT_TRUE(sentence.ends_with(".")) << sentence;
  EXPECT_LT(page.find("How strongly an effect of a typical size would show"), page.find("<h2"));
  EXPECT_NE(page.find("<summary>All sizes, the strongest effect first</summary>"), std::string::npos);
  EXPECT_NE(page.find("What would be taken for what"), std::string::npos);
}

}  // namespace
