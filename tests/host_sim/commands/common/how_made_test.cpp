// The page of each command that writes one says how it was made: version, command, hashes of the inputs.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/description/text/sha256.hpp"
#include "firmware/description/version.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using support::Ended;
using support::rig_file;
using support::rigtwin;
using support::TemporaryFolder;

void expect_made(const std::string& page, const std::string& command, const std::vector<std::string>& inputs) {
  EXPECT_NE(page.find("rigtwin " + std::string(firmware::version) + "\n$ " + command + "\n"), std::string::npos)
      << command;
  for (const std::string& input : inputs) {
    const std::string line = firmware::sha256(TemporaryFolder::read(input)) + "  " + input + "\n";
    EXPECT_NE(page.find(line), std::string::npos) << line;
  }
  const std::size_t begin = page.find("How this page was made"), end = page.find("</pre>", begin);
  ASSERT_NE(end, std::string::npos);
  const std::string part = page.substr(begin, end - begin);
  EXPECT_EQ(std::count(part.begin(), part.end(), '\n'),
            3 + (inputs.empty() ? 0 : 1 + static_cast<std::ptrdiff_t>(inputs.size())))
      << part;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text = "rigtwin";
  for (const std::string& word : words) text += " " + word;
  return text;
}

// Outputs are no inputs, even where an earlier run has left them there.
TEST(HowMade, NamesCommandAndInputs) {
  const TemporaryFolder folder;
  const std::string rig = rig_file("paper_hil_fdva"), page = folder / "page.html", json = folder / "result.json";
  const std::vector<std::string> words{"stability", "--rig=" + rig, "--report", page, "--json=" + json};
  for (int run = 0; run < 2; ++run) {
    const Ended ended = rigtwin(words);
    ASSERT_EQ(ended.status, 0) << ended.errors;
    expect_made(TemporaryFolder::read(page), joined(words), {rig});
  }
}

// The numbers of a law may stand in a file of its own: it decides the result as the description does, also where the
// page is made from another folder.
TEST(HowMade, NamesTheTablesOfADescription) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "rigs");
  const std::string rig = folder.write("rigs/car.toml", TemporaryFolder::read(rig_file("paper_rig_kalman")) +
                                                            "\n[laws.damper]\nplace = \"suspension\"\n"
                                                            "over = \"velocity\"\nfile = \"damper.csv\"\n");
  const std::string table = folder.write("rigs/damper.csv", "velocity [mm/s],force [N]\n-100,-5\n100,5\n");
  const std::string run = folder / "run.csv", page = folder / "page.html";
  ASSERT_EQ(rigtwin({"simulate", "--rig", rig, "--duration", "5", "--out", run}).status, 0);
  const std::vector<std::string> words{"estimate", "--rig", rig, "--data", run, "--out", folder / "estimates.csv",
                                       "--report", page};
  const Ended ended = rigtwin(words);
  ASSERT_EQ(ended.status, 0) << ended.errors;
  expect_made(TemporaryFolder::read(page), joined(words), {rig, table, run});
}

TEST(HowMade, StandsInTheReportOfADiagnosis) {
  const TemporaryFolder folder;
  const std::string rig = rig_file("paper_linear"), run = folder / "run.csv";
  ASSERT_EQ(rigtwin({"simulate", "--rig", rig, "--duration", "4", "--out", run}).status, 0);
  const std::vector<std::string> words{"diagnose", "--rig", rig, "--data", run, "--out", folder / "found"};
  const Ended ended = rigtwin(words);
  ASSERT_EQ(ended.status, 0) << ended.errors;
  expect_made(TemporaryFolder::read(folder.path() / "found" / "report.html"), joined(words), {rig, run});
}

TEST(HowMade, StandsInThePagesOfTheOtherCommands) {
  const TemporaryFolder folder;
  const std::string kalman = rig_file("paper_rig_kalman"), hil = rig_file("paper_hil_fdva"), run = folder / "run.csv";
  ASSERT_EQ(rigtwin({"simulate", "--rig", kalman, "--duration", "5", "--out", run}).status, 0);
  const std::string page = folder / "page.html";
  const auto expect = [&](const std::vector<std::string>& words, const std::vector<std::string>& inputs) {
    const Ended ended = rigtwin(words);
    ASSERT_EQ(ended.status, 0) << ended.errors;
    expect_made(TemporaryFolder::read(page), joined(words), inputs);
  };
  expect({"estimate", "--rig", kalman, "--data", run, "--out", folder / "estimates.csv", "--report", page},
         {kalman, run});
  expect({"plan", "--rig", rig_file("paper_linear"), "--duration", "5", "--report", page}, {rig_file("paper_linear")});
  expect({"compensation", "--rig", hil, "--report", page}, {hil});
}

}  // namespace
