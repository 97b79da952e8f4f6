#include "firmware/controller/recording/recording_thread.hpp"

#include <cstdio>
#include <string>

#include "firmware/recording/run_columns.hpp"
#include "hal/linux/clock.hpp"

namespace firmware::controller {

namespace {
constexpr std::size_t write_records = 512;  // at most so many between two writes, however fast they come
}

void print(const Spans& spans, double allowed_delay) {
  const std::string lines =
      line("wake-up latency", spans.wake_up) + line("step time", spans.step) + line("sample age", spans.age);
  std::fputs(lines.c_str(), stdout);
  const double delay = static_cast<double>(spans.age.quantile(0.999) + spans.step.quantile(0.999)) * 1e-9;
  if (allowed_delay > 0.0 && delay > allowed_delay) {
    std::printf("NOTE: samples and computation take %.3f ms (P99.9), stability leaves %.3f ms: this loop may grow\n",
                delay * 1e3, allowed_delay * 1e3);
  }
  std::fflush(stdout);
}

void RecordingThread::mark(const std::string& text) {
  const std::lock_guard<std::mutex> lock(marks_mutex_);
  marks_.push_back(text);
}

bool RecordingThread::finish(hal::Time patience) {
  end_.store(true);
  hal::linux::MonotonicClock clock;
  const hal::Time until = clock.now() + patience;
  while (!written_.load()) {
    if (clock.now() >= until) return false;
    clock.sleep_until(clock.now() + hal::milliseconds(1));
  }
  thread_.join();
  return true;
}

/// At once, before the disk: a console shows it, and systemd's journal keeps it.
void RecordingThread::say_news() {
  const std::string news = recorder_.news();
  if (news.empty()) return;
  const bool bad = news.starts_with("SAFE STOP") || news.find("then ") != std::string::npos;
  std::FILE* const stream = bad ? stderr : stdout;
  std::fprintf(stream, "rig_controller: %s\n", news.c_str());
  if (!news.starts_with("then ")) refused_.clear();  // another trip: said anew
  const std::string refused = refusals_ ? refusals_() : std::string();
  if (!refused.empty() && refused != refused_) {
    std::fprintf(stream, "rig_controller: not armed, failed checks: %s\n", refused.c_str());
    recorder_.mark("not armed, failed checks: " + refused);
  }
  refused_ = refused;
  std::fflush(stream);
}

void RecordingThread::write() {
  hal::linux::MonotonicClock clock;
  hal::Time synced = clock.now();
  for (bool last = false; !last;) {
    const bool end = end_.load();
    std::size_t taken = 0;
    for (; taken < write_records; ++taken) {
      const auto record = journal_.pop();
      if (!record) break;
      taken_.fetch_add(1, std::memory_order_relaxed);
      spans_.age.add((record->time - oldest_sample(*record)).ns);
      if (tap_ != nullptr) tap_->offer(*record);
      recorder_.take(*record);
    }
    say_news();
    {
      const std::lock_guard<std::mutex> lock(marks_mutex_);
      for (const std::string& text : marks_) recorder_.mark(text);
      marks_.clear();
    }
    const bool more = taken == write_records;
    last = end && !more;
    bool good = recorder_.flush();
    if (good && (last || clock.now() - synced >= hal::milliseconds(500))) {
      good = recorder_.sync();
      synced = clock.now();
    }
    if (print_.exchange(false)) print(spans_, allowed_delay_);
    if (!good) failed_.store(true);
    if (!last && !more) clock.sleep_until(clock.now() + hal::milliseconds(10));
  }
  written_.store(true);
}

}  // namespace firmware::controller
