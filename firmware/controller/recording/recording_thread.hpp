// The thread that writes the recording: it alone waits for the disk.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "firmware/controller/real_time/auxiliary_thread.hpp"
#include "firmware/controller/recording/live_tap.hpp"
#include "firmware/controller/recording/recorder.hpp"
#include "firmware/controller/recording/spans.hpp"
#include "firmware/loop/journal.hpp"
#include "hal/time.hpp"

namespace firmware::controller {

/// Wake-up latency, step time and age of samples on standard output, with a note if the loop is slower than
/// `allowed_delay` [s] (0: unknown).
void print(const Spans& spans, double allowed_delay);

/// Takes the records of the journal to the recorder, and twice a second the recording to the disk.
class RecordingThread {
 public:
  /// `tap`: those who watch get the records too; none: nobody watches. `refusals`: all checks that the last arming has
  /// failed, in words, or nothing.
  RecordingThread(const cpu_set_t& cpus, Journal& journal, Recorder& recorder, Spans& spans, double allowed_delay,
                  LiveTap* tap, std::function<std::string()> refusals)
      : journal_(journal),
        recorder_(recorder),
        spans_(spans),
        allowed_delay_(allowed_delay),
        tap_(tap),
        refusals_(std::move(refusals)),
        thread_(cpus, [this] { write(); }) {}

  /// Asks for the rest of the journal to be written, and waits for that at most for this long. False: the disk still
  /// stalls; this object and the recorder must then stay.
  [[nodiscard]] bool finish(hal::Time patience);

  /// Has a comment written between the rows. From any thread but the loop's.
  void mark(const std::string& text);
  /// Has the histograms printed. From any thread.
  void print_soon() { print_.store(true); }

  [[nodiscard]] std::uint64_t taken() const { return taken_.load(std::memory_order_relaxed); }  ///< records so far
  [[nodiscard]] bool failed() const { return failed_.load(); }  ///< the recording cannot be written

 private:
  void write();
  void say_news();

  Journal& journal_;
  Recorder& recorder_;
  Spans& spans_;
  double allowed_delay_;  ///< [s]; 0: unknown
  LiveTap* tap_;
  std::function<std::string()> refusals_;
  std::string refused_;  ///< said last
  std::atomic<bool> end_{false};
  std::atomic<bool> print_{false};
  std::mutex marks_mutex_;
  std::vector<std::string> marks_;
  std::atomic<bool> written_{false};
  std::atomic<bool> failed_{false};
  std::atomic<std::uint64_t> taken_{0};
  AuxiliaryThread thread_;  // last: it uses the others
};

}  // namespace firmware::controller
