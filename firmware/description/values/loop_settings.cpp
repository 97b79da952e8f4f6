#include "firmware/description/values/loop_settings.hpp"

#include <array>
#include <type_traits>
#include <utility>

namespace firmware {
namespace {

template <auto Part, auto Member>
double get_setting(const Settings& settings) {
  return static_cast<double>((settings.*Part).*Member);
}

template <auto Part, auto Member>
void set_setting(Settings& settings, double value) {
  auto& member = (settings.*Part).*Member;
  member = static_cast<std::remove_reference_t<decltype(member)>>(value);
}

template <auto Part, auto Member>
constexpr LoopSetting loop_setting(std::string_view table, std::string_view key, double lowest, double highest,
                                   std::string_view what) {
  constexpr bool whole = std::is_same_v<std::remove_cvref_t<decltype((std::declval<Settings&>().*Part).*Member)>, int>;
  return {table, key, lowest, highest, what, whole, get_setting<Part, Member>, set_setting<Part, Member>};
}

constexpr auto in_limits = &Settings::limits;
constexpr auto in_supervision = &Settings::supervision;
constexpr auto in_ramps = &Settings::ramps;

constexpr std::array loop_setting_list{
    loop_setting<in_limits, &Limits::acceleration>("limits", "acceleration", 0.1, 100000.0, "an acceleration in m/s²"),
    loop_setting<in_limits, &Limits::low_force>("limits", "low_force", 1.0, 1000000.0, "a force in N (not kN)"),
    loop_setting<in_limits, &Limits::low_speed>("limits", "low_speed", 0.001, 100.0, "a speed in m/s"),
    loop_setting<in_limits, &Limits::following>("limits", "following", 1e-05, 0.5, "the longest following error in m"),
    loop_setting<in_limits, &Limits::following_least>("limits", "following_least", 1e-05, 0.05,
                                                      "a following error at standstill in m"),
    loop_setting<in_limits, &Limits::measured_stroke>("limits", "measured_stroke", 0.001, 4.0,
                                                      "the whole measured travel in m"),
    loop_setting<in_limits, &Limits::measured_speed>("limits", "measured_speed", 0.001, 1000.0,
                                                     "a measured speed in m/s"),
    loop_setting<in_limits, &Limits::bridged_in_a_row>("supervision", "bridged_in_a_row", 1.0, 100.0,
                                                       "a number of samples"),
    loop_setting<in_limits, &Limits::bridged_leak>("supervision", "bridged_leak", 0.01, 1.0,
                                                   "bad samples that a good one makes up for"),
    loop_setting<in_limits, &Limits::stale_after>("supervision", "stale_after", 1.0, 1000.0, "an age in periods"),
    loop_setting<in_limits, &Limits::speed_time>("supervision", "speed_time", 0.0, 1.0, "a time in s"),
    loop_setting<in_supervision, &Supervision::following_time>("supervision", "following_time", 0.0, 1.0,
                                                               "a time in s"),
    loop_setting<in_supervision, &Supervision::following_memory>("supervision", "following_memory", 0.05, 5.0,
                                                                 "a time in s"),
    loop_setting<in_supervision, &Supervision::following_share>("supervision", "following_share", 0.0, 0.5,
                                                                "a share of the way"),
    loop_setting<in_supervision, &Supervision::speed_window>("supervision", "speed_window", 0.0001, 0.1, "a time in s"),
    loop_setting<in_supervision, &Supervision::frozen_time>("supervision", "frozen_time", 0.0, 60.0, "a time in s"),
    loop_setting<in_supervision, &Supervision::frozen_way>("supervision", "frozen_way", 1e-06, 0.1, "a distance in m"),
    loop_setting<in_supervision, &Supervision::frozen_speed>("supervision", "frozen_speed", 0.0001, 1.0,
                                                             "a change of speed in m/s"),
    loop_setting<in_supervision, &Supervision::frozen_acceleration>("supervision", "frozen_acceleration", 0.001, 100.0,
                                                                    "a change of acceleration in m/s²"),
    loop_setting<in_limits, &Limits::late_after>("supervision", "late_after", 0.01, 1.0, "a share of the period"),
    loop_setting<in_supervision, &Supervision::late_leak>("supervision", "late_leak", 0.01, 1.0,
                                                          "late periods that a punctual one makes up for"),
    loop_setting<in_supervision, &Supervision::gap>("supervision", "gap", 0.001, 1.0, "a time in s"),
    loop_setting<in_limits, &Limits::energy_memory>("supervision", "energy_memory", 0.01, 60.0, "a time in s"),
    loop_setting<in_limits, &Limits::energy_quiet>("supervision", "energy_quiet", 0.0, 0.1, "a width in m"),
    loop_setting<in_limits, &Limits::energy_cycles>("supervision", "energy_cycles", 1.0, 1000.0, "a number of cycles"),
    loop_setting<in_supervision, &Supervision::enable_time>("supervision", "enable_time", 0.01, 1.0, "a time in s"),
    loop_setting<in_supervision, &Supervision::unpowered_way>("supervision", "unpowered_way", 1e-05, 0.05,
                                                              "a distance in m"),
    loop_setting<in_supervision, &Supervision::force_share>("supervision", "force_share", 0.0, 0.5,
                                                            "a share of a force"),
    loop_setting<in_supervision, &Supervision::force_way>("supervision", "force_way", 1e-05, 0.1, "a distance in m"),
    loop_setting<in_supervision, &Supervision::innovation_noise>("supervision", "innovation_noise", 1.0, 1000.0,
                                                                 "a factor on the noise described"),
    loop_setting<in_supervision, &Supervision::innovation_share>("supervision", "innovation_share", 0.05, 1000.0,
                                                                 "a share of what is expected"),
    loop_setting<in_supervision, &Supervision::growth_time>("supervision", "growth_time", 0.001, 2.0, "a time in s"),
    loop_setting<in_ramps, &Ramps::braking>("motion", "braking", 0.1, 1000.0, "a deceleration in m/s²"),
    loop_setting<in_ramps, &Ramps::settling>("motion", "settling", 0.0, 600.0, "a time in s"),
};

}  // namespace

std::span<const LoopSetting> loop_settings() { return loop_setting_list; }

}  // namespace firmware
