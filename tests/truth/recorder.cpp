#include "tests/truth/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truth {

using std::numbers::pi;

LowPass::LowPass(double corner, int order, double step) {
  if (corner <= 0.0) return;
  const double k = std::tan(pi * std::min(corner * step, 0.49));
  if (order % 2 == 1) sections_.push_back({{k / (1.0 + k), k / (1.0 + k), 0.0}, {0.0, (k - 1.0) / (1.0 + k), 0.0}});
  for (int pair = 0; pair < order / 2; ++pair) {
    // Poles at an angle from the imaginary axis; twice its sine damps the section.
    const double damping = 2.0 * std::sin(pi * (2.0 * pair + 1.0) / (2.0 * order));
    const double a = 1.0 + damping * k + k * k;
    sections_.push_back(
        {{k * k / a, 2.0 * k * k / a, k * k / a}, {0.0, 2.0 * (k * k - 1.0) / a, (1.0 - damping * k + k * k) / a}});
  }
}

double LowPass::Section::push(double value) {
  u = {value, u[0], u[1]};
  const double next = in[0] * u[0] + in[1] * u[1] + in[2] * u[2] - out[1] * y[0] - out[2] * y[1];
  y = {next, y[0], y[1]};
  return next;
}

double LowPass::push(double value) {
  if (!begun_) {
    begun_ = true;
    for (Section& section : sections_) {
      section.u.fill(value);
      section.y.fill(value);
    }
    return value;
  }
  for (Section& section : sections_) value = section.push(value);
  return value;
}

Recording::Recording(const Recorder& recorder, double node, double sample, Random random)
    : recorder_(recorder),
      node_(node),
      low_pass_(recorder.corner, recorder.order, recorder.digital ? sample : node),
      random_(random),
      hum_phase_(2.0 * pi * random_.uniform()) {}

void Recording::push(double value, bool at_sample) {
  if (recorder_.digital && !at_sample && !history_.empty())
    value = history_.back();
  else if (recorder_.corner > 0.0)
    value = low_pass_.push(value);
  if (has_clock() || history_.empty())
    history_.push_back(value);
  else
    history_.back() = value;
}

double Recording::row(double value, double since_start) {
  if (every_node()) {
    value = history_.back();
    if (has_clock()) {
      const double last = static_cast<double>(history_.size() - 1);
      const double place = std::max(0.0, last - (recorder_.late + recorder_.drift * since_start) / node_);
      const auto i = std::min(static_cast<std::size_t>(place), history_.size() - 1);
      const double u = place - static_cast<double>(i);
      value = (1.0 - u) * history_[i] + u * history_[std::min(i + 1, history_.size() - 1)];
    }
  }
  if (recorder_.hum > 0.0) value += recorder_.hum * std::sin(2.0 * pi * recorder_.hum_hz * since_start + hum_phase_);
  return value;
}

void Recording::strike(std::vector<double>& rows) {
  for (int i = 0; i < recorder_.outliers; ++i) {
    double& row = rows[static_cast<std::size_t>(random_.below(static_cast<int>(rows.size())))];
    row += random_.sign() * random_.uniform(0.5, 1.5) * recorder_.outlier;
  }
  if (recorder_.step > 0.0)
    for (double& row : rows) row = rounded(row);
}

double Recording::rounded(double value) const { return std::round(value / recorder_.step) * recorder_.step; }

double noise_behind(const Recorder& recorder, double sample_rate) {
  // Answer to a value held for one sample, in steps of a fiftieth of it, read at the samples.
  const int fine = recorder.digital ? 1 : 50;
  LowPass filter(recorder.corner, recorder.order, 1.0 / (sample_rate * fine));
  (void)filter.push(0.0);
  double power = 0.0;
  for (int sample = 0; sample < 400; ++sample) {
    double value = 0.0;
    for (int i = 0; i < fine; ++i) value = filter.push(sample == 0 ? 1.0 : 0.0);
    power += value * value;
  }
  return std::sqrt(power);
}

}  // namespace truth
