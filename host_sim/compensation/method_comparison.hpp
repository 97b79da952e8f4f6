// All compensators on one rig: response, tracking error, margin, robustness.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/compensation/settings.hpp"

namespace host_sim::compensation {

using firmware::compensation::Kind;

/// A change of the rig that the compensator does not know of.
enum class Change : unsigned char {
  none,
  later,             ///< the machine's delay 20 % longer
  earlier,           ///< 20 % shorter
  lag,               ///< a lag of the same low-frequency delay instead
  stiffer_specimen,  ///< the component's stiffnesses 3 % higher
};
inline constexpr std::array<const char*, 5> change_names{"as assumed", "delay +20 %", "delay -20 %",
                                                         "lag instead of delay", "component 3 % stiffer"};

/// F_w/z_r and tracking of one loop.
struct LoopResult {
  bool stable = false;
  double spectral_radius{};
  std::optional<double> peak_error;  ///< |peak ÷ peak of the undelayed loop − 1|; none: unstable
  std::optional<double> tracking;    ///< rms(x_act − x) ÷ rms(x) over a road of |z_r|² ∝ 1/f², 0.1 … 50 Hz
};

struct MethodResult {
  std::string name;  ///< of the kind, or "none"
  bool needs_component_model = false;
  std::string assumes;
  std::array<LoopResult, 5> over_changes;  ///< by Change
  std::optional<double> critical_error;    ///< smallest |true − assumed delay| that is unstable [s]; none found
  std::optional<double> critical_later, critical_earlier;  ///< the same for one sign [s]
  std::vector<double> radius_over_error;                   ///< spectral radius over MethodComparison::delay_error
  std::vector<double> magnitude, phase;                    ///< F_w/z_r [N/m], [rad]
};

struct MethodComparison {
  double delay{};  ///< of the machine, low frequencies [s]
  std::vector<double> frequency_hz;
  std::vector<double> truth, truth_phase;  ///< the undelayed loop
  double peak_hz{}, peak{};                ///< of the truth's wheel mode
  std::vector<double> delay_error;         ///< true − assumed [s]
  std::vector<MethodResult> methods;       ///< "none" first, then by Kind
};

/// For a hil rig, each method with firmware::compensation_settings().
/// InputError for another kind of rig, or a machine without any delay.
[[nodiscard]] MethodComparison compare_methods(const firmware::RigDescription& description);

}  // namespace host_sim::compensation
