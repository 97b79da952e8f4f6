// The described rig and its neighbours, simulated side by side with the rig that runs.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/comparison/carried_simulation.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"
#include "host_sim/identification/select/candidates.hpp"
#include "host_sim/live/samples.hpp"
#include "host_sim/live/score_test.hpp"
#include "model/components/sensors.hpp"

namespace host_sim::live {

/// Something of one parameter that may begin to act while the rig runs: an effect of the catalogue, an effect of the
/// rig that becomes another one, or a parameter of the description.
struct Cause {
  const firmware::CatalogueEntry* entry = nullptr;  ///< nullptr: a parameter of the description
  std::optional<model::Channel> channel{};
  std::string path;  ///< "effects.actuator_delay.delay", "suspension.damping"
  std::string unit;
  double described = 0.0;  ///< the value with which the description has it; of an effect that is not there: neutral
  double lower = 0.0, upper = 0.0;
  bool inverse = false;  ///< it acts the more the smaller it is, and not at all when it is infinite: a spring in series
  double price = 0.0;    ///< [χ²] by which it must explain more than another cause
};

/// A cause at one size.
struct Candidate {
  std::size_t cause;  ///< in Twins::causes()
  double step;        ///< value less the described one [SI]; sizes of a score are in units of this
};

/// What the model leaves of a channel while nothing is wrong.
struct Residual {
  double mean = 0.0, deviation = 0.0;
};
using Residuals = std::array<Residual, model::channel_count>;

/// The described rig, and one rig for each candidate, on the model's one step with the state carried from block to
/// block. Effects of sensors cost no simulation: they read what the described rig does. An effect of the sensor that
/// drives acts on the input, and its rig answers to what the sensor would have made of the reading: to first order the
/// opposite of what it would have seen before the sensor.
class Twins {
 public:
  /// `known`: some seconds of this rig, which say how large things are and which channels there are.
  Twins(const firmware::RigDescription& description, const identification::PreparedRecording& known);

  /// The same rig with other candidates: causes of this one, each at one value [SI]. What the model cannot step is left
  /// out.
  [[nodiscard]] Twins at(const std::vector<std::pair<std::size_t, double>>& values) const;

  [[nodiscard]] const std::vector<Cause>& causes() const { return causes_; }
  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }
  [[nodiscard]] const std::vector<model::Channel>& channels() const { return channels_; }
  [[nodiscard]] model::Channel input() const { return like_.channel; }
  /// Whether that channel has a sensor.
  [[nodiscard]] bool input_is_measured() const { return input_sensor_.has_value(); }
  /// The candidates, for a test; sizes in units of their steps.
  [[nodiscard]] std::vector<Tested> tested() const;

  /// Simulations begin with this block, at rest.
  void start(const Block& block);
  /// The described rig over a block, by channel; empty: not simulated.
  [[nodiscard]] const Response& describe(const Block& block);
  /// What the last block described.
  [[nodiscard]] const Response& readings() const { return readings_; }
  /// The same, and all others: the scores of what the block leaves. `residuals`: of a healthy rig.
  [[nodiscard]] BlockScore score(const Block& block, const Residuals& residuals);

 private:
  Twins() = default;

  struct Sensor {
    model::Channel channel;
    model::Sensors<double> path;
    model::Sensors<double>::State state{};
    bool started = false;
  };
  struct Neighbour {
    std::size_t candidate;
    int substeps = 1;
    std::optional<CarriedSimulation> simulation{};  ///< of another rig, or of the described one on another input
    std::optional<Sensor> sensor{};                 ///< of a channel, or of the input
    bool of_input = false;
    std::vector<double> passed{};  ///< the input behind `sensor`, of the block's recording
  };

  void describe_sensors();
  void describe_rig();
  void add(const identification::Candidate& found);
  void add_cause(Cause cause, const std::vector<double>& values, const model::RigParameters<double>& bare);
  [[nodiscard]] bool can_step(const model::RigParameters<double>& rig, int substeps) const;
  [[nodiscard]] SimulationInput input_of(const Block& block) const;
  [[nodiscard]] Response through_sensors(const Response& truth);
  static void pass(Sensor& sensor, std::vector<double>& values);
  [[nodiscard]] SimulationInput passed(Neighbour& neighbour, const Block& block, const SimulationInput& input);

  model::RigParameters<double> rig_;   ///< the explained part, with its sensors
  model::RigParameters<double> bare_;  ///< without
  SimulationInput like_;
  std::optional<model::Channel> input_sensor_;
  std::vector<model::Channel> channels_;
  std::vector<Cause> causes_;
  std::vector<Candidate> candidates_;
  std::vector<Neighbour> neighbours_;
  std::map<int, CarriedSimulation> described_;  ///< by steps a sample
  std::map<int, Response> truths_;
  std::vector<Sensor> sensors_;  ///< of the description
  Response readings_;
};

}  // namespace host_sim::live
