// What a board carries: the control loop for all rig kinds on a handful of registers, and no model of the rig around
// it. This program is what loop.ld holds to 78 KiB of flash and 16 KiB of RAM.
//
// The same source with RIGTWIN_SEMI_ACTIVE is a second program, of a larger board: the quarter car with Kalman filter
// and rollout beside the loop, and the hil rig with each compensation of its machine's delay, within 192 KiB of flash
// and 416 KiB of RAM (semi_active.ld).
#include <optional>

#include "tests/board/run.hpp"

#ifdef RIGTWIN_SEMI_ACTIVE
#include "firmware/loop/compensation/compensator.hpp"
#include "firmware/loop/semi_active.hpp"
#endif

namespace {

/// The rig as registers, and what is behind them: a drive that goes where it is told, a spring and a damper.
struct Registers {
  hal::Time now{};
  hal::Command command{};
  hal::Openings openings{};
  std::uint32_t beats = 0;
};

struct Clock final : hal::Clock {
  explicit Clock(Registers& r) : registers(r) {}
  hal::Time do_now() override { return registers.now; }
  void do_sleep_until(hal::Time deadline) override { registers.now = deadline; }
  Registers& registers;
};

struct Sensors final : hal::SensorSource {
  Sensors(Registers& r, const hal::SensorSetup& setup) : SensorSource(setup), registers(r) {}
  hal::Result<hal::Frame> do_read() override {
    const auto& drive = registers.command;
    // The wheel follows the drive, the body the wheel; more ducts, more force.
    wheel += 0.3 * (drive.position - wheel);
    body += 0.02 * (wheel - body);
    const double force = 31500.0 * drive.position + (500.0 + 10.0 * registers.openings.bits()) * drive.velocity;
    hal::Frame frame;
    const auto show = [&](model::Channel channel, double value) {
      if (fitted(model::index(channel))) {
        frame.channels[model::index(channel)] = {value, registers.now, hal::Quality::good};
      }
    };
    show(model::Channel::z_r, drive.position);
    show(model::Channel::zdd_r, drive.acceleration);
    show(model::Channel::zdd_w, 0.3 * drive.acceleration);
    show(model::Channel::zdd_b, 0.02 * drive.acceleration);
    show(model::Channel::dz_w, drive.position - wheel);
    show(model::Channel::dz_b, wheel - body);
    show(model::Channel::F_w, 200e3 * (drive.position - wheel));
    show(model::Channel::x_act, drive.position);
    show(model::Channel::F, force);
    return frame;
  }
  Registers& registers;
  double wheel = 0.0, body = 0.0;
};

struct Valves final : hal::ValveBank {
  explicit Valves(Registers& r) : ValveBank(6, hal::Openings::first(0)), registers(r) {}
  hal::Result<void> do_write(hal::Openings openings) override {
    registers.openings = openings;
    return {};
  }
  Registers& registers;
};

struct Drive final : hal::CommandOutput {
  explicit Drive(Registers& r) : registers(r) {}
  hal::Result<void> do_write(const hal::Command& command) override {
    registers.command = command;
    return {};
  }
  Registers& registers;
};

struct Button final : hal::StopButton {
  hal::Result<Level> do_read() override { return Level{}; }
};

struct Heartbeat final : hal::Heartbeat {
  explicit Heartbeat(Registers& r) : registers(r) {}
  hal::Result<void> do_beat() override {
    ++registers.beats;
    return {};
  }
  Registers& registers;
};

/// Two waves, each a pointer turned by the same angle every sample: 1.2 and 7 Hz.
class Waves final : public firmware::Reference {
  std::optional<firmware::Motion> do_at(std::uint64_t sample) override {
    if (sample >= board::samples) return std::nullopt;
    firmware::Motion motion{};
    for (Wave& wave : waves_) {
      if (sample > 0) {
        const double cosine = wave.cosine * wave.turn_cosine - wave.sine * wave.turn_sine;
        wave.sine = wave.sine * wave.turn_cosine + wave.cosine * wave.turn_sine;
        wave.cosine = cosine;
      }
      motion.position += wave.amplitude * wave.sine;
      motion.velocity += wave.amplitude * wave.omega * wave.cosine;
      motion.acceleration -= wave.amplitude * wave.omega * wave.omega * wave.sine;
    }
    return motion;
  }
  struct Wave {
    double amplitude, omega, turn_cosine, turn_sine;
    double cosine = 1.0, sine = 0.0;
  };
  std::array<Wave, 2> waves_{{{10e-3, 7.5398223686155035, 0.99997157567, 0.00753975092},
                              {1e-3, 43.982297150257104, 0.99903295476, 0.04396811802}}};
};

struct Board {
  explicit Board(const hal::SensorSetup& setup) : sensors(registers, setup) {}
  hal::Rig roles() { return {clock, sensors, valves, drive, button, heartbeat, enable, interlocks}; }

  Registers registers{};
  Clock clock{registers};
  Sensors sensors;
  Valves valves{registers};
  Drive drive{registers};
  Button button{};
  Heartbeat heartbeat{registers};
  hal::NoEnable enable{};
  hal::NoInterlocks interlocks{};
};

constexpr std::array<model::RigParameters<double>, 3> rigs{board::paper_rig(model::RigKind::hil),
                                                           board::paper_rig(model::RigKind::quarter_car),
                                                           board::paper_rig(model::RigKind::component_bench)};

hal::SensorSetup fitted(model::RigKind kind) {
  hal::SensorSetup setup;
  board::fit_sensors(kind, [&](model::Channel c) { setup[model::index(c)].fitted = true; });
  return setup;
}

#ifdef RIGTWIN_SEMI_ACTIVE
/// All sensors of the quarter car, one road state each of contact and foot point, 20 ms of valve delay.
firmware::SemiActive& semi_active(const model::RigParameters<double>& parameters, double period) {
  static firmware::KalmanSettings kalman;
  const auto noise = [](model::Channel channel, double rms) { kalman.noise[model::index(channel)] = rms; };
  noise(model::Channel::z_r, 2e-5);
  noise(model::Channel::zdd_r, 0.05);
  noise(model::Channel::zdd_w, 0.05);
  noise(model::Channel::zdd_b, 0.05);
  noise(model::Channel::F_w, 10.0);
  noise(model::Channel::dz_w, 5e-5);
  noise(model::Channel::dz_b, 5e-5);
  static constexpr firmware::DuctPolicySettings policy = [] {
    firmware::DuctPolicySettings rollout;
    rollout.policy = firmware::DuctPolicyKind::rollout;
    rollout.delay = 0.020;
    return rollout;
  }();
  static const firmware::EstimatorEquations equations(kalman, parameters);
  static firmware::SteadyGains gains(equations, period);
  // The registers below answer as no car does: the innovations are judged, and end nothing.
  static constexpr firmware::Supervision supervision = [] {
    firmware::Supervision wide;
    wide.innovation_share = 1e6;
    return wide;
  }();
  static firmware::SemiActive both(equations, gains, policy, period, supervision);
  return both;
}

/// Of a machine that is 5 ms late. (This one is not late: what counts here is work and bits.)
firmware::compensation::Compensator& compensator(const model::RigParameters<double>& parameters,
                                                 firmware::compensation::Kind kind, double period) {
  static firmware::compensation::Settings settings;
  settings.kind = kind;
  settings.machine.delay = 0.005;
  settings.damping = 300.0;
  settings.component = {parameters.suspension.stiffness, 0.0, true, parameters.fdva};
  static std::optional<firmware::compensation::Compensator> place;
  return place.emplace(settings, period);
}
using Compensations = std::optional<firmware::compensation::Kind>;
#else
struct Compensations {};
#endif

void ride(const model::RigParameters<double>& parameters, [[maybe_unused]] Compensations compensation = {}) {
  board::paint_stack();
  static std::optional<Board> rig;
  static std::optional<Waves> waves;
  static std::optional<firmware::ControlLoop> loop;
  static firmware::JournalStorage<2> storage;
  firmware::Journal journal(storage);
  // In flash: of the stack it would take what the effects' parameters need.
  static constexpr firmware::Settings settings = [] {
    firmware::Settings usual;
    usual.limits.speed = 5.0;
    return usual;
  }();
  rig.emplace(fitted(parameters.kind));
  loop.emplace(settings, parameters, rig->roles(), waves.emplace(), board::valves, journal);
  std::string_view name = model::name(parameters.kind);
#ifdef RIGTWIN_SEMI_ACTIVE
  if (compensation) {
    loop->attach(compensator(parameters, *compensation, settings.period.seconds()));
    name = firmware::compensation::name(*compensation);
  } else if (parameters.kind == model::RigKind::quarter_car) {
    loop->attach(semi_active(parameters, settings.period.seconds()));
  }
#endif
  const unsigned long deepest = board::deepest_stack();
  board::run(name, *loop, journal, rig->clock, deepest);
}

}  // namespace

extern "C" int trace() {
  board::start_timer();
#ifdef RIGTWIN_SEMI_ACTIVE
  ride(rigs[1]);
  ride(rigs[0]);
  for (std::size_t kind = 0; kind < firmware::compensation::kind_names.size(); ++kind) {
    ride(rigs[0], static_cast<firmware::compensation::Kind>(kind));
  }
#else
  for (const auto& rig : rigs) ride(rig);
#endif
  return 0;
}

#ifndef RIGTWIN_ON_BOARD
int main() { return trace(); }
#endif
