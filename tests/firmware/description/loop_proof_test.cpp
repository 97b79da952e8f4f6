#include "firmware/description/loop_proof.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::loop_fingerprint;
using firmware::parse_rig;
using firmware::with_loop_proof;
using support::hil_text;
using support::with;
using testing::HasSubstr;

std::string fingerprint(const std::string& text) { return loop_fingerprint(parse_rig(text, "rig.toml")); }

// Whatever enters the analysis changes the fingerprint; what does not, leaves it.
TEST(LoopProof, FingerprintsWhatEntersTheAnalysis) {
  const std::string text(hil_text), before = fingerprint(text);
  EXPECT_EQ(before.size(), 7U + 64U);
  EXPECT_EQ(before.substr(0, 7), "sha256:");
  for (const auto& [from, to] :
       {std::pair("virtual_damping = 1140.0", "virtual_damping = 1139.0"),
        std::pair("sample_rate = 1000.0", "sample_rate = 2000.0"), std::pair("open_ducts = 2", "open_ducts = 3"),
        std::pair("minor_loss = 1.5", "minor_loss = 1.6")}) {
    EXPECT_NE(fingerprint(with(text, from, to)), before) << to;
  }
  for (const char* more : {"[effects.actuator_lag]\ntime_constant = 0.001\n", "[delay_budget]\ntransport = 0.001\n",
                           "[effects.sensor_lag.F]\ntime_constant = 0.001\n", "[effects.tyre_lift_off]\n",
                           "[valves]\nplan = [{ t = 1.0, open = 4 }]\n"}) {
    EXPECT_NE(fingerprint(text + more), before) << more;
  }
  for (const char* more : {"# a comment\n", "[limits]\nforce = 5e3\n", "[noise]\nF = 3.0\n", "[controller]\ncpu = 3\n",
                           "[tolerance]\n\"body.mass\" = 0.1\n"}) {
    EXPECT_EQ(fingerprint(text + more), before) << more;
  }
  EXPECT_EQ(fingerprint(with(text, "virtual_damping = 1140.0", "virtual_damping = 114e1")), before)
      << "the same number";
}

// Three values are written. Every other byte stays: comments, order, blanks, line ends.
TEST(LoopProof, KeepsTheTextOfADescription) {
  const std::string text = std::string(hil_text) +
                           "\n# hand-written\n[ controller ]   # of this board\npriority = 70\n"
                           "allowed_delay = 0.0015           # old\n\n[noise]  \nF = 10.0\n";
  const std::string proven = with_loop_proof(text, "rig.toml", {0.00125, 1.2}, "sha256:abc");
  EXPECT_EQ(proven, std::string(hil_text) +
                        "\n# hand-written\n[ controller ]   # of this board\nallowed_gain = 1.2\nproven = "
                        "\"sha256:abc\"\npriority = 70\n"
                        "allowed_delay = 0.00125           # old\n\n[noise]  \nF = 10.0\n");
  EXPECT_EQ(with_loop_proof(proven, "rig.toml", {0.00125, 1.2}, "sha256:abc"), proven) << "again: nothing to do";
  const std::string changed = with_loop_proof(proven, "rig.toml", {0.002, 1.2}, "sha256:def");
  EXPECT_EQ(changed, with(with(proven, "0.00125", "0.002"), "sha256:abc", "sha256:def"));

  EXPECT_EQ(
      with_loop_proof(hil_text, "rig.toml", {0.002, 1.2}, "sha256:x"),
      std::string(hil_text) + "\n[controller]\nallowed_delay = 0.002\nallowed_gain = 1.2\nproven = \"sha256:x\"\n");
  EXPECT_EQ(with_loop_proof(std::string(hil_text) + "[controller]", "rig.toml", {0.002, 1.2}, "sha256:x"),
            std::string(hil_text) + "[controller]\nallowed_delay = 0.002\nallowed_gain = 1.2\nproven = \"sha256:x\"\n");

  std::string dos;
  for (const char c : std::string(hil_text) + "[controller]\ncpu = 3\n")
    dos += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const std::string dos_proven = with_loop_proof(dos, "rig.toml", {0.002, 1.2}, "sha256:x");
  EXPECT_THAT(
      dos_proven,
      HasSubstr("[controller]\r\nallowed_delay = 0.002\r\nallowed_gain = 1.2\r\nproven = \"sha256:x\"\r\ncpu = 3\r\n"));
}

TEST(LoopProof, RefusesATextThatItCannotKeep) {
  const std::string inline_table = "controller = { cpu = 3 }\n" + std::string(hil_text);
  EXPECT_THROW(static_cast<void>(with_loop_proof(inline_table, "rig.toml", {0.002, 1.2}, "sha256:x")),
               firmware::InputError);
  EXPECT_THROW(static_cast<void>(with_loop_proof("kind = 3", "rig.toml", {0.002, 1.2}, "sha256:x")),
               firmware::InputError);
}

// Without a proof, with one of another loop, and with a measured delay beyond it nothing may move – unless somebody has
// said in words why.
TEST(LoopProof, RefusesALoopThatNobodyFoundStable) {
  const std::string text(hil_text);
  EXPECT_THAT(firmware::stability_objection(parse_rig(text, "rig.toml")).text,
              HasSubstr("nothing says that this loop is stable ([controller] proven): write it by  rigtwin stability "
                        "--write-limits rig.toml"));
  const std::string allowed = "[controller]\nallowed_delay = 0.00125\nallowed_gain = 1.2\n";
  const std::string proven = with_loop_proof(text, "rig.toml", {0.00125, 1.2}, fingerprint(text + allowed));
  EXPECT_EQ(firmware::stability_objection(parse_rig(proven, "rig.toml")).text, "");
  const std::string changed = with(proven, "virtual_damping = 1140.0", "virtual_damping = 700.0");
  EXPECT_THAT(firmware::stability_objection(parse_rig(changed, "rig.toml")).text, HasSubstr("has changed since"));
  const std::string by_hand = with(proven, "0.00125", "0.4");
  EXPECT_THAT(firmware::stability_objection(parse_rig(by_hand, "rig.toml")).text, HasSubstr("has changed since"));
  const std::string more_gain = with(proven, "allowed_gain = 1.2", "allowed_gain = 3.0");
  EXPECT_THAT(firmware::stability_objection(parse_rig(more_gain, "rig.toml")).text, HasSubstr("has changed since"));
  const std::string without_gain = text + "[controller]\nallowed_delay = 0.00125\n";
  EXPECT_THAT(firmware::stability_objection(
                  parse_rig(without_gain + "proven = \"" + fingerprint(without_gain) + "\"\n", "rig.toml"))
                  .text,
              HasSubstr("no allowed_gain"));
  const std::string waiver = "[waivers]\nunproven_stability = \"a bench without oil\"\n";
  EXPECT_EQ(firmware::stability_objection(parse_rig(changed + waiver, "rig.toml")).text, "");

  EXPECT_EQ(firmware::delay_objection(parse_rig(proven, "rig.toml"), 0.00125).text, "");
  EXPECT_THAT(firmware::delay_objection(parse_rig(proven, "rig.toml"), 0.0013).text,
              HasSubstr("take 1.300 ms (P99.9), [controller] allowed_delay is 1.250 ms"));
  EXPECT_EQ(firmware::delay_objection(parse_rig(proven + waiver, "rig.toml"), 0.5).text, "");
  EXPECT_EQ(firmware::stability_objection(parse_rig(std::string(support::bench_text), "rig.toml")).text, "")
      << "no loop";
}

}  // namespace
