#include "host_sim/sweep/shard.hpp"

#include <charconv>
#include <cstdlib>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::sweep {
namespace {

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || stop != end) return std::nullopt;
  return value;
}

/// The variables of one kind of engine.
struct EngineVariables {
  const char* index;
  const char* first;   ///< nullptr: indices begin at 0
  const char* last;    ///< nullptr: the count is given
  const char* count;   ///< nullptr: the last one is given
  const char* stride;  ///< nullptr: 1
};

constexpr EngineVariables arrays[] = {
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", nullptr, "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_STEP"},
    {"SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_LAST", nullptr, "SGE_TASK_STEPSIZE"},
    {"PBS_ARRAY_INDEX", nullptr, nullptr, "RIGTWIN_SHARDS", nullptr},
    {"PBS_ARRAYID", nullptr, nullptr, "RIGTWIN_SHARDS", nullptr}};
constexpr EngineVariables ranks[] = {{"OMPI_COMM_WORLD_RANK", nullptr, nullptr, "OMPI_COMM_WORLD_SIZE", nullptr},
                                     {"PMI_RANK", nullptr, nullptr, "PMI_SIZE", nullptr}};

class EngineReader {
 public:
  explicit EngineReader(const Environment& environment) : environment_(environment) {}

  template <std::size_t n>
  [[nodiscard]] std::optional<Shard> first_of(const EngineVariables (&engines)[n]) const {
    for (const EngineVariables& engine : engines) {
      // Grid Engine sets its variables to "undefined" in jobs that are no array.
      const auto text = environment_(engine.index);
      if (text && *text != "undefined") return shard(engine);
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::uint64_t number(const char* name) const {
    const auto text = environment_(name);
    if (!text) {
      throw firmware::UsageError("the engine's variable " + std::string(name) +
                                 " is not set, expected the number of shards: --shard i/n");
    }
    const auto value = whole_number(*text);
    if (!value) {
      throw firmware::UsageError("the engine's variable " + std::string(name) + " is " + firmware::in_quotes(*text) +
                                 ", expected a whole number, or --shard i/n");
    }
    return *value;
  }

  [[nodiscard]] Shard shard(const EngineVariables& engine) const {
    const std::uint64_t index = number(engine.index);
    const std::uint64_t first = engine.first != nullptr && environment_(engine.first) ? number(engine.first) : 0;
    const bool strides = engine.stride != nullptr && environment_(engine.stride);
    const std::uint64_t stride = strides ? number(engine.stride) : 1;
    if (index < first || stride == 0 || (index - first) % stride != 0) {
      throw firmware::UsageError("the engine's variable " + std::string(engine.index) + " is " + std::to_string(index) +
                                 ", expected one of its own array, or --shard i/n");
    }
    Shard shard{(index - first) / stride, 1};
    shard.count = engine.last != nullptr ? (number(engine.last) - first) / stride + 1 : number(engine.count);
    // PBS counts from where the user says, 0 or 1: (1) takes both.
    if (engine.first == nullptr && shard.index == shard.count) shard.index = 0;
    if (shard.count == 0 || shard.count > most_shards || shard.index >= shard.count) {
      throw firmware::UsageError("the engine gives shard " + shard.text() +
                                 ", expected one below the number of shards");
    }
    return shard;
  }

  const Environment& environment_;
};

}  // namespace

Shard parse_shard(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto index = whole_number(text.substr(0, slash));
  const auto count = slash == std::string_view::npos ? std::nullopt : whole_number(text.substr(slash + 1));
  if (!index || !count || *count == 0 || *count > most_shards || *index > *count) {
    throw firmware::UsageError("--shard " + firmware::in_quotes(text) +
                               " is no shard, expected i/n with i = 0 … n − 1 or 1 … n, such as 1/7");
  }
  return {*index % *count, *count};
}

std::optional<std::string> process_environment(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): read before any thread starts
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

std::optional<Shard> shard_of_engine(const Environment& environment) {
  const EngineReader reader(environment);
  const auto task = reader.first_of(arrays), rank = reader.first_of(ranks);
  if (!task) return rank;
  if (!rank) return task;
  return Shard{task->index * rank->count + rank->index, task->count * rank->count};
}

}  // namespace host_sim::sweep
