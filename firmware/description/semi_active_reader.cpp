#include "firmware/description/semi_active_reader.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/spelling.hpp"

namespace firmware {
namespace {

/// A number of a settings struct: key, place, bounds, words for a message.
template <class Settings>
struct NumberKey {
  std::string_view key;
  double Settings::*value;
  double lowest, highest;
  std::string_view what;
};

constexpr std::array<NumberKey<KalmanSettings>, 5> kalman_keys{{
    {"bias_drift", &KalmanSettings::bias_drift, 1e-6, 1e3, "a drift within 1 s in terms of the channel's noise"},
    {"roughness", &KalmanSettings::roughness, 1e-9, 1.0, "the road's G_d(n0) in m³; class B has 64e-6"},
    {"speed", &KalmanSettings::speed, 0.1, 150.0, "the speed over the road in m/s"},
    {"cut_off", &KalmanSettings::cut_off, 0.0, 10.0, "the road's cut-off frequency in Hz"},
    {"false_alarms", &KalmanSettings::false_alarms, 1e-9, 1e3, "false alarms of the innovation monitor an hour"},
}};

constexpr std::array<NumberKey<DuctPolicySettings>, 9> policy_keys{{
    {"wheel_load", &DuctPolicySettings::wheel_load, 0.0, 1e6, "the weight of (F_w/500 N)²"},
    {"body_acceleration", &DuctPolicySettings::body_acceleration, 0.0, 1e6, "the weight of (zdd_b/1 m/s²)²"},
    {"component_force", &DuctPolicySettings::component_force, 0.0, 1e6, "the weight of (F_s/m_b/1 m/s²)²"},
    {"stroke", &DuctPolicySettings::stroke, 0.0, 1e6, "the weight of (dz_b/7 mm)²"},
    {"horizon", &DuctPolicySettings::horizon, 0.005, 1.0, "a prediction time in s"},
    {"dwell", &DuctPolicySettings::dwell, 0.001, 10.0, "the least time between two switchings in s"},
    {"delay", &DuctPolicySettings::delay, 0.0, 0.064, "the time that a valve needs in s"},
    {"closing_time", &DuctPolicySettings::closing_time, 1e-4, 1.0, "the time in which a valve closes in s"},
    {"pressure_peak", &DuctPolicySettings::pressure_peak, 1e4, 1e9, "a pressure in Pa (not bar)"},
}};

template <class Settings, std::size_t count>
void read_numbers(DescriptionTable& table, const std::array<NumberKey<Settings>, count>& keys, Settings& settings) {
  for (const auto& k : keys) table.number_in(k.key, settings.*k.value, k.lowest, k.highest, k.what);
}

template <class Settings, std::size_t count>
void write_numbers(const Settings& settings, const std::array<NumberKey<Settings>, count>& keys,
                   const WriteLine& line) {
  const Settings usual{};
  for (const auto& k : keys) {
    if (settings.*k.value != usual.*k.value) line(std::string(k.key), shortest(settings.*k.value));
  }
}

std::vector<model::Channel> read_channels(DescriptionTable& table, std::string_view key) {
  std::array<std::string_view, model::channel_count> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = model::channel_names[i].name;
  const toml::node& node = table.need(key, "a list of channels");
  const auto* list = node.as_array();
  const std::string expected = "a list of channels such as [\"zdd_b\", \"zdd_w\"]";
  if (list == nullptr || list->empty()) table.fail(node, table.path(key) + " is no list of channels", expected);
  std::vector<model::Channel> channels;
  for (const auto& item : *list) {
    const auto channel = item.is_string() ? model::find_channel(item.as_string()->get()) : std::nullopt;
    if (!channel) table.fail(item, table.path(key) + " names no such channel", "one of " + listed(names));
    if (std::find(channels.begin(), channels.end(), *channel) != channels.end()) {
      table.fail(item, table.path(key) + " names a channel twice", expected);
    }
    channels.push_back(*channel);
  }
  return channels;
}

std::string channel_list(const std::vector<model::Channel>& channels) {
  std::string text;
  for (const model::Channel channel : channels) {
    text += std::string(text.empty() ? "\"" : ", \"") + std::string(model::name(channel)) + "\"";
  }
  return "[" + text + "]";
}

}  // namespace

void read_estimator(DescriptionTable& top, model::RigKind kind, ControllerDescription& controller) {
  auto table = top.table("estimator");
  if (!table) return;
  if (table->has("cross_over")) controller.cross_over = table->positive("cross_over");
  KalmanSettings& kalman = controller.kalman;
  if (table->has("kind")) {
    const std::string name = table->text("kind");
    kalman.enabled = name == "kalman";
    if (!kalman.enabled && name != "observer") {
      table->fail("kind", "unknown estimator.kind '" + name + "'", "\"observer\" or \"kalman\"");
    }
    if (kalman.enabled && kind != model::RigKind::quarter_car) {
      table->fail("kind", "estimator.kind = \"kalman\" does not fit this kind of rig",
                  "\"observer\": a hil rig computes its car, a component_bench has none");
    }
  }
  read_numbers(*table, kalman_keys, kalman);
  if (table->has("sensors")) controller.estimator_sensors = read_channels(*table, "sensors");
  if (table->has("bias")) {
    for (const model::Channel channel : read_channels(*table, "bias")) kalman.bias[model::index(channel)] = true;
  }
  if (table->has("bandwidth")) {
    kalman.bandwidth = table->number("bandwidth");
    controller.estimator_bandwidth_given = true;
    if (kalman.bandwidth != 0.0 && !(kalman.bandwidth >= 0.1 && kalman.bandwidth <= 2e4)) {
      table->fail("bandwidth", "estimator.bandwidth does not fit", "0 (white velocity), or 0.1 to 20000 Hz");
    }
  }
  if (table->has("history")) kalman.history = table->whole_in("history", 1, longest_history);
  if (auto ages = table->table("age")) {
    ages->for_each_channel([&](model::Channel channel, const std::string& key, const toml::node& node) {
      const double value = ages->number(key);
      if (!(value >= 0.0 && value <= 0.5)) ages->fail(node, ages->path(key) + " does not fit", "an age of 0 to 0.5 s");
      kalman.age[model::index(channel)] = value;
    });
  }
  table->finish();
}

void read_duct_policy(DescriptionTable& valves, const model::RigParameters<double>& rig,
                      ControllerDescription& controller) {
  DuctPolicySettings& settings = controller.ducts;
  if (valves.has("policy")) {
    const std::string name = valves.text("policy");
    const auto* at = std::find(duct_policy_names.begin(), duct_policy_names.end(), name);
    if (at == duct_policy_names.end()) {
      valves.fail("policy", "unknown valves.policy '" + name + "'", "one of " + listed(duct_policy_names));
    }
    settings.policy = static_cast<DuctPolicyKind>(at - duct_policy_names.begin());
    if (settings.policy != DuctPolicyKind::plan && !(rig.has_fdva && controller.kalman.enabled)) {
      valves.fail("policy", "valves.policy = \"" + name + "\" has no states to decide by",
                  "a quarter_car with [fdva] and [estimator] kind = \"kalman\"");
    }
  }
  read_numbers(valves, policy_keys, settings);
  if (settings.delay > 0.0 && !controller.kalman.enabled) {
    valves.fail("delay", "valves.delay has nobody who follows the valves", "[estimator] kind = \"kalman\" beside it");
  }
  const double sum = settings.wheel_load + settings.body_acceleration + settings.component_force + settings.stroke;
  if (!(sum > 0.0)) valves.fail("wheel_load", "valves: all weights of the cost are 0", "one above 0");
}

void write_estimator(const ControllerDescription& controller, const WriteLine& line) {
  const KalmanSettings& kalman = controller.kalman;
  if (kalman.enabled) line("kind", "\"kalman\"");
  write_numbers(kalman, kalman_keys, line);
  if (!controller.estimator_sensors.empty()) line("sensors", channel_list(controller.estimator_sensors));
  std::vector<model::Channel> biases;
  std::string ages;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (kalman.bias[i]) biases.push_back(model::channel_at(i));
    if (kalman.age[i] > 0.0) {
      ages += (ages.empty() ? "" : ", ") + std::string(model::channel_names[i].name) + " = " + shortest(kalman.age[i]);
    }
  }
  if (!biases.empty()) line("bias", channel_list(biases));
  if (controller.estimator_bandwidth_given) line("bandwidth", shortest(kalman.bandwidth));
  if (kalman.history > 0) line("history", std::to_string(kalman.history));
  if (!ages.empty()) line("age", "{ " + ages + " }");
}

void write_duct_policy(const DuctPolicySettings& settings, const WriteLine& line) {
  if (settings.policy != DuctPolicyKind::plan) {
    line("policy", "\"" + std::string(duct_policy_names[static_cast<std::size_t>(settings.policy)]) + "\"");
  }
  write_numbers(settings, policy_keys, line);
}

}  // namespace firmware
