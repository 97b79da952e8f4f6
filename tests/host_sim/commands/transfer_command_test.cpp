// rigtwin transfer as a shell meets it, and the paper's own case.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using nlohmann::json;
using support::rigtwin;
using support::TemporaryFolder;
using support::with;

constexpr const char* tolerance = R"(
[tolerance]
"suspension.stiffness" = 0.05
"fdva.oil_viscosity" = 0.15
"fdva.coupling_stiffness" = 0.03
"fdva.minor_loss" = 0.10
)";

std::string rig_text(const std::string& name) { return TemporaryFolder::read(support::rig_file(name)); }

/// The absorber that nobody described: oil 8 % more viscous, 25 N of seal friction, a coil 3 % softer.
std::string hidden(const std::string& text) {
  return with(with(with(text, "stiffness = 31500.0", "stiffness = 30555.0"), "oil_viscosity = 32e-6",
                   "oil_viscosity = 34.56e-6"),
              "[noise]", "[effects.seal_friction]\nforce = 25.0\n\n[noise]");
}

/// The first rig without its delay in the description, the second with 5 kg at its force sensor.
class PaperCase {
 public:
  PaperCase() {
    folder.write("hil.toml",
                 with(rig_text("paper_hil_fdva"), "[effects.actuator_delay]\ndelay = 0.010\n", "") + tolerance);
    folder.write("car.toml",
                 rig_text("paper_rig_fdva") + tolerance + "\"body.mass\" = 0.01\n\"tyre.stiffness\" = 0.02\n");
    folder.write("hil_actual.toml", hidden(rig_text("paper_hil_fdva")));
    folder.write("car_actual.toml", hidden(rig_text("paper_rig_fdva")));
    record("hil", 24, 11);
    record("car", 24, 12);
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder / name).string(); }
  [[nodiscard]] support::Ended transfer(std::vector<std::string> more) const {
    std::vector<std::string> words{"transfer",     "--from", at("hil.toml"), "--data",  at("hil.csv"), "--to",
                                   at("car.toml"), "--out",  at("out"),      "--draws", "1600"};
    words.insert(words.end(), more.begin(), more.end());
    return rigtwin(words);
  }
  [[nodiscard]] json result() const {
    const std::string text = TemporaryFolder::read(folder / "out" / "transfer.json");
    support::expect_schema(text);
    return json::parse(text);
  }

  TemporaryFolder folder;

 private:
  void record(const std::string& rig, int seconds, int seed) const {
    const auto ended = rigtwin({"simulate", "--rig", at(rig + "_actual.toml"), "--duration", std::to_string(seconds),
                                "--seed", std::to_string(seed), "--out", at(rig + ".csv")});
    EXPECT_EQ(ended.status, 0) << ended.errors;
  }
};

const json* effect(const json& list, const std::string& name) {
  for (const json& one : list) {
    if (one["name"] == name) return &one;
  }
  return nullptr;
}

// Journey. The absorber is learned on the hil rig of our own firmware, with 10 ms and 1140 N s/m. The friction travels,
// the delay stays; the car's recording lies in the bands, and both rigs show one friction. Beside it the naive way,
// whose bands are narrow and wrong.
TEST(TransferCommand, CarriesThePapersAbsorberFromTheVirtualToTheRealCar) {
  const PaperCase paper;
  const auto ended = paper.transfer({"--measured", paper.at("car.csv")});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const json t = paper.result();
  EXPECT_TRUE(t["holds"]) << t["text"];
  EXPECT_GE(t["coverage"]["95"], 0.85);
  ASSERT_NE(effect(t["travels"], "seal_friction"), nullptr) << t["travels"];
  const json force = (*effect(t["travels"], "seal_friction"))["parameters"]["force"];
  EXPECT_LE(force["ci95"][0], 25.0);
  EXPECT_GE(force["ci95"][1], 25.0);
  EXPECT_NE(effect(t["stays"], "actuator_delay"), nullptr) << t["stays"];
  EXPECT_EQ(effect(t["travels"], "actuator_delay"), nullptr);
  const json load = t["quantities"]["rms_F_w"];
  EXPECT_LE(load["band95"][0], load["band50"][0]);
  EXPECT_LE(load["band50"][1], load["band95"][1]);
  double sum = 0.0;
  for (const auto& [source, share] : load["sources"].items()) sum += share.get<double>();
  EXPECT_NEAR(sum, 1.0, 1e-9);
  bool pooled = false;
  for (const json& shared : t["shared"])
    pooled = pooled || (shared["path"] == "effects.seal_friction.force" && shared["equal"]);
  EXPECT_TRUE(pooled) << t["shared"];
  EXPECT_LT(t["naive"]["coverage"]["95"], 0.6);
  EXPECT_FALSE(t["naive"]["holds"]);
  EXPECT_FALSE(t["next_measurement"].empty());
  EXPECT_NE(t["text"].get<std::string>().find("The prediction holds: from 0.5"), std::string::npos) << t["text"];
  EXPECT_NE(TemporaryFolder::read(paper.folder / "out" / "report.html").find("</html>"), std::string::npos);
}

// Journey. Without recordings of the second rig it is a prediction; with bad input it is one line and nothing is left.
TEST(TransferCommand, PredictsOverARoadAndRefusesInOneLine) {
  const PaperCase paper;
  const auto predicted = paper.transfer({"--duration", "12", "--json", "-"});
  ASSERT_EQ(predicted.status, 0) << predicted.errors;
  const json t = paper.result();
  EXPECT_EQ(json::parse(predicted.output, nullptr, false), t) << "--json -: transfer.json and nothing else";
  EXPECT_NE(TemporaryFolder::read(paper.folder / "out" / "report.html").find("How this page was made"),
            std::string::npos);
  EXPECT_TRUE(t["holds"].is_null());
  EXPECT_TRUE(t["quantities"]["rms_F_w"]["measured"].is_null());
  EXPECT_GT(t["responses"]["F_w/z_r"]["frequency_hz"].size(), 50U);

  std::filesystem::remove_all(paper.folder / "out");
  paper.folder.write("other.toml", with(rig_text("paper_rig_fdva"), "oil_viscosity = 32e-6", "oil_viscosity = 40e-6"));
  paper.folder.write("empty.csv", "");
  paper.folder.write("header.csv", "t,x_cmd,F\n");
  std::string no_numbers = "t,z_r,x_cmd,x_act,F\n";
  for (int k = 0; k < 4000; ++k) no_numbers += std::to_string(0.001 * k) + ",nan,nan,nan,nan\n";
  paper.folder.write("no_numbers.csv", no_numbers);
  struct Wrong {
    std::vector<std::string> options;
    int status;
    std::string says;
  };
  const std::vector<Wrong> all{{{"--to", paper.at("other.toml")}, 3, "fdva.oil_viscosity is 4e-05"},
                               {{"--to", paper.at("hil.toml")}, 3, "kind is hil"},
                               {{"--data", paper.at("car.csv")}, 3, "car.csv"},
                               {{"--measured", paper.at("hil.csv")}, 3, "hil.csv"},
                               {{"--from", paper.at("nowhere.toml")}, 3, "nowhere.toml"},
                               {{"--data", paper.at("nowhere.csv")}, 3, "nowhere.csv"},
                               {{"--data", paper.at("empty.csv")}, 3, "empty.csv: the file is empty"},
                               {{"--data", paper.at("header.csv")}, 3, "header.csv"},
                               {{"--data", paper.at("no_numbers.csv")}, 3, "no_numbers.csv:2"},
                               {{"--measured", paper.at("empty.csv")}, 3, "empty.csv: the file is empty"},
                               {{"--road", paper.at("nowhere.csv")}, 3, "nowhere.csv"},
                               {{"--draws", "10"}, 2, "--draws"},
                               {{"--road", "iso8608:Q"}, 2, "Q"},
                               {{"--out", "/dev/null/x"}, 4, "/dev/null/x"},
                               {{"--out", paper.at("hil.csv")}, 4, "is not a folder"}};
  for (const Wrong& wrong : all) {
    std::vector<std::string> words{"transfer", "--draws", "400"};
    const auto add = [&](const std::string& option, const std::string& value) {
      if (wrong.options[0] == option && option != "--draws") return;
      words.insert(words.end(), {option, value});
    };
    add("--from", paper.at("hil.toml"));
    add("--data", paper.at("hil.csv"));
    add("--to", paper.at("car.toml"));
    add("--out", paper.at("out"));
    if (wrong.options[0] == "--draws") words.erase(words.begin() + 1, words.begin() + 3);
    words.insert(words.end(), wrong.options.begin(), wrong.options.end());
    const auto ended = rigtwin(words);
    EXPECT_EQ(ended.status, wrong.status) << wrong.options[1] << ": " << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(wrong.says), std::string::npos) << wrong.says << ": " << ended.errors;
  }
  EXPECT_FALSE(std::filesystem::exists(paper.folder / "out" / "transfer.json"));
}

}  // namespace
