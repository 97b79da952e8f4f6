// A rig description: the TOML file that describes a rig, its sensors, its recordings and its controller.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/laws/law_description.hpp"
#include "firmware/description/values/calibration_description.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/description/values/compensation_description.hpp"
#include "firmware/description/values/hardware_description.hpp"
#include "firmware/description/values/recorder_description.hpp"
#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/duct_control/duct_settings.hpp"
#include "firmware/loop/kalman/kalman_settings.hpp"
#include "model/components/channel.hpp"
#include "model/components/fdva.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// Measuring range of a channel [SI]; a sample at or beyond it is clipped.
struct MeasuringRange {
  double lower;
  double upper;

  [[nodiscard]] bool holds(double value) const { return value > lower && value < upper; }
};

/// By model::Channel; nullopt: no range, every sample is used.
using MeasuringRanges = std::array<std::optional<MeasuringRange>, model::channel_count>;

/// Limits and settings of the controller; the defaults are those of the TU Darmstadt rig.
struct ControllerDescription {
  double stroke = 0.250;     ///< whole travel of cylinder or machine [m], half of it to each side of the middle
  double speed = 0.7;        ///< of cylinder or machine [m/s]
  double force = 25e3;       ///< [N]
  bool force_given = false;  ///< by the description; else control_settings() keeps it within the measuring range
  double energy_gain = 1.0;  ///< hil: energy that the interface may feed, in terms of what the dampers take
  double ramp = 0.05;  ///< speed at which the command goes to the start of a run, and to rest in the safe state [m/s]
  Settings loop{};  ///< every other setting of the control loop that the description has; not its period and the above
  KalmanSettings kalman{};                        ///< as [estimator] has it; kalman_settings() adds noise and road
  std::vector<model::Channel> estimator_sensors;  ///< that the filter uses; empty: all with a [noise] above 0
  bool estimator_bandwidth_given = false;         ///< else the road's default for the rig
  DuctPolicySettings ducts{};
  double cross_over = 0.0;          ///< of the velocity estimate [Hz]; 0: the firmware's own default
  model::OpenDucts safe_ducts = 0;  ///< open in the safe state
  struct Switching {
    double time;            ///< since the start of the run [s]
    model::OpenDucts open;  ///< from then on
  };
  std::vector<Switching> valve_plan;  ///< by time; empty: fdva.open_ducts throughout
  Arming arming{.tare_time = 0.5, .position_tolerance = 5e-3, .force_ramp = 0.5};  ///< preload 0: a tenth of `force`
};

/// Delays of a hil loop that no effect of the rig models [s]. `rigtwin stability` adds them to the loop; a simulation
/// ignores them.
struct DelayBudget {
  double sensor_age = 0.0;   ///< of a force sample when it is read
  double transport = 0.0;    ///< on the way from the sensor to the program, and of the command to the machine
  double computation = 0.0;  ///< from force to command

  [[nodiscard]] double sum() const { return sensor_age + transport + computation; }
};

/// The rig, the tolerances of its parameters, and the format of its recordings.
struct RigDescription {
  model::RigParameters<double> rig;
  std::vector<LawDescription> laws;                               ///< names of rig.laws
  double sample_rate = 0.0;                                       ///< of the loop and of its recordings [Hz]
  std::map<std::string, double> tolerance;                        ///< parameter path → relative hard bound
  std::array<std::optional<double>, model::channel_count> noise;  ///< rms of the sensor's noise [SI]
  MeasuringRanges range;
  Calibrations calibration;  ///< of the sensors; used by the workbench only
  ChannelMap channels;
  RecorderDescription recorder;  ///< what it makes of the channels
  ControllerDescription controller;
  DelayBudget delay_budget;
  std::optional<CompensationDescription> compensation;  ///< hil only: of the machine's delay
  HardwareDescription hardware;                         ///< used by rig_controller only
  std::map<std::string, std::string> waivers;  ///< [waivers]: what the rig goes without, and the sentence that says so
  std::string source;                          ///< file name as given by the user
  std::string text;                            ///< its contents, for reports
  std::map<std::string, std::size_t, std::less<>> lines;  ///< of its keys and tables in that text, by path

  [[nodiscard]] double period() const { return 1.0 / sample_rate; }
  /// The line of a key or table ("limits.force"), else of the table around it; 0: neither is there.
  [[nodiscard]] std::size_t line_of(std::string_view path) const;
};

/// A reason not to move, in words without a full stop, and the key of the description that it is about.
struct MotionObjection {
  std::string text;  ///< empty: none
  std::string key;   ///< "limits.force"; empty: no key of the description

  [[nodiscard]] bool empty() const { return text.empty(); }
};

/// "rig.toml:12", with the line of the key that an objection is about; without one "rig.toml".
[[nodiscard]] std::string place(const RigDescription& description, const MotionObjection& objection);

/// [range] of a channel without half a count of its converter at each end: a count stands for all values within half of
/// it, so a sample so near to an end may lie beyond. A range narrower than two counts has no such ends and stays.
[[nodiscard]] std::optional<MeasuringRange> trusted_range(const RigDescription& description, std::size_t channel);

/// A parameter as rig descriptions, tolerances and results name it: "body.mass".
struct ParameterPath {
  std::string_view table;
  std::string_view key;
  std::string_view unit;
  double& (*value)(model::RigParameters<double>&);
};

/// All real-valued parameters of a rig that stand in tables of their own (effects not included).
[[nodiscard]] std::span<const ParameterPath> parameter_paths();

/// Whether a rig has the part that a table describes.
[[nodiscard]] bool has_part(const model::RigParameters<double>& rig, std::string_view table);

/// The parameter "table.key" or "effects.name.key" of a rig, nullptr when there is none of that name or the rig does
/// not have that part or effect.
[[nodiscard]] double* find_parameter(model::RigParameters<double>& rig, std::string_view path);
[[nodiscard]] const double* find_parameter(const model::RigParameters<double>& rig, std::string_view path);

/// nullopt, or the reason why the model refuses these parameters: model::find_fault, or (table and key empty) rates of
/// change that a step of this period [s] cannot resolve.
[[nodiscard]] std::optional<model::RigFault> find_rig_fault(const model::RigParameters<double>& rig, double period);

/// The quarter car on which the component of a component_bench drives: the rig without its effects on the body, wheel
/// and tyre of the description, else of the paper (290 kg, 40 kg, 200 kN/m, 100 N s/m), with 1140 N s/m beside the
/// component.
[[nodiscard]] model::RigParameters<double> on_its_car(const model::RigParameters<double>& component_bench);

/// Reads and checks a description. InputError for every error: TOML syntax, an unknown key (with the nearest known key
/// as suggestion), a missing table, a number outside its bounds, a delay beyond the capacity of the delay line.
[[nodiscard]] RigDescription read_rig(const std::filesystem::path& file);

/// The same from text; `source` stands for the file in messages.
[[nodiscard]] RigDescription parse_rig(std::string_view text, std::string_view source);

/// The files that a description names beside itself (tables of laws), as they are opened, each once.
[[nodiscard]] std::vector<std::filesystem::path> referenced_files(const RigDescription& description);

/// InputError where a rig of devices lacks what makes it safe – stop button, heartbeat, drive enable – and no waiver
/// says why it may.
void check_wiring(const RigDescription& description);

}  // namespace firmware
