// What is known of the rig that is watched: from datagrams to what a page is told.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host_sim/watch/datagram.hpp"
#include "host_sim/watch/envelope.hpp"

namespace host_sim::watch {

/// How a page stands to the publisher.
enum class Link : unsigned char {
  waiting,  ///< nothing has come yet
  live,
  gone,   ///< the datagrams have ceased, nobody said why
  ended,  ///< the controller has said that its session has ended
};

/// Takes datagrams from one thread, gives frames to others. A bounded history: 30 s in intervals of 5 ms, the last 60
/// changes of state.
///
/// One publisher at a time: while the datagrams of one come, those of another are counted and not used.
class Feed {
 public:
  static constexpr double interval = 0.005;       ///< of the envelope [s]: finer than a pixel of 10 s on 1280 pixels
  static constexpr double history = 30.0;         ///< [s]
  static constexpr double patience = 1.0;         ///< without a datagram: gone [s]; at least five of its intervals
  static constexpr std::size_t most_events = 60;  ///< changes of state that are kept

  /// What a page has been told already.
  struct Cursor {
    std::uint64_t history = 0, setup = 0, events = 0, model = 0;  ///< versions; 0: nothing
    std::int64_t interval = 0;
    std::uint64_t datagrams = 0;
  };

  Feed() : envelope_(interval, static_cast<std::size_t>(history / interval)) {}

  /// A datagram from `source` ("127.0.0.1:43210"), at `now` [s] on any clock that goes on evenly; `wall`: milliseconds
  /// since 1970, for the list of changes.
  void take(std::string_view text, const std::string& source, double now, std::int64_t wall);

  /// Called with every datagram of the publisher, in the thread that takes them: it must not wait. Set before the first.
  void tap(std::function<void(const Datagram&)> listener) { listener_ = std::move(listener); }

  /// What a diagnosis says of the rig: key `model` of the frames from now on.
  void say_model(nlohmann::json model);

  [[nodiscard]] Link link(double now) const;

  /// The instance whose values are shown; empty: none, or one that does not say it.
  [[nodiscard]] std::string instance() const;

  /// What is new since the cursor, as one object; the cursor moves on. Keys: link, silence, ended, instance, state,
  /// reason, second_reason, trip, timestamp, values, counts; while another program sends here `foreign`: {source,
  /// instance, rig}; when they have changed setup, events, model (say_model()), and traces {reset, width,
  /// i, low {F: […]}, high}: the complete intervals of the envelope, whose time is i·width.
  [[nodiscard]] nlohmann::json frame(Cursor& cursor, double now) const;

  /// True if datagrams have come since the cursor.
  [[nodiscard]] bool has_news(const Cursor& cursor) const;

 private:
  struct Event {
    std::int64_t wall;
    double timestamp;
    std::string state, text;
  };
  struct Foreign {
    std::string source, instance, rig;
    double at = 0.0;  ///< of its last datagram [s]
  };
  struct Counts {
    std::uint64_t received = 0, lost_on_the_way = 0, malformed = 0, foreign = 0;
  };

  [[nodiscard]] Link link_now(double now) const;
  [[nodiscard]] double allowed_silence() const;
  [[nodiscard]] nlohmann::json traces(Cursor& cursor) const;
  void note_foreign(const Datagram& datagram, const std::string& source, double now);
  void change_publisher(const std::string& source);
  void note_setup(const nlohmann::json& setup);
  void note_changes(const Datagram& next, std::int64_t wall);

  mutable std::mutex mutex_;
  Envelope envelope_;
  std::string source_;
  std::optional<Datagram> last_;
  double last_at_ = 0.0;  ///< [s]
  nlohmann::json setup_;
  std::deque<Event> events_;
  Counts counts_;
  std::optional<Foreign> foreign_;  ///< the last other program that sent here
  std::function<void(const Datagram&)> listener_;
  nlohmann::json model_;
  std::uint64_t model_version_ = 0;  ///< 0: nobody diagnoses
  std::uint64_t history_version_ = 1, setup_version_ = 1, events_version_ = 1;
};

}  // namespace host_sim::watch
