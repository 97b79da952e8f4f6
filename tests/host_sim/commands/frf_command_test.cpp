// rigtwin frf as a user calls it, and the JSON that other people's scripts rely on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/host_sim/frf/signals.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace frf_command_test {
namespace {

using model::Channel;
using nlohmann::json;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;
using testing::HasSubstr;

constexpr double pi = std::numbers::pi;
const std::vector<double> taps{2.0, -0.5};

/// A recording of 20 s at 200 Hz, z_r → F_w by `taps`, → z_w ten samples later.
class Frf : public ::testing::Test {
 protected:
  Frf() { write(first, 1); }

  static void write(const std::string& file, std::uint64_t seed, std::size_t samples = 4000) {
    const auto x = support::white(samples, 1.0, seed);
    std::vector<double> late(11, 0.0);
    late.back() = 1.0;
    host_sim::write_recording(
        file,
        support::recording(
            200.0, {{Channel::z_r, x},
                    {Channel::F_w, support::sum(support::filtered(x, taps), support::white(samples, 0.3, seed, 1))},
                    {Channel::z_w, support::filtered(x, late)}}));
  }

  static json parsed(std::vector<std::string> words) {
    words.insert(words.begin(), "frf");
    words.insert(words.end(), {"--json", "-"});
    const Ended ended = rigtwin(words);
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_EQ(ended.errors, "");
    return json::parse(ended.output);
  }

  /// Exit status and the one line on standard error.
  static void refused(std::vector<std::string> words, int status, const std::string& line) {
    words.insert(words.begin(), "frf");
    const Ended ended = rigtwin(words);
    EXPECT_EQ(ended.status, status) << line;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_EQ(ended.output, "") << line;
    EXPECT_THAT(ended.errors, HasSubstr(line));
  }

  TemporaryFolder folder;
  std::string first = folder / "first.csv";
  std::string second = folder / "second.mat";
};

// contract.md: {"input", "averages", "outputs": {name: {"frequency_hz", "magnitude", "phase_rad", "coherence",
// "magnitude_ci95", "phase_ci95"}}}; bounds are pairs.
TEST_F(Frf, WritesTheJsonOfTheContract) {
  const json result =
      parsed({"--data", first, "--input", "z_r", "--output", "F_w", "--output", "z_w", "--block", "0.5"});
  EXPECT_EQ(result.at("input"), "z_r");
  EXPECT_EQ(result.at("averages"), 78) << "z_w, ten samples late, takes ten samples of the last of 79 blocks";
  EXPECT_TRUE(result.at("instrument").is_null());
  EXPECT_EQ(result.at("estimator"), "H1");
  EXPECT_EQ(result.at("block").at("samples"), 100);
  EXPECT_EQ(result.at("block").at("overlap"), 0.5);
  EXPECT_EQ(result.at("block").at("window"), "hann");
  EXPECT_EQ(result.at("block").at("chosen"), "given");
  EXPECT_EQ(result.at("recordings"), json({first}));
  ASSERT_EQ(result.at("outputs").size(), 2U);
  const json& force = result.at("outputs").at("F_w");
  for (const char* key : {"frequency_hz", "magnitude", "phase_rad", "coherence", "magnitude_ci95", "phase_ci95"}) {
    EXPECT_EQ(force.at(key).size(), 49U) << key;
  }
  std::size_t held = 0;
  for (std::size_t k = 0; k < 49; ++k) {
    const double f = force["frequency_hz"][k], magnitude = force["magnitude"][k], phase = force["phase_rad"][k];
    EXPECT_NEAR(f, 2.0 * static_cast<double>(k + 1), 1e-12);
    const std::complex<double> h = support::response(taps, f / 200.0);
    EXPECT_LT(std::abs(std::polar(magnitude, phase) - h), 0.15) << f;
    const double low = force["magnitude_ci95"][k][0], high = force["magnitude_ci95"][k][1];
    EXPECT_LT(low, magnitude);
    EXPECT_GT(high, magnitude);
    EXPECT_LT(force["phase_ci95"][k][0].get<double>(), phase);
    EXPECT_GT(force["phase_ci95"][k][1].get<double>(), phase);
    if (low <= std::abs(h) && std::abs(h) <= high) ++held;
  }
  EXPECT_GE(held, 42U);
  EXPECT_EQ(force.at("unit"), "N / m");
  const json& late = result.at("outputs").at("z_w").at("delay");
  EXPECT_DOUBLE_EQ(late.at("seconds").get<double>(), 0.05);
  EXPECT_EQ(late.at("compensated"), true);
  EXPECT_NEAR(result["outputs"]["z_w"]["phase_rad"][1].get<double>(), -2.0 * pi * 4.0 * 0.05, 0.05);
}

// What was chosen, and why, is said; a file gets the same JSON as the screen would.
TEST_F(Frf, SaysWhatItChose) {
  const std::string file = folder / "result.json";
  const Ended ended = rigtwin({"frf", "--data", first, "--input", "z_r", "--output", "F_w", "--output", "z_w", "--json",
                               file, "--lowest-damping", "0.1", "--lowest-frequency", "10"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  for (const char* words :
       {"first.csv: 20 s at 200 Hz", "independent averages: blocks of ", "% overlap",
        "block length chosen for least error: for a peak of 10 % damping at 10 Hz the bias is ",
        "F_w / z_r [N/m] by H1", "coherence", "z_w / z_r [m/m] by H1, delay of 50 ms compensated"}) {
    EXPECT_THAT(ended.output, HasSubstr(words));
  }
  EXPECT_EQ(support::without_origin(json::parse(TemporaryFolder::read(file))),
            support::without_origin(parsed({"--data", first, "--input", "z_r", "--output", "F_w", "--output", "z_w",
                                            "--lowest-damping", "0.1", "--lowest-frequency", "10"})));
  const Ended not_compensated = rigtwin(
      {"frf", "--data", first, "--input", "z_r", "--output", "z_w", "--block", "0.5", "--no-delay-compensation"});
  EXPECT_THAT(not_compensated.output, HasSubstr("delay of 50 ms not compensated (6.4 % too small)"));
}

// Every choice reaches the estimate: window, overlap, trend, estimator, range, instrument, running phases, more
// recordings.
TEST_F(Frf, TakesItsOptions) {
  write(second, 2, 2000);
  const std::vector<std::string> base{"--data", first, "--input", "z_r", "--output", "F_w", "--block", "0.5"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), base.begin(), base.end());
    return parsed(more);
  };
  const json plain = with({});
  const auto magnitude = [](const json& j, std::size_t k) { return j["outputs"]["F_w"]["magnitude"][k].get<double>(); };
  for (const char* window : {"hamming", "blackman", "rectangular"}) {
    const json other = with({"--window", window});
    EXPECT_EQ(other["block"]["window"], window);
    EXPECT_NE(magnitude(other, 5), magnitude(plain, 5));
  }
  EXPECT_NE(magnitude(with({"--detrend", "none"}), 0), magnitude(plain, 0));
  EXPECT_NE(magnitude(with({"--detrend", "line"}), 0), magnitude(plain, 0));
  EXPECT_EQ(with({"--overlap", "0"})["averages"], 40);
  EXPECT_EQ(with({"--overlap", "0.75"})["averages"], 157);
  EXPECT_EQ(with({"--data", second})["averages"], 79 + 39);
  const json h1 = with({"--estimator", "h1"}), h2 = with({"--estimator", "h2"}), hv = with({"--estimator", "hv"});
  EXPECT_EQ(support::without_origin(h1), support::without_origin(plain));
  EXPECT_EQ(h2["estimator"], "H2");
  EXPECT_EQ(hv["estimator"], "Hv");
  EXPECT_NEAR(std::sqrt(magnitude(h1, 9) * magnitude(h2, 9)), magnitude(hv, 9), 1e-12);
  EXPECT_GT(magnitude(h2, 9), magnitude(h1, 9));
  const json part = with({"--from", "10", "--to", "20"});
  EXPECT_EQ(part["outputs"]["F_w"]["frequency_hz"], json({10.0, 12.0, 14.0, 16.0, 18.0, 20.0}));
  const json by = with({"--instrument", "z_w"});
  EXPECT_EQ(by["instrument"], "z_w");
  EXPECT_EQ(by["estimator"], "Hiv");
  EXPECT_EQ(by["instrument_coherence"].size(), 49U);
  const json wrapped = parsed({"--data", first, "--input", "z_r", "--output", "z_w", "--block", "0.5"});
  const json running = parsed({"--data", first, "--input", "z_r", "--output", "z_w", "--block", "0.5", "--unwrap"});
  EXPECT_LE(std::abs(wrapped["outputs"]["z_w"]["phase_rad"][40].get<double>()), pi);
  EXPECT_NEAR(running["outputs"]["z_w"]["phase_rad"][40].get<double>(), -2.0 * pi * 82.0 * 0.05, 0.05);
}

// In a closed hil loop z_r becomes the instrument by itself, which is said; nobody is overruled.
TEST_F(Frf, UsesTheRoadAsInstrumentInsideAClosedLoop) {
  const std::string rig = support::rig_file("paper_linear"), run = folder / "run.csv";
  ASSERT_EQ(rigtwin({"simulate", "--rig", rig, "--duration", "20", "--out", run}).status, 0);
  const std::vector<std::string> words{"frf", "--data", run, "--input", "x_act", "--output", "F", "--block", "2"};
  const auto output = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    const Ended ended = rigtwin(more);
    EXPECT_EQ(ended.status, 0) << ended.errors;
    return ended.output;
  };
  EXPECT_THAT(output({"--rig", rig}), HasSubstr("z_r is used as instrument\n"));
  EXPECT_THAT(output({"--rig", rig}), HasSubstr("F / x_act [N/m] by Hiv"));
  EXPECT_THAT(output({"--rig", rig, "--instrument", "none"}), HasSubstr("by H1"));
  EXPECT_THAT(output({"--rig", rig, "--estimator", "hv"}), HasSubstr("note: x_act is inside the closed loop"));
  EXPECT_THAT(output({}), HasSubstr("note: the recording holds z_r and a test machine's deflection"));
  const Ended road = rigtwin({"frf", "--rig", rig, "--data", run, "--input", "z_r", "--output", "F_w", "--block", "2"});
  EXPECT_THAT(road.output, testing::AllOf(HasSubstr("by H1"), testing::Not(HasSubstr("instrument"))));
}

// [channels] of a rig description says how a recording names and scales things.
TEST_F(Frf, ReadsChannelsAsTheRigDescriptionSays) {
  std::string text = "t,Road [mm],Load\n";
  const auto x = support::white(2000, 1.0, 4);
  for (std::size_t n = 0; n < x.size(); ++n) {
    text += std::to_string(static_cast<double>(n) / 1000.0) + "," + std::to_string(1000.0 * x[n]) + "," +
            std::to_string(7.0 * x[n]) + "\n";
  }
  const std::string rig = folder.write("rig.toml", std::string(support::quarter_car_text) +
                                                       "[channels]\nz_r = { column = \"Road [mm]\", scale = 1e-3 }\n"
                                                       "F_w = { column = \"Load\" }\n");
  const json result = parsed({"--rig", rig, "--data", folder.write("foreign.csv", text), "--input", "z_r", "--output",
                              "F_w", "--block", "0.1"});
  EXPECT_NEAR(result["outputs"]["F_w"]["magnitude"][10].get<double>(), 7.0, 1e-4);
}

// --uff writes the universal file beside the rest (universal_file_test reads it back).
TEST_F(Frf, WritesAUniversalFile) {
  const std::string file = folder / "response.uff";
  const Ended ended =
      rigtwin({"frf", "--data", first, "--input", "z_r", "--output", "F_w", "--block", "0.5", "--uff", file});
  EXPECT_EQ(ended.status, 0) << ended.errors;
  const std::string text = TemporaryFolder::read(file);
  EXPECT_THAT(text, HasSubstr("H1 F_w / z_r"));
  EXPECT_THAT(text, HasSubstr("         6        49         1  2.00000E+00  2.00000E+00  0.00000E+00"));
}

// Where the input has no power, there is no number: null, in a text that every parser takes.
TEST_F(Frf, SaysNullWhereThereIsNoNumber) {
  std::string text = "t,z_r,F_w\n";
  for (int n = 0; n < 400; ++n) {
    text += std::to_string(n * 0.01) + "," + std::to_string(n % 2) + "," + std::to_string(n % 4) + "\n";
  }
  const json result = parsed({"--data", folder.write("line.csv", text), "--input", "z_r", "--output", "F_w", "--block",
                              "0.4", "--window", "rectangular"});
  for (const json& pair : result["outputs"]["F_w"]["magnitude_ci95"]) {
    ASSERT_EQ(pair.size(), 2U);
    EXPECT_TRUE(pair[1].is_null() || pair[1].is_number());
  }
  EXPECT_EQ(
      rigtwin({"frf", "--data", folder / "line.csv", "--input", "z_r", "--output", "F_w", "--block", "0.4"}).status, 0);
}

// Fault. One clear line each, nothing on standard output, the contract's exit status.
TEST_F(Frf, TellsWhatIsWrongInOneLine) {
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"--data", first, "--input", "z_r", "--output", "F_w"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  refused({"--data", first, "--input", "z_r"}, 2, "--output is required");
  refused({"--data", first, "--input", "Fw", "--output", "F_w"}, 2,
          "--input: unknown channel 'Fw', expected one of z_r,");
  refused({"--data", first, "--input", "F_w", "--output", "F_w"}, 2, "--output: F_w is also the input");
  refused(with({"--output", "F_w"}), 2, "--output: F_w is given twice");
  refused(with({"--overlap", "1"}), 2, "--overlap: is 1, expected a number from 0 to 0.95");
  refused(with({"--overlap", "nan"}), 2, "--overlap: is ");
  refused(with({"--block", "-1"}), 2, "--block: is -1, expected");
  refused(with({"--block", "0.05"}), 2, "--block: is 0.05, expected a number from 0.08 to");
  refused(with({"--lowest-damping", "0"}), 2, "--lowest-damping: is 0, expected");
  refused(with({"--window", "kaiser"}), 2,
          "--window: is 'kaiser', expected one of hann, hamming, blackman, rectangular");
  refused(with({"--estimator", "h3"}), 2, "--estimator: is 'h3', expected one of h1, h2, hv");
  refused(with({"--estimator", "h1", "--instrument", "z_w"}), 2, "--estimator h1 has no instrument");
  refused(with({"--instrument", "z_r"}), 2, "--instrument: z_r is also the input");
  refused(with({"--block", "1", "--from", "30", "--to", "20"}), 2, "no line of the spectrum lies between");
  refused(with({"--block", "11"}), 3,
          "first.csv: the recording is too short: 20 s, expected at least 22 s for two blocks");
  refused(with({"--lowest-damping", "0.01"}), 3, "expected at least 125 s for a peak 0.024 Hz wide");
  refused({"--data", first, "--input", "z_r", "--output", "z_b"}, 3, "first.csv: there is no channel z_b");
  refused(with({"--data", first}), 2, "first.csv is given twice");
  refused({"--data", folder / "none.csv", "--input", "z_r", "--output", "F_w"}, 3, "none.csv: cannot be opened");
  refused({"--data", folder.write("nan.csv", "t,z_r,F_w\n0,1,1\n0.01,nan,2\n"), "--input", "z_r", "--output", "F_w"}, 3,
          "nan.csv:3: ");
  refused(with({"--json", folder / "no/where.json"}), 4, "no/where.json");
  refused(with({"--uff", folder / "no/where.uff"}), 4, "no/where.uff");
}

}  // namespace
}  // namespace frf_command_test
