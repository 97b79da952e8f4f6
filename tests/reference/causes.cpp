#include "tests/reference/causes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reference {
namespace {

using model::Channel;
using model::MotionScales;
using Samples = std::vector<double>;

double rms(const Samples& values) {
  double squares = 0.0, mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

double peak(const Samples& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

Samples rates(const Samples& values, double period) {
  Samples result(values.size());
  for (std::size_t k = 1; k < values.size(); ++k) result[k] = (values[k] - values[k - 1]) / period;
  return result;
}

/// The period of the sine over the deflection that takes most of a force away, of those between 0.5 and 20 mm.
double ripple_period(const Samples& deflection, const Samples& force) {
  double best = 0.0, most = 0.0;
  for (double period = 0.5e-3; period < 20e-3; period *= 1.01) {
    double sine = 0.0, cosine = 0.0;
    for (std::size_t k = 0; k < force.size(); k += 2) {
      const double turn = 2.0 * std::numbers::pi * deflection[k] / period;
      sine += force[k] * std::sin(turn);
      cosine += force[k] * std::cos(turn);
    }
    if (std::hypot(sine, cosine) > most) most = std::hypot(sine, cosine), best = period;
  }
  return best;
}

MotionScales of_channel(MotionScales scales, const Measured& measured, std::optional<Channel> channel) {
  if (channel) scales.channel = rms(measured.recording[*channel]);
  return scales;
}

Samples starts_of(const model::EffectParameter& parameter, const MotionScales& scales, const Measured& measured,
                  std::optional<Channel> channel) {
  Samples starts;
  if (parameter.starts.read == model::Reading::renewal_period) {
    if (const double period = measured.hold_period(*channel); period > 0.0) starts.push_back(period);
  } else if (parameter.starts.read == model::Reading::repeated_extreme) {
    const Samples& values = measured.recording[*channel];
    const double top = peak(values);
    const auto there = std::count_if(values.begin(), values.end(), [&](double v) { return std::abs(v) == top; });
    if (there > 3) starts.push_back(top);
  } else {
    for (const double factor : parameter.starts.factors) {
      starts.push_back(factor * parameter.starts.scale(scales));
      if (parameter.lower < 0.0) break;  // one start shows every size of either sign
    }
  }
  return starts;
}

}  // namespace

double Parameter::width() const {
  return std::min(logarithmic ? width_of_logarithm : width_in_sizes, upper - lower);
}

double Parameter::get(const Model& model) const {
  if (tolerated) return model.tolerated[number];
  const double value = model.causes[cause].values[number];
  return logarithmic ? std::log(value) : (value - neutral) / size;
}

void Parameter::put(Model& model, double u) const {
  double& value = tolerated ? model.tolerated[number] : model.causes[cause].values[number];
  value = tolerated ? u : logarithmic ? std::exp(u) : neutral + size * u;
}

std::vector<Parameter> parameters_of(const Model& model, const Measured& measured, const MotionScales& scales) {
  std::vector<Parameter> parameters;
  for (std::size_t i = 0; i < model.tolerated.size(); ++i) parameters.push_back({.cause = 0, .number = i, .tolerated = true});
  for (std::size_t c = 0; c < model.causes.size(); ++c) {
    const Cause& cause = model.causes[c];
    for (std::size_t p = 0; p < cause.values.size(); ++p) {
      const model::EffectParameter& card = cause.entry->parameters[p];
      if (!card.fitted) continue;
      Parameter u{.cause = c, .number = p, .logarithmic = card.lower >= 0.0, .neutral = card.neutral};
      if (card.kept_within > 0.0) {
        u.lower = std::log(cause.values[p]) - card.kept_within;
        u.upper = std::log(cause.values[p]) + card.kept_within;
      } else if (u.logarithmic) {
        u.lower = std::log(std::max(card.lower, 1e-9 * card.upper));
        u.upper = std::log(card.upper);
      } else {
        u.size = std::max(card.starts.scale(of_channel(scales, measured, cause.channel)), 1e-12);
        u.lower = (card.lower - u.neutral) / u.size;
        u.upper = (card.upper - u.neutral) / u.size;
      }
      parameters.push_back(u);
    }
  }
  return parameters;
}

MotionScales scales_of(const Rig& rig, const Measured& measured, const host_sim::Response& predicted) {
  MotionScales s;
  const bool car = rig.kind == model::RigKind::quarter_car;
  const double period = measured.input.period;
  Samples deflection = predicted[index(Channel::dz_b)], force, left, foot;
  for (std::size_t k = 0; k < measured.to; ++k) {
    if (!car) deflection.push_back(measured.input.motion[k].position);
    const Channel shown = car ? Channel::zdd_b : Channel::F;
    const double factor = car ? rig.body.mass : 1.0;
    force.push_back(factor * predicted[index(shown)][k]);
    left.push_back(factor * measured.recording[shown][k] - force.back());
    foot.push_back(measured.input.motion[k].acceleration);
  }
  const Samples velocity = rates(deflection, period);
  s.force = rms(force);
  s.deflection = rms(deflection);
  s.deflection_peak = peak(deflection);
  s.velocity = rms(velocity);
  s.velocity_peak = peak(velocity);
  s.acceleration = rms(rates(velocity, period));
  s.tyre_force = rms(predicted[index(Channel::F_w)]);
  s.tyre_deflection = s.tyre_force / std::max(rig.tyre.stiffness, 1.0);
  s.foot_acceleration = rms(foot);
  s.ripple_period = ripple_period(deflection, left);
  return s;
}

std::vector<Cause> candidates(const Rig& rig, const Measured& measured, const MotionScales& scales) {
  std::vector<Cause> list;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    std::vector<std::optional<Channel>> places(1);
    if (entry.of_channel) places.assign(measured.channels.begin(), measured.channels.end());
    for (const auto& channel : places) {
      if (!firmware::has_place(rig, entry, channel)) continue;
      if (rig.kind == model::RigKind::hil && channel == Channel::F_w) continue;  // computed, not measured
      std::vector<Cause> starts{{&entry, channel, {}}};
      for (const model::EffectParameter& parameter : entry.parameters) {
        std::vector<Cause> longer;
        for (const Cause& begun : starts) {
          for (const double value : starts_of(parameter, of_channel(scales, measured, channel), measured, channel)) {
            longer.push_back(begun);
            longer.back().values.push_back(value);
          }
        }
        starts = std::move(longer);
      }
      list.insert(list.end(), starts.begin(), starts.end());
    }
  }
  return list;
}

}  // namespace reference
