// The variables of an FMU: what its importer may set and get.
#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/run_columns.hpp"

namespace host_sim::fmu {

/// Bounds and names that both the model description and the library use.
inline constexpr const char* model_identifier = "rigtwin";  ///< name of the library, without ending
inline constexpr const char* description_resource = "rig.toml";
inline constexpr const char* road_from_outside = "input";
inline constexpr const char* input_at_start = "start";
inline constexpr const char* input_at_end = "end";

/// The value of a variable; the alternative is its type: Real, Integer, Boolean, String.
using Value = std::variant<double, int, bool, std::string>;

enum class Causality : unsigned char {
  parameter,  ///< set before the run begins
  input,      ///< set at each communication point
  output,
};

/// One variable. Its value reference is its index in the list.
struct Variable {
  std::string name;
  std::string unit;  ///< of a Real, else empty
  std::string description;
  Causality causality;
  bool continuous;  ///< a Real that moves between samples
  Value start;      ///< of an output: its type alone
};

/// The variables by name of what they are for.
///
///   road … cut_off                 parameters: those of `rigtwin simulate`
///   input_at                       parameter: the point of a step at which its inputs hold, "start" or "end"
///   body.mass …                    parameters: the numbers of the rig description that stand in tables of their own
///   excitation.position …          inputs, used if road is "input": foot point, component_bench: deflection
///   z_r … F_act, duct_1 …          outputs: the columns of `rigtwin simulate`
///   running, reason, reason_name   outputs: whether the firmware lets the run go on, and why not
class Variables {
 public:
  explicit Variables(const firmware::RigDescription& description);

  [[nodiscard]] const std::vector<Variable>& list() const { return list_; }

  /// The value reference of the time in FMI 3.0, where it is a variable.
  [[nodiscard]] std::size_t time() const { return list_.size(); }

  /// Indices of parts of the list.
  std::size_t road, speed, seed, noise, bandwidth, cut_off, input_at;
  std::size_t first_number;  ///< of the rig description
  std::size_t position, velocity, acceleration;
  std::size_t first_column;
  std::size_t running, reason, reason_name;

  /// Of each column: how it is taken from a record.
  [[nodiscard]] const std::vector<firmware::RunColumns::Column>& columns() const { return columns_; }

 private:
  std::size_t add(Variable variable);

  std::vector<Variable> list_;
  std::vector<firmware::RunColumns::Column> columns_;
};

}  // namespace host_sim::fmu
