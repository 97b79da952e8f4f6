// rigtwin stability as a user calls it.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/description/loop_proof.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "model/effects/catalogue.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using support::Ended;
using support::rig_file;
using support::rigtwin;

std::string linear_with(const std::string& more) {
  return support::TemporaryFolder::read(rig_file("paper_linear")) + "\n" + more + "\n";
}

// Journey. The contract's example: numbers and keys, for the paper's equations with 10 ms.
TEST(StabilityCommand, GivesTheNumbersOfTheContract) {
  const support::TemporaryFolder folder;
  const std::string file = (folder / "result.json").string();
  const Ended ended = rigtwin({"stability", "--rig", rig_file("paper_linear"), "--json", file, "--responses", "--sweep",
                               "tau=0:0.02:5", "--map", "tau=0:0.03:20,virtual_damping=0:2000:10"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  EXPECT_NE(ended.output.find("paper_linear.toml: stable, 4.7"), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find("ms of delay left as sampled at 1000 Hz (5.254 ms without sampling and hold)\n"),
            std::string::npos)
      << ended.output;
  const auto json = nlohmann::json::parse(support::TemporaryFolder::read(file));
  EXPECT_EQ(json["stable"], true);
  EXPECT_NEAR(json["rightmost"]["re"].get<double>(), -1.0753, 0.5e-4);
  EXPECT_NEAR(json["rightmost"]["im"].get<double>(), 9.7797, 0.5e-4);
  EXPECT_EQ(json["roots"].size(), 2U);
  EXPECT_NEAR(json["roots"][1]["re"].get<double>(), -9.3847, 0.5e-4);
  EXPECT_NEAR(json["critical_delay"].get<double>(), 0.0152536, 0.5e-7);
  EXPECT_TRUE(json["critical_virtual_damping"].is_null());  // no damping from 0 to 10 000 N s/m is on the border
  EXPECT_NEAR(json["critical_frequency_hz"].get<double>(), 14.01, 0.005);
  EXPECT_EQ(json["sampled"]["stable"], true);
  EXPECT_LT(json["sampled"]["spectral_radius"].get<double>(), 1.0);
  EXPECT_EQ(json["pade"][0]["order"], 1);
  EXPECT_NEAR(json["pade"][0]["critical_delay"].get<double>(), 0.01805, 0.5e-5);
  EXPECT_EQ(json["roots_right_of"], -60.0);
  EXPECT_EQ(json["delay"], 0.010);
  EXPECT_EQ(json["map"]["rightmost_re"].size(), 10U);
  EXPECT_EQ(json["map"]["rightmost_re"][0].size(), 20U);
  EXPECT_FALSE(json["map"]["boundary"].empty());
  EXPECT_EQ(json["sweeps"][0]["values"].size(), 5U);
  EXPECT_EQ(json["bode"]["outputs"].size(), 10U);
  EXPECT_EQ(json["bode"]["frequency_hz"].size(), json["bode"]["outputs"]["F_w"]["phase_rad"].size());
  EXPECT_EQ(json["nyquist"]["closed_loop_unstable"], 0);
}

// Journey. The verdict stands first; an unstable rig is a result, not a failure.
TEST(StabilityCommand, SaysFirstWhatTheUserWantsToKnow) {
  const support::TemporaryFolder folder;
  std::string text = support::TemporaryFolder::read(rig_file("paper_hil_fdva"));
  text.replace(text.find("virtual_damping = 1140.0"), 24, "virtual_damping = 700.0 ");
  const Ended ended = rigtwin({"stability", "--rig", folder.write("unstable.toml", text).string()});
  EXPECT_EQ(ended.status, 0);
  const std::string first = ended.output.substr(0, ended.output.find('\n'));
  EXPECT_NE(first.find("unstable at 13."), std::string::npos) << first;
  EXPECT_NE(first.find("stable with 2.74"), std::string::npos) << first;
  EXPECT_NE(first.find("ms less delay (2.246 ms less without sampling and hold)"), std::string::npos) << first;
  for (const char* part :
       {"proven by the argument principle", "critical virtual damping  908.04", "spectral radius", "order 1",
        "half a step of hold", "not in the linear analysis (no linear part): fdva.minor_loss"}) {
    EXPECT_NE(ended.output.find(part), std::string::npos) << part;
  }
}

// Point. A budget adds to the loop delay, part by part.
TEST(StabilityCommand, TakesTheDelayBudget) {
  const support::TemporaryFolder folder;
  const auto file = folder.write("rig.toml", linear_with("[delay_budget]\nsensor_age = 0.001\ntransport = 0.002\n"
                                                         "computation = 0.0015"));
  const Ended ended = rigtwin({"stability", "--rig", file.string(), "--json", "-"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const auto json = nlohmann::json::parse(ended.output);
  EXPECT_NEAR(json["delay"].get<double>(), 0.0145, 1e-15);
  EXPECT_EQ(json["stable"], true);
  EXPECT_EQ(json["sampled"]["stable"], true);
  EXPECT_NEAR(json["delay_budget"]["total"].get<double>(), 0.015, 1e-15);
  EXPECT_NEAR(json["delay_budget"]["left"].get<double>(), 0.0152536 - 0.015, 1e-7);
}

// --write-limits leaves a description that a controller accepts, and changes nothing else in it. The delay is four
// fifths of what the sampled loop has left: 10 ms of 11.9 ms are the machine's (physics.md: the wheel mode of the
// FDVA).
TEST(StabilityCommand, WritesForWhichLoopItHolds) {
  const support::TemporaryFolder folder;
  const std::string text = support::TemporaryFolder::read(rig_file("paper_hil_fdva")) + "# the end\n";
  const std::string file = folder.write("rig.toml", text).string();
  const Ended ended = rigtwin({"stability", "--write-limits", file});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const std::string written = support::TemporaryFolder::read(file);
  EXPECT_EQ(written.substr(0, text.size()), text);
  const firmware::RigDescription rig = firmware::read_rig(file);
  EXPECT_EQ(firmware::stability_objection(rig).text, "");
  const auto analysis = host_sim::stability::analyse(rig);
  ASSERT_TRUE(analysis.sampled && analysis.sampled->critical_delay);
  EXPECT_NEAR(rig.hardware.schedule.allowed_delay, 0.8 * (*analysis.sampled->critical_delay - 0.010), 1e-6);

  firmware::RigDescription late = rig;
  late.delay_budget.sensor_age = rig.hardware.schedule.allowed_delay;
  const auto latest = host_sim::stability::analyse(late);
  ASSERT_TRUE(latest.sampled_margins && latest.sampled_margins->upper_gain);
  const double border = latest.sampled_margins->upper_gain->factor;
  EXPECT_NEAR(rig.hardware.schedule.allowed_gain, 1.0 + 0.8 * (border - 1.0), 1e-3);
  EXPECT_LE(rig.hardware.schedule.allowed_gain, border);

  ASSERT_EQ(rigtwin({"stability", "--write-limits", file}).status, 0);
  EXPECT_EQ(support::TemporaryFolder::read(file), written) << "a second time there is nothing to change";
}

// Law. A loop that has both, all of its allowed delay and all of its allowed gain, is stable, with and without
// compensation; so is one with either alone. The gain that it would bear at the described delays alone is too much for
// the longest: both borders, each four fifths of the way to its own, are unstable together.
TEST(StabilityCommand, DelayAndGainAreAllowedTogether) {
  const support::TemporaryFolder folder;
  const std::string text = support::TemporaryFolder::read(rig_file("paper_hil_fdva"));
  const auto stable = [](const firmware::RigDescription& rig, double delay, double gain) {
    firmware::RigDescription at = rig;
    at.rig.effects.add<model::SensorGain>(model::Channel::F, {.gain = gain});
    if (!at.compensation) at.delay_budget.sensor_age = delay;
    if (at.compensation) return host_sim::compensation::compensated_radius(at, delay) < 1.0;
    return host_sim::stability::analyse(at).stable_as_run();
  };
  for (const char* compensation : {"", "\n[compensation]\nkind = \"inverse\"\n"}) {
    const std::string file = folder.write("rig.toml", text + compensation).string();
    const Ended ended = rigtwin({"stability", "--write-limits", file});
    ASSERT_EQ(ended.status, 0) << ended.errors;
    const firmware::RigDescription rig = firmware::read_rig(file);
    const double delay = rig.hardware.schedule.allowed_delay, gain = rig.hardware.schedule.allowed_gain;
    EXPECT_GT(gain, 1.0);
    EXPECT_TRUE(stable(rig, delay, gain)) << delay << " s, " << gain;
    EXPECT_TRUE(stable(rig, 0.0, gain)) << gain;
    if (rig.compensation) continue;
    const auto analysis = host_sim::stability::analyse(rig);
    const double alone = 1.0 + 0.8 * (analysis.sampled_margins->upper_gain->factor - 1.0);
    EXPECT_TRUE(stable(rig, 0.0, alone)) << alone;
    EXPECT_FALSE(stable(rig, delay, alone)) << delay << " s, " << alone;
  }
}

// Each number of ducts that the plan of the valves opens must be stable; where one is not, nothing is written.
TEST(StabilityCommand, ProvesEveryPositionOfTheValves) {
  const support::TemporaryFolder folder;
  const std::string text = support::TemporaryFolder::read(rig_file("paper_hil_fdva"));
  const auto allowed = [&](const std::string& plan) {
    const std::string file = folder.write("rig.toml", text + plan).string();
    EXPECT_EQ(rigtwin({"stability", "--write-limits", file}).status, 0) << plan;
    return firmware::read_rig(file).hardware.schedule.allowed_delay;
  };
  const double alone = allowed("");
  EXPECT_LE(allowed("[valves]\nplan = [{ t = 1.0, open = 1 }]\n"), alone);

  const std::string unstable = support::with(text, "virtual_damping = 1140.0", "virtual_damping = 700.0");
  const std::string file = folder.write("unstable.toml", unstable).string();
  const Ended ended = rigtwin({"stability", "--write-limits", file});
  EXPECT_EQ(ended.status, static_cast<int>(firmware::ExitStatus::unfit_input));
  EXPECT_NE(ended.errors.find("the loop with 2 open ducts is unstable"), std::string::npos) << ended.errors;
  EXPECT_EQ(support::TemporaryFolder::read(file), unstable);
}

// Fault. A delay of 10 ms that swings by 0.8 ms and jitters by 0.4 ms is at times 11.2 ms: limits written for its mean
// would have let samples and computation take 0.96 ms more than four fifths of what is then left. A swing beyond the
// border (11.9 ms) is refused, although the loop is stable at its mean; one below the border with all of it in jitter
// leaves as little as one with all of it in swing.
TEST(StabilityCommand, LimitsHoldAtTheLongestDelayOfTheRange) {
  const support::TemporaryFolder folder;
  const std::string text = support::TemporaryFolder::read(rig_file("paper_hil_fdva"));
  const auto varying = [&](const std::string& keys) {
    return folder.write("rig.toml", support::with(text, "[machine]", "[machine]\n" + keys)).string();
  };
  const auto allowed = [&](const std::string& keys) {
    const std::string file = varying(keys);
    const Ended ended = rigtwin({"stability", "--write-limits", file});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    return firmware::read_rig(file).hardware.schedule.allowed_delay;
  };
  const double mean = allowed("");
  EXPECT_NEAR(allowed("delay_swing = 0.0008\ndelay_jitter = 0.0004"), mean - 0.8 * 0.0012, 2e-6);
  EXPECT_NEAR(allowed("delay_jitter = 0.0012"), mean - 0.8 * 0.0012, 2e-6);
  // With the limit of the mean the loop would grow at the far end of the range.
  firmware::RigDescription rig = firmware::read_rig(rig_file("paper_hil_fdva"));
  rig.delay_budget.sensor_age = mean;
  rig.rig.delay_variation.swing = 0.0012;
  const auto analysis = host_sim::stability::analyse(rig);
  ASSERT_TRUE(analysis.varying);
  EXPECT_TRUE(analysis.stable);
  EXPECT_FALSE(analysis.varying->stable);
  EXPECT_LT(*analysis.balance.left, 0.0);

  // Half a step of hold: 10 ± 2.5 ms is stable at every delay of a loop in continuous time, whose border is 12.75 ms,
  // and not of the one that runs, whose border is 12.25 ms. The worse decides, in words, JSON and limits.
  const std::string near_border = varying("delay_swing = 0.0025");
  const auto json = nlohmann::json::parse(rigtwin({"stability", "--rig", near_border, "--json", "-"}).output);
  EXPECT_EQ(json["stable"], true);
  EXPECT_EQ(json["stable_over_delays"], false);
  EXPECT_EQ(json["varying_delay"]["stable"], false);
  EXPECT_EQ(json["varying_delay"]["stable_without_sampling"], true);
  EXPECT_NEAR(json["varying_delay"]["sampled"]["worst_delay"].get<double>(), 0.0125, 1e-12);
  EXPECT_GT(json["varying_delay"]["sampled"]["spectral_radius"].get<double>(), 1.0001);
  const std::string said = rigtwin({"stability", "--rig", near_border}).output;
  EXPECT_NE(said.find("unstable within the range of its delay, 7.5 ms … 12.5 ms: stable at the mean, not at 12.5 ms"),
            std::string::npos)
      << said.substr(0, 300);
  EXPECT_EQ(rigtwin({"stability", "--write-limits", near_border}).status,
            static_cast<int>(firmware::ExitStatus::unfit_input));

  const std::string wide = varying("delay_swing = 0.003");
  const std::string before = support::TemporaryFolder::read(wide);
  const Ended ended = rigtwin({"stability", "--write-limits", wide});
  EXPECT_EQ(ended.status, static_cast<int>(firmware::ExitStatus::unfit_input));
  EXPECT_NE(ended.errors.find("unstable within the range of its delay, 7 ms … 13 ms"), std::string::npos)
      << ended.errors;
  EXPECT_EQ(support::TemporaryFolder::read(wide), before);
}

// With [compensation] the described loop is the compensated one: first line, JSON and limits are its. The proof is
// written for it; a compensator that makes the loop unstable leaves the file as it was, and the message has the margin.
TEST(StabilityCommand, DecidesByTheCompensatedLoop) {
  const support::TemporaryFolder folder;
  const std::string undamped = support::with(support::TemporaryFolder::read(rig_file("paper_hil_fdva")),
                                             "virtual_damping = 1140.0", "virtual_damping = 0.0");
  const auto write = [&](const std::string& keys) {
    return folder.write("rig.toml", undamped + "\n[compensation]\n" + keys + "\n").string();
  };
  const std::string stable = write("kind = \"inverse\"");
  const Ended words = rigtwin({"stability", "--rig", stable});
  EXPECT_NE(words.output.find("with compensation inverse stable; the machine's delay may be 1.14 ms longer"),
            std::string::npos)
      << words.output.substr(0, 300);
  const auto json = nlohmann::json::parse(rigtwin({"stability", "--rig", stable, "--json", "-"}).output);
  EXPECT_EQ(json["stable"], true);
  EXPECT_EQ(json["stable_without_compensation"], false);
  EXPECT_EQ(json["compensation"]["kind"], "inverse");

  const Ended ended = rigtwin({"stability", "--write-limits", stable});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const firmware::RigDescription rig = firmware::read_rig(stable);
  EXPECT_EQ(firmware::stability_objection(rig).text, "");
  EXPECT_NEAR(rig.hardware.schedule.allowed_delay, 0.8 * json["compensation"]["delay_may_be_longer"].get<double>(),
              2e-6);
  ASSERT_EQ(rigtwin({"stability", "--rig", stable, "--report", (folder / "page.html").string()}).status, 0);
  EXPECT_NE(support::TemporaryFolder::read(folder / "page.html").find("Assumed and true delay"), std::string::npos);

  const std::string unstable = write("kind = \"inverse\"\ndelay = 0.006");
  const std::string before = support::TemporaryFolder::read(unstable);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"stability", "--write-limits", unstable},
        std::vector<std::string>{"simulate", "--rig", unstable, "--out", (folder / "run.csv").string()}}) {
    const Ended refused = rigtwin(command);
    EXPECT_EQ(refused.status, static_cast<int>(firmware::ExitStatus::unfit_input));
    EXPECT_NE(refused.errors.find("unstable at 14.1 Hz"), std::string::npos) << refused.errors;
    EXPECT_NE(refused.errors.find("ms earlier"), std::string::npos) << refused.errors;
  }
  EXPECT_EQ(support::TemporaryFolder::read(unstable), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "run.csv"));
  // Computation that the compensation counts on, but that may not be there: stable only as long as it is late.
  const std::string counts_on_it = write("kind = \"smith\"\n[delay_budget]\ncomputation = 0.02");
  const Ended early = rigtwin({"stability", "--write-limits", counts_on_it});
  EXPECT_EQ(early.status, static_cast<int>(firmware::ExitStatus::unfit_input)) << early.output;
}

// Fault. One line, the right exit status, no result left behind.
TEST(StabilityCommand, RefusesInOneLine) {
  const support::TemporaryFolder folder;
  const std::string linear = rig_file("paper_linear");
  struct Case {
    std::vector<std::string> arguments;
    firmware::ExitStatus status;
    std::string says;
  };
  using firmware::ExitStatus;
  const auto file = [&](const std::string& name, const std::string& text) { return folder.write(name, text).string(); };
  const std::vector<Case> cases{
      {{"--rig", rig_file("paper_rig_fdva")}, ExitStatus::unfit_input, "expected kind = \"hil\""},
      {{"--rig", rig_file("paper_bench_fdva")}, ExitStatus::unfit_input, "this is a component_bench"},
      {{"--rig", linear, "--map", "tau=0.03:0:9,virtual_damping=0:1:9"}, ExitStatus::wrong_usage, "runs backwards"},
      {{"--rig", linear, "--map", "bogus=0:1:9,virtual_damping=0:1:9"}, ExitStatus::wrong_usage, "no variable 'bogus'"},
      {{"--rig", linear, "--sweep", "tau"}, ExitStatus::wrong_usage, "is not a range"},
      {{"--rig", linear, "--right-of", "1"}, ExitStatus::wrong_usage, "--right-of"},
      {{"--rig", linear, "--right-of", "nan"}, ExitStatus::wrong_usage, "--right-of"},
      {{"--json", "-"}, ExitStatus::wrong_usage, "--rig is required"},
      {{"--rig", (folder / "absent.toml").string()}, ExitStatus::unfit_input, "cannot be opened"},
      {{"--rig", linear, "--json", (folder / "no/such/folder.json").string()}, ExitStatus::cannot_write, "folder.json"},
      {{"--rig", file("neutral.toml", linear_with("[effects.force_sensor_inertia]\nmass = 5.0"))},
       ExitStatus::unfit_input,
       "force_sensor_inertia"},
      {{"--rig", file("negative.toml", linear_with("[delay_budget]\ntransport = -0.001"))},
       ExitStatus::unfit_input,
       "delay_budget.transport"},
      {{"--rig", file("unknown.toml", linear_with("[delay_budget]\ntransprt = 0.001"))},
       ExitStatus::unfit_input,
       "did you mean 'delay_budget.transport'"},
      {{"--rig", file("bench.toml", support::TemporaryFolder::read(rig_file("paper_bench_fdva")) +
                                        "\n[delay_budget]\ntransport = 0.001\n")},
       ExitStatus::unfit_input,
       "[delay_budget]"},
  };
  const std::size_t files = folder.count();
  for (const Case& c : cases) {
    std::vector<std::string> arguments{"stability"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const Ended ended = rigtwin(arguments);
    EXPECT_EQ(ended.status, static_cast<int>(c.status)) << ended.errors;
    EXPECT_NE(ended.errors.find(c.says), std::string::npos) << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_EQ(ended.output, "");
  }
  EXPECT_EQ(folder.count(), files);
}

}  // namespace
