#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/reference/diagnose.hpp"

namespace reference {
namespace {

using model::Channel;
using model::MotionScales;
using Samples = std::vector<double>;

double rms(const Samples& values) {
  const Eigen::Map<const Eigen::ArrayXd> x(values.data(), static_cast<Eigen::Index>(values.size()));
  return values.empty() ? 0.0 : std::sqrt((x - x.mean()).square().mean());
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
    std::complex<double> sum;
    for (std::size_t k = 0; k < force.size(); k += 2) {
      sum += force[k] * std::polar(1.0, 2.0 * std::numbers::pi * deflection[k] / period);
    }
    if (std::abs(sum) > most) most = std::abs(sum), best = period;
  }
  return best;
}

double unit_of(const model::EffectParameter& card, MotionScales scales, const Measured& m,
               std::optional<Channel> channel) {
  if (channel) scales.channel = rms(m.recording[*channel]);
  return card.starts.scale(scales);
}

Samples starts_of(const model::EffectParameter& card, const MotionScales& scales, const Measured& m,
                  std::optional<Channel> channel) {
  if (card.starts.read == model::Reading::renewal_period) {
    return m.renewals[index(*channel)] ? Samples{m.hold_period(*channel)} : Samples{};
  }
  if (card.starts.read == model::Reading::repeated_extreme) {  // a limit gives one value again and again
    const Samples& values = m.recording[*channel];
    const double top = peak(values);
    const auto there = std::count_if(values.begin(), values.end(), [&](double v) { return std::abs(v) == top; });
    return there > 3 ? Samples{top} : Samples{};
  }
  Samples starts;
  for (const double factor : card.starts.factors) starts.push_back(factor * unit_of(card, scales, m, channel));
  if (card.lower < 0.0) starts.resize(1);  // shows every size of either sign
  return starts;
}

}  // namespace

std::string words(const Cause& cause) {
  return std::string(cause.entry->name) + (cause.channel ? " of " + std::string(name(*cause.channel)) : "");
}

double Parameter::get(const Model& model) const {
  if (!cause) return model.tolerated[number];
  const double value = model.causes[*cause].values[number];
  return logarithmic ? std::log(value) : (value - neutral) / size;
}

void Parameter::put(Model& model, double u) const {
  if (!cause) model.tolerated[number] = u;
  if (cause) model.causes[*cause].values[number] = logarithmic ? std::exp(u) : neutral + size * u;
}

std::vector<Parameter> parameters_of(const Model& model, const Measured& m, const MotionScales& scales) {
  std::vector<Parameter> parameters;
  for (std::size_t i = 0; i < model.tolerated.size(); ++i) parameters.push_back({.number = i});
  for (std::size_t c = 0; c < model.causes.size(); ++c) {
    const Cause& cause = model.causes[c];
    for (std::size_t p = 0; p < cause.values.size(); ++p) {
      const model::EffectParameter& card = cause.entry->parameters[p];
      if (!card.fitted) continue;
      Parameter u{.number = p, .cause = c, .logarithmic = card.lower >= 0.0, .neutral = card.neutral};
      if (!u.logarithmic) u.size = std::max(std::abs(unit_of(card, scales, m, cause.channel)), 1e-12);
      const auto coordinate = [&u](double v) { return u.logarithmic ? std::log(v) : (v - u.neutral) / u.size; };
      u.lower = coordinate(u.logarithmic ? std::max(card.lower, 1e-9 * card.upper) : card.lower);
      u.upper = coordinate(card.upper);
      if (card.kept_within > 0.0) {
        u.lower = coordinate(cause.values[p]) - card.kept_within;
        u.upper = u.lower + 2.0 * card.kept_within;
      }
      parameters.push_back(u);
    }
  }
  return parameters;
}

MotionScales scales_of(const Description& description, const Measured& m, const Readings& predicted) {
  const bool car = description.rig.kind == model::RigKind::quarter_car;
  const Channel shown = car ? Channel::zdd_b : Channel::F;
  Samples deflection = predicted[index(Channel::dz_b)], force = predicted[index(shown)], left, foot;
  for (std::size_t k = 0; k < m.to; ++k) {
    if (!car) deflection.push_back(m.input.motion[k].position);
    if (car) force[k] *= description.rig.body.mass;
    left.push_back(m.recording[shown][k] * (car ? description.rig.body.mass : 1.0) - force[k]);
    foot.push_back(m.input.motion[k].acceleration);
  }
  const Samples velocity = rates(deflection, m.input.period);
  const double tyre = rms(predicted[index(Channel::F_w)]);
  return {.force = rms(force),
          .deflection = rms(deflection),
          .deflection_peak = peak(deflection),
          .velocity = rms(velocity),
          .velocity_peak = peak(velocity),
          .acceleration = rms(rates(velocity, m.input.period)),
          .tyre_force = tyre,
          .tyre_deflection = tyre / std::max(description.rig.tyre.stiffness, 1.0),
          .foot_acceleration = rms(foot),
          .ripple_period = ripple_period(deflection, left)};
}

std::vector<Cause> candidates(const Description& description, const Measured& m, const MotionScales& scales) {
  std::vector<Cause> list;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    std::vector<std::optional<Channel>> places(1);
    if (entry.of_channel) places.assign(m.channels.begin(), m.channels.end());
    for (const auto& channel : places) {
      // F_w of a hil rig is computed: it has no sensor, and no noise.
      if (channel && !description.noise[index(*channel)]) continue;
      if (!firmware::has_place(description.rig, entry, channel)) continue;
      std::vector<Cause> starts{{&entry, channel, {}}};  // of all parameters: every combination
      for (const model::EffectParameter& card : entry.parameters) {
        std::vector<Cause> longer;
        for (const Cause& begun : starts) {
          for (const double value : starts_of(card, scales, m, channel)) {
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
