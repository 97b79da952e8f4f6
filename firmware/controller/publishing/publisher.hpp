// The thread that publishes the periods of a session as UDP datagrams.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "firmware/controller/publishing/datagram.hpp"
#include "firmware/controller/real_time/auxiliary_thread.hpp"
#include "firmware/controller/recording/live_tap.hpp"
#include "firmware/description/text/internet_address.hpp"

namespace firmware::controller {

/// Sends datagrams and never waits. Nobody need listen.
class DatagramSocket {
 public:
  /// `trouble`: why not.
  DatagramSocket(const InternetAddress& to, std::string& trouble);
  DatagramSocket(const DatagramSocket&) = delete;
  DatagramSocket& operator=(const DatagramSocket&) = delete;
  ~DatagramSocket();

  /// False: it was not sent.
  [[nodiscard]] bool send(const std::string& datagram) const;

 private:
  InternetAddress to_;
  int socket_ = -1;
};

/// Ordinary priority, off the loop's CPU. Takes records from the tap every 5 ms and sends each as a datagram, with what
/// was lost so far: what the tap had no room for, and what the kernel did not take.
class Publisher {
 public:
  /// References must outlive the publisher. `rate`: periods a second [Hz].
  Publisher(const cpu_set_t& cpus, LiveTap& tap, const DatagramWriter& writer, const DatagramSocket& socket,
            double rate);
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;
  ~Publisher() { finish(); }

  /// Sends what the tap still holds. Nothing is offered any more.
  void finish();
  /// The last datagram: why the session has ended. After finish().
  void say_end(const std::string& why);

  [[nodiscard]] std::uint64_t sent() const { return sent_.load(); }  ///< datagrams
  [[nodiscard]] std::uint64_t lost() const { return tap_.lost() + unsent_.load(); }

 private:
  void publish();
  void send_waiting();
  void send(const std::string& datagram);
  [[nodiscard]] DatagramWriter::Numbers numbers() const { return {sequence_, lost()}; }

  LiveTap& tap_;
  const DatagramWriter& writer_;
  const DatagramSocket& socket_;
  const std::uint64_t setup_every_;  ///< periods
  std::uint64_t next_setup_ = 0;     ///< period
  std::uint64_t sequence_ = 0;
  hal::Time time_{};  ///< of the last record
  std::atomic<bool> end_{false};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint64_t> unsent_{0};
  AuxiliaryThread thread_;  // last: it uses the others
};

}  // namespace firmware::controller
