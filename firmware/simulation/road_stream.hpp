// Roads sample by sample, for runs whose length is not known beforehand.
#pragma once

#include <cmath>
#include <cstdint>

#include "firmware/description/rig_description.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "firmware/simulation/road.hpp"
#include "model/components/road_filter.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// The motion over an ISO 8608 road, one sample after the other; drive_over() collects them. No heap in next().
class RoadStream {
 public:
  RoadStream(const IsoRoad& road, double sample_rate)
      : filter_({road.roughness, road.speed, road.cut_off, road.bandwidth}, 1.0 / sample_rate),
        noise_(road.seed, stream),
        deviation_(std::sqrt(0.5 * sample_rate)) {}

  [[nodiscard]] model::Motion<double> next() {
    const model::Motion<double> motion = filter_.motion(state_);
    state_ = filter_.step(state_, deviation_ * noise_());
    return motion;
  }

 private:
  static constexpr std::uint32_t stream = 1;  ///< of a run's seed; sensor noise has its own

  model::RoadFilter<double> filter_;
  Gaussian noise_;
  double deviation_;  ///< variance 1/(2h): one-sided density 1
  model::RoadFilter<double>::State state_ = model::RoadFilter<double>::State::Zero();
};

/// The deflection of the component of a component_bench in its car on a road, one sample after the other; excitation()
/// collects them. No heap.
class DeflectionStream {
 public:
  DeflectionStream(const model::RigParameters<double>& component_bench, double sample_rate)
      : model_(on_its_car(component_bench), 1.0 / sample_rate) {}

  [[nodiscard]] model::Motion<double> next(const model::Motion<double>& road) {
    if (begins_) state_ = model_.start(road.position);
    begins_ = false;
    model_.step(state_, {.foot_point = road});
    const auto signals = model_.signals(state_);
    const auto deflection = model_.deflection(state_);
    return {deflection.position, deflection.velocity,
            signals[index(model::Channel::zdd_w)] - signals[index(model::Channel::zdd_b)]};
  }

 private:
  model::RigModel<> model_;
  model::RigModel<>::State state_{};
  bool begins_ = true;
};

}  // namespace firmware
