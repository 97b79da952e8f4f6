// The catalogue by name, and rig descriptions written and read back.
#include "firmware/description/values/effects_by_name.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "firmware/description/control_settings.hpp"
#include "firmware/description/rig_writer.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::catalogue;
using firmware::CatalogueEntry;
using firmware::PlacedEffect;
using firmware::RigDescription;
using model::Channel;

/// Each effect of the catalogue on a rig, with values inside its bounds that a rig can have.
std::vector<PlacedEffect> all_effects(const model::RigParameters<double>& rig) {
  std::vector<PlacedEffect> effects;
  for (const CatalogueEntry& entry : catalogue()) {
    std::vector<std::optional<Channel>> channels{std::nullopt};
    if (entry.of_channel) {
      channels.clear();
      for (std::size_t c = 0; c < model::channel_count; ++c) channels.emplace_back(model::channel_at(c));
    }
    for (const auto channel : channels) {
      if (!has_place(rig, entry, channel)) continue;
      PlacedEffect effect{&entry, channel, {}};
      for (const model::EffectParameter& p : entry.parameters) {
        effect.values.push_back(p.unit == "s" ? 0.0123 : (p.unit == "Hz" ? 25.5 : (p.unit == "m" ? 0.0101 : 3000.7)));
        if (p.name == "damping_ratio" || p.name == "mass" || p.name == "gain" || p.name == "velocity") {
          effect.values.back() = 0.71;
        }
        effect.values.back() = std::min(effect.values.back(), p.upper);
      }
      effects.push_back(effect);
    }
  }
  return effects;
}

const std::vector<std::string_view> texts{support::hil_text, support::quarter_car_text, support::bench_text};

// The contract's catalogue and hardening_hysteresis, whole and each name once.
TEST(Catalogue, HoldsTheEffectsOfTheContract) {
  std::set<std::string_view> names;
  for (const CatalogueEntry& entry : catalogue()) {
    names.insert(entry.name);
    EXPECT_EQ(firmware::find_effect(entry.name), &entry);
    EXPECT_FALSE(entry.equation.empty());
    EXPECT_FALSE(entry.shows.empty());
  }
  EXPECT_EQ(names.size(), 35U);
  EXPECT_EQ(catalogue().size(), 35U);
  EXPECT_EQ(firmware::find_effect("nothing"), nullptr);
}

// Law. What is put into a rig is what is read out of it, and only that.
TEST(Catalogue, PutsAndRemovesEffects) {
  const RigDescription description = firmware::parse_rig(support::quarter_car_text, "rig");
  for (const PlacedEffect& effect : all_effects(description.rig)) {
    SCOPED_TRACE(effect.entry->name);
    auto rig = description.rig;
    put_effect(rig, effect);
    const auto found = firmware::effects_of(rig);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].entry, effect.entry);
    EXPECT_EQ(found[0].channel, effect.channel);
    EXPECT_EQ(found[0].values, effect.values);
    remove_effect(rig, *effect.entry, effect.channel);
    EXPECT_TRUE(firmware::effects_of(rig).empty());
  }
}

// Places: guides exist only in hardware, machines not beside a quarter car, a hil rig senses F and x_act alone.
TEST(Catalogue, KnowsWhichRigHasAPlaceForAnEffect) {
  const auto hil = firmware::parse_rig(support::hil_text, "rig").rig;
  const auto car = firmware::parse_rig(support::quarter_car_text, "rig").rig;
  const auto has = [](const auto& rig, const char* name, std::optional<Channel> channel = {}) {
    return has_place(rig, *firmware::find_effect(name), channel);
  };
  EXPECT_TRUE(has(car, "body_guide_friction"));
  EXPECT_FALSE(has(hil, "body_guide_friction"));
  EXPECT_TRUE(has(hil, "actuator_delay"));
  EXPECT_TRUE(has(car, "actuator_delay"));
  EXPECT_FALSE(has(car, "moving_mass"));
  EXPECT_TRUE(has(hil, "sensor_lag", Channel::F));
  EXPECT_FALSE(has(hil, "sensor_lag", Channel::F_w));
  EXPECT_TRUE(has(car, "sensor_lag", Channel::F_w));
  EXPECT_FALSE(has(car, "sensor_lag"));
  EXPECT_TRUE(has(hil, "seal_friction"));
  auto plain = hil;
  plain.has_fdva = false;
  EXPECT_FALSE(has(plain, "seal_friction"));
}

// Round trip of every effect on every kind of rig: written, read, the same bits, and a model can be made of it.
TEST(RigWriter, WritesWhatReadsBackForEveryEffect) {
  for (const std::string_view text : texts) {
    const RigDescription plain = firmware::parse_rig(text, "rig");
    for (const PlacedEffect& effect : all_effects(plain.rig)) {
      SCOPED_TRACE(std::string(name(plain.rig.kind)) + " " + std::string(effect.entry->name));
      RigDescription description = plain;
      put_effect(description.rig, effect);
      const std::string written = format_rig(description);
      const RigDescription again = firmware::parse_rig(written, "again");
      const auto found = firmware::effects_of(again.rig);
      ASSERT_EQ(found.size(), firmware::effects_of(description.rig).size());
      EXPECT_EQ(found.back().values, firmware::effects_of(description.rig).back().values);
      EXPECT_EQ(format_rig(again), written);
      EXPECT_FALSE(firmware::find_rig_fault(again.rig, again.period()));
    }
  }
}

// Everything that a description can say survives.
TEST(RigWriter, KeepsTheWholeDescription) {
  constexpr std::string_view more = R"(
[tolerance]
"body.mass" = 0.01
[noise]
F = 10.25
x_act = 2e-05
[range]
F = [-10000.5, 9000.0]
[channels]
F = { column = "Force \"raw\"\\[kN]", scale = 1000.0, offset = -3.5 }
[limits]
stroke = 0.2
speed = 0.6
force = 20000.0
ramp = 0.04
[estimator]
cross_over = 0.7
[valves]
safe = [2, 5]
plan = [{ t = 1.5, open = 4 }, { t = 2.0, open = [1, 6] }]
[delay_budget]
sensor_age = 0.0005
[controller]
priority = 70
cpu = 3
late_in_a_row = 7
wake_early = 2e-05
allowed_delay = 0.004
allowed_gain = 1.25
[gpio]
chip = "bank \"A\""
valves = ["d1", "d2", "d3", "d4", "d5", "d6"]
valves_active_low = true
stop = "stop"
stop_2 = "stop-2"
stop_active_low = true
stop_bias = "pull-up"
enable = "enable"
enable_active_low = true
heartbeat = "beat"
high_pressure = "stage-2"
hold_to_run = "oil pressure"
interlock_bias = "external-pull-down"
[gpio.interlocks]
door = "door"
"oil pressure" = "pressure"
[arming]
tare_time = 0.75
preload = 900.0
position_tolerance = 0.004
probe_amplitude = 0.0
force_ramp = 0.25
stop_test = 12.0
[waivers]
no_probe = "the component is never moved"
stop_fails_dangerous = "the button is a toy"
enable_active_low = "an inverter stands behind it"
[converters]
trigger = "t1"
trigger_rate = 1000.0
[converters.F]
device = "adc"
input = "voltage0"
scale = -0.305
offset = 12.5
[converters.command]
device = "dac"
output = "voltage1"
scale = 4e-06
offset = -0.131
lowest_counts = -10
highest_counts = 4095
[converters.area]
device = "dac"
output = "voltage2"
scale = -1e-4
offset = 0.2
highest_counts = 4000
[lasers.x_act]
port = "/dev/ttyS1"
baud = 115200
address = 9
range = 0.25
scale = -1.0
offset = 0.125
)";
  std::string text(support::hil_text);
  text.append(more);
  const RigDescription d = firmware::parse_rig(text, "rig");
  const RigDescription e = firmware::parse_rig(format_rig(d), "again");
  EXPECT_EQ(e.tolerance, d.tolerance);
  EXPECT_EQ(e.noise, d.noise);
  EXPECT_EQ(e.range[index(Channel::F)]->lower, -10000.5);
  EXPECT_EQ(e.channels.at("F").column, "Force \"raw\"\\[kN]");
  EXPECT_EQ(e.channels.at("F").offset, -3.5);
  EXPECT_EQ(e.controller.stroke, 0.2);
  EXPECT_EQ(e.controller.speed, 0.6);
  EXPECT_EQ(e.controller.force, 20000.0);
  EXPECT_EQ(e.controller.ramp, 0.04);
  EXPECT_EQ(e.controller.cross_over, 0.7);
  EXPECT_EQ(e.controller.safe_ducts, d.controller.safe_ducts);
  ASSERT_EQ(e.controller.valve_plan.size(), 2U);
  EXPECT_EQ(e.controller.valve_plan[1].open, d.controller.valve_plan[1].open);
  EXPECT_EQ(e.delay_budget.sensor_age, 0.0005);
  EXPECT_EQ(format_rig(e), format_rig(d));
  const auto& hardware = e.hardware;
  EXPECT_EQ(hardware.converters->area->output, "voltage2");
  EXPECT_EQ(hardware.converters->area->scale, -1e-4);
  EXPECT_EQ(hardware.converters->area->highest_counts, 4000);
  EXPECT_EQ(hardware.schedule.priority, 70);
  EXPECT_EQ(hardware.schedule.cpu, 3);
  EXPECT_EQ(hardware.schedule.late_in_a_row, 7);
  EXPECT_EQ(hardware.schedule.wake_early, 2e-5);
  EXPECT_EQ(hardware.schedule.allowed_delay, 0.004);
  ASSERT_TRUE(hardware.gpio);
  EXPECT_EQ(hardware.gpio->chip, "bank \"A\"");
  EXPECT_EQ(hardware.gpio->valves.at(5), "d6");
  EXPECT_TRUE(hardware.gpio->valves_active_low && hardware.gpio->stop_active_low);
  EXPECT_EQ(hardware.gpio->stop_bias, "pull-up");
  EXPECT_EQ(hardware.gpio->stop_2, "stop-2");
  EXPECT_EQ(hardware.gpio->enable, "enable");
  EXPECT_TRUE(hardware.gpio->enable_active_low);
  EXPECT_EQ(hardware.gpio->interlock_bias, "external-pull-down");
  ASSERT_EQ(hardware.gpio->interlocks.size(), 2U);
  EXPECT_EQ(hardware.gpio->interlocks[1].name, "oil pressure");
  EXPECT_EQ(hardware.gpio->interlocks[1].line, "pressure");
  EXPECT_EQ(hardware.schedule.allowed_gain, 1.25);
  EXPECT_EQ(hardware.gpio->high_pressure, "stage-2");
  EXPECT_EQ(hardware.gpio->hold_to_run, "oil pressure");
  EXPECT_EQ(firmware::arming_settings(e).hold_to_run, 2U);
  EXPECT_DOUBLE_EQ(e.controller.arming.stop_test, 12.0 * 3600.0);
  EXPECT_EQ(e.controller.arming.tare_time, 0.75);
  EXPECT_EQ(e.controller.arming.preload, 900.0);
  EXPECT_EQ(e.controller.arming.position_tolerance, 0.004);
  EXPECT_EQ(e.controller.arming.probe_amplitude, 0.0);
  EXPECT_EQ(e.controller.arming.force_ramp, 0.25);
  EXPECT_EQ(e.waivers, d.waivers);
  EXPECT_EQ(e.waivers.size(), 3U);
  ASSERT_TRUE(hardware.converters && hardware.converters->command);
  ASSERT_EQ(hardware.converters->inputs.size(), 1U);
  EXPECT_EQ(hardware.converters->inputs[0].channel, index(Channel::F));
  EXPECT_EQ(hardware.converters->inputs[0].scale, -0.305);
  EXPECT_EQ(hardware.converters->inputs[0].offset, 12.5);
  EXPECT_EQ(hardware.converters->command->lowest_counts, -10);
  EXPECT_EQ(hardware.converters->command->highest_counts, 4095);
  ASSERT_EQ(hardware.lasers.size(), 1U);
  EXPECT_EQ(hardware.lasers[0].channel, index(Channel::x_act));
  EXPECT_EQ(hardware.lasers[0].offset, 0.125);
  EXPECT_EQ(e.rig.fdva.open_ducts, d.rig.fdva.open_ducts);
  EXPECT_EQ(e.rig.machine.virtual_damping, d.rig.machine.virtual_damping);
}

}  // namespace
