// The HTTP server of `rigtwin watch`.
#pragma once

#include <memory>
#include <string>

#include "host_sim/watch/feed.hpp"

namespace host_sim::watch {

/// Serves one page, the events that move it, and takes its requests to the controller's socket:
///
///   GET  /?token=…        the page
///   GET  /events?token=…  server-sent events: a frame of the feed each 40 ms while datagrams come, else each 0.5 s;
///                         `controller` in it is the instance that answers the requests
///   POST /ask             one request as text, token in the header X-Rigtwin-Token; answers {"heard", "answer"}
///
/// Refused: a Host that is not this server's (421), a wrong token (403), an Origin that is not this server's (403), a
/// ninth watcher (503), a request that the socket does not know (400). The token is compared in constant time.
///
/// Every request but `stop` and `state` is sent for the instance whose values are shown; another program refuses it.
/// Slow and silent strangers delay nobody, and `stop` has a thread of its own (FrontDoor).
class WatchServer {
 public:
  struct Setup {
    std::string address = "127.0.0.1";  ///< of the network interface that it listens at
    int port = 8080;                    ///< 0: any that is free
    std::string socket;                 ///< of the controller
  };

  /// Listens from here on. UsageError: it cannot. The feed must outlive the server.
  WatchServer(const Setup& setup, const Feed& feed);
  WatchServer(const WatchServer&) = delete;
  WatchServer& operator=(const WatchServer&) = delete;
  ~WatchServer();

  [[nodiscard]] int port() const;
  [[nodiscard]] const std::string& token() const;
  /// Where the page is, with its token.
  [[nodiscard]] std::string url() const;

 private:
  class Implementation;  // httplib.h stays out of this header
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace host_sim::watch
