// A diagnosis of the controller whose datagrams a feed takes.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host_sim/live/live_diagnosis.hpp"
#include "host_sim/watch/feed.hpp"

namespace host_sim::live {

/// The samples of a datagram; NaN: it has none of that channel, or the period [s] was late.
[[nodiscard]] LiveSample sample_of(const watch::Datagram& datagram, double period);

/// Why the controller that sends this setup cannot be diagnosed with a description; nullopt: it can.
struct SetupObjection {
  std::string wrong, expected;
};
[[nodiscard]] std::optional<SetupObjection> setup_objection(const nlohmann::json& setup,
                                                            const firmware::RigDescription& description);

/// Takes the samples of runs (states running and holding) from the feed to a thread of its own, tells the feed what the
/// diagnosis says, and asks the controller for a stop where the description says so ([controller] model_watch). The stop is
/// for the program whose values were diagnosed; another one refuses it. Another program's values begin a new diagnosis.
class LiveWatch {
 public:
  struct State {
    Progress progress;
    std::vector<Finding> findings;
    std::string stop;              ///< what the controller was asked and has answered; empty: nothing
    bool stopped = false;          ///< the controller has heard it
    std::string error;             ///< why the diagnosis has ended, one line; empty: it goes on
    std::exception_ptr failure{};  ///< the same, to be thrown again
  };

  /// `socket`: of the controller. `told`: called from the thread with each finding and with the answer to a stop. The
  /// feed outlives this and has taken no datagram yet. InputError: this rig cannot be watched.
  LiveWatch(const firmware::RigDescription& description, std::string socket, watch::Feed& feed,
            std::function<void(const std::string&)> told);
  LiveWatch(const LiveWatch&) = delete;
  LiveWatch& operator=(const LiveWatch&) = delete;
  ~LiveWatch();

  /// Waits until all samples so far are diagnosed.
  void finish();
  [[nodiscard]] State state() const;

 private:
  struct Received {
    LiveSample sample;
    std::string instance;
    std::optional<SetupObjection> objection;
    bool run = false;
  };

  void receive(const watch::Datagram& datagram);
  void work();
  void diagnose(const Received& received);
  void say();
  void stop_rig(const Finding& finding, const std::string& instance);

  const firmware::RigDescription description_;
  const std::string socket_;
  watch::Feed& feed_;
  const std::function<void(const std::string&)> told_;
  std::unique_ptr<LiveDiagnosis> diagnosis_;
  std::string instance_;
  double begun_ = 0.0;  ///< [s] of the first sample, on the controller's clock: times count from there
  double said_at_ = -1.0;
  mutable std::mutex mutex_;
  std::condition_variable news_, idle_;
  std::deque<Received> waiting_;
  bool busy_ = false, end_ = false;
  std::vector<Finding> earlier_;  ///< of programs before this one
  State state_;
  std::thread thread_;
};

}  // namespace host_sim::live
