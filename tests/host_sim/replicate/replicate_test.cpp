// The drive that makes a rig do what a recording shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "firmware/simulation/road.hpp"
#include "host_sim/replicate/damage.hpp"
#include "host_sim/replicate/replication.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::InputError;
using firmware::Recording;
using firmware::RigDescription;
using host_sim::replicate::Replication;
using host_sim::replicate::TargetRequest;
using model::Channel;
namespace replicate = host_sim::replicate;

// --- damage

// Point. ASTM E1049-85, figure 6: ranges and counts of its worked example.
TEST(Rainflow, CountsTheExampleOfAstmE1049) {
  const std::vector<double> history{-2, 1, -3, 5, -1, 3, -4, 4, -2};
  std::map<double, double> counts;
  for (const auto& cycle : replicate::rainflow(history)) counts[cycle.range()] += cycle.count;
  EXPECT_EQ(counts, (std::map<double, double>{{3, 0.5}, {4, 1.5}, {6, 0.5}, {8, 1.0}, {9, 0.5}}));
}

// Law. Whatever a signal does, its largest cycle goes from its highest peak to its lowest valley, and no half cycle is
// lost: ranges over turning points, two to a cycle.
TEST(Rainflow, TheLargestRangeIsFromPeakToValley) {
  firmware::Gaussian random(7, 1);
  std::vector<double> signal(3000);
  double value = 0.0;
  for (double& v : signal) v = value = 0.9 * value + random();
  const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
  double largest = 0.0, halves = 0.0;
  const auto cycles = replicate::rainflow(signal);
  for (const auto& cycle : cycles) {
    largest = std::max(largest, cycle.range());
    halves += 2.0 * cycle.count;
  }
  EXPECT_DOUBLE_EQ(largest, *high - *low);
  EXPECT_DOUBLE_EQ(halves, static_cast<double>(replicate::turning_points(signal).size()) - 1.0);
  const auto matrix = replicate::rainflow_matrix(cycles, *low, *high, 16);
  double sum = 0.0;
  for (const double count : matrix.counts) sum += count;
  EXPECT_DOUBLE_EQ(2.0 * sum, halves);
}

// Point. Twice the signal is 2^k the damage; level crossings of a sine, one per period.
TEST(Rainflow, DamageGrowsWithThePowerOfTheRange) {
  std::vector<double> once(1000), twice(1000);
  for (std::size_t k = 0; k < 1000; ++k) {
    once[k] = std::sin(0.1 * static_cast<double>(k));
    twice[k] = 2.0 * once[k];
  }
  const double ratio =
      replicate::pseudo_damage(replicate::rainflow(twice), 5) / replicate::pseudo_damage(replicate::rainflow(once), 5);
  EXPECT_NEAR(ratio, 32.0, 1e-9);
  const auto counts = replicate::level_crossings(once, {-0.5, 0.5, 2.0});
  EXPECT_NEAR(counts[0], 1000.0 * 0.1 / 6.283185307179586, 1.0);
  EXPECT_EQ(counts[2], 0.0);
}

// --- replication

constexpr std::string_view machine =
    "[effects.actuator_delay]\ndelay = 0.0044\n[effects.actuator_lag]\ntime_constant = 0.0222\n";

RigDescription car(const std::string& more = "") {
  const RigDescription rig = support::rig("paper_rig_fdva");
  return firmware::parse_rig(rig.text + std::string(machine) + "[limits]\nspeed = 3.0\n" + more, "rig.toml");
}

/// What the true rig does on a class B road.
Recording target_of(const RigDescription& truth, const std::vector<Channel>& channels, double seconds,
                    std::uint64_t seed = 5) {
  const firmware::IsoRoad road{.roughness = 64e-6, .speed = 27.78, .bandwidth = 30.0, .seed = seed};
  std::vector<double> z;
  for (const auto& m : firmware::drive_over(road, 1000.0, static_cast<std::size_t>(1000.0 * seconds)))
    z.push_back(m.position);
  const replicate::DriveModel model(truth, channels);
  const auto answer = model.answer(z);
  Recording recording;
  recording.source = "target.csv";
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(z.size(), 1000.0);
  for (std::size_t c = 0; c < channels.size(); ++c) recording[channels[c]] = answer[c];
  return recording;
}

/// A run of the newest drive on the true rig, with sensors' noise where it is asked for.
Recording run_of(const Replication& replication, const RigDescription& truth, std::uint64_t seed = 0) {
  const auto& drive = replication.drives().back().values;
  const Channel command = replicate::drive_channel(truth.rig.kind);
  host_sim::SimulationInput input;
  input.period = 1e-3;
  input.motion = firmware::through_samples(drive, 1000.0);
  input.channel = command;
  const auto channels = host_sim::response_channels(truth.rig.kind, input);
  const replicate::DriveModel model(truth, channels);
  const auto answer = model.answer(drive);
  Recording run;
  run.source = "run.csv";
  run.sample_period = 1e-3;
  run.time = firmware::sample_times(drive.size(), 1000.0);
  run[command] = drive;
  firmware::Gaussian random(seed, 3);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    run[channels[c]] = answer[c];
    const double noise = seed == 0 ? 0.0 : truth.noise[index(channels[c])].value_or(0.0);
    if (!(noise > 0.0)) continue;
    for (double& v : run[channels[c]]) v += noise * random();
  }
  return run;
}

TargetRequest wheel() { return replicate::parse_request("zdd_w", {"0.7:40"}); }

// Law. With the true model one run is enough: what is left is below a thousandth, and the damage is the target's.
TEST(Replication, ReachesTheTargetAtOnceWithTheTrueModel) {
  const RigDescription truth = car();
  Replication replication(truth, wheel(), {target_of(truth, {Channel::zdd_w}, 6.0)}, 0.01);
  EXPECT_LT(replication.inverse().unreachable()[0], 2e-3) << "one channel, one drive";
  replication.solve();
  EXPECT_LT(replication.results()[0].predicted[0], 1e-3);
  replication.take(run_of(replication, truth));
  EXPECT_LT(replication.results()[0].error[0], 1e-3);
  EXPECT_NEAR(replication.results()[0].damage[0][1], 1.0, 5e-3);
  EXPECT_EQ(replication.stop(), replicate::Stop::goal);
}

// Law. A model with numbers 2 % off: what repeats is learned, run by run, and the noise of the sensors is not.
TEST(Replication, LearnsWhatRepeats) {
  const RigDescription described = car();
  RigDescription truth = described;
  truth.rig.wheel.mass *= 1.02;
  truth.rig.tyre.stiffness *= 0.98;
  truth.rig.suspension.damping *= 1.03;
  Replication replication(described, wheel(), {target_of(truth, {Channel::zdd_w}, 6.0)}, 0.001);
  for (std::uint64_t run = 1; run <= 3; ++run) {
    replication.solve();
    replication.take(run_of(replication, truth, run));
  }
  const auto& results = replication.results();
  EXPECT_GT(results[0].error[0], 0.02);
  EXPECT_LT(results[1].error[0], 0.015);
  EXPECT_LT(results[2].error[0], 1.5 * replication.floor().noise[0] + 5e-3);
}

// Law. Friction and a stop in the model: the non-linear model is inverted, not its linear part.
TEST(Replication, InvertsFrictionAndStops) {
  const RigDescription truth =
      car("[effects.coulomb_friction]\nforce = 60.0\n[effects.bump_stop]\nclearance = 0.010\nstiffness = 200e3\n");
  Replication replication(truth, wheel(), {target_of(truth, {Channel::zdd_w}, 6.0)}, 0.01);
  replication.solve();
  EXPECT_LT(replication.results()[0].predicted[0], 0.02);
}

// Law. Two targets, one foot point: what it cannot make of both is said before anything moves.
TEST(Replication, SaysWhatOneFootPointCannotMake) {
  const RigDescription truth = car();
  const auto request = replicate::parse_request("zdd_w,dz_b:0.5", {"0.7:30"});
  Recording target = target_of(truth, {Channel::zdd_w, Channel::dz_b}, 6.0);
  const Replication together(truth, request, {target}, 0.01);
  // The absorber's losses are quadratic: at its tangent it is damped less than on the road.
  EXPECT_LT(together.inverse().unreachable()[0], 0.06);
  EXPECT_LT(together.inverse().unreachable()[1], 0.06);
  target[Channel::dz_b] = target_of(truth, {Channel::dz_b}, 6.0, 99)[Channel::dz_b];
  const Replication apart(truth, request, {target}, 0.01);
  EXPECT_GT(apart.inverse().unreachable()[0] + apart.inverse().unreachable()[1], 0.5) << "two roads are no road";
}

// Law. A target beyond the stroke: the drive stays within every limit, and what that costs is said.
TEST(Replication, StaysWithinTheLimitsAndSaysWhatTheyCost) {
  const RigDescription truth = car();
  Recording target = target_of(truth, {Channel::dz_b}, 6.0);
  double largest = 0.0;
  for (const double v : target[Channel::dz_b]) largest = std::max(largest, std::abs(v));
  for (double& v : target[Channel::dz_b]) v *= 0.4 / largest;
  Replication replication(truth, replicate::parse_request("dz_b", {"0.7:20"}), {target}, 0.01);
  replication.solve();
  const auto& result = replication.results()[0];
  EXPECT_LE(std::max({result.used.stroke, result.used.speed, result.used.acceleration}), 1.0);
  EXPECT_GT(std::max({result.used.stroke, result.used.speed, result.used.acceleration}), 0.9);
  ASSERT_EQ(result.unlimited.size(), 1U);
  EXPECT_GT(result.predicted[0], result.unlimited[0] + 0.05);
}

// Fault. Runs that are not what they should be.
TEST(Replication, RefusesWhatItCannotUse) {
  const RigDescription truth = car();
  const Recording target = target_of(truth, {Channel::zdd_w}, 6.0);
  Replication replication(truth, wheel(), {target}, 1e-6);
  replication.solve();
  RigDescription heavier = truth;
  heavier.rig.wheel.mass *= 1.05;
  const Recording first = run_of(replication, heavier);
  Recording other = first;
  for (double& v : other[Channel::z_cmd]) v *= 1.01;
  EXPECT_THROW(replication.take(other), InputError) << "of another drive";
  Recording silent = first;
  silent[Channel::z_cmd].clear();
  EXPECT_THROW(replication.take(silent), InputError) << "of no known drive";
  Recording dead = first;
  std::fill(dead[Channel::zdd_w].begin(), dead[Channel::zdd_w].end(), 0.0);
  EXPECT_THROW(replication.take(dead), InputError) << "its only channel is lost";
  const auto cut = [&first](std::size_t rows) {
    Recording part = first;
    part.time.resize(rows);
    for (auto& column : part.channels) column.resize(std::min(column.size(), rows));
    return part;
  };
  EXPECT_THROW(replication.take(cut(3000)), InputError) << "too short";
  replication.take(cut(6000));
  ASSERT_FALSE(replication.results()[0].remarks.empty());
  EXPECT_NE(replication.results()[0].remarks[0].find("cut short"), std::string::npos);
  replication.solve();
  EXPECT_THROW(replication.take(first), InputError) << "of the first drive, not of the second";

  EXPECT_THROW(Replication(support::rig("paper_rig_fdva"), wheel(), {target}, 0.01), InputError) << "no machine";
  Recording slow = target;
  slow.sample_period = 2e-3;
  EXPECT_THROW(Replication(truth, wheel(), {slow}, 0.01), InputError);
  EXPECT_THROW(Replication(truth, replicate::parse_request("F", {}), {target}, 0.01), firmware::UsageError);
  EXPECT_THROW(Replication(truth, replicate::parse_request("F_w", {}), {target}, 0.01), InputError)
      << "not in the target";
  Recording in_g = target_of(truth, {Channel::zdd_w, Channel::dz_b}, 6.0);
  for (double& v : in_g[Channel::zdd_w]) v /= 9.80665;
  EXPECT_THROW(Replication(truth, replicate::parse_request("zdd_w,dz_b", {"0.7:30"}), {in_g}, 0.01), InputError);
  EXPECT_THROW(static_cast<void>(replicate::parse_request("zdd_w,zdd_w", {})), firmware::UsageError);
  EXPECT_THROW(static_cast<void>(replicate::parse_request("zdd_w", {"40:0.7"})), firmware::UsageError);
}

// Law. The component of a hil rig, and of a bench, is driven by x_cmd; the target is its force.
TEST(Replication, DrivesAComponentByItsForce) {
  RigDescription hil = support::rig("paper_hil_fdva");
  hil.rig.effects.add(model::ActuatorLag<double>{0.01});
  const RigDescription part = replicate::driven_part(hil);
  EXPECT_EQ(part.rig.kind, model::RigKind::component_bench);
  Recording target = target_of(part, {Channel::F}, 6.0);
  Replication replication(hil, replicate::parse_request("F", {"0.7:30"}), {target}, 0.01);
  replication.solve();
  replication.take(run_of(replication, part));
  EXPECT_LT(replication.results()[0].error[0], 0.01);
  EXPECT_TRUE(replicate::drive_recording(replication, 0).has(Channel::x_cmd));
}

// Point. Events in a row: the error counts the events, and between them the drive goes on.
TEST(Target, PutsEventsInARow) {
  const RigDescription truth = car();
  const Recording one = target_of(truth, {Channel::zdd_w}, 3.0, 1), two = target_of(truth, {Channel::zdd_w}, 4.0, 2);
  const replicate::Target target = replicate::make_target(truth, wheel(), {one, two});
  ASSERT_EQ(target.events.size(), 2U);
  EXPECT_EQ(target.events[0].from, 2000U);
  EXPECT_EQ(target.events[1].from, 2000U + 3000U + 2000U);
  EXPECT_EQ(target.size(), 2000U + 3000U + 2000U + 4000U + 2000U);
  EXPECT_EQ(target.values[0][target.events[1].from + 7], two[Channel::zdd_w][7]);
  EXPECT_EQ(target.values[0].front(), 0.0);
}

}  // namespace
