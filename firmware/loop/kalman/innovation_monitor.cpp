#include "firmware/loop/kalman/innovation_monitor.hpp"

#include <cmath>

#include "model/numerics/elementary.hpp"

namespace firmware {
namespace {

/// 1 − Φ(z), z ≥ 0.
double upper_tail(double z) {
  constexpr double one_by_root_2_pi = 0.3989422804014327;
  constexpr int pieces = 400;
  constexpr double width = 6.0 / pieces;  // beyond z + 6 less than 1e-8 of the tail is left
  const auto density = [](double t) { return model::decaying(0.5 * t * t); };
  double sum = density(z) + density(z + 6.0);
  for (int i = 1; i < pieces; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * density(z + width * i);
  return one_by_root_2_pi * sum * width / 3.0;
}

}  // namespace

double normal_quantile(double tail) {
  double low = 0.0, high = 9.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    if (upper_tail(middle) > tail) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return 0.5 * (low + high);
}

InnovationMonitor::InnovationMonitor(int channels, double period, double false_alarms) {
  constexpr double tests = 2.0 + static_cast<double>(shifts.size());
  const double share = false_alarms * block * period / 3600.0 / (tests * channels);
  limit_ = normal_quantile(0.5 * (share < 0.5 ? share : 0.5));
}

void InnovationMonitor::restart() {
  for (PerChannel& channel : channels_) channel = {};
  wrong_ = false;
  alarms_ = blocks_ = 0;
  last_ = {};
}

void InnovationMonitor::take(int channel, double innovation) {
  PerChannel& c = channels_[static_cast<std::size_t>(channel)];
  c.sum += innovation;
  c.squares += innovation * innovation;
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const auto at = static_cast<std::size_t>(c.newest + static_cast<int>(kept) - shifts[i] + 1) % kept;
    c.products[i] += innovation * c.past[at];
  }
  c.newest = (c.newest + 1) % static_cast<int>(kept);
  c.past[static_cast<std::size_t>(c.newest)] = innovation;
  if (++c.taken + c.aside == block) judge(channel);
}

void InnovationMonitor::set_aside(int channel) {
  PerChannel& c = channels_[static_cast<std::size_t>(channel)];
  if (++c.aside + c.taken == block) judge(channel);
}

void InnovationMonitor::judge(int channel) {
  PerChannel& c = channels_[static_cast<std::size_t>(channel)];
  if (c.blocks == settling) {
    ++blocks_;
    if (c.aside > block / 2) {
      compare(Test::road, channel, c.aside / static_cast<double>(block), 0.0, 0.5);
    } else {
      const auto n = static_cast<double>(c.taken);
      const double root = std::sqrt(n), skew = (limit_ * limit_ - 1.0) * std::sqrt(8.0 / n) / 6.0;
      compare(Test::level, channel, c.sum / root, -limit_, limit_);
      compare(Test::variance, channel, (c.squares - n) / std::sqrt(2.0 * n), skew - limit_, skew + limit_);
      for (const double products : c.products) compare(Test::colour, channel, products / root, -limit_, limit_);
    }
  }
  if (c.blocks < settling) ++c.blocks;
  c.sum = c.squares = 0.0;
  c.products.fill(0.0);
  c.taken = c.aside = 0;
}

void InnovationMonitor::compare(Test test, int channel, double statistic, double lower, double upper) {
  if (statistic >= lower && statistic <= upper) return;  // NaN: wrong
  wrong_ = true;
  ++alarms_;
  last_ = {test, channel, statistic};
}

}  // namespace firmware
