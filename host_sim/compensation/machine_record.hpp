// The machine of a rig description against a recording of it: what a compensation would have made of that run.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "model/components/subsystems.hpp"

namespace host_sim::compensation {

/// With M the described machine (delay, lag, resonance among the effects), x_cmd and x_act as recorded:
///
///   (1)  u = M⁻¹ x_cmd         the command that would have made x_act follow x_cmd
///   (2)  x̂_act = C x_act       where the machine would have been with the command C x_cmd
///   (3)  error = rms(x̂_act − x_cmd)/rms(x_cmd), over the frequencies that the command moved
///
/// (2) holds for any linear machine, M or not: the real one commutes with C. So (3) judges M against the real machine,
/// without a second recording. By Parseval's theorem from one transform of both columns.
struct MachineRecord {
  struct Method {
    std::string name;
    double error{};  ///< (3)
  };
  model::MachinePath<double> machine;  ///< as assumed
  double lowest_hz{}, highest_hz{};    ///< of the command: between them lies 98 % of its power
  double uncompensated{};              ///< error of the recording itself
  double pure_delay{};                 ///< the best one, as C = e^{sτ} [s]
  std::vector<Method> methods;         ///< pure delay, inverse of M, and the series of [compensation] of orders 1 … 3
  std::vector<double> command;         ///< (1), at the recording's instants; led up to 1.5 times highest_hz [m]
  std::vector<double> reached;         ///< (2) with the exact inverse [m]

  [[nodiscard]] double error_of(const std::string& name) const;
};

inline constexpr const char* exact_inverse = "inverse of the machine";
inline constexpr const char* best_pure_delay = "pure delay";

/// The machine is that of [compensation] where it gives one, else that of the effects. InputError for a recording
/// without x_cmd and x_act, or that does not move, and for a description whose machine is not late.
[[nodiscard]] MachineRecord machine_record(const firmware::RigDescription& description,
                                           const firmware::Recording& recording);

[[nodiscard]] nlohmann::ordered_json to_json(const MachineRecord& record);

/// x_cmd: the command (1), x_act: (2); the command as it was recorded stands beside them as x_wanted.
[[nodiscard]] firmware::Recording compensated_command(const MachineRecord& record,
                                                      const firmware::Recording& recording);

}  // namespace host_sim::compensation
