// Journey. A rig is driven over a rough road through the firmware, with noise and switching valves; its recording goes
// to a file and comes back; the same firmware, given nothing but what the sensors had said, does the same again.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/description/control_settings.hpp"
#include "firmware/loop/control_loop.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "hal/replay/rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::Recording;
using model::Channel;
using model::index;

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

struct Ride {
  firmware::RigDescription rig;
  firmware::FootPointMotion motion;
};

Ride ride_of(const std::string& name, std::uint64_t seed) {
  Ride ride{support::rig(name), {}};
  ride.rig.controller.speed = 5.0;
  ride.rig.controller.valve_plan = {{0.5, 0b000110}, {1.0, 0}, {1.2, 0b111111}};
  firmware::IsoRoad road;
  road.roughness = firmware::class_roughness("C");
  road.bandwidth = 30.0;
  road.seed = seed;
  ride.motion = firmware::excitation(ride.rig.rig, firmware::drive_over(road, 1000.0, 2000), 1000.0);
  return ride;
}

class Replay : public ::testing::TestWithParam<const char*> {};

TEST_P(Replay, GivesTheSameOutputsToTheBit) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  const Ride ride = ride_of(GetParam(), seed);
  host_sim::RunOptions options;
  options.seed = seed;
  const host_sim::Run run = host_sim::run_closed_loop(ride.rig, ride.motion, options);
  ASSERT_EQ(run.trip.reason, firmware::Reason::reference_ended);
  const support::TemporaryFolder folder;
  host_sim::write_recording(folder / "run.csv", run.recording);
  const Recording recorded = host_sim::read_recording(folder / "run.csv", {}, 1000.0);
  ASSERT_EQ(recorded.size(), ride.motion.size());

  // What hardware said, and nothing else, is played to the firmware.
  const model::RigKind kind = ride.rig.rig.kind;
  std::vector<hal::Time> times;
  for (const double t : recorded.time) times.push_back(hal::seconds(t));
  hal::replay::Recording played;
  played.time = times;
  hal::SensorSetup sensors{};
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!firmware::is_hardware_channel(kind, model::channel_at(i)) || recorded.channels[i].empty()) continue;
    played.columns[i].values = recorded.channels[i];
    sensors[i].fitted = true;
  }
  const std::size_t periods = recorded.size();
  std::vector<hal::replay::Written<hal::Command>> commands(periods);
  std::vector<hal::replay::Written<hal::Openings>> openings(periods);
  std::vector<hal::replay::Written<std::uint64_t>> beats(periods);
  hal::replay::Rig rig(played, sensors, 6, hal::Openings::from_bits(ride.rig.controller.safe_ducts),
                       {commands, openings, beats});
  firmware::TableReference reference(ride.motion);
  std::vector<firmware::Record> storage(periods);
  firmware::Journal journal(storage);
  firmware::ControlLoop loop(firmware::control_settings(ride.rig), ride.rig.rig, rig.roles(), reference,
                             firmware::valve_plan(ride.rig), journal);
  loop.arm();
  loop.start();
  std::size_t left = periods;
  loop.run([&left] { return left-- > 0; });

  for (std::size_t k = 0; k < periods; ++k) {
    const auto record = journal.pop();
    ASSERT_TRUE(record) << k;
    ASSERT_EQ(record->mode, firmware::Mode::running) << k;
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      if (run.recording.channels[i].empty()) continue;
      ASSERT_TRUE(same_bits(record->values[i], run.recording.channels[i][k]))
          << model::channel_names[i].name << ", " << k;
    }
    for (std::size_t j = 0; j < 6; ++j) {
      ASSERT_EQ(record->openings.is_open(j), run.recording.ducts[j][k] == 1.0) << "duct " << j + 1 << ", " << k;
    }
    const double estimates[] = {record->wheel_load, record->velocities.foot_point, record->velocities.wheel,
                                record->velocities.body};
    for (std::size_t i = 0; i < run.recording.extra.size(); ++i) {
      ASSERT_TRUE(same_bits(estimates[i], run.recording.extra[i].values[k]))
          << run.recording.extra[i].name << ", " << k;
    }
    // The command of row k is for the next: what was commanded there.
    if (k + 1 == periods) continue;
    const Channel commanded = kind == model::RigKind::quarter_car ? Channel::z_r : Channel::x_cmd;
    const double command = rig.commands().written()[k].value.position;
    if (kind == model::RigKind::quarter_car) {
      ASSERT_TRUE(same_bits(command, ride.motion[k + 1].position))
          << "z_r is measured with noise; the command is the road";
    } else {
      ASSERT_TRUE(same_bits(command, run.recording[commanded][k + 1])) << k;
    }
  }
  EXPECT_EQ(loop.trip().reason, firmware::Reason::reference_ended);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, Replay, ::testing::Values("paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
