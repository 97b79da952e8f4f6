// Firmware and simulated rig in one loop.
#include "host_sim/closed_loop/closed_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/description/control_settings.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::FootPointMotion;
using firmware::parse_rig;
using firmware::Reason;
using firmware::RigDescription;
using firmware::SimulatedRig;
using hal::simulated::ChannelFault;
using hal::simulated::DeviceFault;
using host_sim::RunOptions;
using model::Channel;
using model::CoreIndex;
using model::index;

FootPointMotion road(const RigDescription& rig, std::size_t samples, std::uint64_t seed = 1) {
  firmware::IsoRoad iso;
  iso.seed = seed;
  iso.bandwidth = firmware::default_bandwidth(rig.rig.kind, rig.sample_rate);
  return firmware::excitation(rig.rig, firmware::drive_over(iso, rig.sample_rate, samples), rig.sample_rate);
}

host_sim::Run run_of(const RigDescription& rig, std::size_t samples, const RunOptions& options = {}) {
  return host_sim::run_closed_loop(rig, road(rig, samples), options);
}

RunOptions without_noise() {
  RunOptions options;
  options.noise = SimulatedRig::Noise::none;
  return options;
}

// Golden by construction: one step function. Virtual car in the firmware and machine in the simulated rig, a sample of
// F between them, are RigModel's whole rig to the bit, valves and all.
TEST(ClosedLoop, IsTheWholeRigOfTheModelToTheBit) {
  for (const char* name : {"paper_hil_fdva", "paper_linear", "paper_hil_aas"}) {
    RigDescription rig = support::rig(name);
    rig.controller.speed = 5.0;       // nothing limited
    if (rig.rig.air_spring.fitted) {  // the skyhook of the firmware, through a lever
      rig.rig.lever.count = 3;
      rig.rig.lever.at = {-0.05, 0.0, 0.05};
      rig.rig.lever.ratio = {0.95, 1.0, 1.1};
    }
    if (rig.rig.has_fdva) rig.controller.valve_plan = {{0.5, 0b101}, {1.2, 0}, {1.4, 0b111111}};
    rig.rig.effects.add(model::TyreLiftOff<double>{});
    rig.rig.effects.add(model::CoulombFriction<double>{30.0});
    constexpr std::size_t samples = 3000;
    const FootPointMotion motion = road(rig, samples);
    const host_sim::Run run = host_sim::run_closed_loop(rig, motion, without_noise());
    ASSERT_EQ(run.trip.reason, Reason::reference_ended);
    ASSERT_EQ(run.recording.size(), samples);

    const model::RigModel<> model(rig.rig, 1e-3);
    model::Column<double, 6> core = model::Column<double, 6>::Zero();
    core(CoreIndex::wheel_position) = core(CoreIndex::body_position) = motion[0].position;
    auto x = model.start(core, motion[0], {});
    for (std::size_t k = 0; k < samples; ++k) {
      const auto signals = model.signals(x);
      for (const Channel c : {Channel::z_r, Channel::z_w, Channel::z_b, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b,
                              Channel::dz_w, Channel::dz_b, Channel::F_w, Channel::x_cmd, Channel::x_act, Channel::F}) {
        ASSERT_EQ(run.recording[c][k], signals[index(c)]) << name << ", " << model::name(c) << " at sample " << k;
      }
      if (k + 1 == samples) break;
      for (const auto& change : rig.controller.valve_plan) {
        if (static_cast<long>(k) == std::lround(change.time * 1e3)) model.open_ducts(x, change.open);
      }
      model.step(x, {.foot_point = motion[k + 1]});
    }
  }
}

// A recording holds what such a rig measures and computes, one row a period, nothing else; its time begins at 0.
TEST(ClosedLoop, RecordsWhatTheRigMeasuresAndComputes) {
  const auto channels_of = [](const char* name) {
    const host_sim::Run run = run_of(support::rig(name), 50);
    std::string names;
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      const auto& column = run.recording.channels[i];
      if (column.empty()) continue;
      EXPECT_EQ(column.size(), 50U);
      names += std::string(model::channel_names[i].name) + " ";
    }
    for (std::size_t j = 0; j < firmware::recorded_ducts; ++j) {
      if (!run.recording.ducts[j].empty()) names += std::to_string(j + 1);
    }
    for (const auto& extra : run.recording.extra) names += " " + extra.name;
    EXPECT_EQ(run.recording.sample_period, 1e-3);
    EXPECT_EQ(run.recording.time, firmware::sample_times(50, 1000.0));
    EXPECT_EQ(run.lost_records, 0U);
    return names;
  };
  EXPECT_EQ(channels_of("paper_hil_fdva"), "z_r z_w z_b zdd_r zdd_w zdd_b dz_w dz_b F_w x_cmd x_act F 123456");
  EXPECT_EQ(channels_of("paper_rig_fdva"), "z_r zdd_r zdd_w zdd_b dz_w dz_b F_w 123456 F_w_c v_r v_w v_b");
  EXPECT_EQ(channels_of("paper_bench_fdva"), "x_cmd x_act F 123456");
  EXPECT_EQ(channels_of("paper_linear"), "z_r z_w z_b zdd_r zdd_w zdd_b dz_w dz_b F_w x_cmd x_act F ");
}

// The foot point of the hardware rig and the deflection of the bench are where the reference says, when it says.
TEST(ClosedLoop, FollowsTheReferenceSampleBySample) {
  for (const auto& [name, channel] :
       {std::pair{"paper_rig_fdva", Channel::z_r}, std::pair{"paper_bench_fdva", Channel::x_cmd}}) {
    const RigDescription rig = support::rig(name);
    const FootPointMotion motion = road(rig, 500);
    const host_sim::Run run = host_sim::run_closed_loop(rig, motion, without_noise());
    ASSERT_EQ(run.recording.size(), 500U);
    for (std::size_t k = 0; k < 500; ++k) ASSERT_EQ(run.recording[channel][k], motion[k].position) << name << k;
  }
}

// A road that begins away from the rest: the rig moves there first, and the recording begins when it is there.
TEST(ClosedLoop, MovesToTheBeginningBeforeItRecords) {
  const RigDescription rig = support::rig("paper_rig_fdva");
  FootPointMotion motion = road(rig, 100);
  for (auto& m : motion) m.position += 0.02;
  const host_sim::Run run = host_sim::run_closed_loop(rig, motion, without_noise());
  ASSERT_EQ(run.recording.size(), 100U);
  EXPECT_EQ(run.recording.time.front(), 0.0);
  EXPECT_EQ(run.recording[Channel::z_r].front(), motion.front().position);
  EXPECT_GT(run.trip.time.seconds(), 0.02 / rig.controller.ramp) << "0.02 m take their time at the ramp's speed";
}

// Law. A run is a function of description, road and seed.
TEST(ClosedLoop, FollowsFromTheSeed) {
  for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"}) {
    const RigDescription rig = support::rig(name);
    RunOptions other;
    other.seed = 2;
    const host_sim::Run a = run_of(rig, 300), b = run_of(rig, 300), c = run_of(rig, 300, other);
    EXPECT_EQ(a.recording.channels, b.recording.channels) << name;
    EXPECT_NE(a.recording.channels, c.recording.channels) << name;
  }
}

// The valves switch at the sample whose time the plan says, not one earlier or later, the valves' columns with them;
// from there the run is another.
TEST(ClosedLoop, SwitchesValvesAtTheVerySample) {
  RigDescription rig = support::rig("paper_bench_fdva");
  const host_sim::Run plain = run_of(rig, 200, without_noise());
  rig.controller.valve_plan = {{0.100, 0b000001}, {0.1505, 0b110000}};
  const host_sim::Run switched = run_of(rig, 200, without_noise());
  for (std::size_t k = 0; k < 199; ++k) {  // in the last row the run is over: safe position
    const unsigned open = k < 100 ? 0b11U : (k < 151 ? 0b1U : 0b110000U);  // 150.5 ms: the first sample not before it
    for (std::size_t j = 0; j < 6; ++j) {
      ASSERT_EQ(switched.recording.ducts[j][k], ((open >> j) & 1U) != 0 ? 1.0 : 0.0) << "duct " << j + 1 << ", " << k;
    }
  }
  for (std::size_t k = 0; k <= 100; ++k) {
    ASSERT_EQ(switched.recording[Channel::F][k], plain.recording[Channel::F][k]) << k;
  }
  EXPECT_NE(switched.recording[Channel::F][101], plain.recording[Channel::F][101]);
}

// Fault. What goes wrong in the rig ends the run in the safe state, for the reason and at the time it happened. A bad
// sample is bridged twice; the third in a row trips, at sample 102 for a fault that begins at 100.
TEST(ClosedLoop, EndsSafelyForTheReasonThatWasInjected) {
  using Kind = ChannelFault::Kind;
  using Device = DeviceFault::Device;
  const hal::simulated::Window window{hal::milliseconds(100), hal::milliseconds(200)};
  const auto expect_trip = [](const hal::simulated::FaultPlan& plan, Reason reason, std::size_t last_sample) {
    RunOptions options = without_noise();
    options.faults = plan;
    const host_sim::Run run = run_of(support::rig("paper_hil_fdva"), 400, options);
    EXPECT_EQ(run.trip.reason, reason) << firmware::name(run.trip.reason);
    EXPECT_EQ(run.recording.size(), last_sample + 1);
    EXPECT_EQ(run.trip.time.ns, hal::milliseconds(static_cast<std::int64_t>(last_sample)).ns);
    return run;
  };
  ChannelFault fault{Kind::drop, index(Channel::F), window};
  host_sim::Run run = expect_trip({.channels = {&fault, 1}}, Reason::sample_missing, 102);
  EXPECT_EQ(run.trip.channel, Channel::F);
  EXPECT_TRUE(std::isnan(run.recording[Channel::F][101])) << "not measured is not a number";
  EXPECT_EQ(run.counters.bridged_samples, 3U);
  fault.kind = Kind::not_a_number;
  expect_trip({.channels = {&fault, 1}}, Reason::sample_not_finite, 102);
  fault.kind = Kind::freeze;  // bad once it is older than five periods
  expect_trip({.channels = {&fault, 1}}, Reason::sample_stale, 108);
  fault = {Kind::spike, index(Channel::F), window};
  fault.spike = 30e3;
  run = expect_trip({.channels = {&fault, 1}}, Reason::force, 100);
  EXPECT_GT(run.trip.value, run.trip.limit);
  EXPECT_EQ(run.trip.limit, 25e3);

  DeviceFault device{Device::sensors, hal::Fault::disconnected, window};
  expect_trip({.devices = {&device, 1}}, Reason::sensors_lost, 100);
  device = {Device::valves, hal::Fault::timeout, window};
  expect_trip({.devices = {&device, 1}}, Reason::valves_failed, 100);
  device = {Device::command, hal::Fault::refused, window};
  expect_trip({.devices = {&device, 1}}, Reason::command_failed, 100);
  device = {Device::heartbeat, hal::Fault::timeout, window};
  expect_trip({.devices = {&device, 1}}, Reason::heartbeat_failed, 100);
  const hal::simulated::Press press{window};
  expect_trip({.presses = {&press, 1}}, Reason::stop_button, 100);

  // A channel that is lost from the first sample on is still a column: the others show what happened.
  fault = {Kind::drop, index(Channel::x_act), {}};
  RunOptions options;
  options.faults = {.channels = {&fault, 1}};
  EXPECT_EQ(run_of(support::rig("paper_hil_fdva"), 50, options).trip.reason, Reason::sample_missing);
}

// physics.md, section 6: with the FDVA and 10 ms the wheel mode grows by 2.17 1/s at b̃ = 700 and decays at 1140. From
// 10 mm/s of road it grows, which the energy says before a limit of motion or force is reached
// (journeys/energy_guard_test by how much); the loop held stable stays below all.
TEST(ClosedLoop, TripsWhenTheLoopIsUnstable) {
  RigDescription rig = support::rig("paper_hil_fdva");
  EXPECT_EQ(run_of(rig, 10000).trip.reason, Reason::reference_ended);
  rig.rig.machine.virtual_damping = 700.0;
  const host_sim::Run run = run_of(rig, 20000);
  EXPECT_EQ(run.trip.reason, Reason::energy) << firmware::name(run.trip.reason);
  EXPECT_LT(run.trip.time.seconds(), 2.0);

  // Whoever lets it feed ten times what the dampers take meets the other limits.
  rig.controller.energy_gain = 10.0;
  const host_sim::Run unguarded = run_of(rig, 20000);
  const Reason reason = unguarded.trip.reason;
  EXPECT_TRUE(reason == Reason::speed || reason == Reason::force || reason == Reason::stroke) << firmware::name(reason);
  EXPECT_LT(unguarded.trip.time.seconds(), 10.0);
}

// Each sensor's noise has the rms of the description, ± 1/√(2N): at rest nothing else is there. Channels are
// independent, ± 1/√N. Four standard errors.
TEST(ClosedLoop, AddsTheNoiseOfTheDescription) {
  const RigDescription rig = support::rig("paper_rig_fdva");
  constexpr double n = 20000.0;
  const host_sim::Run run = host_sim::run_closed_loop(rig, FootPointMotion(static_cast<std::size_t>(n)), {});
  const std::vector<Channel> noisy{Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b,
                                   Channel::F_w, Channel::dz_w,  Channel::dz_b};
  const auto product = [&run](Channel a, Channel b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < run.recording.size(); ++k) sum += run.recording[a][k] * run.recording[b][k];
    return sum / n;
  };
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const double described = *rig.noise[index(noisy[i])];
    EXPECT_NEAR(std::sqrt(product(noisy[i], noisy[i])) / described, 1.0, 4.0 / std::sqrt(2.0 * n))
        << model::name(noisy[i]);
    if (i > 0) {
      const double scale = described * *rig.noise[index(noisy[i - 1])];
      EXPECT_NEAR(product(noisy[i], noisy[i - 1]) / scale, 0.0, 4.0 / std::sqrt(n)) << model::name(noisy[i]);
    }
  }
}

// In a hil rig the car is numbers: a noise that the description gives for one of them has no sensor to come from.
TEST(ClosedLoop, AddsNoNoiseToNumbers) {
  RigDescription rig = support::rig("paper_hil_fdva");
  const auto flat = [](const RigDescription& r) { return host_sim::run_closed_loop(r, FootPointMotion(200), {}); };
  rig.noise = {};
  rig.noise[index(Channel::z_w)] = rig.noise[index(Channel::F_w)] = rig.noise[index(Channel::x_cmd)] = 1.0;
  const host_sim::Run run = flat(rig);
  for (const auto& column : run.recording.channels) {
    for (const double value : column) ASSERT_EQ(value, 0.0);
  }
  rig.noise[index(Channel::F)] = 10.0;
  EXPECT_NE(flat(rig).recording[Channel::F][1], 0.0);
  EXPECT_NE(flat(rig).recording[Channel::z_w][100], 0.0) << "the noise of F goes round the loop";
}

// A sensor shows no more than its range. Three samples at its end in a row trip; fewer are bridged.
TEST(ClosedLoop, ClipsAtTheMeasuringRange) {
  RigDescription rig = support::rig("paper_rig_fdva");
  const host_sim::Run free = run_of(rig, 5000);
  const auto& load = free.recording[Channel::F_w];
  const double limit = 0.6 * *std::max_element(load.begin(), load.end());
  rig.range[index(Channel::F_w)] = {-limit, limit};
  const host_sim::Run run = run_of(rig, 5000);
  EXPECT_EQ(run.trip.reason, Reason::sample_clipped);
  EXPECT_EQ(run.trip.channel, Channel::F_w);
  ASSERT_GT(run.recording.size(), 3U);
  const std::size_t last = run.recording.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) ASSERT_LE(std::abs(run.recording[Channel::F_w][k]), limit);
  for (std::size_t k = last - 2; k <= last; ++k) EXPECT_EQ(std::abs(run.recording[Channel::F_w][k]), limit);
}

TEST(ClosedLoop, TellsItsProgress) {
  std::vector<double> shares;
  RunOptions options;
  options.progress = [&shares](double share) { shares.push_back(share); };
  static_cast<void>(run_of(support::rig("paper_linear"), 40000, options));
  ASSERT_GE(shares.size(), 3U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GE(shares.front(), 0.0);
  EXPECT_LE(shares.back(), 1.0);
}

TEST(ClosedLoop, EndsAtOnceWithoutARoad) {
  const host_sim::Run run = host_sim::run_closed_loop(support::rig("paper_linear"), {}, {});
  EXPECT_EQ(run.recording.size(), 0U);
  EXPECT_EQ(run.trip.reason, Reason::reference_ended);
}

// What the description says reaches the firmware; what no controller can do is the user's mistake, not ours.
TEST(ClosedLoop, SetsTheFirmwareUpAsDescribed) {
  RigDescription rig = support::rig("paper_rig_fdva");
  rig.controller.stroke = 0.2;
  rig.controller.speed = 1.5;
  rig.controller.force = 20e3;
  rig.controller.force_given = true;
  rig.controller.ramp = 0.1;
  rig.controller.energy_gain = 1.3;
  rig.controller.cross_over = 2.0;
  rig.sample_rate = 500.0;
  const firmware::Settings settings = firmware::control_settings(rig);
  EXPECT_EQ(settings.period, hal::milliseconds(2));
  EXPECT_EQ(settings.limits.stroke, 0.2);
  EXPECT_EQ(settings.limits.speed, 1.5);
  EXPECT_EQ(settings.limits.force, 20e3);
  EXPECT_EQ(settings.ramps.rate, 0.1);
  EXPECT_EQ(settings.limits.energy_gain, 1.3);
  EXPECT_EQ(settings.observers.cross_over, 2.0);
  rig.controller.cross_over = 0.0;
  EXPECT_EQ(firmware::control_settings(rig).observers.cross_over, firmware::Observers{}.cross_over);
  EXPECT_EQ(firmware::valve_plan(rig).at({}), hal::Openings::first(2));

  rig.sample_rate = 3000.0;
  EXPECT_THROW(static_cast<void>(firmware::control_settings(rig)), firmware::InputError) << "no whole nanoseconds";
  rig.sample_rate = 1e6;
  EXPECT_THROW(static_cast<void>(firmware::control_settings(rig)), firmware::InputError) << "faster than a controller";
  rig.controller.valve_plan = {{1.0, 1}, {1.0, 2}};
  EXPECT_THROW(static_cast<void>(firmware::valve_plan(rig)), firmware::InputError);
}

// In the safe state the ducts stand where the description says.
TEST(ClosedLoop, LeavesTheDuctsInTheSafePosition) {
  RigDescription rig = support::rig("paper_bench_fdva");
  rig.controller.safe_ducts = 0b100;
  const hal::simulated::Press press{{hal::milliseconds(10), hal::milliseconds(20)}};
  RunOptions options;
  options.faults = {.presses = {&press, 1}};
  const host_sim::Run run = run_of(rig, 100, options);
  ASSERT_EQ(run.recording.size(), 11U);
  EXPECT_EQ(run.recording.ducts[0].back(), 0.0) << "the period that trips already puts them there";
  EXPECT_EQ(run.recording.ducts[2].back(), 1.0);
  EXPECT_EQ(run.recording.ducts[0][9], 1.0);
}

constexpr const char* driven_mass = R"(
kind = "component_bench"
driven_by = "force"
sample_rate = 1000.0
[body]
mass = 10.0
[suspension]
stiffness = 10e3
damping = 30.0
[noise]
x_act = 1e-6
)";

// Law. A mass that a force drives has no controller between: its recording holds the force and its answers, which obey
// m ẍ + c ẋ + k x = F, with ẋ from differences of x (their error at 15 Hz: (ω h)²/6 = 1.5e-3 of a force of 30 N s/m).
TEST(ClosedLoop, DrivesAMassByForce) {
  const RigDescription rig = parse_rig(driven_mass, "mass.toml");
  const host_sim::Run run = run_of(rig, 4000, without_noise());
  EXPECT_EQ(run.trip.reason, Reason::reference_ended);
  const auto& r = run.recording;
  EXPECT_TRUE(r.has(Channel::F) && r.has(Channel::x_act) && r.has(Channel::zdd_b));
  for (const Channel none : {Channel::x_cmd, Channel::z_r, Channel::F_w, Channel::z_b}) EXPECT_FALSE(r.has(none));
  double squares = 0.0, all = 0.0;
  for (std::size_t k = 1; k + 1 < r.size(); ++k) {
    const double velocity = (r[Channel::x_act][k + 1] - r[Channel::x_act][k - 1]) / 2e-3;
    const double left = 10.0 * r[Channel::zdd_b][k] + 30.0 * velocity + 10e3 * r[Channel::x_act][k] - r[Channel::F][k];
    squares += left * left;
    all += r[Channel::F][k] * r[Channel::F][k];
  }
  EXPECT_GT(all, 0.0);
  EXPECT_LT(std::sqrt(squares / all), 1e-3);
  EXPECT_NE(host_sim::run_closed_loop(rig, road(rig, 4000), {}).recording[Channel::x_act], r[Channel::x_act]);
}

}  // namespace
