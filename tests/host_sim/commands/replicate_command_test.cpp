// rigtwin replicate: what goes wrong with targets and runs, each in one clear line.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace replicate_command_test {
namespace {

using nlohmann::json;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;

/// A recording as text, row by row.
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;

  [[nodiscard]] std::size_t column(const std::string& name) const {
    for (std::size_t c = 0; c < head.size(); ++c) {
      if (head[c].substr(0, head[c].find(' ')) == name) return c;
    }
    throw std::runtime_error("no column " + name);
  }
  void change(const std::string& name, const std::function<double(double)>& by) {
    const std::size_t at = column(name);
    for (auto& row : rows) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "%.12g", by(std::stod(row[at])));
      row[at] = text.data();
    }
  }
};

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> words;
  std::stringstream stream(line);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  return words;
}

Table read_table(const std::string& file) {
  Table table;
  std::stringstream stream(TemporaryFolder::read(file));
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.front() == '#') continue;
    (table.head.empty() ? table.head : table.rows.emplace_back()) = cells(line);
  }
  return table;
}

std::string text_of(const Table& table) {
  std::string text;
  const auto add = [&text](const std::vector<std::string>& row) {
    for (std::size_t c = 0; c < row.size(); ++c) text += (c == 0 ? "" : ",") + row[c];
    text += "\n";
  };
  add(table.head);
  for (const auto& row : table.rows) add(row);
  return text;
}

/// A plain car behind a machine, with a target that it made itself.
class Replicate : public ::testing::Test {
 protected:
  Replicate() {
    const std::string car(support::quarter_car_text);
    const std::string plain = folder.write("plain.toml", car);
    const Ended ended = rigtwin({"simulate", "--rig", plain, "--duration", "4", "--out", folder / "target.csv"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    rig = folder.write("rig.toml", car + "[effects.actuator_lag]\ntime_constant = 0.01\n[limits]\nspeed = 3.0\n");
    target = read_table(folder / "target.csv");
  }

  Ended begin(const Table& wanted, const std::string& channels, const std::string& band) {
    const std::string file = folder.write("wanted.csv", text_of(wanted));
    return rigtwin({"replicate", "--rig", rig, "--target", file, "--channels", channels, "--band", band, "--out",
                    folder / "drives"});
  }

  /// The answer of the rig to the first drive, in a file of its own.
  Table answer() {
    const std::string copy = folder / "copy";
    std::filesystem::copy(folder / "drives", copy);
    const Ended ended = rigtwin({"replicate", copy, "--simulated", rig, "--runs", "1"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    return read_table(copy + "/run_1.csv");
  }

  Ended give(const Table& run) {
    return rigtwin({"replicate", folder / "drives", "--measured", folder.write("run.csv", text_of(run))});
  }

  static void expect_one_line(const Ended& ended, const std::string& words) {
    EXPECT_EQ(ended.status, 3);
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(words), std::string::npos) << ended.errors;
  }

  TemporaryFolder folder;
  std::string rig;
  Table target;
};

// Fault. Runs: half of one is refused, most of one is used and said; a lost channel is neither judged nor corrected,
// and a run without any is refused. A refused run leaves the folder as it was.
TEST_F(Replicate, SaysWhatARunLacks) {
  const Ended begun = begin(target, "zdd_w,dz_b", "0.7:40");
  ASSERT_EQ(begun.status, 0) << begun.errors;
  const Table run = answer();
  const std::string before = TemporaryFolder::read(folder / "drives/replicate.json");
  Table half = run;
  half.rows.resize(half.rows.size() / 3);
  expect_one_line(give(half), "the run was cut short after");
  Table silent = run;
  for (const char* channel : {"zdd_w", "dz_b"}) silent.change(channel, [](double) { return 0.0; });
  expect_one_line(give(silent), "holds no channel of the target that moves");
  EXPECT_EQ(TemporaryFolder::read(folder / "drives/replicate.json"), before);
  Table part = run;
  part.rows.resize(5000);  // of 2 + 4 + 2 s
  part.change("dz_b", [](double) { return 0.0; });
  const Ended used = give(part);
  EXPECT_EQ(used.status, 0) << used.errors;
  EXPECT_NE(used.output.find("cut short after 5 of 8 s"), std::string::npos) << used.output;
  EXPECT_NE(used.output.find("dz_b never moves in the run: it is neither judged nor corrected"), std::string::npos)
      << used.output;
  const json result = json::parse(TemporaryFolder::read(folder / "drives/replicate.json"));
  EXPECT_TRUE(result.at("runs").at(0).at("error").at("dz_b").is_null());
  EXPECT_LT(result.at("runs").at(0).at("error").at("zdd_w").get<double>(), 0.05);
}

// Fault. An acceleration in g beside a displacement in m: said before anything moves.
TEST_F(Replicate, KnowsATargetInG) {
  Table in_g = target;
  in_g.change("zdd_w", [](double a) { return a / 9.80665; });
  expect_one_line(begin(in_g, "zdd_w,dz_b", "0.7:40"), "zdd_w looks as if it were in g");
  EXPECT_FALSE(std::filesystem::exists(folder / "drives"));
}

// Limit. A target that asks for 400 mm of suspension travel: the drive stays within the stroke, and what that costs
// stands in one line and in the JSON.
TEST_F(Replicate, SaysWhatATargetBeyondTheStrokeCosts) {
  double largest = 0.0;
  for (const auto& row : target.rows) largest = std::max(largest, std::abs(std::stod(row[target.column("dz_b")])));
  Table far = target;
  far.change("dz_b", [largest](double d) { return 0.4 * d / largest; });
  const Ended begun = begin(far, "dz_b", "0.7:20");
  EXPECT_EQ(begun.status, 0) << begun.errors;
  EXPECT_NE(begun.output.find("the limits cost: without them"), std::string::npos) << begun.output;
  const json run = json::parse(TemporaryFolder::read(folder / "drives/replicate.json")).at("runs").at(0);
  EXPECT_GT(run.at("predicted_error").at("dz_b").get<double>(),
            run.at("predicted_error_without_limits").at("dz_b").get<double>() + 0.05);
  for (const char* limit : {"stroke", "speed", "acceleration"})
    EXPECT_LE(run.at("limits_used").at(limit).get<double>(), 1.0) << limit;
}

// Law. An earlier run tells the numbers before the first drive: a tyre 3 % off costs nothing then, and the folder goes
// on with what was fitted.
TEST_F(Replicate, FitsTheNumbersToAnEarlierRun) {
  const Ended drove =
      rigtwin({"simulate", "--rig", rig, "--duration", "4", "--seed", "5", "--out", folder / "earlier.csv"});
  ASSERT_EQ(drove.status, 0) << drove.errors;
  const std::string off =
      folder.write("off.toml", support::with(TemporaryFolder::read(rig), "stiffness = 200e3", "stiffness = 206e3") +
                                   "[tolerance]\n\"tyre.stiffness\" = 0.05\n");
  const std::string wanted = folder.write("wanted.csv", text_of(target));
  const auto first_error = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{"replicate", "--rig",  off,      "--target", wanted,       "--channels",
                                   "zdd_w",     "--band", "0.7:40", "--out",    folder / name};
    words.insert(words.end(), more.begin(), more.end());
    const Ended begun = rigtwin(words);
    EXPECT_EQ(begun.status, 0) << begun.errors;
    const Ended ran = rigtwin({"replicate", folder / name, "--simulated", rig, "--runs", "1"});
    EXPECT_EQ(ran.status, 0) << ran.errors;
    return json::parse(TemporaryFolder::read(folder / (name + "/replicate.json"))).at("runs").at(0);
  };
  EXPECT_GT(first_error("without", {}).at("error").at("zdd_w").get<double>(), 0.02);
  const json fitted = first_error("with", {"--data", folder / "earlier.csv"});
  EXPECT_LT(fitted.at("error").at("zdd_w").get<double>(), 0.01);
  EXPECT_NE(fitted.at("remarks").at(0).get<std::string>().find("tolerated parameters were fitted"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "with/rig_0.toml"));
  EXPECT_FALSE(std::filesystem::exists(folder / "without/rig_0.toml"));
}

}  // namespace
}  // namespace replicate_command_test
