// What the recording's thread hands on to those who watch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/loop/journal.hpp"

namespace firmware::controller {

/// A second ring behind the journal: the recording's thread offers each record that it has taken from the journal, the
/// publisher takes them out. Neither waits for the other, and the loop's thread is not involved. A record that finds
/// the ring full is lost and counted.
///
/// Of every n records one is handed on, and each that begins another state or has another reason: those are not lost
/// by a decimation.
class LiveTap {
 public:
  static constexpr std::size_t usual_capacity = 4096;  ///< four seconds at 1 kHz

  explicit LiveTap(std::uint64_t every, std::size_t capacity = usual_capacity)
      : every_(every), storage_(capacity), ring_(storage_) {}
  LiveTap(const LiveTap&) = delete;
  LiveTap& operator=(const LiveTap&) = delete;
  ~LiveTap() = default;

  /// From the recording's thread only.
  void offer(const Record& record) {
    const bool due = offered_++ % every_ == 0;
    const bool changed =
        record.mode != last_.mode || record.trip.reason != last_.reason || record.second != last_.second;
    last_ = {record.mode, record.trip.reason, record.second};
    if (due || changed) ring_.push(record);
  }

  /// From the publisher only: the oldest record not yet taken.
  [[nodiscard]] std::optional<Record> pop() { return ring_.pop(); }

  [[nodiscard]] std::uint64_t every() const { return every_; }
  [[nodiscard]] std::size_t lost() const { return ring_.lost(); }

 private:
  struct Situation {
    Mode mode = Mode::idle;
    Reason reason = Reason::none;
    Reason second = Reason::none;
  };
  std::uint64_t every_;
  std::uint64_t offered_ = 0;
  Situation last_{};
  std::vector<Record> storage_;
  Journal ring_;
};

}  // namespace firmware::controller
