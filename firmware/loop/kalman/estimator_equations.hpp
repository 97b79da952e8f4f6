// The rig, its road and its sensors as the Kalman filter sees them.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "firmware/loop/kalman/kalman_settings.hpp"
#include "model/components/channel.hpp"
#include "model/components/duct_flows.hpp"
#include "model/components/road_filter.hpp"
#include "model/components/sensors.hpp"
#include "model/numerics/exact_discretisation.hpp"
#include "model/rig/rig_equations.hpp"

namespace firmware {

/// Most states and used channels of the filter: car 4, piston 2, relaxation and mount 2, road 5, biases 3.
inline constexpr int estimator_states = 16;
inline constexpr int estimator_channels = 8;

using EstimatorVector = model::Column<double, estimator_states>;
using EstimatorMatrix = model::Block<double, estimator_states, estimator_states>;

/// What a state of the filter is.
struct EstimatorState {
  enum class Kind : unsigned char { core, road, bias };
  Kind kind = Kind::core;
  int entry = 0;  ///< model::CoreIndex, RoadFilter::Index, or the channel's index of a bias

  [[nodiscard]] std::string_view name() const;  ///< "z_b", "piston travel", "road", "bias of zdd_b" …
};

/// Right-hand side and outputs, linear, for n open ducts:
///
///   (1)  ẋ = A_n x + B w + b_F F_act − b_q Σ_j q_j|q_j|     core: RigEquations; road: RoadFilter, or its first state
///   (2)  y_i = c_i x                                        z̈ and F_w: rows of (1); a bias adds its state
///   (3)  A_n^lin = A_n − κ_n e_ẏ e_ẏᵀ                       duct losses linearised for a random motion of the piston
///
/// State: those of model::RigEquations that the rig has (4 … 8), the road (5, or 1 with bandwidth 0: ż_r then is white
/// noise, of which (2) takes the mean), and one for each bias. w: S_w = 1, one-sided.
/// Force laws that are not linear – friction, stops, free play – are left out; their action is in the innovations. A
/// description's laws from tables, air spring and lever come as springs and dampers (description/filtered_rig). The mass at a wheel-load sensor (force_sensor_inertia) is in the row of F_w.
class EstimatorEquations {
 public:
  /// What makes settings unfit for a rig and its sensors, or an empty text.
  [[nodiscard]] static std::string_view check(const KalmanSettings& settings, const model::RigParameters<double>& rig);

  /// Parts that pass check(), else stops.
  EstimatorEquations(const KalmanSettings& settings, const model::RigParameters<double>& rig);

  [[nodiscard]] int states() const { return states_; }
  [[nodiscard]] const EstimatorState& state(int i) const { return list_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int core(int entry) const { return core_[static_cast<std::size_t>(entry)]; }  ///< −1: not a state
  [[nodiscard]] int road() const { return road_begin_; }                                      ///< first road state
  [[nodiscard]] int foot_point() const;                                                       ///< z_r
  [[nodiscard]] int channels() const { return channels_; }
  [[nodiscard]] model::Channel channel(int i) const { return channel_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int ducts() const { return rig_.has_fdva ? rig_.fdva.ducts : 0; }
  [[nodiscard]] const model::RigParameters<double>& rig() const { return rig_; }
  [[nodiscard]] const KalmanSettings& settings() const { return settings_; }

  /// (1) for n open ducts.
  [[nodiscard]] EstimatorVector rates(const EstimatorVector& x, int open, double noise = 0.0, double actuator = 0.0,
                                      double losses = 0.0) const;
  [[nodiscard]] EstimatorMatrix matrix(int open) const;  ///< A_n
  [[nodiscard]] EstimatorVector noise_column() const;    ///< B
  /// Of the ducts' flows; a rig with ducts.
  [[nodiscard]] model::DuctFlows<double>::Step flow_step(double period) const {
    return model::DuctFlows<double>::step_of(rig_.fdva, equations_.duct(), period);
  }
  /// (3) κ_n of a piston that moves with this rms velocity [1/s].
  [[nodiscard]] double linear_loss(double piston_rms, int open) const;

  /// (2) without bias: the true value of a channel; F_w with the mass at its sensor if `as_measured`.
  [[nodiscard]] double output(model::Channel channel, const EstimatorVector& x, int open, bool as_measured) const;
  [[nodiscard]] EstimatorVector row(model::Channel channel, int open, bool as_measured) const;

  /// What a channel shows of F_act at once: ∂y_i/∂F_act [1/kg] of the accelerations, else 0.
  [[nodiscard]] double feedthrough(model::Channel channel) const;
  [[nodiscard]] double foot_point_velocity(const EstimatorVector& x) const { return foot_point_motion(x).velocity; }
  /// Gain, offset and delay of a channel's sensor as described.
  [[nodiscard]] const model::SensorPath<double>& path(model::Channel channel) const {
    return paths_[model::index(channel)];
  }

 private:
  using Equations = model::RigEquations<double>;
  using Road = model::RoadFilter<double>;

  [[nodiscard]] Equations::JoinedState core_state(const EstimatorVector& x) const;
  [[nodiscard]] model::Motion<double> foot_point_motion(const EstimatorVector& x) const;

  KalmanSettings settings_;
  model::RigParameters<double> rig_;
  Equations equations_;
  std::optional<Road> filter_{};  ///< none: one road state
  double road_gain_, road_corner_;
  double sensor_mass_ = 0.0;  ///< [kg], of F_w
  std::array<model::SensorPath<double>, model::channel_count> paths_{};
  std::array<EstimatorState, estimator_states> list_{};
  std::array<int, model::core_states> core_{};
  std::array<model::Channel, estimator_channels> channel_{};
  int states_ = 0, road_begin_ = 0, bias_begin_ = 0, channels_ = 0;
};

}  // namespace firmware
