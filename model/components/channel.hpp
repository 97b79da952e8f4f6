// Names and units of the quantities that a rig can measure.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace model {

/// The channels of a recording (SI units; up is positive; displacements count from the static equilibrium).
enum class Channel : unsigned char {
  z_r,    ///< foot point displacement [m]
  z_w,    ///< wheel displacement [m]
  z_b,    ///< body displacement [m]
  zdd_r,  ///< foot point acceleration [m/s²]
  zdd_w,  ///< wheel acceleration [m/s²]
  zdd_b,  ///< body acceleration [m/s²]
  dz_w,   ///< tyre deflection z_r − z_w [m]
  dz_b,   ///< suspension deflection z_w − z_b [m]
  F_w,    ///< dynamic wheel load [N]
  x_cmd,  ///< deflection commanded to the test machine [m]
  x_act,  ///< deflection reached by the test machine [m]
  F,      ///< measured force of the component [N]
  F_act,  ///< known extra force of an actuator between wheel and body, compression positive [N]
  z_cmd,  ///< foot point displacement commanded to the machine of a quarter car [m]
};

inline constexpr std::size_t channel_count = 14;

/// The name a channel has in recordings and rig descriptions, and its SI unit.
struct ChannelName {
  std::string_view name;
  std::string_view unit;
};

inline constexpr std::array<ChannelName, channel_count> channel_names{{
    {"z_r", "m"},
    {"z_w", "m"},
    {"z_b", "m"},
    {"zdd_r", "m/s²"},
    {"zdd_w", "m/s²"},
    {"zdd_b", "m/s²"},
    {"dz_w", "m"},
    {"dz_b", "m"},
    {"F_w", "N"},
    {"x_cmd", "m"},
    {"x_act", "m"},
    {"F", "N"},
    {"F_act", "N"},
    {"z_cmd", "m"},
}};

[[nodiscard]] constexpr std::size_t index(Channel channel) { return static_cast<std::size_t>(channel); }
[[nodiscard]] constexpr Channel channel_at(std::size_t index) { return static_cast<Channel>(index); }
[[nodiscard]] constexpr std::string_view name(Channel channel) { return channel_names[index(channel)].name; }
[[nodiscard]] constexpr std::string_view unit(Channel channel) { return channel_names[index(channel)].unit; }

[[nodiscard]] constexpr std::optional<Channel> find_channel(std::string_view name) {
  for (std::size_t i = 0; i < channel_count; ++i) {
    if (channel_names[i].name == name) return channel_at(i);
  }
  return std::nullopt;
}

/// The kinds of rig: hardware quarter car, component in the loop with a virtual car, component on a test machine, mass
/// on a component that a force drives.
enum class RigKind : unsigned char { quarter_car, hil, component_bench, driven_mass };

/// The words of `kind` in a rig description; a driven_mass is a component_bench with driven_by = "force".
inline constexpr std::array<std::string_view, 3> rig_kind_names{"quarter_car", "hil", "component_bench"};

[[nodiscard]] constexpr std::string_view name(RigKind kind) {
  return kind == RigKind::driven_mass ? "component_bench driven by force"
                                      : rig_kind_names[static_cast<std::size_t>(kind)];
}

}  // namespace model
