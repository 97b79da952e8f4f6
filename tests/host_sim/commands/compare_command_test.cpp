// rigtwin compare: what it prints, and the JSON that other people's scripts rely on.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_sim/signal/bands.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace compare_command_test {
namespace {

using nlohmann::json;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;

/// Two simulated recordings of a plain car, of different length, and a description with a wrong tyre.
class Compare : public ::testing::Test {
 protected:
  Compare() {
    const std::string true_rig = folder.write("true.toml", support::quarter_car_text);
    for (const auto& [file, seconds, seed] : {std::tuple{&first, "8", "1"}, std::tuple{&second, "4", "2"}}) {
      const Ended ended =
          rigtwin({"simulate", "--rig", true_rig, "--duration", seconds, "--seed", seed, "--out", *file});
      EXPECT_EQ(ended.status, 0) << ended.errors;
    }
  }

  json compare(std::vector<std::string> more) const {
    std::vector<std::string> words{"compare", "--rig", rig, "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = rigtwin(words);
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_EQ(ended.errors, "") << "no progress where nobody watches";
    return json::parse(ended.output);
  }

  TemporaryFolder folder;
  std::string first = folder / "first.csv";
  std::string second = folder / "second.csv";
  std::string rig = folder.write("rig.toml", support::with(support::quarter_car_text, "200e3", "190e3") +
                                                 "[tolerance]\n\"tyre.stiffness\" = 0.1\n\"body.mass\" = 0.01\n");
};

// contract.md: {"channels": {name: {"nrmse", "bands": [{"band_hz": [,], "error_rms", "data_rms"}]}}, "parameters": {}}
TEST_F(Compare, WritesTheJsonOfTheContract) {
  const json result = compare({"--data", first});
  ASSERT_TRUE(result.at("channels").is_object());
  for (const char* name : {"zdd_w", "zdd_b", "dz_w", "dz_b", "F_w"}) {
    const json& channel = result.at("channels").at(name);
    const double nrmse = channel.at("nrmse");
    EXPECT_GT(nrmse, 0.001) << name;
    EXPECT_LT(nrmse, 0.2) << name;
    EXPECT_NEAR(nrmse, channel.at("error_rms").get<double>() / channel.at("data_rms").get<double>(), 1e-12);
    ASSERT_GT(channel.at("bands").size(), 15U);
    double squares = 0.0;
    for (const json& band : channel.at("bands")) {
      ASSERT_EQ(band.at("band_hz").size(), 2U);
      const double lower = band.at("band_hz")[0], upper = band.at("band_hz")[1];
      EXPECT_NEAR(upper / lower, std::pow(10.0, 0.1), 1e-9) << "a third octave";
      EXPECT_GE(band.at("data_rms").get<double>(), 0.0);
      squares += std::pow(band.at("error_rms").get<double>(), 2);
    }
    EXPECT_LE(std::sqrt(squares), channel.at("error_rms").get<double>() * (1.0 + 1e-9)) << name;
  }
  EXPECT_EQ(result.at("parameters"), json({{"tyre.stiffness", 190e3}, {"body.mass", 290.0}}));
  EXPECT_EQ(result.at("refit"), false);
  EXPECT_EQ(result.at("recordings").size(), 1U);
  EXPECT_EQ(result.at("recordings")[0].at("file"), first);
  EXPECT_EQ(result.at("recordings")[0].at("input"), "z_r");
  EXPECT_EQ(result.at("recordings")[0].at("channels"), result.at("channels"));
}

// A file gets the same text; the screen then shows the table.
TEST_F(Compare, WritesJsonToAFileToo) {
  const std::string file = folder / "result.json";
  const Ended ended = rigtwin({"compare", "--rig", rig, "--data", first, "--json", file});
  ASSERT_EQ(ended.status, 0);
  EXPECT_EQ(support::without_origin(json::parse(TemporaryFolder::read(file))),
            support::without_origin(compare({"--data", first})));
  EXPECT_NE(ended.output.find("driven by z_r, started at rest"), std::string::npos) << ended.output;
  for (const char* word : {"nrmse", "rms error", "clipped", "F_w", "third-octave band [Hz]", "12.5"}) {
    EXPECT_NE(ended.output.find(word), std::string::npos) << word << '\n' << ended.output;
  }
}

// Law. Several recordings: powers add up, weighted with their lengths 8 s and 4 s, in whole and in the bands that both
// resolve.
TEST_F(Compare, PoolsRecordingsByTheirLength) {
  const json both = compare({"--data", first, "--data", second});
  ASSERT_EQ(both.at("recordings").size(), 2U);
  const json& a = both["recordings"][0]["channels"]["F_w"];
  const json& b = both["recordings"][1]["channels"]["F_w"];
  const json& all = both["channels"]["F_w"];
  const auto joined = [](double one, double other) {
    return std::sqrt((8.0 * one * one + 4.0 * other * other) / 12.0);
  };
  for (const char* key : {"error_rms", "data_rms"})
    EXPECT_NEAR(all[key].get<double>(), joined(a[key], b[key]), 1e-9) << key;
  EXPECT_NEAR(all["nrmse"].get<double>(), all["error_rms"].get<double>() / all["data_rms"].get<double>(), 1e-12);
  EXPECT_EQ(all["bands"].size(), std::min(a["bands"].size(), b["bands"].size()));
  EXPECT_NE(a["bands"].size(), b["bands"].size());
  const json& last = all["bands"].back();
  EXPECT_EQ(last["band_hz"], b["bands"].back()["band_hz"]);
  EXPECT_NEAR(last["error_rms"].get<double>(), joined(a["bands"].back()["error_rms"], b["bands"].back()["error_rms"]),
              1e-12);
}

// --refit finds the tyre again and says from where to where; what stays at its bound is said to.
TEST_F(Compare, RefitsWhatIsTolerated) {
  const json result = compare({"--data", first, "--refit"});
  EXPECT_EQ(result.at("refit"), true);
  EXPECT_NEAR(result.at("parameters").at("tyre.stiffness").get<double>() / 200e3, 1.0, 1e-3);
  EXPECT_LT(result.at("channels").at("F_w").at("nrmse").get<double>(), 1e-3);
  const Ended text = rigtwin({"compare", "--rig", rig, "--data", first, "--refit"});
  EXPECT_NE(text.output.find("tyre.stiffness                 190000 ->"), std::string::npos) << text.output;
  const std::string narrow = folder.write("narrow.toml", support::with(support::quarter_car_text, "200e3", "190e3") +
                                                             "[tolerance]\n\"tyre.stiffness\" = 0.01\n");
  const Ended bound = rigtwin({"compare", "--rig", narrow, "--data", first, "--refit"});
  EXPECT_NE(bound.output.find("191900   (at its bound)"), std::string::npos) << bound.output;
}

TEST_F(Compare, StartsAsItIsTold) {
  EXPECT_EQ(compare({"--data", first})["recordings"][0]["started_at_rest"], true);
  EXPECT_EQ(compare({"--data", first, "--start", "rest"})["recordings"][0]["started_at_rest"], true);
  EXPECT_EQ(compare({"--data", first, "--start", "estimated"})["recordings"][0]["started_at_rest"], false);
}

// A channel that never moves has no nrmse: null, not a text that no parser takes.
TEST_F(Compare, SaysNullWhereThereIsNoNumber) {
  std::string text = "t,z_r,F_w\n";
  for (int k = 0; k < 50; ++k) text += "0.0" + std::string(k < 10 ? "0" : "") + std::to_string(k) + ",0,7\n";
  const json result = compare({"--data", folder.write("still.csv", text)});
  EXPECT_TRUE(result.at("channels").at("F_w").at("nrmse").is_null());
  EXPECT_EQ(rigtwin({"compare", "--rig", rig, "--data", folder / "still.csv"}).status, 0);
}

}  // namespace
}  // namespace compare_command_test
