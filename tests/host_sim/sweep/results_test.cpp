// Results that are complete, or not there: shards, kills, full disks, merges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/sweep/merge.hpp"
#include "host_sim/sweep/run_cases.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace host_sim::sweep;
using support::TemporaryFolder;

const CaseSet hundred{100, "plan"};

std::string line(std::uint64_t id) {
  return nlohmann::ordered_json{{"id", id}, {"road", "a \"b\", c"}, {"square", static_cast<double>(id * id)}}.dump();
}

void run(const TemporaryFolder& folder, const std::string& shard, std::size_t jobs = 1) {
  run_cases(hundred, parse_shard(shard), folder.path(), jobs, line);
}

std::string merged(const TemporaryFolder& folder) {
  static_cast<void>(merge_into_files(folder.path()));
  return TemporaryFolder::read(folder / "results.jsonl") + TemporaryFolder::read(folder / "results.csv");
}

template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
    return "nothing";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

// Law. The merged bytes do not depend on the number of shards, of threads, or on who ran which first.
TEST(SweepResults, AreTheSameForOneTwoAndSevenShards) {
  const TemporaryFolder one, two, seven;
  run(one, "0/1", 3);
  run(two, "2/2");
  run(two, "1/2", 2);
  for (const int i : {3, 0, 6, 1, 5, 2, 4}) run(seven, std::to_string(i) + "/7", 2);
  const std::string whole = merged(one);
  EXPECT_EQ(merged(two), whole);
  EXPECT_EQ(merged(seven), whole);
  EXPECT_THAT(
      TemporaryFolder::read(one / "results.csv"),
      testing::StartsWith("id,road,square,failed\n0,\"a \"\"b\"\", c\",0.0,\n1,\"a \"\"b\"\", c\",1.0,\n2,\"a \"\"b"));
}

// Point. Σ id² = 328350 over 100 cases; Welford's recursion is exact here to rounding.
TEST(SweepResults, AreSummedUp) {
  const TemporaryFolder folder;
  run(folder, "0/1");
  const Merged all = merge_into_files(folder.path());
  ASSERT_EQ(all.numbers.size(), 1U);
  EXPECT_NEAR(all.numbers[0].mean, 3283.5, 1e-9);
  EXPECT_NEAR(all.numbers[0].standard_deviation(), 2968.1748, 1e-3);  // √(Σ(x − mean)²/99), by hand
  EXPECT_EQ(all.numbers[0].highest, 9801.0);
  EXPECT_EQ(all.failed, 0U);
}

// Fault. Killed in the middle of a line: the part of a line is cut off, the rest is computed, nothing twice.
TEST(SweepResults, GoOnAfterAKill) {
  const TemporaryFolder folder, whole;
  run(whole, "0/1");
  run(folder, "0/1");
  const auto file = folder / "results-0-of-1.jsonl";
  const std::string text = TemporaryFolder::read(file);
  // Every length that a killed process may leave in the first lines and the last one.
  std::vector<std::size_t> lengths;
  for (std::size_t n = 0; n < 300; n += 7) lengths.push_back(n);
  for (std::size_t n = text.size() - 60; n <= text.size(); n += 5) lengths.push_back(n);
  for (const std::size_t length : lengths) {
    std::filesystem::remove(file);
    folder.write("results-0-of-1.jsonl", text.substr(0, length));
    std::atomic<int> computed = 0;
    const ShardWork work = run_cases(hundred, {}, folder.path(), 2, [&](std::uint64_t id) {
      ++computed;
      return line(id);
    });
    EXPECT_EQ(work.before + work.now, 100U) << length;
    EXPECT_EQ(static_cast<int>(work.now), computed) << length;
    EXPECT_EQ(TemporaryFolder::read(file), text) << length;
  }
}

// A sweep that goes on with another number of shards does not compute finished cases again.
TEST(SweepResults, GoOnWithAnotherNumberOfShards) {
  const TemporaryFolder folder, whole;
  run(whole, "0/1");
  run(folder, "0/3");
  const ShardWork work = run_cases(hundred, {}, folder.path(), 1, line);
  EXPECT_EQ(work.before, 34U);
  EXPECT_EQ(work.now, 66U);
  EXPECT_EQ(merged(folder), merged(whole));
}

// Fault. Shards that start side by side look at each other's files; one may have made its file and written no line yet.
TEST(SweepResults, OfAShardThatHasJustBegunAreNone) {
  for (const std::string begin : {"", "{\"cases\":100,\"finger"}) {
    const TemporaryFolder folder;
    folder.write("results-1-of-2.jsonl", begin);
    EXPECT_EQ(run_cases(hundred, parse_shard("0/2"), folder.path(), 1, line).now, 50U);
    EXPECT_NE(error_of([&] { static_cast<void>(merge_into_files(folder.path())); }).find("50 of 100 cases are missing"),
              std::string::npos);
    EXPECT_EQ(TemporaryFolder::read(folder / "results-1-of-2.jsonl"), begin);
    run(folder, "1/2");
    EXPECT_EQ(merge_into_files(folder.path()).cases.count, 100U);
  }
}

TEST(SweepResults, ProvesThatNothingIsMissing) {
  const TemporaryFolder folder;
  EXPECT_NE(error_of([&] { static_cast<void>(merge_into_files(folder.path())); }).find("holds no results"),
            std::string::npos);
  run(folder, "0/7");
  run(folder, "2/7");
  const std::string error = error_of([&] { static_cast<void>(merge_into_files(folder.path())); });
  EXPECT_NE(error.find("71 of 100 cases are missing, the first is 1"), std::string::npos) << error;
  EXPECT_FALSE(std::filesystem::exists(folder / "results.csv"));
  EXPECT_EQ(folder.count(), 2U) << "nothing half-written";
}

TEST(SweepResults, ProvesThatNothingIsThereTwice) {
  const TemporaryFolder folder;
  run(folder, "0/1");
  const std::string header = "{\"cases\":100,\"fingerprint\":\"plan\",\"shard\":\"1/2\"}\n";
  folder.write("results-1-of-2.jsonl", header + line(17) + "\n");
  EXPECT_NE(error_of([&] { static_cast<void>(merge_into_files(folder.path())); }).find("case 17 is there, and in"),
            std::string::npos);
  const std::pair<std::string, std::string> damaged[] = {
      {header + line(17) + "\n" + line(17) + "\n", ":3: case 17 is there twice"},
      {header + line(17) + "\n" + line(16) + "\n", ":3: case 16 stands behind 17"},
      {header + line(100) + "\n", ":2: case 100 does not exist"},
      {header + "{}\n", ":2: is no result"},
      {header + "nonsense\n", ":2: is no result"},
      {"nonsense\n", ":1: is no file of results"}};
  folder.write("results-1-of-2.jsonl", "{\"cases\":100,\"fingerprint\":\"other\"}\n");
  EXPECT_NE(error_of([&] { static_cast<void>(merge_into_files(folder.path())); }).find("belongs to another plan"),
            std::string::npos);
  std::filesystem::remove(folder / "results-0-of-1.jsonl");
  for (const auto& [text, says] : damaged) {
    folder.write("results-1-of-2.jsonl", text);
    const std::string error = error_of([&] { static_cast<void>(merge_into_files(folder.path())); });
    EXPECT_NE(error.find(says), std::string::npos) << error;
  }
}

TEST(SweepResults, OfAnotherPlanAreNotContinued) {
  const TemporaryFolder folder;
  run(folder, "0/2");
  const CaseSet other{100, "other plan"};
  const std::string error = error_of([&] { run_cases(other, parse_shard("1/2"), folder.path(), 1, line); });
  EXPECT_NE(error.find("belongs to another plan"), std::string::npos) << error;
}

// Fault. Two processes with one shard number would write one file.
TEST(SweepResults, OfOneShardAreWrittenByOneProcess) {
  const TemporaryFolder folder;
  const ResultFile first(folder.path(), hundred, {});
  const std::string error = error_of([&] { const ResultFile second(folder.path(), hundred, {}); });
  EXPECT_NE(error.find("is being written by another process"), std::string::npos) << error;
}

// Fault. A disk that is full, here a limit on the file's size: no part of a line stays, and the shard goes on later.
TEST(SweepResults, LeaveNoPartOfALineOnAFullDisk) {
  const TemporaryFolder folder, whole;
  run(whole, "0/1");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 1000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(run(folder, "0/1", 2), firmware::OutputError);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  const std::string text = TemporaryFolder::read(folder / "results-0-of-1.jsonl");
  EXPECT_LE(text.size(), 1000U);
  EXPECT_EQ(text.back(), '\n');
  run(folder, "0/1");
  EXPECT_EQ(merged(folder), merged(whole));
}

// Fault. A case that throws ends the shard; the lines before it stand.
TEST(SweepResults, StandBeforeACaseThatThrows) {
  const TemporaryFolder folder;
  const auto throws = [](std::uint64_t id) {
    if (id == 40) throw std::runtime_error("case 40");
    return line(id);
  };
  EXPECT_EQ(error_of([&] { run_cases(hundred, {}, folder.path(), 3, throws); }), "case 40");
  const std::string text = TemporaryFolder::read(folder / "results-0-of-1.jsonl");
  EXPECT_NE(text.find("\"id\":39,"), std::string::npos);
  EXPECT_EQ(text.find("\"id\":40,"), std::string::npos);
  run(folder, "0/1");
  EXPECT_EQ(merge(folder.path(), [](const auto&) {}).count, 100U);
}

}  // namespace
