#include "host_sim/sweep/run_cases.hpp"

#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace host_sim::sweep {
namespace {

/// Cases that are taken and not written: one slow case holds the lines behind it back, this many at most. Half: with
/// more than 32 processors some would wait; twice: 128 lines of 2 kB in memory.
constexpr std::size_t longest_queue = 64;

/// A bit for each case that some file of the folder holds.
std::vector<bool> done_before(const CaseSet& cases, const std::filesystem::path& folder) {
  std::vector<bool> done(cases.count, false);
  for (const std::filesystem::path& file : result_files(folder)) {
    ResultReader reader(file);
    reader.demand(cases);
    while (const auto line = reader.next()) done[line->id] = true;
  }
  return done;
}

/// Hands out the cases of a shard in order, and writes their lines in that order.
class CaseQueue {
 public:
  CaseQueue(const CaseSet& cases, const Shard& shard, std::vector<bool> done, ResultFile& file,
            const ShardProgress& progress)
      : next_(shard.index),
        stride_(shard.count),
        end_(cases.count),
        done_(std::move(done)),
        file_(file),
        progress_(progress) {
    if (next_ < end_) work_.cases = (end_ - 1 - next_) / stride_ + 1;
    for (std::uint64_t id = next_; id < end_; id += stride_) work_.before += done_[id] ? 1 : 0;
  }

  /// The next case; nullopt when there is none, or after an error.
  [[nodiscard]] std::optional<std::uint64_t> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failure_ || taken_.size() < longest_queue; });
    while (next_ < end_ && done_[next_]) next_ += stride_;
    if (failure_ || next_ >= end_) return std::nullopt;
    const std::uint64_t id = next_;
    next_ += stride_;
    taken_.push_back(id);
    return id;
  }

  void put(std::uint64_t id, std::string line) {
    const std::lock_guard lock(mutex_);
    waiting_[id] = std::move(line);
    try {
      while (writable_ && !taken_.empty() && waiting_.contains(taken_.front())) {
        file_.append(waiting_[taken_.front()]);
        waiting_.erase(taken_.front());
        taken_.pop_front();
        ++work_.now;
        if (progress_) progress_(work_);
      }
    } catch (...) {
      writable_ = false;
      failure_ = std::current_exception();
    }
    changed_.notify_all();
  }

  /// A case has thrown: those before it are still written, none is handed out.
  void fail(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
    changed_.notify_all();
  }

  [[nodiscard]] ShardWork result() const {
    if (failure_) std::rethrow_exception(failure_);
    return work_;
  }

 private:
  std::uint64_t next_, stride_, end_;
  std::vector<bool> done_;
  ResultFile& file_;
  const ShardProgress& progress_;
  ShardWork work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::uint64_t> taken_;  ///< by id, not yet written
  std::map<std::uint64_t, std::string> waiting_;
  std::exception_ptr failure_;
  bool writable_ = true;
};

}  // namespace

ShardWork run_cases(const CaseSet& cases, const Shard& shard, const std::filesystem::path& folder, std::size_t jobs,
                    const LineOfCase& line_of, const ShardProgress& progress) {
  ResultFile file(folder, cases, shard);
  CaseQueue queue(cases, shard, done_before(cases, folder), file, progress);
  const auto work = [&] {
    try {
      while (const auto id = queue.take()) queue.put(*id, line_of(*id));
    } catch (...) {
      queue.fail(std::current_exception());
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t j = 1; j < jobs; ++j) threads.emplace_back(work);
    work();
  }
  return queue.result();
}

}  // namespace host_sim::sweep
