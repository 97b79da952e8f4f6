// Which cases a process computes, from its flag or from what a cluster's engine tells it.
#include "host_sim/sweep/shard.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

#include "firmware/description/text/input_error.hpp"

namespace {

using namespace host_sim::sweep;

Environment with(std::map<std::string, std::string> variables) {
  return [variables = std::move(variables)](const char* name) -> std::optional<std::string> {
    const auto it = variables.find(name);
    return it == variables.end() ? std::nullopt : std::optional(it->second);
  };
}

// Law. Counted from 0 or from 1, n shards hold every case, and each case once: scripts count either way.
TEST(Shard, PartitionsTheCasesHoweverItIsCounted) {
  for (const int first : {0, 1}) {
    std::multiset<std::uint64_t> held;
    for (int i = first; i < first + 7; ++i) {
      const Shard shard = parse_shard(std::to_string(i) + "/7");
      for (std::uint64_t id = 0; id < 100; ++id) {
        if (shard.holds(id)) held.insert(id);
      }
    }
    EXPECT_EQ(held.size(), 100U) << "counted from " << first;
    EXPECT_EQ(std::set<std::uint64_t>(held.begin(), held.end()).size(), 100U);
  }
}

TEST(Shard, RefusesWhatIsNoShard) {
  for (const char* text :
       {"", "1", "/", "1/", "/7", "8/7", "-1/7", "1/0", "1/7/2", "a/7", "1/1000001", " 1/7", "1.0/7"}) {
    EXPECT_THROW(static_cast<void>(parse_shard(text)), firmware::UsageError) << text;
  }
}

// Point. The variables as the manuals of the engines describe them.
TEST(Shard, FollowsTheEngines) {
  struct Engine {
    std::map<std::string, std::string> variables;
    std::uint64_t index, count;
  };
  const std::vector<Engine> engines{
      {{{"SLURM_ARRAY_TASK_ID", "5"}, {"SLURM_ARRAY_TASK_MIN", "3"}, {"SLURM_ARRAY_TASK_COUNT", "4"}}, 2, 4},
      {{{"SLURM_ARRAY_TASK_ID", "7"},
        {"SLURM_ARRAY_TASK_MIN", "1"},
        {"SLURM_ARRAY_TASK_COUNT", "4"},
        {"SLURM_ARRAY_TASK_STEP", "2"}},
       3,
       4},
      {{{"OMPI_COMM_WORLD_RANK", "3"}, {"OMPI_COMM_WORLD_SIZE", "4"}}, 3, 4},
      {{{"PMI_RANK", "0"}, {"PMI_SIZE", "2"}}, 0, 2},
      {{{"PBS_ARRAY_INDEX", "6"}, {"RIGTWIN_SHARDS", "7"}}, 6, 7},
      {{{"PBS_ARRAY_INDEX", "7"}, {"RIGTWIN_SHARDS", "7"}}, 0, 7},
      {{{"PBS_ARRAYID", "2"}, {"RIGTWIN_SHARDS", "7"}}, 2, 7},
      {{{"SGE_TASK_ID", "5"}, {"SGE_TASK_FIRST", "1"}, {"SGE_TASK_LAST", "9"}, {"SGE_TASK_STEPSIZE", "2"}}, 2, 5},
      {{{"SGE_TASK_ID", "undefined"}, {"PMI_RANK", "1"}, {"PMI_SIZE", "2"}}, 1, 2},
      // Four ranks in each task of an array of three: twelve shards.
      {{{"SLURM_ARRAY_TASK_ID", "2"},
        {"SLURM_ARRAY_TASK_MIN", "0"},
        {"SLURM_ARRAY_TASK_COUNT", "3"},
        {"OMPI_COMM_WORLD_RANK", "1"},
        {"OMPI_COMM_WORLD_SIZE", "4"}},
       9,
       12},
  };
  for (const Engine& engine : engines) {
    const auto shard = shard_of_engine(with(engine.variables));
    ASSERT_TRUE(shard) << engine.variables.begin()->first;
    EXPECT_EQ(shard->text(), (Shard{engine.index, engine.count}.text())) << engine.variables.begin()->first;
  }
  EXPECT_FALSE(shard_of_engine(with({{"SLURM_JOB_ID", "17"}, {"SLURM_NTASKS", "8"}})))
      << "a batch job that is no array runs one process: no shard";
}

TEST(Shard, SaysWhichVariableIsWrong) {
  const std::vector<std::pair<std::map<std::string, std::string>, std::string>> wrong{
      {{{"PBS_ARRAY_INDEX", "6"}}, "RIGTWIN_SHARDS"},
      {{{"PMI_RANK", "x"}, {"PMI_SIZE", "2"}}, "PMI_RANK"},
      {{{"PMI_RANK", "2"}, {"PMI_SIZE", "1"}}, "2/1"},
      {{{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_MIN", "3"}, {"SLURM_ARRAY_TASK_COUNT", "4"}},
       "SLURM_ARRAY_TASK_ID"}};
  for (const auto& [variables, says] : wrong) {
    try {
      static_cast<void>(shard_of_engine(with(variables)));
      FAIL() << says;
    } catch (const firmware::UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
}

}  // namespace
