// A rig that exists only in the computer.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/rig.hpp"
#include "hal/simulated/channel_faults.hpp"
#include "hal/simulated/fault_plan.hpp"
#include "hal/simulated/plant.hpp"
#include "hal/stop_channels.hpp"

namespace hal::simulated {

/// How the simulated rig is built.
struct Construction {
  Time period{};              ///< grid of the plant: one advance a period [> 0]
  Time start{};               ///< time of the first instant
  SensorSetup sensors{};      ///< which channels are fitted, and their ranges
  std::size_t ducts = 0;      ///< valves installed
  Openings safe_position{};   ///< where they fall to without a heartbeat
  Time watchdog{};            ///< valves fall to the safe position so long after the last beat; 0: no watchdog
  Command rest{};             ///< the command that the drive holds before it is given one
  bool drive_enable = false;  ///< the drive has an enable input, off at first; false: it has power at all times
  double coasting = 20.0;     ///< deceleration of a drive that loses its enable [m/s², > 0]
  std::size_t interlocks = 0;
  bool enable_feedback = false;  ///< a contact shows whether the drive has power
  bool high_pressure = false;    ///< the power unit has a second stage
};

/// All roles of a rig around a plant, in virtual time.
///
/// Time passes only in Clock::sleep_until, which advances the plant through every instant of its grid up to the new
/// time. Sensors deliver the newest instant, stamped with its time. Outputs hold until written anew. Seeded and
/// deterministic: the same plant, plan and calls give the same bits.
///
/// A drive without its enable coasts to a stop and stays there, whatever is commanded; with it, it is at the held
/// command at the end of the next period: a jump, if the command is elsewhere. A watchdog takes the enable away too.
class Rig {
 public:
  /// The plant and the lists of the plan must outlive the rig.
  Rig(Plant& plant, const Construction& construction, const FaultPlan& plan = {});
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  ~Rig() = default;

  [[nodiscard]] hal::Rig roles();

  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const Command& command() const { return held_command_; }  ///< what the drive holds
  [[nodiscard]] Openings openings() const;                                ///< where the valves stand now
  [[nodiscard]] bool watchdog_has_acted() const;                          ///< beats have ceased for too long
  [[nodiscard]] std::uint64_t beats() const { return beats_; }
  [[nodiscard]] bool enabled() const { return enabled_; }              ///< as the enable was last written
  [[nodiscard]] bool high_pressure() const { return high_pressure_; }  ///< the second stage, as last written
  [[nodiscard]] bool powered() const;                                  ///< the drive has power: it follows the command
  [[nodiscard]] const Command& drive() const { return drive_; }        ///< what the drive did last

 private:
  struct ClockRole final : Clock {
    explicit ClockRole(Rig& r) : rig(r) {}
    Time do_now() override { return rig.now_; }
    Time do_suspended() override;
    void do_sleep_until(Time deadline) override { rig.pass_time(deadline); }
    Rig& rig;
  };
  struct SensorRole final : SensorSource {
    SensorRole(Rig& r, const SensorSetup& setup) : SensorSource(setup), rig(r) {}
    Result<Frame> do_read() override;
    Rig& rig;
  };
  struct ValveRole final : ValveBank {
    ValveRole(Rig& r, std::size_t ducts, Openings safe) : ValveBank(ducts, safe), rig(r) {}
    Result<void> do_write(Openings openings) override;
    Rig& rig;
  };
  struct CommandRole final : CommandOutput {
    explicit CommandRole(Rig& r) : rig(r) {}
    Result<void> do_write(const Command& command) override;
    Result<double> do_read_back() override;
    Rig& rig;
  };
  struct AreaRole final : AreaOutput {
    explicit AreaRole(Rig& r) : rig(r) {}
    Result<void> do_write(double area) override;
    Rig& rig;
  };
  struct ButtonRole final : StopButton {
    explicit ButtonRole(Rig& r) : rig(r) {}
    Result<Level> do_read() override;
    Rig& rig;
    Time last_read = never;
    Time first_opened = never, second_opened = never;  ///< its contacts, last
    StopChannels channels{};
  };
  struct HeartbeatRole final : Heartbeat {
    explicit HeartbeatRole(Rig& r) : rig(r) {}
    Result<void> do_beat() override;
    Rig& rig;
  };

  struct EnableRole final : DriveEnable {
    explicit EnableRole(Rig& r) : rig(r) {}
    [[nodiscard]] bool fitted() const override { return rig.construction_.drive_enable; }
    [[nodiscard]] bool feedback_fitted() const override { return rig.construction_.enable_feedback; }
    Result<void> do_write(bool on) override;
    Result<bool> do_feedback() override;
    Rig& rig;
  };
  struct PressureRole final : DriveEnable {
    explicit PressureRole(Rig& r) : rig(r) {}
    Result<void> do_write(bool on) override;
    Rig& rig;
  };
  struct InterlockRole final : Interlocks {
    InterlockRole(Rig& r, std::size_t count) : Interlocks(count), rig(r) {}
    Result<std::uint32_t> do_read() override;
    Rig& rig;
    Time last_read = never;
  };

  void pass_time(Time deadline);
  void move_drive();
  [[nodiscard]] bool contact_closed() const;
  void measure();
  [[nodiscard]] std::optional<Fault> fault_of(DeviceFault::Device device) const;

  Plant& plant_;
  Construction construction_;
  FaultPlan plan_;
  ChannelFaults channel_faults_;
  Time now_;
  Time instant_;           ///< newest instant of the plant's grid
  bool measured_ = false;  ///< has the plant been measured at instant_?
  Frame frame_{};          ///< what the sensors delivered at instant_
  Command held_command_;
  bool enabled_;
  bool high_pressure_ = false;
  Command drive_;  ///< where it is at instant_: it follows the command, or coasts to a stop
  Openings held_openings_;
  Time last_beat_;
  std::uint64_t beats_ = 0;

  ClockRole clock_role_{*this};
  SensorRole sensor_role_;
  ValveRole valve_role_;
  CommandRole command_role_{*this};
  ButtonRole button_role_{*this};
  HeartbeatRole heartbeat_role_{*this};
  EnableRole enable_role_{*this};
  PressureRole pressure_role_{*this};
  InterlockRole interlock_role_;
  AreaRole area_role_{*this};
};

}  // namespace hal::simulated
