// Datagrams from the controller.
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "host_sim/watch/feed.hpp"

namespace host_sim::watch {

/// "localhost:9870", "127.0.0.1:9870" or "9870" taken apart; the host in numbers. UsageError: it is none.
struct ReceiveAddress {
  std::string host = "127.0.0.1";
  int port = 9870;
};
[[nodiscard]] ReceiveAddress parse_receive_address(const std::string& text);

/// Takes UDP datagrams in a thread of its own to the feed, while it lives.
class Receiver {
 public:
  /// UsageError: the address cannot be listened at. Port 0: any.
  Receiver(const ReceiveAddress& address, Feed& feed);
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  ~Receiver();

  [[nodiscard]] int port() const { return port_; }

 private:
  void receive();

  Feed& feed_;
  int socket_ = -1;
  int port_ = 0;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace host_sim::watch
