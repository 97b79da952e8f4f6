// A press and an interlock of a recorded session are replayed by the program, to the bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "firmware/controller/run.hpp"
#include "firmware/description/rig_description.hpp"
#include "hal/simulated/fault_plan.hpp"
#include "tests/faults/session_trial.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::Ended;
using support::TemporaryFolder;
using testing::HasSubstr;

/// A car on a cylinder with two interlocks.
std::string with_interlocks() {
  std::string text{support::quarter_car_text};
  text += "[gpio]\nchip = 'c'\nstop = 's'\nheartbeat = 'h'\nenable = 'e'\n[gpio.interlocks]\ndoor = 'd'\noil = 'o'\n";
  return text;
}

std::string without_comments(const std::string& text) {
  std::string rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    if (text[at] != '#') rows += text.substr(at, end + 1 - at);
    at = end + 1;
  }
  return rows;
}

void expect_replayed(const hal::simulated::FaultPlan& plan, const std::string& reason) {
  const TemporaryFolder folder;
  const std::string rig = folder.write("rig.toml", with_interlocks());
  const std::string run = folder / "run.csv", again = folder / "again.csv";
  ASSERT_EQ(faults::record_session(firmware::read_rig(rig), plan, 5, run), firmware::controller::Status::safe_stop);
  const std::string recorded = TemporaryFolder::read(run);
  ASSERT_THAT(recorded, HasSubstr("\n# ended by " + reason));
  support::RunningProgram replay(folder,
                                 {"--rig", rig, "--replay", run, "--road", faults::session_road, "--duration",
                                  std::to_string(faults::session_length), "--seed", "5", "--out", again},
                                 {}, RIG_CONTROLLER_PROGRAM);
  const Ended ended = replay.wait();
  EXPECT_EQ(ended.status, 7) << ended.errors;
  EXPECT_THAT(ended.output, HasSubstr("ended by " + reason));
  EXPECT_EQ(without_comments(TemporaryFolder::read(again)), without_comments(recorded));
}

TEST(ReplayOfStops, PressesAgain) {
  const hal::simulated::Press press{{hal::milliseconds(900), hal::milliseconds(950)}};
  hal::simulated::FaultPlan plan;
  plan.presses = {&press, 1};
  expect_replayed(plan, "stop_button");
}

TEST(ReplayOfStops, OpensTheInterlockAgain) {
  const hal::simulated::OpenInterlock open{1, {hal::milliseconds(1200), hal::milliseconds(1201)}};
  hal::simulated::FaultPlan plan;
  plan.open_interlocks = {&open, 1};
  expect_replayed(plan, "interlock oil");
}

// What ended the run was an output that took nothing more.
TEST(ReplayOfStops, RefusesTheOutputAgain) {
  using Device = hal::simulated::DeviceFault::Device;
  for (const auto& [device, reason] :
       {std::pair(Device::command, "command_failed"), std::pair(Device::valves, "valves_failed"),
        std::pair(Device::heartbeat, "heartbeat_failed")}) {
    const hal::simulated::DeviceFault fault{
        device, hal::Fault::refused, {hal::milliseconds(1100), hal::milliseconds(100'000)}};
    hal::simulated::FaultPlan plan;
    plan.devices = {&fault, 1};
    SCOPED_TRACE(reason);
    expect_replayed(plan, reason);
  }
}

}  // namespace
