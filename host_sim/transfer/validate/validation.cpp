#include "host_sim/transfer/validate/validation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/transfer/common/thresholds.hpp"

namespace host_sim::transfer {

namespace {

/// Mean and variance of the draws of one response, by line.
struct LineMoments {
  std::vector<Complex> mean;
  std::vector<double> variance;
};
LineMoments line_moments_of(const Prediction& prediction, std::size_t response) {
  const std::size_t lines = prediction.centre.response[response].size();
  LineMoments m{std::vector<Complex>(lines), std::vector<double>(lines)};
  const auto count = static_cast<double>(prediction.draws.size());
  for (std::size_t k = 0; k < lines; ++k) {
    for (const Outcome& o : prediction.draws) m.mean[k] += o.response[response][k] / count;
    for (const Outcome& o : prediction.draws) {
      m.variance[k] += std::norm(o.response[response][k] - m.mean[k]) / std::max(count - 1.0, 1.0);
    }
  }
  return m;
}

/// Lines in which the road says something.
std::vector<bool> excited_lines(const Analysis& analysis) {
  std::vector<double> power;  // of the velocity: that of a road is level
  for (std::size_t k = 0; k < analysis.frequencies().size(); ++k) {
    power.push_back(analysis.foot_power()[k] * std::pow(analysis.frequencies()[k], 2));
  }
  const double usual = quantile(power, 0.5);
  std::vector<bool> excited;
  for (const double p : power) excited.push_back(p > thresholds::least_power * usual);
  return excited;
}

BandCheck check_band(const Prediction& prediction, const SecondRig& second, const LineMoments& moments,
                     const std::vector<Complex>& measured, const std::vector<std::size_t>& lines,
                     std::size_t response) {
  const Analysis& analysis = *second.analysis;
  BandCheck check{response, analysis.frequencies()[lines.front()] - 0.5 * analysis.line_width(),
                  analysis.frequencies()[lines.back()] + 0.5 * analysis.line_width()};
  double statistic = 0.0, deviation = 0.0, size = 0.0, level = 0.0, width = 0.0, effect = 0.0;
  Complex force = 0.0;
  std::vector<double> drawn(prediction.draws.size());
  for (const std::size_t k : lines) {
    const Complex d = measured[k] - moments.mean[k];
    const double variance = std::max(moments.variance[k], 1e-300);
    statistic += std::norm(d) / variance;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      drawn[i] += std::norm(prediction.draws[i].response[response][k] - moments.mean[k]) / variance;
    }
    const double noise = second.noise_density[response][k] /
                         (std::max(analysis.foot_power()[k], 1e-300) * std::max(analysis.averages(), 1.0));
    deviation += std::norm(d) - noise;
    size += std::norm(moments.mean[k]);
    level += std::norm(measured[k]);
    std::vector<double> magnitudes;
    for (const Outcome& o : prediction.draws) magnitudes.push_back(std::abs(o.response[response][k]));
    const Bands bands = bands_of(std::move(magnitudes));
    width += std::pow(0.5 * (bands.high95 - bands.low95), 2);
    const auto& effects = prediction.force_effect.response[response];
    const Complex e = effects.empty() ? 0.0 : effects[k];
    force += std::conj(e) * d;
    effect += std::norm(e);
  }
  check.p = tail_probability(statistic, drawn);
  check.deviation = std::sqrt(std::max(0.0, deviation) / std::max(size, 1e-300));
  check.level = std::sqrt(level / std::max(size, 1e-300)) - 1.0;
  check.half_width = std::sqrt(width / std::max(size, 1e-300));
  if (effect > 0.0) check.force = force / effect;
  return check;
}

}  // namespace

double Validation::smallest_p() const {
  double p = 1.0;
  for (const BandCheck& band : bands) p = std::min(p, band.p);
  return p;
}

Validation validate(const Prediction& prediction, const SecondRig& second) {
  Validation result;
  result.measured = second.analysis->of(second.measured);
  const std::vector<bool> excited = excited_lines(*second.analysis);
  double inside50 = 0.0, inside95 = 0.0, count = 0.0, score = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    const std::vector<Complex>& measured = result.measured.response[r];
    if (measured.empty()) continue;
    const LineMoments moments = line_moments_of(prediction, r);
    const std::vector<Bands> bands = prediction.response(r);
    double square = 0.0, lines = 0.0;
    std::vector<std::vector<std::size_t>> by_band(identification::noise_bands);
    for (std::size_t k = 0; k < measured.size(); ++k) {
      if (!excited[k]) continue;
      const double m = std::abs(measured[k]);
      inside50 += m >= bands[k].low50 && m <= bands[k].high50 ? 1.0 : 0.0;
      inside95 += m >= bands[k].low95 && m <= bands[k].high95 ? 1.0 : 0.0;
      for (const Outcome& o : prediction.draws) {
        result.area[r] += std::abs(std::abs(o.response[r][k]) - m) / static_cast<double>(prediction.draws.size());
      }
      square += m * m;
      lines += 1.0;
      const std::size_t band = identification::noise_band_of(second.analysis->frequencies()[k]);
      if (band < by_band.size()) by_band[band].push_back(k);
    }
    if (!(lines > 0.0)) continue;
    count += lines;
    const double rms = std::sqrt(square / lines);
    result.area[r] /= lines;
    result.area_share[r] = result.area[r] / std::max(rms, 1e-300);
    for (std::size_t k = 0; k < measured.size(); ++k) {
      if (!excited[k]) continue;
      const double variance = std::max(moments.variance[k], 1e-300) / std::max(rms * rms, 1e-300);
      score += std::log(std::numbers::pi * variance) +
               std::norm(measured[k] - moments.mean[k]) / std::max(moments.variance[k], 1e-300);
    }
    for (const auto& list : by_band) {
      if (!list.empty()) result.bands.push_back(check_band(prediction, second, moments, measured, list, r));
    }
  }
  if (count > 0.0) {
    result.coverage50 = inside50 / count;
    result.coverage95 = inside95 / count;
    result.log_score = score / count;
  }
  const double limit = thresholds::family_error / static_cast<double>(std::max<std::size_t>(result.bands.size(), 1));
  for (BandCheck& band : result.bands) {
    band.holds = band.p >= limit || band.deviation < thresholds::worth_saying;
    result.holds = result.holds && band.holds;
  }
  for (std::size_t q = 0; q < quantity_count; ++q) {
    for (const Outcome& o : prediction.draws) {
      result.quantity_area[q] +=
          std::abs(o.quantity[q] - result.measured.quantity[q]) / static_cast<double>(prediction.draws.size());
    }
  }
  return result;
}

}  // namespace host_sim::transfer
