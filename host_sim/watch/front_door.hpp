// Takes connections and reads requests, so that nobody who is slow keeps others waiting.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "firmware/description/text/internet_address.hpp"

namespace host_sim::watch {

/// Listens at one port. One thread reads what all connections send, without waiting for any of them; a request that has
/// come whole is answered by another thread:
///
///     connections ─▶ door (1 thread, poll) ─┬─▶ POST /ask with "stop": a thread of its own
///                                           └─▶ everything else: threads for watchers and requests
///
/// So a connection has a thread only once its request is there. One that has not sent it within two seconds is closed;
/// of more than 256 the one that came first is. A connection carries one request.
class FrontDoor {
 public:
  /// Answers the request `head_and_body` on the connected socket, which is closed afterwards.
  using Answer = std::function<void(int socket, const std::string& head_and_body)>;

  static constexpr std::size_t most_connections = 256;  ///< that have not sent their request yet
  static constexpr std::size_t most_waiting = 64;       ///< requests without a thread; more are closed
  static constexpr std::size_t longest_request = 16'384, longest_body = 1024;  ///< [bytes]

  /// Listens from here on. UsageError: it cannot. Port 0: any that is free.
  FrontDoor(const std::string& address, int port, std::size_t threads, Answer answer);
  FrontDoor(const FrontDoor&) = delete;
  FrontDoor& operator=(const FrontDoor&) = delete;
  ~FrontDoor();

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] int socket() const { return listening_; }

 private:
  struct Connection {
    int socket;
    std::int64_t until_ms;
    std::string received;
  };
  struct Request {
    int socket;
    std::string bytes;
  };
  struct Queue {
    std::deque<Request> requests;
    std::condition_variable news;
  };

  void watch_door();
  void accept_all();
  [[nodiscard]] bool read_on(Connection& connection);
  void hand_on(Connection& connection);
  void answer_all(Queue& queue);

  Answer answer_;
  int listening_ = -1;
  int port_ = -1;
  int wake_ = -1;  ///< eventfd that ends the door's poll
  std::list<Connection> connections_;
  std::mutex mutex_;
  bool end_ = false;
  Queue stops_, others_;
  std::vector<std::thread> threads_;
};

/// Whether the request is whole: 0: not yet; else its length. One that announces more than a body may have is whole
/// with its head: it is refused unread.
[[nodiscard]] std::size_t whole_request(const std::string& bytes);

/// True for POST /ask with the body "stop".
[[nodiscard]] bool is_stop_request(const std::string& request);

}  // namespace host_sim::watch
