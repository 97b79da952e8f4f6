// Who asks the loop of a session for what leads to a run.
#pragma once

#include <cstdint>
#include <memory>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/devices/options.hpp"
#include "firmware/loop/control_loop.hpp"

namespace firmware::controller {

/// An operator, who asks by the socket; nobody, then the program arms and starts; a recording that is replayed.
class Lead {
 public:
  Lead() = default;
  Lead(const Lead&) = delete;
  Lead& operator=(const Lead&) = delete;
  virtual ~Lead() = default;

  /// Before a period, on the loop's thread; `periods` are over.
  virtual void ask(ControlLoop& loop, std::uint64_t periods) = 0;
  /// Whether a rig in safe is to be led on. If not, the session ends once it is at rest.
  [[nodiscard]] virtual bool goes_on(std::uint64_t /*periods*/) const { return false; }
};

/// `replayed`: nothing but for a replay.
[[nodiscard]] std::unique_ptr<Lead> lead_of(const Options& options, const ReplayedRun* replayed);

/// Somebody arms and starts by the socket.
[[nodiscard]] inline bool is_operated(const Options& options) {
  return options.wait || !(options.start || options.simulated || !options.replay.empty());
}

}  // namespace firmware::controller
