// Journey. A rig whose controller is late now and then: its recording is read as it is, by compare and by diagnose,
// which report how often it was late; missing samples are not used.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/controller/recording/recorder.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/simulated/rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/comparison/comparison.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"
#include "host_sim/identification/prepare/validation.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using hal::simulated::LateWake;
using model::Channel;

constexpr hal::Time ms = hal::milliseconds(1);

/// Eight seconds of highway through the firmware and the controller's own recorder.
void drive(const firmware::RigDescription& rig, std::span<const LateWake> late, const std::string& out) {
  firmware::IsoRoad road;
  road.bandwidth = firmware::default_bandwidth(rig.rig.kind, 1000.0);
  const auto motion = firmware::excitation(rig.rig, firmware::drive_over(road, 1000.0, 8000), 1000.0);
  firmware::SimulatedRig plant(rig, 3, firmware::SimulatedRig::Noise::as_described);
  hal::simulated::Construction construction;
  construction.period = ms;
  construction.sensors = firmware::simulated_sensors(rig);
  construction.ducts = 6;
  hal::simulated::FaultPlan faults;
  faults.late_wakes = late;
  hal::simulated::Rig hardware(plant, construction, faults);
  firmware::TableReference reference(motion);
  std::vector<firmware::Record> storage(8);
  firmware::Journal journal(storage);
  firmware::ControlLoop loop(firmware::control_settings(rig), rig.rig, hardware.roles(), reference,
                             firmware::valve_plan(rig), journal);
  std::string trouble;
  firmware::controller::Recorder::Setup setup;
  setup.file = out;
  setup.overwrite = true;
  firmware::controller::Recorder recorder(setup, rig, hardware.roles().sensors.setup(), trouble);
  ASSERT_EQ(trouble, "");
  loop.arm();
  loop.start();
  loop.run([&] {
    while (const auto record = journal.pop()) recorder.take(*record);
    return loop.mode() != firmware::Mode::safe;
  });
  ASSERT_EQ(loop.trip().reason, firmware::Reason::reference_ended);
  ASSERT_TRUE(recorder.flush());
}

/// Forty times late, by 2.4 ms and by 0.4 ms in turn: at each of the former two rows are missing.
std::vector<LateWake> forty_late_periods() {
  std::vector<LateWake> late;
  for (int i = 0; i < 40; ++i) {
    const hal::Time from = ms * (200 + 173 * i);
    late.push_back({{from, from + ms}, hal::microseconds(i % 2 == 0 ? 2400 : 400)});
  }
  return late;
}

TEST(LateRecording, IsComparedAndSaysHowOftenItWasLate) {
  const support::TemporaryFolder folder;
  const firmware::RigDescription rig = support::rig("paper_rig_fdva");
  const auto error = [&](const std::string& file) {
    const host_sim::ComparedRecording recording(rig, host_sim::read_recording(file, {}, 1000.0),
                                                host_sim::StartChoice::automatic);
    const auto result = recording.compare(recording.simulate(rig.rig));
    double worst = 0.0;
    for (const auto& channel : result.channels) worst = std::max(worst, channel.nrmse);
    return worst;
  };
  drive(rig, {}, folder / "punctual.csv");
  const auto late = forty_late_periods();
  drive(rig, late, folder / "late.csv");
  // The rig waits 2 ms at each of twenty places while its model goes through a straight line: on a road whose foot
  // point moves at 0.15 m/s rms that is 0.3 mm of 3 mm, fading within 0.3 s of the 0.35 s between two such places.
  EXPECT_LT(error(folder / "late.csv"), error(folder / "punctual.csv") + 0.1);

  const std::string description = support::rig_file("paper_rig_fdva");
  const support::Ended told = support::rigtwin(
      {"compare", "--rig", description, "--data", folder / "late.csv", "--json", folder / "late.json"});
  ASSERT_EQ(told.status, 0) << told.errors;
  EXPECT_NE(
      told.output.find("late.csv: 40 periods of 8000 began late, by 56 ms in total and 2.4 ms at most; 40 rows are "
                       "missing or incomplete and not used"),
      std::string::npos)
      << told.output;
  const auto json = nlohmann::json::parse(support::TemporaryFolder::read(folder / "late.json"));
  EXPECT_EQ(json.at("recordings").at(0).at("missing_samples"), 40);
}

TEST(LateRecording, IsEvidenceWithoutItsMissingRows) {
  const support::TemporaryFolder folder;
  const firmware::RigDescription rig = support::rig("paper_rig_fdva");
  const auto late = forty_late_periods();
  drive(rig, late, folder / "late.csv");
  firmware::Recording recording = host_sim::read_recording(folder / "late.csv", {}, 1000.0);
  const auto remarks = host_sim::identification::validate(rig, {&recording});
  ASSERT_FALSE(remarks.empty());
  EXPECT_NE(remarks.front().find("40 periods of 8000 began late"), std::string::npos) << remarks.front();
  const auto evidence = host_sim::identification::prepare_recording(rig, std::move(recording),
                                                                    host_sim::identification::Use::shared, false);
  ASSERT_FALSE(evidence.channels.empty());
  for (const Channel channel : evidence.channels) {
    const auto& left_out = evidence.clipped[model::index(channel)];
    EXPECT_EQ(std::count(left_out.begin(), left_out.end(), true), 40) << model::name(channel);
  }
}

}  // namespace
