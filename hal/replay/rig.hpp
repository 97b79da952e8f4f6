// A rig that is a recording.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/replay/recording.hpp"
#include "hal/rig.hpp"

namespace hal::replay {

/// Where a replay keeps what the program writes; an empty span keeps nothing of its kind (and counts it as lost).
struct OutputStorage {
  std::span<Written<Command>> commands{};
  std::span<Written<Openings>> openings{};
  std::span<Written<std::uint64_t>> beats{};  ///< numbered from 0
};

/// All roles of a rig, played from a recording: the same program gives the same outputs, to the bit.
///
/// One sleep is one row, whatever the deadline; the clock shows the time of the row, so a late period of the recorded
/// run is late again. After the last row the sensors are disconnected. Outputs go to the storage and succeed, but
/// for the one that the recorded rig refused.
class Rig {
 public:
  /// Ranges are checked as on the rig: give the setup of the recorded run. Fitted is what has a column in both.
  Rig(const Recording& recording, const SensorSetup& setup, std::size_t ducts, Openings safe_position,
      const OutputStorage& storage);
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  ~Rig() = default;

  [[nodiscard]] hal::Rig roles();

  /// True when the row after the last one is reached.
  [[nodiscard]] bool ended() const { return row_ >= recording_.time.size(); }

  [[nodiscard]] const Track<Command>& commands() const { return commands_; }
  [[nodiscard]] bool enabled() const { return enabled_; }  ///< as last written
  [[nodiscard]] const Track<Openings>& openings() const { return openings_; }
  [[nodiscard]] const Track<std::uint64_t>& beats() const { return beats_; }

 private:
  struct ClockRole final : Clock {
    explicit ClockRole(Rig& r) : rig(r) {}
    Time do_now() override { return rig.now(); }
    Time do_suspended() override;
    void do_sleep_until(Time deadline) override;
    Rig& rig;
  };
  struct SensorRole final : SensorSource {
    SensorRole(Rig& r, const SensorSetup& setup) : SensorSource(setup), rig(r) {}
    Result<Frame> do_read() override;
    Rig& rig;
  };
  struct AreaRole final : AreaOutput {
    Result<void> do_write(double /*area*/) override { return {}; }
  };
  struct ValveRole final : ValveBank {
    ValveRole(Rig& r, std::size_t ducts, Openings safe) : ValveBank(ducts, safe), rig(r) {}
    Result<void> do_write(Openings openings) override;
    Rig& rig;
  };
  struct CommandRole final : CommandOutput {
    explicit CommandRole(Rig& r) : rig(r) {}
    Result<void> do_write(const Command& command) override;
    Result<double> do_read_back() override { return rig.held_; }
    Rig& rig;
  };
  struct ButtonRole final : StopButton {
    explicit ButtonRole(Rig& r) : rig(r) {}
    Result<Level> do_read() override;
    Rig& rig;
  };
  struct HeartbeatRole final : Heartbeat {
    explicit HeartbeatRole(Rig& r) : rig(r) {}
    Result<void> do_beat() override;
    Rig& rig;
  };

  struct EnableRole final : DriveEnable {
    EnableRole(Rig& r, bool was_fitted) : rig(r), recorded(was_fitted) {}
    [[nodiscard]] bool fitted() const override { return recorded; }
    Result<void> do_write(bool on) override;
    Rig& rig;
    bool recorded;
  };
  struct InterlockRole final : Interlocks {
    explicit InterlockRole(Rig& r) : Interlocks(capacity), rig(r) {}
    Result<std::uint32_t> do_read() override;
    Rig& rig;
  };

  [[nodiscard]] Time now() const;
  [[nodiscard]] bool refuses(Refusal::Output output) const;

  Recording recording_;
  std::size_t row_ = 0;
  bool started_ = false;  ///< the first sleep leads to the first row
  Track<Command> commands_;
  Track<Openings> openings_;
  Track<std::uint64_t> beats_;
  std::uint64_t beat_count_ = 0;
  double held_ = 0.0;  ///< position last commanded [m]
  bool enabled_ = false;

  ClockRole clock_role_{*this};
  SensorRole sensor_role_;
  ValveRole valve_role_;
  CommandRole command_role_{*this};
  ButtonRole button_role_{*this};
  HeartbeatRole heartbeat_role_{*this};
  EnableRole enable_role_;
  InterlockRole interlock_role_;
  AreaRole area_role_{};
};

}  // namespace hal::replay
