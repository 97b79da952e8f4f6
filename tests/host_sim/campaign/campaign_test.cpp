#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/campaign/campaign_list.hpp"
#include "tests/support/json_schema.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using host_sim::campaign::campaign_records;
using support::TemporaryFolder;
using testing::HasSubstr;

std::string error_of(const std::filesystem::path& campaign, const std::optional<std::filesystem::path>& rig) {
  try {
    static_cast<void>(campaign_records(campaign, rig));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CampaignList, TakesAFolderInTheOrderOfItsNumbers) {
  const TemporaryFolder folder;
  for (const char* const name : {"run_10.csv", "run_9.csv", "run_009.csv", "notes.txt", ".hidden.csv"})
    folder.write(name, "x");
  const std::string rig = folder.write("rig.toml", "x");
  std::vector<std::string> names;
  for (const auto& record : campaign_records(folder / "", rig)) names.push_back(record.name);
  EXPECT_THAT(names, testing::ElementsAre("run_009.csv", "run_9.csv", "run_10.csv"));
  EXPECT_THAT(error_of(folder / "", std::nullopt), HasSubstr("expected --rig RIG.toml"));
}

TEST(CampaignList, TakesAListAndSaysWhatIsWrongWithIt) {
  const TemporaryFolder folder;
  folder.write("a.csv", "x");
  folder.write("b.toml", "x");
  const std::string list = folder.write(
      "list.toml",
      "rig = \"b.toml\"\n[[record]]\ndata = \"a.csv\"\n[[record]]\ndata = \"a.csv\"\nname = \"again/1\"\n");
  const auto records = campaign_records(list, std::nullopt);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[1].name, "again_1");
  EXPECT_THAT(error_of(folder.write("2.toml", "[[record]]\ndata = \"a.csv\"\n"), std::nullopt),
              HasSubstr("2.toml:1: the record has no rig"));
  EXPECT_THAT(error_of(folder.write("3.toml", "rig = \"b.toml\"\n[[record]]\ndata = \"no.csv\"\n"), std::nullopt),
              HasSubstr("no.csv: is not there"));
  EXPECT_THAT(
      error_of(folder.write("4.toml", "rig = \"b.toml\"\n[[record]]\ndata = \"a.csv\"\n[[record]]\ndata = \"a.csv\"\n"),
               std::nullopt),
      HasSubstr("two records have the name 'a.csv'"));
  EXPECT_THAT(error_of(folder.write("5.toml", "record = 3\n"), std::nullopt),
              HasSubstr("5.toml:1: record is not a list"));
}

/// A bench with dry friction that its description does not have, three recordings of it and one broken file.
class CampaignCommand : public testing::Test {
 protected:
  void SetUp() override {
    firmware::RigDescription rig = support::rig("paper_bench_fdva");
    remove_effect(rig.rig, *firmware::find_effect("coulomb_friction"), std::nullopt);
    rig.noise[index(model::Channel::F)] = 10.0;
    rig.noise[index(model::Channel::x_act)] = 2e-5;
    folder.write("bench.toml", format_rig(rig));
    rig.rig.effects.add(model::CoulombFriction<double>{60.0});
    folder.write("truth.toml", format_rig(rig));
    std::filesystem::create_directory(folder / "runs");
    for (const char* const seed : {"1", "2", "3"}) {
      ASSERT_EQ(rigtwin({"simulate", "--rig", folder / "truth.toml", "--duration", "4", "--seed", seed, "--out",
                         folder / "runs" / ("run_" + std::string(seed) + ".csv")})
                    .status,
                0);
    }
    folder.write("runs/run_4.csv", "t,F,x_act\n0,1,x\n");
  }
  [[nodiscard]] support::Ended run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"diagnose", "--campaign",  folder / "runs", "--rig", folder / "bench.toml",
                                   "--out",    folder / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return support::rigtwin(words);
  }
  static support::Ended rigtwin(const std::vector<std::string>& words) { return support::rigtwin(words); }
  [[nodiscard]] nlohmann::json result() const {
    return nlohmann::json::parse(TemporaryFolder::read(folder / "out/campaign.json"));
  }

  TemporaryFolder folder;
};

TEST_F(CampaignCommand, LeavesATableOfAllRecordsAndGoesOnWhereItWas) {
  const auto first = run({"--shard", "1/2"});
  ASSERT_EQ(first.status, 0) << first.errors;
  EXPECT_THAT(first.output, HasSubstr("2 of 4 records are there"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/campaign.json"));
  const std::string made = TemporaryFolder::read(folder / "out/records/run_2.csv/state.json");

  const auto second = run();
  ASSERT_EQ(second.status, 0) << second.errors;
  EXPECT_THAT(second.output, HasSubstr("4 records: coulomb_friction in 3, 1 could not be diagnosed"));
  EXPECT_EQ(TemporaryFolder::read(folder / "out/records/run_2.csv/state.json"), made) << "not done again";
  support::expect_schema(TemporaryFolder::read(folder / "out/campaign.json"));
  support::expect_schema(TemporaryFolder::read(folder / "out/records/run_1.csv/verdict.json"));
  const nlohmann::json json = result();
  EXPECT_NEAR(json["quantities"]["coulomb_friction: force"]["mean"].get<double>(), 60.0, 1.0);
  ASSERT_EQ(json["outliers"].size(), 1U);
  EXPECT_EQ(json["outliers"][0]["record"], "run_4.csv");
  EXPECT_THAT(json["outliers"][0]["why"].get<std::string>(), HasSubstr("run_4.csv:2"));
  EXPECT_THAT(TemporaryFolder::read(folder / "out/campaign.csv"), HasSubstr("run_1.csv,named,coulomb_friction ("));
  EXPECT_THAT(TemporaryFolder::read(folder / "out/report.html"), HasSubstr("could not be diagnosed"));
}

TEST_F(CampaignCommand, RefusesInOneLine) {
  EXPECT_EQ(run({"--data", folder / "runs/run_1.csv"}).status, 2);
  EXPECT_EQ(run({"--shard", "9/2"}).status, 2);
  EXPECT_EQ(rigtwin({"diagnose", "--campaign", folder / "runs", "--out", folder / "x"}).status, 3);
  EXPECT_EQ(rigtwin({"diagnose", "--campaign", folder / "none.toml", "--out", folder / "x"}).status, 3);
}

}  // namespace
