#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/controller/devices/devices.hpp"
#include "firmware/controller/devices/replay_devices.hpp"
#include "firmware/controller/devices/simulated_devices.hpp"
#include "firmware/description/text/input_error.hpp"
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

/// Only where a waiver says why.
class NoStop final : public hal::StopButton {
 private:
  hal::Result<Level> do_read() override { return Level{}; }
};

IioOutput::Wanted wanted_output(const ConverterDescription::Output& described) {
  return {described.device, described.output,        described.scale,
          described.offset, described.lowest_counts, described.highest_counts};
}

class LinuxDevices final : public Devices {
 public:
  [[nodiscard]] hal::Rig roles() override {
    return {clock_,      *sensors_, *valves_,     *command_,   *stop_,
            *heartbeat_, *enable_,  *interlocks_, area_.get(), high_pressure_.get()};
  }

  [[nodiscard]] std::vector<StopContact> stop_contacts() const override {
    if (!gpio_stop_) return {};
    std::vector<StopContact> contacts{{stop_line_, gpio_stop_->opened().first}};
    if (!stop_2_line_.empty()) contacts.push_back({stop_2_line_, gpio_stop_->opened().second});
    return contacts;
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
    for (const auto& step : {&LinuxDevices::open_lines, &LinuxDevices::open_command, &LinuxDevices::open_area,
                             &LinuxDevices::open_sensors}) {
      std::string trouble = (this->*step)(rig);
      if (!trouble.empty()) return trouble;
    }
    return {};
  }

 private:
  std::string open_lines(const RigDescription& rig) {
    if (!rig.hardware.gpio)
      return rig.source + ": no table [gpio], expected chip, valves, stop, enable and heartbeat of the rig";
    const GpioDescription& gpio = *rig.hardware.gpio;
    check_wiring(rig);
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
    for (const auto& step : {&LinuxDevices::open_enable, &LinuxDevices::open_stop, &LinuxDevices::open_interlocks,
                             &LinuxDevices::open_heartbeat}) {
      std::string trouble = (this->*step)(gpio);
      if (!trouble.empty()) return trouble;
    }
    for (const auto& [name, sentence] : rig.waivers) text_ += "WAIVER " + name + ": " + one_line(sentence) + "\n";
    return {};
  }

  static Bias bias_of(std::string_view bias) {
    return bias == "pull-up" ? Bias::pull_up : bias == "pull-down" ? Bias::pull_down : Bias::as_is;
  }

  std::string open_enable(const GpioDescription& gpio) {
    if (gpio.enable.empty()) {
      enable_ = std::make_unique<hal::NoEnable>();
      text_ += "drive enable: NONE: nobody takes the power from the drive\n";
      return {};
    }
    auto line = OutputLines::open({gpio.chip, {gpio.enable}, gpio.enable_active_low, 0, consumer});
    if (!line) return line.trouble;
    Opened<EdgeLine> feedback;
    text_ += "drive enable: line '" + gpio.enable + "', off";
    if (gpio.enable_feedback.empty()) {
      text_ += ", NO FEEDBACK: a welded relay is seen by its motion only\n";
    } else {  // a contact that is closed without power: open, and a cut wire, show power
      const std::string& bias = gpio.enable_feedback_bias;
      feedback = EdgeLine::open({gpio.chip, gpio.enable_feedback, pulls_down(bias), bias_of(bias), consumer});
      if (!feedback) return feedback.trouble;
      const auto shown = feedback.device->read();
      text_ += ", feedback: line '" + gpio.enable_feedback + "', " +
               (!shown       ? "CANNOT BE READ"
                : shown->now ? "SHOWS POWER"
                             : "no power") +
               "\n";
    }
    enable_ = std::make_unique<GpioDriveEnable>(std::move(line.device), std::move(feedback.device));
    return open_high_pressure(gpio);
  }

  std::string open_high_pressure(const GpioDescription& gpio) {
    if (gpio.high_pressure.empty()) return {};
    auto line = OutputLines::open({gpio.chip, {gpio.high_pressure}, false, 0, consumer});
    if (!line) return line.trouble;
    text_ += "high pressure: line '" + gpio.high_pressure + "', off\n";
    high_pressure_ = std::make_unique<GpioDriveEnable>(std::move(line.device), nullptr);
    return {};
  }

  std::string open_stop(const GpioDescription& gpio) {
    if (gpio.stop.empty()) {
      stop_ = std::make_unique<NoStop>();
      text_ += "stop button: NONE\n";
      return {};
    }
    const Bias bias = bias_of(gpio.stop_bias);
    auto first = EdgeLine::open({gpio.chip, gpio.stop, gpio.stop_active_low, bias, consumer});
    if (!first) return first.trouble;
    Opened<EdgeLine> second;
    if (!gpio.stop_2.empty()) {
      second = EdgeLine::open({gpio.chip, gpio.stop_2, gpio.stop_active_low, bias, consumer});
      if (!second) return second.trouble;
    }
    auto button = std::make_unique<GpioStopButton>(std::move(first.device), std::move(second.device), clock_);
    gpio_stop_ = button.get();
    stop_ = std::move(button);
    stop_line_ = gpio.stop;
    stop_2_line_ = gpio.stop_2;
    const auto pressed = stop_->pressed();
    if (!pressed || *pressed) {
      return "stop button, line '" + gpio.stop + "' of chip '" + gpio.chip +
             "': " + (pressed ? "is pressed, or its wire is cut; release it, or mend the wiring" : "cannot be read");
    }
    text_ += "stop button: line '" + gpio.stop + "'" +
             (gpio.stop_2.empty() ? ", ONE CONTACT: a short circuit across it is not seen"
                                  : " and line '" + gpio.stop_2 + "'") +
             ", not pressed\n";
    return {};
  }

  std::string open_interlocks(const GpioDescription& gpio) {
    std::vector<std::unique_ptr<EdgeLine>> lines;
    for (const auto& [name, line] : gpio.interlocks) {
      auto opened =
          EdgeLine::open({gpio.chip, line, pulls_down(gpio.interlock_bias), bias_of(gpio.interlock_bias), consumer});
      if (!opened) return opened.trouble;
      const auto state = opened.device->read();
      const std::string shows = !state ? "CANNOT BE READ" : state->now ? "OPEN" : "closed";
      text_ += "interlock " + name + ": line '" + line + "', " + shows + "\n";
      lines.push_back(std::move(opened.device));
    }
    if (lines.empty()) text_ += "interlocks: NONE\n";
    interlocks_ = std::make_unique<GpioInterlocks>(std::move(lines));
    return {};
  }

  std::string open_heartbeat(const GpioDescription& gpio) {
    if (gpio.heartbeat.empty()) {
      heartbeat_ = std::make_unique<NoWatchdog>();
      text_ += "heartbeat: NONE: nobody makes the rig safe when this program hangs\n";
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
      if (const auto range = trusted_range(rig, channel)) {
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
      text_ +=
          "laser: " + std::string(model::name(model::channel_at(laser.channel))) + " at " + laser.port +
          (opened.device->low_latency() ? ", low latency\n"
                                        : ", its driver grants NO LOW LATENCY: samples may be up to 16 ms older\n");
      lasers_.push_back(opened.device.get());
      parts.push_back(std::move(opened.device));
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
    IioCommand::Wanted wanted{.output = wanted_output(output)};
    wanted.bounds = {-0.5 * rig.controller.stroke, 0.5 * rig.controller.stroke, rig.controller.speed,
                     2.0 * rig.period()};
    auto opened = IioCommand::open(wanted, clock_);
    if (!opened) return opened.trouble;
    command_ = std::move(opened.device);
    text_ += "command: converter '" + output.device + "', output '" + output.output + "'\n";
    return {};
  }

  std::string open_area(const RigDescription& rig) {
    const auto& converters = rig.hardware.converters;
    if (!(rig.rig.air_spring.skyhook > 0.0)) return {};
    if (!converters || !converters->area) {
      return rig.source + ": no table [converters.area], expected the converter that sets the area of the air spring";
    }
    const auto& output = *converters->area;
    auto opened = IioArea::open(wanted_output(output));
    if (!opened) return opened.trouble;
    area_ = std::move(opened.device);
    text_ += "area of the air spring: converter '" + output.device + "', output '" + output.output + "', at rest\n";
    return {};
  }

  MonotonicClock clock_;
  hal::Time period_{};
  std::unique_ptr<hal::ValveBank> valves_;
  std::unique_ptr<hal::StopButton> stop_;
  const GpioStopButton* gpio_stop_ = nullptr;
  std::string stop_line_, stop_2_line_;
  std::unique_ptr<hal::DriveEnable> enable_;
  std::unique_ptr<hal::DriveEnable> high_pressure_;  ///< none: one stage
  std::unique_ptr<hal::Interlocks> interlocks_;
  std::unique_ptr<hal::Heartbeat> heartbeat_;
  std::unique_ptr<Sensors> sensors_;
  std::vector<const Rf60xLaser*> lasers_;
  std::unique_ptr<IioCommand> command_;
  std::unique_ptr<IioArea> area_;
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
