#include "firmware/controller/lead.hpp"

#include <cstddef>

namespace firmware::controller {
namespace {

class Operator final : public Lead {
 public:
  void ask(ControlLoop& /*loop*/, std::uint64_t /*periods*/) override {}
  [[nodiscard]] bool goes_on(std::uint64_t /*periods*/) const override { return true; }
};

/// Arms at once, and starts as soon as the rig is armed.
class Automatic final : public Lead {
 public:
  void ask(ControlLoop& loop, std::uint64_t periods) override {
    if (periods == 0) loop.arm();
    if (periods == 0 || loop.mode() == Mode::armed) loop.start();
  }
};

/// Asks for what led the recorded run, in the same periods.
class Replay final : public Lead {
 public:
  explicit Replay(const ReplayedRun& run) : run_(run) {}
  void ask(ControlLoop& loop, std::uint64_t periods) override {
    const auto row = static_cast<std::size_t>(periods);
    const Mode mode = loop.mode();
    if (row == run_.stop_requested) loop.stop();
    for (const LevelChange& change : run_.levels) {
      if (change.row == row) static_cast<void>(loop.level(change.level));
    }
    if (row >= run_.modes.size()) return;
    const Mode next = run_.modes[row];
    const bool goes = next == Mode::ready || next == Mode::running;
    if (mode == Mode::idle && next != Mode::idle) loop.arm();
    if (goes && (mode == Mode::idle || mode == Mode::arming || mode == Mode::armed)) loop.start();
    if (mode == Mode::running && next == Mode::holding) loop.hold();
    if (mode == Mode::holding && next == Mode::running) loop.resume();
  }

 private:
  const ReplayedRun& run_;
};

}  // namespace

std::unique_ptr<Lead> lead_of(const Options& options, const ReplayedRun* replayed) {
  if (is_operated(options)) return std::make_unique<Operator>();
  if (replayed != nullptr && !replayed->modes.empty()) return std::make_unique<Replay>(*replayed);
  return std::make_unique<Automatic>();
}

}  // namespace firmware::controller
