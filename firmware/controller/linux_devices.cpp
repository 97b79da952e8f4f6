#include <optional>
#include <vector>

#include "firmware/controller/devices.hpp"
#include "firmware/controller/replay_devices.hpp"
#include "firmware/controller/simulated_devices.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "hal/linux/clock.hpp"
#include "hal/linux/gpio_roles.hpp"
#include "hal/linux/iio.hpp"
#include "hal/linux/rf60x_laser.hpp"

namespace firmware::controller {
namespace {

using namespace hal::linux;
constexpr const char* consumer = "rig_controller";

class NoValves final : public hal::ValveBank {
 public:
  NoValves() : ValveBank(0, {}) {}

 private:
  hal::Result<void> do_write(hal::Openings) override { return {}; }
};

class NoWatchdog final : public hal::Heartbeat {
 private:
  hal::Result<void> do_beat() override { return {}; }
};

class LinuxDevices final : public Devices {
 public:
  [[nodiscard]] hal::Rig roles() override {
    return {clock_, *sensors_, *valves_, *command_, *stop_, *heartbeat_, no_enable_, no_interlocks_};
  }

  [[nodiscard]] std::string warnings() const override {
    std::string text;
    for (const Rf60xLaser* laser : lasers_) {
      const std::string warning = laser->warning(period_);
      if (!warning.empty()) text += warning + "\n";
    }
    if (command_->limit().limited() > 0) {
      text += std::to_string(command_->limit().limited()) + " commands were limited before they left\n";
    }
    return text;
  }

  [[nodiscard]] std::string text() const override { return text_; }

  /// One line of trouble, or nothing.
  [[nodiscard]] std::string open(const RigDescription& rig) {
    period_ = hal::seconds(rig.period());
    for (const auto& step : {&LinuxDevices::open_lines, &LinuxDevices::open_command, &LinuxDevices::open_sensors}) {
      std::string trouble = (this->*step)(rig);
      if (!trouble.empty()) return trouble;
    }
    return {};
  }

 private:
  std::string open_lines(const RigDescription& rig) {
    if (!rig.hardware.gpio)
      return rig.source + ": no table [gpio], expected chip, valves, stop and heartbeat of the rig";
    const GpioDescription& gpio = *rig.hardware.gpio;
    if (gpio.stop.empty()) return rig.source + ": [gpio] has no stop, expected the line of the stop button";
    const auto ducts = rig.rig.has_fdva ? static_cast<std::size_t>(rig.rig.fdva.ducts) : 0;
    if (ducts != gpio.valves.size()) return rig.source + ": [gpio] has no valves, expected a line for each duct";
    if (ducts > 0) {
      const auto safe = hal::Openings::from_bits(rig.controller.safe_ducts);
      auto lines = OutputLines::open({gpio.chip, gpio.valves, gpio.valves_active_low, safe.bits(), consumer});
      if (!lines) return lines.trouble;
      valves_ = std::make_unique<GpioValveBank>(std::move(lines.device), ducts, safe);
      text_ += "valves: " + std::to_string(ducts) + " lines of chip '" + gpio.chip + "', in the safe position\n";
    } else {
      valves_ = std::make_unique<NoValves>();
    }
    const Bias bias = gpio.stop_bias == "pull-up"     ? Bias::pull_up
                      : gpio.stop_bias == "pull-down" ? Bias::pull_down
                                                      : Bias::as_is;
    auto line = EdgeLine::open({gpio.chip, gpio.stop, gpio.stop_active_low, bias, consumer});
    if (!line) return line.trouble;
    stop_ = std::make_unique<GpioStopButton>(std::move(line.device), clock_);
    const auto pressed = stop_->pressed();
    if (!pressed || *pressed) {
      return "stop button, line '" + gpio.stop + "' of chip '" + gpio.chip +
             "': " + (pressed ? "is pressed; release it, or correct stop_active_low" : "cannot be read");
    }
    text_ += "stop button: line '" + gpio.stop + "', not pressed\n";
    if (gpio.heartbeat.empty()) {
      heartbeat_ = std::make_unique<NoWatchdog>();
      text_ += "heartbeat: NONE: nobody makes the valves safe when this program hangs\n";
      return {};
    }
    auto beat = OutputLines::open({gpio.chip, {gpio.heartbeat}, false, 0, consumer});
    if (!beat) return beat.trouble;
    heartbeat_ = std::make_unique<GpioHeartbeat>(std::move(beat.device));
    text_ += "heartbeat: line '" + gpio.heartbeat + "'\n";
    return {};
  }

  std::string open_sensors(const RigDescription& rig) {
    hal::SensorSetup setup{};
    std::vector<std::unique_ptr<SensorPart>> parts;
    const auto fit = [&](std::size_t channel) -> std::string {
      const model::Channel name = model::channel_at(channel);
      if (!is_hardware_channel(rig.rig.kind, name) || setup[channel].fitted) {
        return rig.source + ": channel " + std::string(model::name(name)) +
               (setup[channel].fitted ? " has two sensors" : " is no measured one of this kind of rig") +
               ", expected one device for each measured channel";
      }
      setup[channel].fitted = true;
      if (const auto& range = rig.range[channel]) {
        setup[channel].lowest = range->lower;
        setup[channel].highest = range->upper;
      }
      return {};
    };
    if (const auto& converters = rig.hardware.converters; converters && !converters->inputs.empty()) {
      IioConverters::Wanted wanted{converters->trigger, converters->trigger_rate, {}};
      for (const auto& input : converters->inputs) {
        if (std::string trouble = fit(input.channel); !trouble.empty()) return trouble;
        wanted.inputs.push_back({input.channel, input.device, input.input, input.scale, input.offset});
      }
      auto opened = IioConverters::open(wanted);
      if (!opened) return opened.trouble;
      parts.push_back(std::move(opened.device));
      text_ += "converters: " + std::to_string(wanted.inputs.size()) + " channels, trigger '" + wanted.trigger + "'\n";
    }
    for (const auto& laser : rig.hardware.lasers) {
      if (std::string trouble = fit(laser.channel); !trouble.empty()) return trouble;
      auto opened =
          Rf60xLaser::open({laser.port, static_cast<unsigned>(laser.baud), static_cast<unsigned>(laser.address),
                            laser.channel, laser.range, laser.scale, laser.offset});
      if (!opened) return opened.trouble;
      lasers_.push_back(opened.device.get());
      parts.push_back(std::move(opened.device));
      text_ += "laser: " + std::string(model::name(model::channel_at(laser.channel))) + " at " + laser.port + "\n";
    }
    if (parts.empty()) return rig.source + ": no sensors, expected [converters.F] and the like, or [lasers.dz_b]";
    sensors_ = std::make_unique<Sensors>(setup, clock_, std::move(parts));
    return {};
  }

  std::string open_command(const RigDescription& rig) {
    const auto& converters = rig.hardware.converters;
    if (!converters || !converters->command) {
      return rig.source + ": no table [converters.command], expected the converter that moves the drive";
    }
    const auto& output = *converters->command;
    IioCommand::Wanted wanted;
    wanted.device = output.device;
    wanted.output = output.output;
    wanted.scale = output.scale;
    wanted.offset = output.offset;
    wanted.lowest_counts = output.lowest_counts;
    wanted.highest_counts = output.highest_counts;
    wanted.bounds = {-0.5 * rig.controller.stroke, 0.5 * rig.controller.stroke, rig.controller.speed,
                     2.0 * rig.period()};
    auto opened = IioCommand::open(wanted, clock_);
    if (!opened) return opened.trouble;
    command_ = std::move(opened.device);
    text_ += "command: converter '" + output.device + "', output '" + output.output + "'\n";
    return {};
  }

  hal::NoEnable no_enable_;
  hal::NoInterlocks no_interlocks_;
  MonotonicClock clock_;
  hal::Time period_{};
  std::unique_ptr<hal::ValveBank> valves_;
  std::unique_ptr<GpioStopButton> stop_;
  std::unique_ptr<hal::Heartbeat> heartbeat_;
  std::unique_ptr<Sensors> sensors_;
  std::vector<const Rf60xLaser*> lasers_;
  std::unique_ptr<IioCommand> command_;
  std::string text_;
};

}  // namespace

std::unique_ptr<Devices> open_devices(const RigDescription& rig, const Options& options, std::string& trouble) {
  if (!options.replay.empty()) return replay_devices(rig, options);
  if (options.simulated) return simulate_devices(rig, options);
  auto devices = std::make_unique<LinuxDevices>();
  trouble = devices->open(rig);
  if (!trouble.empty()) return nullptr;
  return devices;
}

}  // namespace firmware::controller
