#include "firmware/description/semi_active_setup.hpp"

#include <algorithm>
#include <string>

#include "firmware/description/filtered_rig.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/semi_active.hpp"

namespace firmware {
namespace {

std::string sensors_in_words(const EstimatorEquations& equations) {
  std::string text;
  for (int i = 0; i < equations.channels(); ++i) {
    text += (text.empty() ? "" : ", ") + std::string(model::name(equations.channel(i)));
  }
  return text;
}

void refuse_unobservable(const RigDescription& description, const EstimatorEquations& equations,
                         const KalmanFilter& filter) {
  const auto [state, open] = filter.unobservable();
  if (state < 0) return;
  throw InputError(description.source, description.line_of("estimator"),
                   "state '" + std::string(equations.state(state).name()) + "' is not observable with " +
                       sensors_in_words(equations) +
                       (equations.ducts() > 0 ? " and " + std::to_string(open) + " open ducts" : ""),
                   "sensors that determine every state (estimator.sensors), or a road with a cut_off above 0");
}

}  // namespace

KalmanSettings kalman_settings(const RigDescription& description) {
  const ControllerDescription& controller = description.controller;
  KalmanSettings settings = controller.kalman;
  settings.noise = {};
  const auto use = [&](model::Channel channel) {
    const auto noise = description.noise[model::index(channel)];
    if (!noise || *noise <= 0.0) {
      throw InputError(description.source, description.line_of("estimator"),
                       "the filter cannot weigh " + std::string(model::name(channel)), "its rms in [noise], above 0");
    }
    settings.noise[model::index(channel)] = *noise;
  };
  for (const model::Channel channel : controller.estimator_sensors) use(channel);
  if (controller.estimator_sensors.empty()) {
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      const model::Channel channel = model::channel_at(i);
      const auto noise = description.noise[i];
      if (channel == model::Channel::F_act || !noise || *noise <= 0.0) continue;
      settings.noise[i] = *noise;
    }
  }
  if (!controller.estimator_bandwidth_given) {
    const double fifth = 0.2 * description.sample_rate;  // as the roads of a simulated run
    settings.bandwidth = std::min(settings.bandwidth, fifth);
  }
  if (const auto wrong = EstimatorEquations::check(settings, description.rig); !wrong.empty()) {
    throw InputError(description.source, description.line_of("estimator"), "the Kalman filter does not fit the rig",
                     wrong);
  }
  return settings;
}

std::unique_ptr<KalmanFilter> kalman_filter(const RigDescription& description, const EstimatorEquations& equations) {
  const auto gains = std::make_unique<SteadyGains>(equations, description.period());
  auto filter = std::make_unique<KalmanFilter>(equations, *gains, description.period());
  refuse_unobservable(description, equations, *filter);
  return filter;
}

std::unique_ptr<Companion> companion(const RigDescription& description) {
  if (!description.controller.kalman.enabled) return nullptr;
  const KalmanSettings settings = kalman_settings(description);
  const EstimatorEquations equations(settings, filtered_rig(description, settings));
  if (description.rig.has_fdva) {
    const auto wrong = DuctPolicy::check(description.controller.ducts, equations.rig(), description.period());
    if (!wrong.empty()) {
      throw InputError(description.source, description.line_of("valves"), "the duct policy does not fit", wrong);
    }
  }
  const auto gains = std::make_unique<SteadyGains>(equations, description.period());
  auto result = std::make_unique<SemiActive>(equations, *gains, description.controller.ducts, description.period(),
                                             description.controller.loop.supervision);
  refuse_unobservable(description, equations, result->filter());
  return result;
}

}  // namespace firmware
