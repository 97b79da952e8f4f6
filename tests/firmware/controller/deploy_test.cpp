// What a package puts on a board beside the program: the systemd unit, rights, udev rules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

std::string deployed(const char* name) { return (support::source / "firmware/controller/deploy" / name).string(); }

// A rig must not be started by a machine that boots, nor again by systemd after a safe stop.
TEST(Deploy, NobodyButAPersonStartsARig) {
  const std::string unit = TemporaryFolder::read(deployed("rig_controller@.service"));
  EXPECT_THAT(unit, Not(HasSubstr("\n[Install]")));
  EXPECT_THAT(unit, Not(HasSubstr("--start")));
  EXPECT_THAT(unit, HasSubstr("\nRestart=no\n"));
}

// The service has the rights that it needs and no others: an exposure of at most 3.0 of 10 by systemd's own count.
TEST(Deploy, TheServiceHasFewRights) {
  const TemporaryFolder folder;
  const auto shell = [&](const std::string& command) {
    return support::RunningProgram(folder, {"-c", command}, {}, "/bin/sh").wait();
  };
  if (shell("command -v systemd-analyze").status != 0) GTEST_SKIP() << "this machine has no systemd-analyze";
  const support::Ended ended =
      shell("systemd-analyze security --offline=true --threshold=30 '" + deployed("rig_controller@.service") + "'");
  if (ended.errors.find("unrecognized option") != std::string::npos) GTEST_SKIP() << "systemd-analyze before 250";
  EXPECT_EQ(ended.status, 0) << ended.output << ended.errors;
}

// The service has no network unless somebody installs the drop-in for --publish, and then the loopback interface alone.
TEST(Deploy, OnlyADropInLetsValuesOut) {
  const std::string unit = TemporaryFolder::read(deployed("rig_controller@.service"));
  EXPECT_THAT(unit, HasSubstr("\nPrivateNetwork=yes\nRestrictAddressFamilies=AF_UNIX\nIPAddressDeny=any\n"));
  EXPECT_THAT(unit, Not(HasSubstr("--publish")));
  const std::string drop_in = TemporaryFolder::read(deployed("publish.conf"));
  EXPECT_THAT(drop_in, HasSubstr("\n[Service]\nPrivateNetwork=no\n"));
  EXPECT_THAT(drop_in, HasSubstr("\nIPAddressAllow=localhost\n"));
  EXPECT_THAT(drop_in, Not(HasSubstr("IPAddressDeny=\n"))) << "that would forget the unit's own";
}

// Fault. The times of a unit follow from its rig's description without a hand: the generator writes what --unit-times
// prints, for each description that can be read, and leaves out a name that systemd would write otherwise.
TEST(Deploy, TheUnitsTimesFollowFromTheDescription) {
  const TemporaryFolder folder;
  const std::string rigs = folder / "rigs", out = folder / "out";
  std::filesystem::create_directories(rigs);
  const std::string slow = std::string(support::bench_text) + "\n[limits]\nramp = 0.01\nstroke = 0.4\n";
  folder.write("rigs/slow.toml", slow);
  folder.write("rigs/a name.toml", slow);
  folder.write("rigs/unfit.toml", "kind = 3\n");
  const auto shell = [&](const std::string& command) {
    return support::RunningProgram(folder, {"-c", command}, {}, "/bin/sh").wait();
  };
  const std::string program = RIG_CONTROLLER_PROGRAM;
  const support::Ended ended = shell("RIG_CONTROLLER_RIGS='" + rigs + "' RIG_CONTROLLER='" + program + "' '" +
                                     deployed("rig_controller-generator") + "' '" + out + "'");
  EXPECT_EQ(ended.status, 0) << ended.errors;
  const support::Ended printed = shell("'" + program + "' --rig '" + rigs + "/slow.toml' --unit-times");
  EXPECT_THAT(printed.output, HasSubstr("\nTimeoutStopSec=132\n")) << "3 · 0.4/0.01 + 12 s";
  EXPECT_EQ(TemporaryFolder::read(out + "/rig_controller@slow.service.d/times.conf"), printed.output);
  std::size_t written = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(out)) ++written;
  EXPECT_EQ(written, 1U);
}

// The group may use no priority above the loop's, which is at most 90 as a service; rules take effect without a reboot.
TEST(Deploy, RulesTakeEffectWithoutAReboot) {
  const std::string script = TemporaryFolder::read(deployed("postinst"));
  EXPECT_THAT(script, HasSubstr("udevadm trigger --action=add"));
  for (const char* subsystem : {"gpio", "iio", "misc", "usb-serial"}) EXPECT_THAT(script, HasSubstr(subsystem));
  EXPECT_THAT(TemporaryFolder::read(deployed("rig_controller.conf")), HasSubstr("@rig - rtprio 90\n"));
}

// Serial lines are other people's too: the rule leaves them to their group, and the service joins that.
TEST(Deploy, TakesNoSerialLineFromItsGroup) {
  const std::string rules = TemporaryFolder::read(deployed("70-rig_controller.rules"));
  EXPECT_THAT(rules, Not(HasSubstr("tty\"")));
  EXPECT_THAT(rules, Not(HasSubstr("ttyS")));
  EXPECT_THAT(TemporaryFolder::read(deployed("rig_controller@.service")), HasSubstr("\nSupplementaryGroups=dialout\n"));
}

// An instance has a directory of its own, which systemd removes with it; one that all shared went with the first
// (systemd#5394).
TEST(Deploy, EachInstanceHasItsOwnDirectory) {
  const std::string unit = TemporaryFolder::read(deployed("rig_controller@.service"));
  EXPECT_THAT(unit, HasSubstr("\nRuntimeDirectory=rigtwin/%i\n"));
  EXPECT_THAT(unit, Not(HasSubstr("--socket")));
}

// A machine that sleeps, or that is short of memory, must not leave a rig to itself.
TEST(Deploy, TheMachineStaysAwakeAndSparesTheRig) {
  const std::string unit = TemporaryFolder::read(deployed("rig_controller@.service"));
  EXPECT_THAT(unit, HasSubstr("\nOOMScoreAdjust=-900\n"));
  EXPECT_THAT(unit, HasSubstr("\nConflicts=sleep.target\nBefore=sleep.target\n"));
  EXPECT_THAT(unit, HasSubstr("\nWants=rig_controller-awake@%i.service\n"));
  const std::string awake = TemporaryFolder::read(deployed("rig_controller-awake@.service"));
  EXPECT_THAT(awake, HasSubstr("systemd-inhibit --what=sleep"));
  EXPECT_THAT(awake, HasSubstr("--mode=block"));
  EXPECT_THAT(awake, HasSubstr("\nStopWhenUnneeded=yes\n"));
  EXPECT_THAT(awake, Not(HasSubstr("[Install]")));
}

}  // namespace
