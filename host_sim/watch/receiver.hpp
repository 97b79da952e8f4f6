// Datagrams from the controller.
#pragma once

#include <atomic>
#include <thread>

#include "firmware/description/text/internet_address.hpp"
#include "host_sim/watch/feed.hpp"

namespace host_sim::watch {

/// Takes UDP datagrams in a thread of its own to the feed, while it lives.
class Receiver {
 public:
  /// UsageError: the address cannot be listened at. Port 0: any.
  Receiver(const firmware::InternetAddress& address, Feed& feed);
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  ~Receiver();

  [[nodiscard]] const firmware::InternetAddress& address() const { return address_; }  ///< with the port that it got

 private:
  void receive();

  Feed& feed_;
  int socket_ = -1;
  firmware::InternetAddress address_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace host_sim::watch
